# SPDX-License-Identifier: GPL-3.0-or-later
"""Rectangles and triangles by solid angle: the angle itself, and that directions are uniform in it."""

import numba
import numpy as np
import pytest

from blender_tests.helpers.chi_square import compare_directions, significance_of_one_of, window_around
from engine_core.linalg.vec3 import Vec3
from engine_core.sampling.spherical import (
    Rectangle,
    edge_angle,
    is_small_rectangle,
    rectangle_solid_angle,
    sample_rectangle,
    sample_rectangle_pdf,
    square_to_spherical_triangle,
    triangle_solid_angle,
)

N = 100_000
RECTANGLES = {  # x0, x1, y0, y1, z
    "ahead": (-0.5, 0.5, -0.5, 0.5, 1.0),
    "beside": (0.3, 1.5, 0.2, 2.0, 0.7),
    "strip": (-3.0, 3.0, 0.1, 0.2, 0.5),
    "all around": (-50.0, 40.0, -30.0, 60.0, 0.1),
    "near its edge": (0.001, 1.0, -0.5, 0.5, 0.01),
    "edge on": (0.5, 1.5, -0.5, 0.5, 0.03),
    "far": (0.0, 0.1, 0.0, 0.2, 3.0),
}
TRIANGLES = {
    "octant": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "small": ((1, 0, 0), (1, 0.3, 0), (1, 0.1, 0.4)),
    "sliver": ((1, -2, 0.1), (1, 2, 0.1), (1, 0, 0.3)),
    "nearly a half sphere": ((1, 0, -0.05), (-0.5, 0.8, -0.05), (-0.5, -0.8, -0.05)),
}
SIGNIFICANCE = significance_of_one_of(len(RECTANGLES) + len(TRIANGLES))


def float32s(values):
    return tuple(np.float32(v) for v in values)


def exact_triangle_solid_angle(a, b, c):
    """Van Oosterom and Strackee 1983, in float64."""
    a, b, c = (np.asarray(v, float) / np.linalg.norm(v) for v in (a, b, c))
    return 2.0 * np.arctan2(abs(np.dot(a, np.cross(b, c))), 1.0 + a @ b + b @ c + c @ a) % (2.0 * np.pi)


def exact_rectangle_solid_angle(x0, x1, y0, y1, z):
    corners = [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]
    return exact_triangle_solid_angle(*corners[:3]) + exact_triangle_solid_angle(corners[0], *corners[2:])


@numba.njit
def sample_rectangle_often(u, x0, x1, y0, y1, z):
    result = np.empty((len(u), 3), np.float32)
    for i in range(len(u)):
        result[i] = sample_rectangle(u[i, 0], u[i, 1], Rectangle(x0, x1, y0, y1, z))
    return result


@numba.njit
def rectangle_pdf_often(points, x0, x1, y0, y1, z):
    result = np.empty(len(points), np.float32)
    for i in range(len(points)):
        result[i] = sample_rectangle_pdf(Rectangle(x0, x1, y0, y1, z), points[i, 0], points[i, 1])
    return result


@numba.njit
def sample_triangle_often(u, a, b, c):
    result = np.empty((len(u), 3), np.float32)
    solid_angle = triangle_solid_angle(a, b, c)
    for i in range(len(u)):
        w = square_to_spherical_triangle(u[i, 0], u[i, 1], a, b, c, solid_angle)
        result[i, 0], result[i, 1], result[i, 2] = w.x, w.y, w.z
    return result


@pytest.fixture
def u():
    return (np.random.default_rng(2).integers(0, 2**24, (N, 2)) * 2.0**-24).astype(np.float32)


@pytest.mark.parametrize("name", [n for n in RECTANGLES if n != "far"])
def test_rectangle_solid_angle(name):
    solid_angle, phi = rectangle_solid_angle(Rectangle(*float32s(RECTANGLES[name])))
    assert solid_angle == pytest.approx(exact_rectangle_solid_angle(*RECTANGLES[name]), rel=1e-4)
    assert phi == edge_angle(Rectangle(*float32s(RECTANGLES[name])), np.float32(RECTANGLES[name][0]))


@pytest.mark.parametrize("name", RECTANGLES)
def test_rectangle_follows_its_density(name, u):
    x0, x1, y0, y1, z = rectangle = float32s(RECTANGLES[name])
    x, y, density = sample_rectangle_often(u, *rectangle).T.astype(float)
    assert x0 <= x.min() <= x.max() <= x1
    assert y0 <= y.min() <= y.max() <= y1
    directions = np.stack([x, y, np.full(N, z)], axis=1)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)

    def pdf(w):
        with np.errstate(divide="ignore", invalid="ignore"):
            points = w[:, :2] * (z / w[:, 2:])
        px, py = points.T
        inside = (w[:, 2] > 0) & (px >= x0) & (px <= x1) & (py >= y0) & (py <= y1)
        values = rectangle_pdf_often(np.ascontiguousarray(points, np.float32), *rectangle)
        return np.where(inside, values, 0.0)

    result = compare_directions(directions, pdf, window_around(directions, 1.0), tolerance=1e-4)
    assert result.p_value > SIGNIFICANCE, result
    points = np.stack([x, y], axis=1).astype(np.float32)
    np.testing.assert_allclose(rectangle_pdf_often(points, *rectangle), density, rtol=1e-6)


def test_small_rectangles_are_sampled_by_area():
    assert is_small_rectangle(Rectangle(*float32s(RECTANGLES["far"])))
    assert not is_small_rectangle(Rectangle(*float32s(RECTANGLES["ahead"])))


@pytest.mark.parametrize("z", [1e-7, 1e-3, 1e3])
def test_extreme_rectangles_give_finite_points_within(z, u):
    for corners in ((-1e-3, 1e3, -1e3, 1e3), (0.0, 1.0, 0.0, 1.0), (1.0, 1.0001, -5.0, 5.0)):
        x0, x1, y0, y1, _ = rectangle = float32s((*corners, z))
        x, y, density = sample_rectangle_often(u[:5000], *rectangle).T
        assert np.isfinite(density).all()
        assert (density > 0).all()
        assert ((x >= x0) & (x <= x1) & (y >= y0) & (y <= y1)).all()


@pytest.mark.parametrize("name", TRIANGLES)
def test_triangle_is_uniform_in_its_solid_angle(name, u):
    corners = np.array(TRIANGLES[name], float)
    corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    a, b, c = (Vec3(*corner) for corner in corners)
    exact = exact_triangle_solid_angle(*corners)
    assert triangle_solid_angle(a, b, c) == pytest.approx(exact, rel=1e-5)
    directions = sample_triangle_often(u, a, b, c)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, atol=2e-6)
    # inside: on the inner side of the three planes through the eye
    planes = np.cross(corners, np.roll(corners, -1, axis=0))
    planes *= np.sign(np.linalg.det(corners))
    assert (directions @ planes.T).min() > -1e-5

    result = compare_directions(
        directions,
        lambda w: ((w @ planes.T).min(axis=1) >= 0.0) / exact,
        window_around(directions, 1.0),
        tolerance=1e-4,
    )
    assert result.p_value > SIGNIFICANCE, result
