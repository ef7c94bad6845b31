# SPDX-License-Identifier: GPL-3.0-or-later
"""Warps: each follows its density, and its inverse finds the way back."""

import math

import numba
import numpy as np
import pytest
from scipy import stats

from blender_tests.helpers.chi_square import compare_directions, significance_of_one_of, window_around
from engine_core.jit import kernel
from engine_core.linalg.vec3 import Vec3, vec3
from engine_core.linking import KernelDispatcher
from engine_core.sampling import warp

N = 100_000
SIGNIFICANCE = significance_of_one_of(20)


@pytest.fixture
def u():
    """Random numbers with 24 bits, as samplers give them: float32 (n, 2)."""
    return (np.random.default_rng(1).integers(0, 2**24, (N, 2)) * 2.0**-24).astype(np.float32)


def plane_map(function, *parameters):
    """Apply a kernel (x, y, *parameters) -> (x, y) to rows of an array."""

    @numba.njit
    def apply(points):
        result = np.empty_like(points)
        for i in range(len(points)):
            result[i, 0], result[i, 1] = function(points[i, 0], points[i, 1], *parameters)
        return result

    return apply


def direction_map(function, *parameters):
    """Apply a kernel (u0, u1, *parameters) -> Vec3 to rows of an array."""

    @numba.njit
    def apply(points):
        result = np.empty((len(points), 3), np.float32)
        for i in range(len(points)):
            w = function(points[i, 0], points[i, 1], *parameters)
            result[i, 0], result[i, 1], result[i, 2] = w.x, w.y, w.z
        return result

    return apply


def inverse_direction_map(function, *parameters):
    @numba.njit
    def apply(directions):
        result = np.empty((len(directions), 2), np.float32)
        for i in range(len(directions)):
            w = Vec3(directions[i, 0], directions[i, 1], directions[i, 2])
            result[i, 0], result[i, 1] = function(w, *parameters)
        return result

    return apply


def uniformity(*coordinates, cells=20):
    counts, _ = np.histogramdd(np.stack(coordinates, axis=-1), bins=cells, range=[(0, 1)] * len(coordinates))
    assert counts.sum() == len(coordinates[0])
    return stats.chisquare(counts.ravel()).pvalue


# ---- Planes ----------------------------------------------------------------------------------------------------------


def test_disk_is_uniform(u):
    x, y = plane_map(warp.square_to_disk)(u).T.astype(float)
    r2, turn = x * x + y * y, np.arctan2(y, x) / (2 * np.pi) + 0.5
    assert r2.max() <= 1.0 + 1e-6
    assert uniformity(np.minimum(r2, 1.0), turn) > SIGNIFICANCE  # equal cells of these have equal area


def test_disk_keeps_squares_around_the_centre_as_circles():
    to_disk = plane_map(warp.square_to_disk)
    edge = np.linspace(-0.3, 0.3, 7)
    for a, b in ((edge, 0.3), (edge, -0.3), (0.3, edge), (-0.3, edge)):
        points = to_disk(np.stack(np.broadcast_arrays(a, b), axis=-1).astype(np.float32) + np.float32(0.5))
        np.testing.assert_allclose(np.hypot(*points.T), 0.6, atol=1e-6)


def test_disk_has_an_edge():
    """Its density is 1 / area inside and 0 outside."""
    assert warp.square_to_disk_pdf(np.float32(0.6), np.float32(-0.79)) == pytest.approx(1.0 / math.pi)
    assert warp.square_to_disk_pdf(np.float32(0.6), np.float32(-0.81)) == 0.0


def test_disk_has_a_centre():
    np.testing.assert_array_equal(warp.square_to_disk(np.float32(0.5), np.float32(0.5)), 0.0)


def test_triangle_is_uniform(u):
    b1, b2 = plane_map(warp.square_to_triangle)(u).T.astype(float)
    assert min(b1.min(), b2.min(), (1.0 - b1 - b2).min()) >= -1e-7
    # b1 + b2 = s has the density 2 s, and any part of it may be b2
    s = np.minimum(b1 + b2, 1.0)
    assert uniformity(s * s, b2 / np.maximum(s, 1e-30)) > SIGNIFICANCE


@pytest.mark.parametrize("corners", [3, 5, 6, 17])
def test_polygon_is_uniform_and_inscribed(u, corners):
    points = plane_map(warp.square_to_regular_polygon, corners)(u)
    # distances from the edges' lines: the middles of the edges lie at the turns 0, 1 / n, 2 / n ...
    angles = 2.0 * np.pi * np.arange(corners) / corners
    edges = np.stack([np.cos(angles), np.sin(angles)])
    assert (points @ edges).max() <= np.cos(np.pi / corners) + 1e-6
    cells, fine = 24, 50
    grid = (np.arange(cells * fine) + 0.5) / (cells * fine) * 2.0 - 1.0
    inside = np.ones((len(grid), len(grid)), bool)
    for x, y in edges.T:
        inside &= grid[:, None] * x + grid * y <= np.cos(np.pi / corners)
    area = inside.reshape(cells, fine, cells, fine).mean(axis=(1, 3)) * (2.0 / cells) ** 2
    assert warp.square_to_regular_polygon_pdf(corners) == pytest.approx(1.0 / area.sum(), rel=2e-3)
    counts, _, _ = np.histogram2d(*points.T, bins=cells, range=[(-1, 1)] * 2)
    whole = area > 0.999 * area.max()  # the area of cells that an edge cuts is known less well
    expected = counts[whole].sum() / whole.sum()
    assert stats.chisquare(counts[whole]).pvalue > SIGNIFICANCE
    assert expected == pytest.approx(N * area.max() / area.sum(), rel=0.01)


@pytest.mark.parametrize(
    ("forth", "back"),
    [(warp.square_to_disk, warp.disk_to_square), (warp.square_to_triangle, warp.triangle_to_square)],
)
def test_inverses_in_the_plane(u, forth, back):
    np.testing.assert_allclose(plane_map(back)(plane_map(forth)(u)), u, atol=1e-6)


# ---- Directions ------------------------------------------------------------------------------------------------------


def test_cosine_hemisphere_follows_its_density(u):
    directions = direction_map(warp.square_to_cosine_hemisphere)(u)
    result = compare_directions(directions, lambda w: np.maximum(w[:, 2], 0.0) / np.pi)
    assert result.p_value > SIGNIFICANCE, result
    for z in (-0.5, 0.0, 0.3, 1.0):
        assert warp.square_to_cosine_hemisphere_pdf(Vec3(0.0, 0.0, z)) == pytest.approx(max(z, 0.0) / math.pi)


def test_sphere_is_uniform(u):
    directions = direction_map(warp.square_to_sphere)(u)
    result = compare_directions(directions, lambda w: np.full(len(w), warp.square_to_sphere_pdf()))
    assert result.p_value > SIGNIFICANCE, result


@pytest.mark.parametrize("degrees", [0.1, 10.0, 90.0, 150.0])
def test_cone_is_uniform_however_narrow(u, degrees):
    height = np.float32(2.0 * math.sin(math.radians(degrees) / 2.0) ** 2)
    x, y, _ = direction_map(warp.square_to_cone, height)(u).T.astype(float)
    # by the sine, not by z, which says nothing in a narrow cone
    sine2 = x * x + y * y
    z = direction_map(warp.square_to_cone, height)(u)[:, 2]
    down = np.where(z > 0.5, sine2 / (1.0 + np.sqrt(np.maximum(1.0 - sine2, 0.0))), 1.0 - z)
    assert down.max() <= height * (1.0 + 1e-5)
    turn = np.arctan2(y, x) / (2 * np.pi) + 0.5
    assert uniformity(np.minimum(down / height, 1.0), turn) > SIGNIFICANCE
    solid_angle = 2.0 * math.pi * (1.0 - math.cos(math.radians(degrees)))
    assert warp.square_to_cone_pdf(height) == pytest.approx(1.0 / solid_angle, rel=1e-5)


def test_directions_are_unit(u):
    for apply in (
        direction_map(warp.square_to_cosine_hemisphere),
        direction_map(warp.square_to_sphere),
        direction_map(warp.square_to_cone, np.float32(1.7)),
    ):
        np.testing.assert_allclose(np.linalg.norm(apply(u), axis=1), 1.0, atol=1e-6)


def test_inverses_on_the_sphere(u):
    u = u[(u[:, 0] > 1e-3) & (u[:, 0] < 1.0 - 1e-3)]  # at the poles every turn is the same direction
    cosine = direction_map(warp.square_to_cosine_hemisphere)(u)
    np.testing.assert_allclose(inverse_direction_map(warp.cosine_hemisphere_to_square)(cosine), u, atol=1e-6)
    back = inverse_direction_map(warp.sphere_to_square)(direction_map(warp.square_to_sphere)(u))
    np.testing.assert_allclose(np.abs(back - u) % 1.0, 0.0, atol=1e-5)
    height = np.float32(0.4)
    back = inverse_direction_map(warp.cone_to_square, height)(direction_map(warp.square_to_cone, height)(u))
    np.testing.assert_allclose(back, u, atol=2e-6)


def test_cap_height_keeps_its_digits():
    sine = np.geomspace(1e-8, 0.5, 50)
    heights = [warp.cap_height(np.float32(s * s)) for s in sine]
    np.testing.assert_allclose(heights, 2.0 * np.sin(np.arcsin(sine) / 2.0) ** 2, rtol=3e-7)
    assert warp.cap_height(np.float32(1.0)) == 1.0
    assert warp.cap_height(np.float32(0.0)) == 0.0


def test_circular_functions_are_right_to_the_last_place():
    @kernel
    def turns(turn, c, s):
        for i in range(len(turn)):
            c[i], s[i] = warp.cos_sin_turn(turn[i])

    turn = np.linspace(0.0, 1.0, 10_001).astype(np.float32)
    c, s = np.empty_like(turn), np.empty_like(turn)
    turns(turn, c, s)
    angle = 2.0 * np.pi * turn.astype(float)
    np.testing.assert_allclose(c, np.cos(angle), atol=1.2e-7)
    np.testing.assert_allclose(s, np.sin(angle), atol=1.2e-7)


def test_angle_of_a_point_is_right_to_the_last_places():
    @kernel
    def angles(y, x, out):
        for i in range(len(x)):
            out[i] = warp.angle_of(y[i], x[i])

    turn, size = np.linspace(-np.pi, np.pi, 20_001), np.geomspace(1e-15, 1e15, 20_001)
    on_axes = np.array([(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (1.0, 1.0), (-1.0, -1.0), (1e-30, 1e-30)])
    y = np.append(size * np.sin(turn), on_axes[:, 0]).astype(np.float32)
    x = np.append(size * np.cos(turn), on_axes[:, 1]).astype(np.float32)
    out = np.empty_like(x)
    angles(y, x, out)
    np.testing.assert_allclose(out, np.arctan2(y.astype(float), x.astype(float)), rtol=2.5e-7)
    assert warp.angle_of(np.float32(0.0), np.float32(0.0)) == 0.0


def test_results_are_float32():
    """A float64 in between would make a kernel twice as slow."""

    @numba.njit  # without a cache: what comes from one has not looked at the types of what it calls
    def call(u0, u1):
        w = warp.square_to_cosine_hemisphere(u0, u1)
        a, b = warp.disk_to_square(u0, u1), warp.cosine_hemisphere_to_square(w)
        c, d = warp.square_to_cone(u0, u1, u0), warp.cone_to_square(w, u0)
        e, f = warp.square_to_sphere(u0, u1), warp.sphere_to_square(w)
        g, h = warp.square_to_triangle(u0, u1), warp.triangle_to_square(u0, u1)
        return a, b, c, d, e, f, g, h, warp.square_to_regular_polygon(u0, u1, 5)

    call(np.float32(0.3), np.float32(0.3))
    allowed = {numba.float32, numba.types.UniTuple(numba.float32, 2), vec3}
    seen = 0
    for function in vars(warp).values():
        for signature in function.inner.nopython_signatures if isinstance(function, KernelDispatcher) else ():
            if numba.float64 not in signature.args:
                assert signature.return_type in allowed, (function, signature)
                seen += 1
    assert seen >= 10


def test_window_sees_a_narrow_cone(u):
    """The cone once more by the sphere's own test, zoomed in."""
    height = np.float32(0.05)
    directions = direction_map(warp.square_to_cone, height)(u)
    pdf = 1.0 / (2.0 * np.pi * float(height))
    result = compare_directions(
        directions, lambda w: np.where(w[:, 2] >= 1.0 - height, pdf, 0.0), window_around(directions)
    )
    assert result.p_value > SIGNIFICANCE, result
