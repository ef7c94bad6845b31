# SPDX-License-Identifier: GPL-3.0-or-later
"""Converged pictures, kept outside the repository from run to run, and how far other pictures are from them."""

import hashlib
import os
from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np

import addon
from engine_core.jit import source_digest

from .cycles import references_folder
from .engines import render

PART = 512  # samples of one part: an interrupted reference goes on where it was, and the parts tell its own noise
SETTINGS = (  # that change what a picture converges to
    *(
        "max_bounces",
        "diffuse_bounces",
        "glossy_bounces",
        "transmission_bounces",
        "volume_bounces",
        "transparent_max_bounces",
    ),
    *("filter_type", "filter_width", "exposure", "caustics_reflective", "caustics_refractive"),
)


class Reference(NamedTuple):
    picture: np.ndarray  # float32 (h, w, 3)
    samples: int
    mean: float  # over pixels and colours
    mean_error: float  # one standard deviation of that


def reference(engine, scene, source, samples, progress=None, draw=None, key=()):
    """The mean of pictures by independent seeds with `samples` together. `source`: what names the open scene.

    `progress(fraction)` is called now and then. `draw(samples, seed, progress)` renders a picture where `engine` is
    none of Blender's, and `key` is what that depends on besides.
    """
    part = min(PART, -(-samples // 4))
    count = -(-samples // part)
    draw = draw or (lambda *effort: render(engine, scene, effort[0], effort[1], progress=effort[2]).picture)
    name, parts = digest(engine, scene, source, key), []
    for number in range(count):
        kept = references_folder() / f"{name}-{part}-{number}.npy"
        if not kept.exists():
            tell = progress and (lambda fraction, number=number: progress((number + fraction) / count))
            save(kept, draw(part, 977 + number, tell)[..., :3])
        parts.append(np.load(kept))
    means = np.array([picture.mean(dtype=np.float64) for picture in parts])
    error = means.std(ddof=1) / np.sqrt(count) if count > 1 else np.inf
    return Reference(np.mean(parts, axis=0), part * count, float(means.mean()), float(error))


def digest(engine, scene, source, key=()):
    """Names a picture by all that decides it: files, settings, the engine's sources."""
    parts = [engine, bpy.app.version_string, scene.frame_current, scene.render.resolution_x, scene.render.resolution_y]
    parts += [scene.render.resolution_percentage, scene.render.film_transparent]
    parts += [
        round(getattr(scene.lambent, name), 6) if name == "filter_width" else getattr(scene.lambent, name)
        for name in SETTINGS
    ]
    parts.append(Path(source).read_bytes())
    for path in sorted(bpy.utils.blend_paths(absolute=True, packed=False)):  # images and libraries beside the file
        parts += [path, Path(path).stat().st_mtime_ns if Path(path).is_file() else None]
    if engine == "LAMBENT":
        parts += [source_digest(), scene.lambent.integrator]
        parts += [path.read_bytes() for path in sorted(Path(addon.__file__).parent.glob("export/*.py"))]
    parts += key
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:32]


def save(path, picture):
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(f".{os.getpid()}.npy")
    np.save(unfinished, picture)
    unfinished.replace(path)


def relative_error(picture, reference):
    """Mean of (x - r)^2 / (r^2 + 0.01) over pixels and colours, without the worst 0.1 % of the pixels."""
    x, r = (image[..., :3].astype(np.float64) for image in (picture, reference))
    errors = ((x - r) ** 2 / (r**2 + 0.01)).mean(axis=-1).ravel()
    kept = len(errors) - int(np.ceil(len(errors) * 0.001))
    return float(np.sort(errors)[:kept].mean())


def rms_error(picture, reference):
    """Root of the mean squared difference."""
    x, r = (image[..., :3].astype(np.float64) for image in (picture, reference))
    return float(np.sqrt(np.mean((x - r) ** 2)))
