# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes whose radiance is known on paper."""

import math

import numpy as np
import pytest

from blender_tests.helpers.scenes import (
    CUBE_CORNERS,
    CUBE_TRIANGLES,
    box,
    builder,
    cube,
    mean_and_error,
    picture,
    plane,
    quad,
    sphere,
)
from engine_core.scene.materials import Add, Diffuse, Emission, Glass, Metallic, Mix, Transparent
from engine_core.settings import IntegratorKind
from engine_core.tables import Visibility

INTEGRATORS = [IntegratorKind.PATH, IntegratorKind.MIXTURE, IntegratorKind.BRUTE_FORCE]


def assert_radiance(image, expected, tolerance=0.005):
    """The mean is what it should be, within four standard errors; and those are small enough to tell."""
    mean, error = mean_and_error(image)
    assert (error < tolerance * np.max(expected)).all(), "too noisy to prove anything"
    assert mean == pytest.approx(np.broadcast_to(expected, 3), abs=max(4 * error.max(), 1e-4 * np.max(expected)))


def turned_about_z(angle, scale, position):
    """Transform (3, 4)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.column_stack([np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) * scale, position])


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("shape", [sphere, cube, box])
def test_glowing_furnace_has_the_radiance_of_its_series(shape, integrator):
    """Emission 0.5 and albedo 0.5 all around: 0.5 + 0.25 + 0.125 ... = 1."""
    b = builder()
    shape(b, Add(Diffuse((0.5, 0.5, 0.5)), Emission((1, 1, 1), 0.5)))
    assert_radiance(picture(b, samples=64, integrator=integrator), 1.0)


@pytest.mark.parametrize("bounces", [0, 1, 3])
def test_bounces_cut_the_series_where_they_say(bounces):
    """With n bounces allowed, a furnace of emission 1 and albedo 0.7 has radiance 1 + 0.7 + ... + 0.7^(n + 1).

    Zero bounces leave direct light, which is the emission seen, and what is scattered once.
    """
    b = builder()
    cube(b, Add(Diffuse((0.7, 0.7, 0.7)), Emission((1, 1, 1), 1.0)))
    expected = sum(0.7**k for k in range(bounces + 2))
    assert_radiance(picture(b, samples=64, max_bounces=bounces), expected)


@pytest.mark.parametrize("radius", [0.0, 0.2])
@pytest.mark.parametrize("soft", [True, False])
def test_lamp_in_the_centre_of_a_sphere(radius, soft):
    """A lamp of 4 pi^2 W has intensity pi W/sr: at distance 1, albedo 0.5 leaves 0.5 directly, 1 after all bounces.

    A ball of radiance that is not seen by other than shadow rays shines on the wall like its centre; a facing disk of
    radius r as seen from distance 1 loses the factor 1 / (1 + r^2).
    """
    b = builder(eye=(0, 0.5, 0), target=(0, 1, 0))
    sphere(b, Diffuse((0.5, 0.5, 0.5)))
    b.point_light("Lamp", (0, 0, 0), (4 * math.pi**2,) * 3, radius=radius, soft=soft, visibility=Visibility.DIFFUSE)
    lost = 1.0 / (1.0 + radius**2) if soft else 1.0
    assert_radiance(picture(b, samples=64), lost)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_furnace_of_quads_has_the_radiance_of_its_series(integrator):
    b = builder()
    glow = Add(Diffuse((0.5, 0.5, 0.5)), Emission((1, 1, 1), 0.5))
    for axis in range(3):
        for side in (-1.0, 1.0):
            to_world = np.eye(4)
            to_world[:3, :3] = np.roll(np.eye(3), axis, axis=1)
            to_world[:3, 3] = side * to_world[:3, 2]
            quad(b, glow, to_world)
    assert_radiance(picture(b, samples=64, integrator=integrator), 1.0)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("body", [sphere, box])
@pytest.mark.parametrize(
    "surface",
    [
        Diffuse((1, 1, 1)),
        Glass((1, 1, 1), roughness=0.0, ior=1.5),
        Metallic((1, 1, 1), (1, 1, 1), roughness=0.0),
        Mix(0.5, Diffuse((1, 1, 1)), Transparent((1, 1, 1))),
        Mix(0.3, Glass((1, 1, 1), roughness=0.0, ior=1.33), Diffuse((1, 1, 1))),
    ],
)
def test_white_things_vanish_in_a_white_world(surface, body, integrator):
    b = builder(eye=(0, -3, 0))
    body(b, surface)
    b.background((1, 1, 1))
    assert_radiance(picture(b, samples=64, integrator=integrator, transparent_bounces=1000), 1.0)


def test_square_lamp_above_a_floor():
    """Irradiance below the middle of a 2 x 2 m square lamp 1 m above: pi L F with the form factor of the textbook.

    F = 4 / (2 pi) (A atan B + B atan A) twice, with X = Y = 1: A = 1 / sqrt 2, B = 1 / sqrt 2 (Howell, B-4).
    """
    b = builder(eye=(0, 0, 0.5), target=(0, 1e-3, 0.0), field_of_view=0.5)
    plane(b, Diffuse((0.8, 0.8, 0.8)), half=10.0)
    lamp = np.eye(4)
    lamp[2, 3] = 1.0
    b.area_light("Lamp", lamp, (4 * math.pi,) * 3, 2.0, 2.0, visibility=Visibility.ALL & ~Visibility.CAMERA)
    x = 1.0 / math.sqrt(2.0)
    form_factor = 4.0 / (2.0 * math.pi) * 2.0 * (x * math.atan(x))
    assert_radiance(picture(b, samples=256, max_bounces=0), 0.8 * form_factor)


def test_sun_on_a_floor():
    """Irradiance 3 W/m2 under 60 degrees, from a point or from a disk of half a degree."""
    for angle in (0.0, math.radians(0.5)):
        b = builder(eye=(0, 0, 1), target=(0, 1e-3, 0), field_of_view=20)
        plane(b, Diffuse((0.5, 0.5, 0.5)), half=10)
        b.sun_light("Sun", (0, math.sin(math.pi / 3), -math.cos(math.pi / 3)), (3, 3, 3), angle)
        assert_radiance(picture(b, samples=16), 0.5 * 3 * 0.5 / math.pi)


@pytest.mark.parametrize("times", [1, 2])
def test_long_thin_triangles_are_not_in_their_own_way(times):
    """A sloping floor of them, 14 m long and 7 cm wide, under a sun and a white sky: each point sees all of both."""
    b = builder(eye=(-1, -3, 3), target=(-1, -2.99, 0), field_of_view=60)
    corners = np.array([[x, y, 0.04 + 0.01 * x] for y in np.arange(-7, 7, 0.07) for x in (-8, 6)], np.float32)
    rows = np.arange(0, len(corners) - 2, 2)[:, None]
    strips = b.mesh("strips", corners, (rows + np.array([[[0, 1, 3]], [[0, 3, 2]]])).reshape(-1, 3))
    material = b.material("floor", Diffuse((0.5, 0.5, 0.5)))
    for k in range(times):  # more than once: in the space of its object
        b.instance(strips, np.vstack([turned_about_z(0.0, 1.0, (0, 0, -9 * k)), [0, 0, 0, 1]]), materials=[material])
    b.sun_light("Sun", (math.sqrt(0.5), 0, -math.sqrt(0.5)), (math.pi, math.pi, math.pi))
    b.background((1, 1, 1))
    cosine = (1 + 0.01) / math.sqrt(2 * (1 + 0.01**2))
    image = picture(b, samples=64, size=32)
    assert_radiance(image, 0.5 * (1 + cosine), tolerance=0.001)


def test_coloured_pane_dims_light_once_for_each_passage():
    """A floor below a transparent red pane, lit by a sun: seen through the pane, it is dimmed twice."""
    b = builder(eye=(0, 0, 2), target=(0, 1e-3, 0), field_of_view=20)
    plane(b, Diffuse((0.5, 0.5, 0.5)), half=10)
    plane(b, Transparent((0.9, 0.5, 0.1)), half=10, z=1.0)
    b.sun_light("Sun", (0, 0, -1), (math.pi, math.pi, math.pi))
    assert_radiance(picture(b, samples=4, max_bounces=0), 0.5 * np.array([0.9, 0.5, 0.1]) ** 2)


@pytest.mark.parametrize("of_shapes", [False, True])
def test_panes_that_nearly_touch_all_dim_the_light(of_shapes):
    """Five of them, thousandths of a millimetre apart: a ray of the camera meets each, and so does a shadow ray."""
    b = builder(eye=(0, 0, 3), target=(0, 1e-3, 0), field_of_view=20)
    plane(b, Diffuse((0.5, 0.5, 0.5)), half=10)
    for k in range(5):
        z, surface = 1.0 + 4e-6 * k, Transparent((0.9, 0.8, 0.7))
        if of_shapes:
            quad(b, surface, np.vstack([turned_about_z(0.0, 10.0, (0, 0, z)), [0, 0, 0, 1]]))
        else:
            plane(b, surface, half=10, z=z)
    b.sun_light("Sun", (0, 0, -1), (math.pi, math.pi, math.pi))
    assert_radiance(picture(b, samples=4, max_bounces=0, transparent_bounces=16), 0.5 * np.array([0.9, 0.8, 0.7]) ** 10)


def test_transparent_background_leaves_alpha():
    """Half of what a half transparent thing shows is the background, which is left out of colour and alpha."""
    b = builder(eye=(0, -3, 0), field_of_view=10)
    cube(b, Mix(0.5, Emission((1, 1, 1), 1.0), Transparent((1, 1, 1))))
    b.background((5, 5, 5))
    image = picture(b, samples=256, transparent_background=1)
    # two faces, each lets half pass: a quarter of the background is seen
    assert image[..., 3].mean() == pytest.approx(0.75, abs=0.005)
    assert image[..., :3].mean() == pytest.approx(0.5 + 0.25, abs=0.01)


@pytest.mark.parametrize("kind", ["mesh", "sphere", "box", "quad", "area", "point", "ball", "sun"])
def test_light_sampling_and_luck_agree(kind):
    """The path integrator, the mixture and brute force see the same room, whatever lights it."""
    b = builder(eye=(0, -0.9, 0.3), target=(0, 0, -0.3), field_of_view=70)
    cube(b, Mix(0.2, Diffuse((0.7, 0.6, 0.5)), Metallic((0.9, 0.9, 0.9), (1, 1, 1), roughness=0.4)))
    sphere(b, Glass(roughness=0.2), (0.4, 0.4, -0.6), 0.35)
    lamp = np.eye(4)
    lamp[2, 3] = 0.95
    if kind == "mesh":
        lamp[0, 0] = lamp[1, 1] = 0.4
        lamp[2, 2] = 0.02
        cube(b, Emission((1, 0.9, 0.8), 4.0), lamp)
    elif kind == "sphere":
        sphere(b, Emission((1, 0.9, 0.8), 4.0), (0, 0, 0.6), 0.3)
    elif kind in ("box", "quad"):
        lamp[:3] = turned_about_z(0.5, (0.3, 0.2, 0.15), (0.1, 0, 0.6))
        (box if kind == "box" else quad)(b, Emission((1, 0.9, 0.8), 4.0), lamp)
    elif kind == "area":
        b.area_light("Lamp", lamp, (10, 9, 8), 0.8, 0.6)
    elif kind in ("point", "ball"):
        b.point_light("Lamp", (0, 0, 0.6), (10, 9, 8), radius=0.3, soft=kind == "point")
    else:
        b = builder(eye=(0, -4, 2), target=(0, 0, 0), field_of_view=40)
        sphere(b, Diffuse((0.7, 0.6, 0.5)))
        b.background((0.1, 0.2, 0.3))
        b.sun_light("Sun", (0.5, 0.5, -1), (2, 2, 2), math.radians(40))
    pictures = [picture(b, size=24, samples=256, integrator=i, seed=int(i), max_bounces=6) for i in INTEGRATORS]
    for other in pictures[1:]:
        mean, error = mean_and_error(pictures[0] - other)
        assert (np.abs(mean) < 4 * error).all()
        assert error.max() < 0.02 * pictures[0][..., :3].mean()


@pytest.mark.parametrize("shared", [False, True])
@pytest.mark.parametrize("squeeze", [(1.0, 1.0, 1.0), (0.5, 1.3, 0.8)])
def test_analytic_boxes_and_quads_look_like_those_of_triangles(squeeze, shared):
    """Turned and scaled, in the world or behind instances, lighting and lit: the same picture but for noise."""
    pictures = []
    for analytic in (False, True):
        b = builder(eye=(0, -5, 2.5), field_of_view=50)
        plane(b, Diffuse((0.7, 0.7, 0.7)), half=6, z=-1.0)
        grey, glow = b.material("Grey", Diffuse((0.6, 0.4, 0.3))), b.material("Glow", Emission((1, 0.8, 0.6), 5.0))
        if analytic:
            block, sheet = (
                b.boxes("box", [(0, 0, 0)], [(1, 1, 1)]),
                b.quads("quad", [(0, 0, 0)], [(1, 0, 0)], [(0, 1, 0)]),
            )
        else:
            block = b.mesh("box", CUBE_CORNERS, CUBE_TRIANGLES)
            corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
            sheet = b.mesh("quad", corners, [[0, 1, 2], [0, 2, 3]])
        for geometry, material, angle, position in (
            (block, grey, 0.7, (-1.5, 0, 0)),
            (block, glow, 0.3, (2, 1, 1)),
            (sheet, grey, 0.4, (0.5, -1, 0)),
            (sheet, glow, -0.5, (-0.5, 0, 2)),
        ):
            matrix = np.eye(4)
            matrix[:3] = turned_about_z(angle, np.multiply(squeeze, 0.6), position)
            b.instance(geometry if shared else copy_of(b, geometry), matrix, [material])
        pictures.append(picture(b, size=24, samples=256, seed=int(analytic), max_bounces=4))
        assert b.warnings == []
    for other in pictures[1:]:
        mean, error = mean_and_error(pictures[0] - other)
        assert (np.abs(mean) < 4 * error).all()
        assert error.max() < 0.02 * pictures[0][..., :3].mean()
    assert np.abs(pictures[0] - pictures[1])[..., :3].mean() < 0.1 * pictures[0][..., :3].mean()


def copy_of(b, geometry):
    """Another geometry of the same rows, so that each stands in the world once."""
    b.geometries.append(b.geometries[geometry])
    return len(b.geometries) - 1
