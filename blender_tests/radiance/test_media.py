# SPDX-License-Identifier: GPL-3.0-or-later
"""Light in media, where it is known on paper."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad as integral

from blender_tests.helpers.scenes import CUBE_CORNERS, CUBE_TRIANGLES, builder, mean_and_error, picture, plane, quad
from engine_core.scene.materials import Add, Diffuse, Emission, Mix, Transparent
from engine_core.scene.volumes import HenyeyGreenstein, Rayleigh, VolumeAbsorption, VolumeCoefficients, VolumeScatter
from engine_core.settings import IntegratorKind

INTEGRATORS = [IntegratorKind.PATH, IntegratorKind.MIXTURE, IntegratorKind.BRUTE_FORCE]
SIGMA = np.array([0.8, 0.3, 0.0])
ABSORBING = VolumeCoefficients(tuple(SIGMA), (0.0, 0.0, 0.0))
SHAPES = ["mesh", "box", "sphere"]


def seen_along_y(eye_y=-5.0, z=0.0):
    """A camera that looks along y, all its rays nearly alike, at a white world."""
    b = builder(eye=(0, eye_y, z), target=(0, eye_y + 1.0, z), field_of_view=0.01)
    b.background((1, 1, 1))
    return b


def fill(b, volume, shape="box", to_world=None, surface=None, times=1):
    """Add a shape from -1 to 1 with a volume inside; several `times` in one place if it shall be behind an instance."""
    geometry = {
        "mesh": lambda: b.mesh("m", CUBE_CORNERS, CUBE_TRIANGLES),
        "box": lambda: b.boxes("b", [(0, 0, 0)], [(1, 1, 1)]),
        "sphere": lambda: b.spheres("s", [(0, 0, 0)], [1.0]),
    }[shape]()
    material = b.material("filled", surface, volume=volume)
    b.instance(geometry, np.eye(4) if to_world is None else to_world, [material])
    far = np.eye(4)
    far[0, 3] = 100.0
    for _ in range(times - 1):
        b.instance(geometry, far, [material])


def assert_seen(b, expected, **changes):
    image = picture(b, size=4, samples=4, **changes)
    assert image[..., :3].mean(axis=(0, 1)) == pytest.approx(expected, rel=1e-4)


# ---- What gets through -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", SHAPES)
def test_a_slab_and_a_sphere_dim_by_their_thickness(shape):
    b = seen_along_y()
    fill(b, ABSORBING, shape)
    assert_seen(b, np.exp(-2.0 * SIGMA))


@pytest.mark.parametrize("shape", SHAPES)
def test_a_camera_inside_sees_through_what_is_before_it(shape):
    b = seen_along_y(eye_y=-0.25)
    fill(b, ABSORBING, shape)
    assert_seen(b, np.exp(-1.25 * SIGMA))


@pytest.mark.parametrize("stretch", [(1, 1.5, 1), (-1, 1.5, 1), (1, -1.5, 1)])
@pytest.mark.parametrize("times", [1, 2])
def test_density_is_per_metre_of_the_world_however_the_object_is_scaled_or_mirrored(stretch, times):
    for shape in ("mesh", "box"):
        b = seen_along_y()
        fill(b, ABSORBING, shape, np.diag([*stretch, 1.0]), times=times)
        assert_seen(b, np.exp(-3.0 * SIGMA))


def test_media_in_one_place_add_up():
    """Two boxes that overlap, in a third one, with the camera in one of them."""
    b = seen_along_y(eye_y=-0.5)
    fill(b, ABSORBING, "mesh")
    moved = np.eye(4)
    moved[1, 3] = 1.0
    fill(b, VolumeAbsorption((0.0, 0.5, 1.0), 0.4), "box", moved)
    fill(b, VolumeAbsorption((1.0, 1.0, 0.0), 0.1), "sphere", np.diag([4.0, 4.0, 4.0, 1.0]))
    assert_seen(b, np.exp(-1.5 * SIGMA - 2.0 * np.array([0.4, 0.2, 0.0]) - 4.5 * np.array([0.0, 0.0, 0.1])))


@pytest.mark.parametrize(("eye_y", "metres"), [(-5.0, 4.0), (0.0, 2.0), (2.0, 1.0)])
def test_a_mesh_need_not_be_convex(eye_y, metres):
    """One mesh of two cubes with a gap between: before it, in the gap, in the second cube."""
    b = seen_along_y(eye_y)
    aside = np.array([0, 2, 0])
    corners = np.concatenate([CUBE_CORNERS - aside, CUBE_CORNERS + aside]).astype(np.float32)
    two = b.mesh("two", corners, np.concatenate([CUBE_TRIANGLES, CUBE_TRIANGLES + 8]))
    b.instance(two, materials=[b.material("filled", None, volume=ABSORBING)])
    assert_seen(b, np.exp(-metres * SIGMA))


def test_what_has_a_surface_is_coloured_inside():
    b = seen_along_y()
    fill(b, ABSORBING, surface=Transparent((0.5, 0.6, 0.7)))
    assert_seen(b, np.array([0.5, 0.6, 0.7]) ** 2 * np.exp(-2.0 * SIGMA))


def test_a_medium_that_shines():
    b = seen_along_y()
    b.background((0, 0, 0))
    fill(b, Add(ABSORBING, Emission((1, 2, 3), 0.5)))
    length = np.where(SIGMA > 0.0, -np.expm1(-2.0 * SIGMA) / np.where(SIGMA > 0.0, SIGMA, 1.0), 2.0)
    assert_seen(b, np.array([0.5, 1.0, 1.5]) * length)


def test_mixes_are_of_coefficients():
    b = seen_along_y()
    fill(b, Mix(0.25, ABSORBING, VolumeAbsorption((0.5, 0.5, 0.5), 2.0)))
    assert_seen(b, np.exp(-2.0 * (0.75 * SIGMA + 0.25)))


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_shadows_are_as_dark_as_the_medium(integrator):
    """A floor in the light of a sun that stands above, under a box that is seen by nobody but its light."""
    b = builder(eye=(0, -5, 0.2), target=(0, 0, 0), field_of_view=0.01)
    plane(b, Diffuse((1, 1, 1)), half=20.0)
    moved = np.diag([1.0, 1.0, 0.5, 1.0])
    moved[2, 3] = 2.0
    fill(b, ABSORBING, "mesh", moved)
    b.sun_light("Sun", (0, 0, -1), (math.pi,) * 3)
    assert_seen(b, np.exp(-1.0 * SIGMA), integrator=integrator, max_bounces=0)


# ---- Boundaries that lie in surfaces ---------------------------------------------------------------------------------


def on_floor(b, volume, shape, size, surface, floor):
    """A box on a floor: its bottom lies in the floor's plane, at a height of -size."""
    fill(b, volume, shape, np.diag([size, size, size, 1.0]))
    if floor == "mesh":
        plane(b, surface, half=20.0, z=-size)
        return
    low = np.diag([20.0, 20.0, 1.0, 1.0])
    low[2, 3] = -size
    quad(b, surface, low)


FLOORS = pytest.mark.parametrize("floor", ["mesh", "quad"])
BOXES = pytest.mark.parametrize("shape", ["mesh", "box"])


@FLOORS
@BOXES
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("size", [1.0, 0.37])
def test_a_floor_under_smoke_is_seen(size, integrator, shape, floor):
    """A floor that shines, seen through the front and the bottom of a box that stands on it."""
    b = builder(eye=(0, -5 * size, 3 * size), target=(0, 0, -size), field_of_view=0.01)
    on_floor(b, ABSORBING, shape, size, Emission((1, 1, 1), 2.0), floor)
    assert_seen(b, 2.0 * np.exp(-0.2 * math.sqrt(41.0) * size * SIGMA), integrator=integrator)


@FLOORS
@BOXES
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_no_light_comes_through_a_floor_under_smoke(integrator, shape, floor):
    b = builder(eye=(0, -5, 3), target=(0, 0, -1), field_of_view=30)
    on_floor(b, VolumeScatter(density=2.0), shape, 1.0, Diffuse((1, 1, 1)), floor)
    b.point_light("Lamp", (0, 0, -3), (100, 100, 100))
    b.sun_light("Sun", (0, 0.2, 1), (1, 1, 1))
    assert not picture(b, size=16, samples=16, integrator=integrator)[..., :3].any()


@BOXES
def test_a_camera_in_smoke_below_a_ceiling_is_in_it(shape):
    """The top of the box lies in the plane of the ceiling."""
    b = seen_along_y(eye_y=0.0)
    fill(b, ABSORBING, shape)
    plane(b, Diffuse(), z=1.0)
    assert_seen(b, np.exp(-SIGMA))


# ---- What is scattered -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_light_scattered_once(integrator):
    """A ball under a sun, against quadrature along the ray: all that a volume bounce of 0 leaves."""
    sigma_s, sigma_t, g, z = np.array([0.6, 1.2, 0.1]), np.array([0.8, 1.2, 1.0]), 0.4, 0.3
    b = seen_along_y(z=z)
    b.background((0, 0, 0))
    fill(b, VolumeCoefficients(tuple(sigma_t - sigma_s), tuple(sigma_s), phase=HenyeyGreenstein(g)), "sphere")
    b.sun_light("Sun", (0, 0, -1), (1, 1, 1))
    half = math.sqrt(1.0 - z * z)
    phase = (1.0 - g * g) / (4.0 * math.pi * (1.0 + g * g) ** 1.5)  # at a right angle
    expected = [
        s * phase * integral(lambda y, t=t: math.exp(-t * (y + half + math.sqrt(1.0 - y * y) - z)), -half, half)[0]
        for s, t in zip(sigma_s, sigma_t, strict=True)
    ]
    image = picture(b, size=16, samples=64, integrator=integrator, volume_bounces=0, adaptive=0)
    mean, error = mean_and_error(image)
    assert (error < 0.01 * mean).all()
    assert (np.abs(mean - expected) < 4.5 * error + 1e-4 * mean).all()


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_light_of_a_lamp_in_a_fog_scattered_once(integrator):
    """The ray passes near three lamps, against quadrature."""
    sigma_s, sigma_t = np.array([0.6, 1.2, 0.1]), np.array([0.8, 1.2, 0.15])
    b = seen_along_y()
    b.background((0, 0, 0))
    fill(b, VolumeCoefficients(tuple(sigma_t - sigma_s), tuple(sigma_s)), "sphere")
    lamps = {(0.0, 0.2, 0.1): 1.0, (0.3, -0.6, 0.2): 0.5, (0.5, 0.5, 0.5): 0.2}
    for place, power in lamps.items():
        b.point_light("Lamp", place, (4.0 * math.pi**2 * power,) * 3)

    def seen(y, sigma):
        """Radiance scattered at a place of the ray, a metre of it, that gets out of the ball."""
        away = [(math.dist(place, (0.0, y, 0.0)), power) for place, power in lamps.items()]
        return sum(power * math.pi * math.exp(-sigma * (y + 1.0 + r)) / r**2 for r, power in away) / (4.0 * math.pi)

    near = [-1.0, -0.6, 0.2, 0.5, 1.0]
    expected = [
        s * sum(integral(seen, *ends, args=(t,), epsabs=1e-6)[0] for ends in itertools.pairwise(near))
        for s, t in zip(sigma_s, sigma_t, strict=True)
    ]
    image = picture(b, size=16, samples=256, integrator=integrator, volume_bounces=0, adaptive=0)
    mean, error = mean_and_error(image)
    assert (error < 0.02 * mean).all()
    assert (np.abs(mean - expected) < 4.5 * error + 1e-4 * mean).all()


FURNACE = Add(VolumeScatter((1, 1, 1), 0.5, Rayleigh()), VolumeScatter((0, 0.3, 1), 2.0, HenyeyGreenstein(0.8)))


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("eye_y", [-5.0, 0.3])
@pytest.mark.parametrize("shape", ["mesh", "sphere"])
def test_a_medium_that_absorbs_nothing_is_not_seen_in_a_white_world(shape, eye_y, integrator):
    b = builder(eye=(0, eye_y, 0.2), target=(0, eye_y + 1.0, 0.2), field_of_view=25)
    b.background((1, 1, 1))
    fill(b, FURNACE, shape)
    mean, error = mean_and_error(picture(b, size=16, samples=64, integrator=integrator, adaptive=0))
    assert (error < 0.01).all()
    assert (np.abs(mean - 1.0) < 4.5 * error + 1e-4).all()


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_media_in_one_place_scatter_together(integrator):
    """Nothing is lost where a box of smoke reaches into a ball of another one."""
    b = builder(eye=(0, -5, 0.2), target=(0, 1, 0.2), field_of_view=25)
    b.background((1, 1, 1))
    fill(b, VolumeScatter((1, 1, 1), 0.5, Rayleigh()), "mesh")
    aside = np.eye(4)
    aside[0, 3] = 0.5
    fill(b, VolumeScatter((0, 0.3, 1), 1.0, HenyeyGreenstein(0.5)), "sphere", aside)
    mean, error = mean_and_error(picture(b, size=16, samples=64, integrator=integrator, adaptive=0))
    assert (error < 0.01).all()
    assert (np.abs(mean - 1.0) < 4.5 * error + 1e-4).all()


def test_media_in_one_place_shine_together():
    """Seen from within both, of which one absorbs."""
    b = seen_along_y(eye_y=0.0)
    b.background((0, 0, 0))
    fill(b, VolumeCoefficients((0.5, 0.5, 0.5), (0, 0, 0), emission=(0.3, 0.2, 0.1)), "mesh")
    fill(b, VolumeCoefficients((0, 0, 0), (0, 0, 0), emission=(0.0, 0.2, 0.4)), "sphere")
    assert_seen(b, np.array([0.3, 0.4, 0.5]) * (1.0 - np.exp(-0.5)) / 0.5)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_fog_without_end_hides_the_world(integrator):
    """The world's medium is everywhere: what is beyond has no light left; a wall has what Beer's law leaves of it."""
    b = seen_along_y(eye_y=0.0)
    b.background((1, 1, 1), volume=ABSORBING)
    upright = np.array([[1.0, 0, 0, 0], [0, 0, -1, 3], [0, 1, 0, 0], [0, 0, 0, 1]])
    glow = b.material("glow", Emission((1, 1, 1), 2.0))
    b.instance(b.quads("wall", [(0, 0, 0)], [(9, 0, 0)], [(0, 9, 0)]), upright, [glow])
    assert_seen(b, 2.0 * np.exp(-3.0 * SIGMA), integrator=integrator)
    b = seen_along_y()
    b.background((1, 1, 1), volume=VolumeAbsorption((0, 0, 0), 0.1))
    assert not picture(b, size=4, samples=2, integrator=integrator)[..., :3].any()
