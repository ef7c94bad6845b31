# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights: samples follow their density, rays that hit the light agree with them, and surfaces get the light that
formulas promise.
"""

import math

import numpy as np
import pytest

from blender_tests.helpers.chi_square import (
    compare_counts,
    integrate_over_cells,
    significance_of_one_of,
    tabulate_directions,
    window_around,
)
from blender_tests.helpers.lights import (
    EMISSION,
    even_numbers,
    hit_light,
    irradiance,
    light,
    random_numbers,
    sample_light,
)
from engine_core.light import bounds
from engine_core.tables import LightKind as Kind

L = np.array(EMISSION)
UP = (0.0, 0.0, 1.0)
TILTED = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])  # a rotation
CENTRE = np.array([0.2, 0.1, 1.0])
ASKEW = {"u": 0.8 * TILTED[0], "v": -0.3 * TILTED[1], "p": CENTRE}  # looks down, along -TILTED[2]


def before(x, y, z):
    """The point at these coordinates before the light that hangs askew; z from its plane."""
    return CENTRE + x * TILTED[0] - y * TILTED[1] - z * TILTED[2]


# A light, and a point that it shines on.
CASES = {
    "soft point": (light(Kind.POINT, radius=0.5, soft=1), (0.3, 0.2, 0.1)),
    "soft point, from within": (light(Kind.POINT, radius=0.5, soft=1), (0.1, 0.1, 0.9)),
    "ball": (light(Kind.POINT, radius=0.5), (0.3, 0.2, 0.1)),
    "ball, far": (light(Kind.POINT, radius=0.01), (3.0, 2.0, -1.0)),
    "ball, from within": (light(Kind.POINT, radius=0.5), (0.1, 0.2, 1.1)),
    "soft spot": (light(Kind.SPOT, radius=0.5, soft=1, cos_angle=0.5, blend=3.0), (0.3, 0.2, 0.1)),
    "spot with a ball": (light(Kind.SPOT, radius=0.3, cos_angle=0.5, blend=3.0), (0.3, 0.2, 0.1)),
    "sun": (light(Kind.SUN, height=0.02, n=-TILTED[2]), (0, 0, 0)),
    "real sun": (light(Kind.SUN, height=1.08e-5, n=TILTED[1]), (0, 0, 0)),
    "quad": (light(Kind.QUAD, **ASKEW), (0.1, 0.0, 0.1)),
    "quad, far": (light(Kind.QUAD, **ASKEW), (-2.0, 3.0, -5.0)),
    "quad, spread": (light(Kind.QUAD, **ASKEW, spread=0.4), before(0.7, 0.2, 0.6)),
    "quad, spread, far": (light(Kind.QUAD, **ASKEW, spread=0.4), before(2.5, 0.1, 5.0)),
    "disk": (light(Kind.DISK, **ASKEW), (0.1, 0.0, 0.1)),
    "disk, spread": (light(Kind.DISK, **ASKEW, spread=0.15), before(0.66, 0.13, 0.5)),
    "triangle": (light(Kind.TRIANGLE, **ASKEW), (0.1, 0.0, 0.1)),
    "triangle, far": (light(Kind.TRIANGLE, **ASKEW), (0.1, -2.0, -3.1)),
    "triangle, from behind": (light(Kind.TRIANGLE, **ASKEW, two_sided=1), before(0.1, -0.1, -0.5)),
    "background": (light(Kind.BACKGROUND), (0, 0, 0)),
    "sphere": (light(Kind.SPHERE, radius=0.6, two_sided=1), (0.3, 0.2, 0.1)),
    "sphere, from within": (light(Kind.SPHERE, radius=0.6, two_sided=1), (0.3, 0.2, 1.1)),
    "quad, from behind": (light(Kind.QUAD, **ASKEW, two_sided=1), before(0.1, 0.0, -0.9)),
    "box, one face": (light(Kind.BOX, **ASKEW, radius=0.5), before(0.1, 0.0, 0.9)),
    "box, two faces": (light(Kind.BOX, **ASKEW, radius=0.5), before(1.3, 0.1, -0.8)),
    "box, three faces": (light(Kind.BOX, **ASKEW, radius=0.5), before(1.1, -0.7, 0.9)),
    "box, far": (light(Kind.BOX, **ASKEW, radius=0.5), before(-20.0, 30.0, 15.0)),
    "box, flat": (light(Kind.BOX, **ASKEW, radius=0.01), before(1.5, 0.1, 0.4)),
    "box, from within": (light(Kind.BOX, **ASKEW, radius=0.5, two_sided=1), before(0.3, -0.1, 0.2)),
    "box, from its surface": (light(Kind.BOX, **ASKEW, radius=0.5, two_sided=1), before(0.3, -0.1, 0.5)),
}
SIGNIFICANCE = significance_of_one_of(len(CASES))
DELTAS = {
    "point": light(Kind.POINT, is_delta=1),
    "spot": light(Kind.SPOT, is_delta=1, cos_angle=0.8, blend=20.0),
    "sun": light(Kind.SUN, is_delta=1),
    "beam": light(Kind.QUAD, is_delta=1, spread=0.0),
    "round beam": light(Kind.DISK, is_delta=1, spread=0.0),
}
ROWS = {
    **{name: row for name, (row, _) in CASES.items()},
    **{f"{name}, no extent": row for name, row in DELTAS.items()},
}


def test_every_kind_is_tested():
    assert {Kind(row["kind"][0]) for row in ROWS.values()} == set(Kind)


@pytest.mark.parametrize("name", sorted(ROWS.keys() - {"background"}))
def test_every_kind_can_be_chosen(name):
    """What has no intensity is left to chance. A constant background is."""
    row = ROWS[name]
    assert bounds.irradiance(row)[0] > 0 if bounds.is_far(row)[0] else bounds.intensity(row)[0] > 0


# ---- Sampling and hitting --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CASES)
def test_samples_follow_their_density(name):
    row, p = CASES[name]
    s = sample_light(row, p, random_numbers(100_000))
    assert (s.pdf > 0).all()
    np.testing.assert_allclose(np.linalg.norm(s.wi, axis=1), 1.0, atol=1e-6)
    directions = s.wi
    if name == "disk, spread":  # points of the rectangle that are not on the disk are no directions
        directions = np.where((hit_light(row, p, s.wi)[0] > 0)[:, None], s.wi, np.nan)
    window = window_around(directions, 1.0)
    # integrated over finer cells than are compared, lest the tip of an outline falls between the points of quadrature
    observed = tabulate_directions(directions, 48, 48, window)
    expected = integrate_over_cells(lambda w: hit_light(row, p, w)[1], 48, 48, window, tolerance=2e-6)
    observed, expected = (cells.reshape(12, 4, 12, 4).sum(axis=(1, 3)) for cells in (observed, expected))
    result = compare_counts(observed, expected, len(directions))
    assert result.p_value > SIGNIFICANCE, result


@pytest.mark.parametrize("name", CASES)
def test_a_ray_along_a_sample_finds_the_same(name):
    row, p = CASES[name]
    s = sample_light(row, p, random_numbers(4000))
    distance, density, radiance = hit_light(row, p, s.wi)
    found = distance > 0
    assert found.mean() > (0.4 if "disk, spread" in name else 0.995)  # at an outline a ray may just miss
    np.testing.assert_allclose(density[found], s.pdf[found], rtol=1e-4)
    near_edge = 1e-3 * L.max() if "sp" in name else 1e-30  # spots and spreads dim towards an edge
    np.testing.assert_allclose(radiance[found], s.radiance[found], rtol=1e-4, atol=near_edge)
    if row["kind"] not in (Kind.SUN, Kind.BACKGROUND):
        tolerance = 2e-3 if row["radius"] > 0 else 1e-5  # distances to the rim of a sphere are not well defined
        np.testing.assert_allclose(distance[found], s.distance[found], rtol=tolerance)
    else:
        assert np.isinf(s.distance).all()


@pytest.mark.parametrize("name", DELTAS)
def test_no_ray_finds_a_light_without_extent(name):
    row = DELTAS[name]
    s = sample_light(row, (0.1, 0.2, 0), random_numbers(100))
    assert s.is_delta.all()
    np.testing.assert_array_equal(s.pdf, 1.0)
    np.testing.assert_array_equal(hit_light(row, (0.1, 0.2, 0), s.wi)[1], 0.0)


ONE_SIDED = ("quad", "quad, spread", "disk", "disk, spread", "triangle")


@pytest.mark.parametrize("name", ONE_SIDED)
def test_area_lights_are_dark_from_behind(name):
    row, p = CASES[name]
    behind = 2.0 * row["p"][0] - p
    assert (sample_light(row, behind, random_numbers(1000)).pdf == 0.0).all()
    towards = row["p"][0] + 0.1 * row["u"][0] + 0.1 * row["v"][0] - behind
    _, density, radiance = hit_light(row, behind, towards[None] / np.linalg.norm(towards))
    assert density == 0.0
    assert (radiance == 0.0).all()


@pytest.mark.parametrize("kind", [Kind.SPHERE, Kind.BOX])
def test_one_sided_bodies_are_dark_inside(kind):
    row = light(kind, radius=0.6)
    assert (sample_light(row, (0.1, 0, 1), random_numbers(100)).pdf == 0.0).all()
    _, density, radiance = hit_light(row, (0.1, 0, 1), np.array([[1.0, 0, 0]]))
    assert density == 0.0
    assert (radiance == 0.0).all()


@pytest.mark.parametrize(
    ("row", "p"),
    [
        (light(Kind.POINT, is_delta=1), (0, 0, 1)),
        (light(Kind.POINT, radius=0.5, soft=1), (0, 0, 1)),
        (light(Kind.POINT, radius=0.5), (0, 0, 1)),
        (light(Kind.POINT, radius=1e-30), (0, 0, 0)),
        (light(Kind.SPOT, is_delta=1, cos_angle=0.5), (0, 0, 1)),
        (light(Kind.SPOT, is_delta=1, cos_angle=0.5), (0, 0, 2)),
        (light(Kind.SUN, height=0.01), (1e20, 0, 0)),
        (light(Kind.QUAD), (0.3, 0.2, 1)),
        (light(Kind.QUAD), (5, 0.2, 1)),
        (light(Kind.QUAD, spread=0.1), (5, 0.2, 0)),
        (light(Kind.QUAD, u=(1e-12, 0, 0), v=(0, -1e-12, 0)), (0, 0, 0)),
        (light(Kind.QUAD, is_delta=1, spread=0.0), (0.3, 0.2, 1)),
        (light(Kind.DISK), (0.3, 0.2, 1)),
        (light(Kind.DISK, spread=0.1), (5, 0.2, 0)),
        (light(Kind.TRIANGLE, two_sided=1), (0.3, -0.2, 1)),
        (light(Kind.TRIANGLE, two_sided=1), (0, 0, 1)),
        (light(Kind.TRIANGLE, two_sided=1, v=(2, 0, 0)), (0, 0, 0)),
        (light(Kind.SPHERE, radius=0.0), (0, 0, 0)),
        (light(Kind.SPHERE, radius=0.5), (0, 0, 0.5)),
        (light(Kind.SPHERE, radius=0.5), (0, 0, 1)),
        (light(Kind.QUAD, two_sided=1), (0.3, 0.2, 1)),
        (light(Kind.BOX, radius=0.5), (0, 0, 1)),
        (light(Kind.BOX, radius=0.5), (0.2, 0.1, 0.5)),
        (light(Kind.BOX, radius=0.5), (1, 1, 0.5)),
        (light(Kind.BOX, radius=0.5, two_sided=1), (1, 1, 0.5)),
        (light(Kind.BOX, radius=0.5, two_sided=1), (1, 0, 0.5)),
        (light(Kind.BOX, radius=0.5, two_sided=1), (1, 0, 1)),
        (light(Kind.BOX, radius=0.5, two_sided=1), (2, 0, 0.5)),
        (light(Kind.BOX, radius=1e-12), (0, 0, 0)),
    ],
)
def test_degenerate_cases_give_numbers(row, p):
    s = sample_light(row, p, random_numbers(1000))
    for values in (s.wi, s.radiance, s.pdf):
        assert np.isfinite(values).all()
    lit = s.pdf > 0
    assert not np.isnan(s.distance).any()
    assert (s.distance[lit] >= 0).all()
    directions = np.concatenate([s.wi[lit], np.eye(3), -np.eye(3)]).astype(np.float32)
    _, density, radiance = hit_light(row, p, directions)
    assert not np.isnan(density).any()
    assert np.isfinite(radiance).all()


def test_a_sphere_light_looks_at_its_far_side_from_its_surface():
    """A point on the surface lights itself from across, not from where it stands."""
    row = light(Kind.SPHERE, radius=0.5, two_sided=1)
    p = np.array([0.3, 0.0, 1.4])
    s = sample_light(row, p, random_numbers(1000))
    inwards = -(s.wi.astype(float) @ (p - (0, 0, 1))) / 0.5
    np.testing.assert_allclose(s.distance, 2.0 * 0.5 * inwards, atol=1e-4)


# ---- Irradiance, by formulas -----------------------------------------------------------------------------------------


def polygon_irradiance(corners, p, n):
    """Lambert's formula: E = L / 2 times the sum of each edge's angle times the cosine of its plane's normal to n."""
    w = np.asarray(corners, float) - p
    w /= np.linalg.norm(w, axis=1, keepdims=True)
    after = np.roll(w, -1, axis=0)
    normals = np.cross(w, after)
    length = np.linalg.norm(normals, axis=1)
    angles = np.arctan2(length, (w * after).sum(axis=1))
    return L * abs((angles * (normals @ np.asarray(n, float)) / length).sum()) / 2.0


@pytest.mark.parametrize("p", [(0.1, 0, 0.1), (0.5, -0.7, 0.2), (-2.0, 3.0, -5.0)])
def test_quads_light_as_lambert_says(p):
    row = light(Kind.QUAD, **ASKEW)
    centre, u, v = (row[name][0].astype(float) for name in "puv")
    corners = [centre - u - v, centre + u - v, centre + u + v, centre - u + v]
    n = (centre - p) / np.linalg.norm(centre - p)  # the whole light is above the horizon
    np.testing.assert_allclose(irradiance(row, p, n), polygon_irradiance(corners, p, n), rtol=1e-3)


@pytest.mark.parametrize("p", [(0.1, 0, 0.1), (0.5, -0.7, 0.2), (-2.0, 3.0, -5.0)])
def test_triangles_light_as_lambert_says(p):
    row = light(Kind.TRIANGLE, **ASKEW, two_sided=1)
    first, u, v = (row[name][0].astype(float) for name in "puv")
    n = (first - p) / np.linalg.norm(first - p)
    np.testing.assert_allclose(
        irradiance(row, p, n), polygon_irradiance([first, first + u, first + v], p, n), rtol=1e-3
    )


@pytest.mark.parametrize("p", [(0.1, 0.0, 0.9), (1.3, 0.1, 0.6), (1.1, -0.7, 0.9), (30.0, 20.0, -40.0)])
def test_boxes_light_as_the_outline_of_their_faces_says(p):
    """Each face that is turned to the point is a polygon of Lambert's formula."""
    row = light(Kind.BOX, **ASKEW, radius=0.5)
    eye = before(*p)
    centre, u, v = (row[name][0].astype(float) for name in "puv")
    edges = u, v, 0.5 * row["n"][0].astype(float)
    n = (centre - eye) / np.linalg.norm(centre - eye)  # the whole box is above the horizon
    expected = 0.0
    for i, across in enumerate(edges):
        for side in (across, -across):
            if (eye - centre - side) @ side > 0:
                a, b = edges[i - 1], edges[i - 2]
                corners = [centre + side + x * a + y * b for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
                expected = expected + polygon_irradiance(corners, eye, n)
    np.testing.assert_allclose(irradiance(row, eye, n), expected, rtol=2e-3)


def test_a_corner_above_has_its_textbook_form_factor():
    """A surface below a corner of a parallel rectangle, a by b at height c (Howell, configuration B-3)."""
    a, b, c = 0.7, 0.4, 0.5
    row = light(Kind.QUAD, p=(a / 2, b / 2, c), u=(a / 2, 0, 0), v=(0, -b / 2, 0))
    x, y = math.hypot(a, c), math.hypot(b, c)
    factor = (a / x * math.atan(b / x) + b / y * math.atan(a / y)) / (2.0 * math.pi)
    np.testing.assert_allclose(irradiance(row, (0, 0, 0), UP), math.pi * L * factor, rtol=1e-4)


def test_disks_light_their_axis():
    row = light(Kind.DISK, u=(0.4, 0, 0), v=(0, -0.4, 0))
    np.testing.assert_allclose(irradiance(row, (0, 0, 0), UP), math.pi * L * 0.16 / 1.16, rtol=1e-4)


@pytest.mark.parametrize(("kind", "distance"), [(Kind.POINT, 1.0), (Kind.SPHERE, 1.0), (Kind.SPHERE, 30.0)])
def test_spheres_light_like_points(kind, distance):
    """A uniformly bright sphere is as bright as a point with all its intensity, if all of it is above the horizon."""
    row = light(kind, radius=0.5, p=(0, 0, distance))
    n = (0.6, 0.0, 0.8)
    np.testing.assert_allclose(irradiance(row, (0, 0, 0), n), math.pi * L * (0.5 / distance) ** 2 * 0.8, rtol=1e-4)


def test_soft_points_fall_off_softly():
    """Blender's formula: that of a point, times d^2 / (d^2 + r^2)."""
    row = light(Kind.POINT, radius=0.5, soft=1)
    np.testing.assert_allclose(irradiance(row, (0, 0, 0), UP), math.pi * L * 0.25 / 1.25, rtol=1e-4)


def test_points_light_by_the_inverse_square():
    row = light(Kind.POINT, is_delta=1)
    np.testing.assert_allclose(irradiance(row, (0, 0, -2), UP, 1), L / 9.0, rtol=1e-6)


@pytest.mark.parametrize("degrees", [0.26, 5.0, 40.0])
def test_suns_give_their_irradiance(degrees):
    sine = math.sin(math.radians(degrees))
    row = light(Kind.SUN, height=2.0 * math.sin(math.radians(degrees) / 2.0) ** 2, n=(0, 0, -1))
    np.testing.assert_allclose(irradiance(row, (0, 0, 0), UP), math.pi * L * sine**2, rtol=1e-4)


def test_a_beam_lights_what_is_before_it():
    row = light(Kind.DISK, is_delta=1, spread=0.0, u=(0.5, 0, 0), v=(0, -0.2, 0))
    for p, lit in (((0.4, 0.0, -7.0), 1.0), ((0.0, 0.3, 0.0), 0.0), ((0.0, 0.0, 1.1), 0.0)):
        np.testing.assert_allclose(irradiance(row, p, UP, 1), L * lit, rtol=1e-6)


def test_the_world_lights_half_of_what_it_fills():
    np.testing.assert_allclose(irradiance(light(Kind.BACKGROUND), (0, 0, 0), UP), math.pi * L, rtol=1e-3)


@pytest.mark.parametrize("kind", [Kind.QUAD, Kind.DISK])
@pytest.mark.parametrize("degrees", [10.0, 40.0])
def test_spread_narrows_without_losing_power(kind, degrees):
    """In front of a large light each point gets its power per area: radiance ahead is that over pi (1 - a / tan a)."""
    angle = math.radians(degrees)
    row = light(kind, spread=math.tan(angle), p=(0.1, 0.2, 1.0), u=(2, 0, 0), v=(0, -2, 0))
    expected = math.pi * L * (1.0 - angle / math.tan(angle))
    np.testing.assert_allclose(irradiance(row, (0, 0, 0), UP, 400), expected, rtol=2e-3)


@pytest.mark.parametrize("name", ["quad, spread", "quad, spread, far", "disk, spread"])
def test_spread_lights_what_it_reaches(name):
    """Against the integral over all of the light's area, most of which is dark from here."""
    row, p = CASES[name]
    x, y = even_numbers(2000).T.astype(float) * 2.0 - 1.0
    whole_area = 4.0 * np.linalg.norm(np.cross(row["u"][0], row["v"][0]))
    w = row["p"][0] + x[:, None] * row["u"][0] + y[:, None] * row["v"][0] - p
    distance = np.linalg.norm(w, axis=1)
    cosine = -(w @ row["n"][0]) / distance
    left_open = np.maximum(1.0 - np.tan(np.arccos(cosine)) / row["spread"][0], 0.0)
    if row["kind"] == Kind.DISK:
        left_open[x * x + y * y > 1.0] = 0.0
    n = -row["n"][0].astype(float)
    expected = L * (left_open * cosine**2 / distance**2).mean() * whole_area
    np.testing.assert_allclose(irradiance(row, p, n, 500), expected, rtol=2e-3)


# ---- Spots -----------------------------------------------------------------------------------------------------------


def spot_brightness(row, direction):
    """Radiance of a spot without extent, seen from one metre along `direction`, over its brightest."""
    p = row["p"][0] + np.asarray(direction, float) / np.linalg.norm(direction)
    return sample_light(row, p, random_numbers(1)).radiance[0, 0] / L[0]


def test_spots_shine_into_their_cone():
    """Half of 60 degrees, the outer 40 % of its height smooth: Blender's spot_size and spot_blend."""
    cos_angle = math.cos(math.radians(30.0))
    width = 0.4 * (1.0 - cos_angle)
    row = light(Kind.SPOT, is_delta=1, n=TILTED[2], u=TILTED[0], v=TILTED[1], cos_angle=cos_angle, blend=1.0 / width)
    for cosine, expected in (
        (1.0, 1.0),
        (cos_angle + 1.01 * width, 1.0),
        (cos_angle + 0.75 * width, 0.84375),  # 3 x^2 - 2 x^3
        (cos_angle + 0.5 * width, 0.5),
        (cos_angle - 0.01 * width, 0.0),
        (-1.0, 0.0),
    ):
        sine = math.sqrt(1.0 - cosine**2)
        for phi in (0.0, 1.0, 4.0):
            direction = TILTED.T @ (sine * math.cos(phi), sine * math.sin(phi), cosine)
            assert spot_brightness(row, direction) == pytest.approx(expected, abs=1e-4)


def test_spots_without_blend_have_a_sharp_edge():
    row = light(Kind.SPOT, is_delta=1, cos_angle=math.cos(0.5))
    for angle, expected in ((0.0, 1.0), (0.499, 1.0), (0.501, 0.0), (3.0, 0.0)):
        assert spot_brightness(row, (math.sin(angle), 0.0, -math.cos(angle))) == pytest.approx(expected, abs=1e-5)


def test_scaled_spots_are_elliptic():
    """A spot twice as long in x as in z shines twice as far to the side: u is its x axis over 2."""
    row = light(Kind.SPOT, is_delta=1, cos_angle=math.cos(math.atan(0.5)), u=(0.5, 0, 0))
    for x, y, expected in ((0.99, 0.0, 1.0), (1.01, 0.0, 0.0), (0.0, 0.49, 1.0), (0.0, 0.51, 0.0)):
        assert spot_brightness(row, (x, y, -1.0)) == pytest.approx(expected, abs=1e-5)
