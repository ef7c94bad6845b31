# SPDX-License-Identifier: GPL-3.0-or-later
"""Boundaries of media that lie in one place with others, or with surfaces."""

import math

import numpy as np
import pytest

from blender_tests.helpers.scenes import CUBE_CORNERS, CUBE_TRIANGLES, builder, picture, plane
from engine_core.scene.materials import Diffuse, Emission, Transparent
from engine_core.scene.volumes import VolumeCoefficients, VolumeScatter
from engine_core.settings import IntegratorKind

FIRST, SECOND = np.array([0.8, 0.3, 0.0]), np.array([0.1, 0.6, 0.4])
INTEGRATORS = [IntegratorKind.PATH, IntegratorKind.MIXTURE, IntegratorKind.BRUTE_FORCE]
GLAZED = Transparent((0.5, 0.6, 0.7))
SHAPES = pytest.mark.parametrize("shape", ["mesh", "box"])
SIZES = pytest.mark.parametrize("size", [1.0, 0.37, 13.0])


def absorbing(sigma):
    return VolumeCoefficients(tuple(sigma), (0.0, 0.0, 0.0))


def block(b, volume, centre, shape="mesh", size=1.0, surface=None):
    """A cube that reaches `size` to all sides of its centre, which is in units of `size`."""
    geometry = b.mesh("m", CUBE_CORNERS, CUBE_TRIANGLES) if shape == "mesh" else b.boxes("b", [(0, 0, 0)], [(1, 1, 1)])
    to_world = np.diag([size, size, size, 1.0])
    to_world[:3, 3] = size * np.array(centre, float)
    b.instance(geometry, to_world, [b.material("filled", surface, volume=volume)])


def along_y(size, eye=(0.1, -5.0, 0.2)):
    eye = size * np.array(eye)
    b = builder(eye=eye, target=eye + np.array([0.0, size, 0.0]), field_of_view=0.01)
    b.background((1, 1, 1))
    return b


def assert_seen(b, expected, **changes):
    image = picture(b, size=4, samples=4, **changes)
    assert image[..., :3].mean(axis=(0, 1)) == pytest.approx(expected, rel=1e-4)


@SHAPES
@SIZES
def test_boxes_side_by_side(shape, size):
    """A row of three: their media begin where the one before ends."""
    b = along_y(size)
    for number, sigma in enumerate((FIRST, SECOND, FIRST)):
        block(b, absorbing(sigma), (0, 2 * number, 0), shape, size)
    assert_seen(b, np.exp(-size * (4.0 * FIRST + 2.0 * SECOND)))


@SHAPES
@SIZES
def test_a_box_in_the_corner_of_a_larger_one(shape, size):
    """Both are entered by one plane: the larger has its centre where the smaller ends."""
    b = along_y(size)
    block(b, absorbing(SECOND), (0, 0, 0), shape, size)
    block(b, absorbing(FIRST), (0, 0.5, 0), shape, 2.0 * size)
    assert_seen(b, np.exp(-size * (4.0 * FIRST + 2.0 * SECOND)))


@SHAPES
def test_a_camera_in_one_of_two_boxes_that_stand_on_each_other(shape):
    b = along_y(1.0, eye=(0.1, 0.0, 0.2))
    block(b, absorbing(FIRST), (0, 0, 0), shape)
    block(b, absorbing(SECOND), (0, 0, 2), shape)
    assert_seen(b, np.exp(-FIRST))


@SHAPES
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_shadows_of_boxes_that_stand_on_each_other(shape, integrator):
    """On a floor in the plane of the lower one's bottom, a sun above; the camera looks through both of them."""
    b = builder(eye=(0.1, 0.2, 9), target=(0.1, 0.2001, 0), field_of_view=0.01)
    plane(b, Diffuse((1, 1, 1)), half=20.0, z=-1.0)
    block(b, absorbing(FIRST), (0, 0, 0), shape)
    block(b, absorbing(SECOND), (0, 0, 2), shape)
    b.sun_light("Sun", (0, 0, -1), (math.pi,) * 3)
    assert_seen(b, np.exp(-4.0 * (FIRST + SECOND)), integrator=integrator, max_bounces=0)


@SHAPES
@pytest.mark.parametrize("size", [1.0, 0.37])
@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("tint", [(1.0, 1.0, 1.0), (0.5, 0.6, 0.7)])
def test_smoke_beside_the_medium_of_what_has_a_surface(shape, size, order, tint):
    b = along_y(size)
    block(b, absorbing(FIRST), (0, 0, 0), shape, size)
    block(b, absorbing(SECOND), (0, 2 * order, 0), shape, size, Transparent(tint))
    assert_seen(b, np.array(tint) ** 2 * np.exp(-2.0 * size * (FIRST + SECOND)))


@SHAPES
@SIZES
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_floor_is_seen_through_what_has_a_surface_and_stands_on_it(shape, size, integrator):
    b = builder(eye=(0, -5 * size, 3 * size), target=(0, 0, -size), field_of_view=0.01)
    plane(b, Emission((1, 1, 1), 2.0), half=40.0, z=-size)
    block(b, absorbing(FIRST), (0, 0, 0), shape, size, GLAZED)
    through = 2.0 * np.array([0.5, 0.6, 0.7]) * np.exp(-0.2 * math.sqrt(41.0) * size * FIRST)
    assert_seen(b, through, integrator=integrator)


@SHAPES
def test_no_light_comes_through_a_floor_below_what_has_a_surface(shape):
    b = builder(eye=(0, -5, 3), target=(0, 0, -1), field_of_view=30)
    plane(b, Diffuse((1, 1, 1)), half=20.0, z=-1.0)
    block(b, VolumeScatter(density=2.0), (0, 0, 0), shape, surface=GLAZED)
    b.point_light("Lamp", (0, 0, -3), (100, 100, 100))
    b.sun_light("Sun", (0, 0.2, 1), (1, 1, 1))
    assert not picture(b, size=16, samples=16)[..., :3].any()


@SHAPES
def test_smoke_on_a_floor_is_as_bright_as_smoke_that_is_sunk_into_it(shape):
    """By a thousandth, a box in fog, at the box and around its feet.

    Paths of one seed go nearly the same way in both, so their differences have little noise; tested by block.
    """
    seeds, pictures = 12, []
    for sunk in (0.0, 0.001):
        b = builder(eye=(0.5, -7, 3.5), target=(0, 0, 0.5), field_of_view=35)
        b.point_light("Lamp", (-2, 1.5, 4), (400, 400, 400), radius=0.5)
        plane(b, Diffuse((0.7, 0.7, 0.7)), half=12.0, z=0.0)
        for size, density in ((3.0, 0.1), (1.0, 1.5)):
            block(b, VolumeScatter((0.9, 0.7, 0.5), density), (0, 0, 1.0 - sunk / size), shape, size)
        of_seeds = [picture(b, size=24, samples=64, seed=seed, adaptive=0, volume_bounces=4) for seed in range(seeds)]
        pictures.append(np.array(of_seeds, float)[..., :3].reshape(seeds, 3, 8, 3, 8, 3).mean(axis=(2, 4)))
    flush, sunk = pictures
    difference = (flush - sunk) / sunk.mean(axis=0)
    error = difference.std(axis=0, ddof=1) / np.sqrt(seeds)
    assert error.max() < 0.01
    assert (np.abs(difference.mean(axis=0)) < 6.5 * error + 0.002).all()  # of twelve seeds: 6.5 as 4.5 of many
