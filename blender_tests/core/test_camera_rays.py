# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras: where rays go, where they meet, and where on the lens they start."""

import math

import numpy as np
import pytest
from scipy import stats

from engine_core.camera.dispatch import generate_ray
from engine_core.jit import kernel
from engine_core.linalg.records import Tables
from engine_core.tables import CAMERA, CameraKind

ROTATION = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
POSITION = np.array([1.0, -2.0, 3.0])
SCREEN = (-0.6, 0.4, -0.2, 0.3)  # shifted


class OneCamera(Tables):
    camera = CAMERA


@kernel
def _generate_rays(scene, places, u, rays):
    for i in range(len(places)):
        ray = generate_ray(scene.camera[0], places[i, 0], places[i, 1], u[i, 0], u[i, 1])
        rays[i, 0], rays[i, 1], rays[i, 2] = ray.o.x, ray.o.y, ray.o.z
        rays[i, 3], rays[i, 4], rays[i, 5], rays[i, 6] = ray.d.x, ray.d.y, ray.d.z, ray.t_max


def camera(kind=CameraKind.PERSPECTIVE, **fields):
    row = np.zeros(1, CAMERA)
    row["kind"], row["screen"], row["aperture_ratio"], row["focus_distance"] = kind, SCREEN, 1.0, 4.0
    row["to_world"] = np.column_stack([ROTATION, POSITION])
    row["clip_end"] = np.inf
    for name, value in fields.items():
        row[name] = value
    return OneCamera(camera=row)


def rays_of(scene, places, u=None):
    """Rays for places (n, 2) in the frame, in the camera's space: origins, directions, (n, 3) each, and t_max."""
    places = np.atleast_2d(np.asarray(places, np.float32))
    u = np.full_like(places, 0.5) if u is None else np.asarray(u, np.float32)
    rays = np.zeros((len(places), 7), np.float32)
    _generate_rays(scene, places, u, rays)
    rays = rays.astype(float)
    return (rays[:, :3] - POSITION) @ ROTATION, rays[:, 3:6] @ ROTATION, rays[:, 6]


def lens_numbers(n, seed=0):
    return (np.random.default_rng(seed).integers(0, 2**24, (n, 2)) * 2.0**-24).astype(np.float32)


CORNERS = [(0, 0), (1, 0), (0, 1), (1, 1), (0.5, 0.5)]
KINDS = [CameraKind.PERSPECTIVE, CameraKind.ORTHOGRAPHIC]


def on_screen(places):
    x, y = np.asarray(places, float).T
    left, right, bottom, top = SCREEN
    return np.stack([left + (right - left) * x, bottom + (top - bottom) * y], axis=1)


# ---- Without a lens --------------------------------------------------------------------------------------------------


def test_perspective_rays_pass_the_screen_at_one_metre():
    o, d, t_max = rays_of(camera(), CORNERS)
    np.testing.assert_allclose(o, 0.0, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1.0, atol=1e-6)
    np.testing.assert_allclose(d[:, :2] / -d[:, 2:], on_screen(CORNERS), atol=1e-6)
    assert (d[:, 2] < 0).all()
    assert np.isinf(t_max).all()


def test_orthographic_rays_are_parallel():
    o, d, _ = rays_of(camera(CameraKind.ORTHOGRAPHIC), CORNERS)
    np.testing.assert_allclose(d, [[0, 0, -1]] * 5, atol=1e-6)
    np.testing.assert_allclose(o[:, :2], on_screen(CORNERS), atol=1e-6)
    np.testing.assert_allclose(o[:, 2], 0.0, atol=1e-6)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("lens_radius", [0.0, 0.3])
def test_rays_run_between_the_clipping_planes(kind, lens_radius):
    """Planes, not spheres: the distance along the axis counts."""
    scene = camera(kind, clip_start=0.5, clip_end=20.0, lens_radius=lens_radius)
    o, d, t_max = rays_of(scene, CORNERS, lens_numbers(5))
    np.testing.assert_allclose(o[:, 2], -0.5, atol=1e-6)
    np.testing.assert_allclose((o + d * t_max[:, None])[:, 2], -20.0, rtol=1e-6)


# ---- With a lens -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("blades", [0, 5])
def test_rays_through_the_whole_lens_meet_in_the_plane_of_focus(kind, blades):
    place = (0.9, 0.2)
    scene = camera(kind, lens_radius=0.3, blades=blades)
    o, d, _ = rays_of(scene, [place] * 1000, lens_numbers(1000))
    there = o + d * ((-4.0 - o[:, 2]) / d[:, 2])[:, None]
    x, y = on_screen([place])[0] * (4.0 if kind == CameraKind.PERSPECTIVE else 1.0)
    np.testing.assert_allclose(there, [[x, y, -4.0]] * 1000, atol=5e-6)
    spread = (o + d * ((-8.0 - o[:, 2]) / d[:, 2])[:, None]).std(axis=0)
    assert spread[:2].min() > 0.1  # and nowhere else


def lens_points(**fields):
    """Where rays leave the lens, over its radius."""
    scene = camera(lens_radius=0.3, **fields)
    o, _, _ = rays_of(scene, [(0.6, 0.4)] * 100_000, lens_numbers(100_000))
    np.testing.assert_allclose(o[:, 2], 0.0, atol=1e-6)
    return o[:, :2] / 0.3


@pytest.mark.parametrize("blades", [0, 2])
def test_round_lenses_are_uniform(blades):
    x, y = lens_points(blades=blades).T
    r2, turn = x * x + y * y, np.arctan2(y, x) / (2 * np.pi) + 0.5
    assert r2.max() < 1.0 + 1e-5
    counts, _, _ = np.histogram2d(np.minimum(r2, 1.0), turn, bins=20, range=[(0, 1)] * 2)
    assert counts.sum() == len(x)
    assert stats.chisquare(counts.ravel()).pvalue > 1e-4


@pytest.mark.parametrize(("blades", "rotation"), [(3, 0.0), (6, 0.4), (7, -1.0)])
def test_blades_make_a_polygon(blades, rotation):
    """Its corners on the circle, the middle of an edge at the angle of the rotation, counter-clockwise from x."""
    points = lens_points(blades=blades, blade_rotation=rotation)
    angles = rotation + 2.0 * np.pi * np.arange(blades) / blades
    reach = points @ np.stack([np.cos(angles), np.sin(angles)])
    apothem = math.cos(math.pi / blades)
    assert reach.max() < apothem + 1e-5
    assert reach.max(axis=0).min() > apothem - 0.01  # each edge is reached
    assert np.hypot(*points.T).max() > 0.98
    # uniform: each of the triangles between the centre and an edge gets its share, and is denser outwards as r
    sector = reach.argmax(axis=1)
    assert stats.chisquare(np.bincount(sector)).pvalue > 1e-4
    depth = np.minimum((reach.max(axis=1) / apothem) ** 2, 1.0)
    assert stats.chisquare(np.histogram(depth, 50, (0, 1))[0]).pvalue > 1e-4


def test_the_ratio_squeezes_the_lens_sideways():
    x, y = lens_points(aperture_ratio=2.0).T
    assert np.abs(x).max() == pytest.approx(0.5, abs=0.01)
    assert np.abs(y).max() == pytest.approx(1.0, abs=0.01)
    assert (4.0 * x * x + y * y).max() < 1.0 + 1e-5
