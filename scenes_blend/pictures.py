# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures that are wrapped around spheres or shine: painted by code. Float arrays (h, w, 3), lowest row first."""

import numpy as np


def mountains(width=384, height=192):
    """A wallpaper: an evening with a large sun behind five ranges of mountains. Left and right fit together."""
    y, x = np.mgrid[0:height, 0:width]
    up, along = (y + 0.5) / height, (x + 0.5) / width * 2 * np.pi
    night, dusk, glow = (np.array(color) for color in ((0.10, 0.10, 0.32), (0.85, 0.38, 0.38), (1.0, 0.80, 0.45)))
    rise = np.clip((up - 0.3) / 0.55, 0.0, 1.0)[..., None]
    picture = np.where(rise < 0.4, glow + (dusk - glow) * rise / 0.4, dusk + (night - dusk) * (rise - 0.4) / 0.6)
    across = np.abs(along - np.pi) / (2 * np.pi) * width / height
    picture[np.hypot(across, up - 0.56) < 0.13] = (1.0, 0.93, 0.72)
    random = np.random.default_rng(4)
    for layer in range(5):
        ridge = sum(
            np.sin(k * along + random.uniform(0, 2 * np.pi)) * random.uniform(0.3, 1.0) / k for k in range(2, 24)
        )
        color = glow * (0.62 - 0.13 * layer) + np.array((0.05, 0.02, 0.16)) * (1 + 0.3 * layer)
        picture[up < 0.5 - 0.09 * layer + 0.05 * ridge] = color * (0.6, 0.45, 0.62)
    return picture.astype(np.float32)


def planet(width=384, height=192):
    """A world of its own with seas, deserts, woods and ice, as a map of longitude and latitude."""
    latitude = ((np.arange(height) + 0.5) / height - 0.5)[:, None] * np.pi
    longitude = ((np.arange(width) + 0.5) / width * 2 * np.pi)[None]
    places = np.stack(np.broadcast_arrays(*on_sphere(latitude, longitude)), axis=-1)
    land, grain = waves(places, 3.0, seed=24), waves(places, 14.0, seed=2)
    land = land + 0.25 * grain
    sea, coast, wood = (0.08, 0.20, 0.48), (0.16, 0.42, 0.64), (0.38, 0.56, 0.22)
    desert, ice = (0.78, 0.64, 0.40), (0.94, 0.96, 0.98)
    picture = np.where((land < -0.25)[..., None], sea, coast)
    dry = np.abs(np.degrees(latitude) + 4 * grain) < 28
    picture = np.where((land > 0.05)[..., None], np.where((dry & (land > 0.3))[..., None], desert, wood), picture)
    picture = np.where((np.abs(np.degrees(latitude)) + 5 * land + 3 * grain > 68)[..., None], ice, picture)
    return picture.astype(np.float32)


def on_sphere(latitude, longitude):
    return np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)


def waves(places, frequency, seed, count=60):
    """Smooth random numbers of variance 1 at points (..., 3): a sum of plane waves in all directions."""
    random = np.random.default_rng(seed)
    directions = random.normal(size=(count, 3)) * frequency
    phases = random.uniform(0, 2 * np.pi, count)
    return np.sqrt(2 / count) * np.cos(places @ directions.T + phases).sum(axis=-1)
