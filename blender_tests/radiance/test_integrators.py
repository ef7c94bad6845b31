# SPDX-License-Identifier: GPL-3.0-or-later
"""The three integrators see the same room, whatever lights it and whatever is aimed at."""

import functools
import math

import numpy as np
import pytest

from blender_tests.helpers.scenes import CUBE_CORNERS, CUBE_TRIANGLES, box, builder, cube, picture, plane, quad, sphere
from engine_core.scene.materials import Diffuse, Emission, Glass, Metallic, Mix, Principled, Subsurface, Translucent
from engine_core.scene.targets import Aim
from engine_core.settings import IntegratorKind
from engine_core.tables import SubsurfaceKind, Visibility

WALLS, LIGHT = Diffuse((0.7, 0.6, 0.5)), Emission((1, 0.9, 0.8), 4.0)
CEILING = np.array([[0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1, 0.95], [0, 0, 0, 1]])
DOWN = CEILING @ np.diag([1.0, -1.0, -1.0, 1.0])
ALWAYS = {"aim": Aim.ALWAYS}


def room(surface=WALLS):
    b = builder(eye=(0, -0.9, 0.3), target=(0, 0.2, -0.4), field_of_view=75)
    cube(b, surface)
    return b


def at(x, y, z, size=1.0):
    return np.array([[size, 0, 0, x], [0, size, 0, y], [0, 0, size, z], [0, 0, 0, 1.0]])


# ---- Rooms -----------------------------------------------------------------------------------------------------------


def targets_in_each_other():
    """A glass ball around a small diffuse one, both in a box of glass, all aimed at; and a metal box beside them."""
    b = room()
    quad(b, LIGHT, DOWN)
    sphere(b, Glass(roughness=0.0), (0.2, 0.3, -0.5), 0.3, **ALWAYS)
    sphere(b, Diffuse((0.9, 0.2, 0.1)), (0.2, 0.3, -0.5), 0.15, **ALWAYS)
    box(b, Glass(roughness=0.3, ior=1.2), at(0.2, 0.3, -0.5, 0.4), **ALWAYS)
    box(b, Metallic((0.9, 0.8, 0.7), (1, 1, 1), roughness=0.2), at(-0.5, 0.4, -0.7, 0.25), **ALWAYS)
    return b


def light_below_surfaces():
    """A ball of two kinds of wax, and a stretched cube of skin under a varnish; what is in them does not matter."""
    b = room()
    quad(b, LIGHT, DOWN)
    deep, shallow = Subsurface((0.8, 0.5, 0.2), (0.3, 0.1, 0.05)), Subsurface((0.2, 0.5, 0.8), (0.02, 0.01, 0.01))
    sphere(b, Mix(0.5, deep, shallow), (0.3, 0.3, -0.5), 0.35)
    sphere(b, Metallic((1, 1, 1), (1, 1, 1), roughness=0.3), (0.3, 0.3, -0.5), 0.1)
    skin = {"subsurface_weight": 0.7, "subsurface_radius": (0.3, 0.2, 0.1), "subsurface_kind": SubsurfaceKind.SKIN}
    cube(b, Principled((0.9, 0.8, 0.7), roughness=0.3, **skin), at(-0.5, 0.4, -0.6) @ np.diag([0.3, 0.2, 0.35, 1.0]))
    return b


def camera_in_a_target():
    """All that is seen lies in a translucent ball that is aimed at."""
    b = room()
    quad(b, LIGHT, DOWN)
    sphere(b, Mix(0.5, Diffuse((0.8, 0.8, 0.8)), Translucent((0.8, 0.8, 0.8))), (0, 0, 0), 0.97, **ALWAYS)
    return b


def target_behind_the_surface():
    """The light shines up, onto the ceiling: from most places it cannot be seen, but its back is aimed at."""
    b = room()
    cube(b, LIGHT, at(0, 0.1, 0.2) @ np.diag([0.4, 0.4, 0.01, 1.0]))
    plane(b, WALLS, half=0.8, z=0.1)
    return b


def rough_glass_before_the_light():
    b = room()
    quad(b, LIGHT, DOWN)
    cube(b, Glass(roughness=0.4), at(0, 0.1, 0.5) @ np.diag([0.7, 0.7, 0.2, 1.0]), **ALWAYS)
    return b


def mesh_that_is_not_convex():
    """A star of three crossed bars that emits, and is one mesh; another of clay."""
    b = room()
    bars = [np.diag(sizes) for sizes in ((0.4, 0.1, 0.1), (0.1, 0.4, 0.1), (0.1, 0.1, 0.4))]
    corners = np.concatenate([CUBE_CORNERS @ bar for bar in bars])
    star = b.mesh("star", corners, np.concatenate([CUBE_TRIANGLES, CUBE_TRIANGLES + 8, CUBE_TRIANGLES + 16]))
    b.instance(star, at(-0.3, 0.3, 0.4), [b.material("light", LIGHT)])
    b.instance(star, at(0.4, 0.4, -0.4), [b.material("clay", WALLS)], **ALWAYS)
    return b


def lamps_of_every_kind():
    b = room()
    b.area_light("Area", DOWN @ at(0.8, 0.8, 0, 0.4), (2, 1, 1), 1.0, 1.0)
    b.area_light("Disk", DOWN @ at(-0.8, -0.8, 0, 0.4), (1, 2, 1), 1.0, 0.8, "ELLIPSE")
    b.area_light("Spread", DOWN @ at(-0.8, 0.8, 0, 0.4), (1, 1, 2), 1.0, 0.8, spread=2.0)
    b.point_light("Soft", (0.5, 0.3, 0.1), (2, 1, 1), radius=0.2)
    b.point_light("Ball", (-0.5, 0.3, 0.1), (1, 2, 1), radius=0.2, soft=False)
    b.spot_light("Spot", at(0, 0.3, 0.6), (4, 4, 8), 0.15, 1.5, 0.5)
    return b


def lamps_that_no_ray_hits():
    b = room()
    b.point_light("Point", (0.5, 0.3, 0.5), (3, 2, 2))
    b.spot_light("Spot", at(-0.3, 0.3, 0.6), (4, 4, 8), 0.0, 1.5, 0.5)
    b.area_light("Beam", DOWN, (0.3, 0.3, 0.3), 0.8, 0.8, spread=0.0)
    b.point_light("Ball", (-0.5, 0.3, 0.1), (1, 2, 1), radius=0.2, soft=False)
    return b


def suns():
    b = builder(eye=(0, -4, 2), target=(0, 0, 0), field_of_view=40)
    sphere(b, WALLS, **ALWAYS)
    plane(b, WALLS, half=4.0, z=-1.0)
    b.background((0.1, 0.2, 0.3))
    b.sun_light("Wide", (0.5, 0.5, -1), (2, 2, 2), math.radians(50))
    b.sun_light("Parallel", (-0.5, 0.5, -1), (1, 1, 1))
    return b


def one_sided_and_stretched():
    """An ellipsoid that emits has no exact sample; a one-sided light is dark from behind."""
    b = room()
    material = b.material("egg", LIGHT)
    b.instance(b.spheres("egg", [(0, 0, 0)], [0.25]), at(-0.5, 0.4, 0) @ np.diag([1, 0.6, 1.5, 1.0]), [material])
    b.instance(b.quads("q", [(0.3, 0, 0)], [(0, 0.3, 0)], [(0, 0, 0.3)]), materials=[one_sided(b)])
    return b


def one_sided(b):
    return b.material("one-sided", LIGHT, one_sided_emission=True)


def lights_that_some_rays_see():
    """Walls of two lobes, of which each sees other lights; glass rays see a third."""
    b = room(Mix(0.5, Diffuse((0.9, 0.9, 0.9)), Metallic((0.9, 0.9, 0.9), (1, 1, 1), roughness=0.5)))
    shadow = Visibility.CAMERA | Visibility.SHADOW
    b.area_light("Diffuse", DOWN @ at(0.8, 0.8, 0, 0.4), (2, 1, 1), 1.0, 1.0, visibility=shadow | Visibility.DIFFUSE)
    b.point_light("Glossy", (-0.5, 0.3, 0.1), (1, 2, 1), 0.2, soft=False, visibility=shadow | Visibility.GLOSSY)
    quad(b, LIGHT, DOWN @ at(-0.8, -0.8, 0, 0.4), visibility=Visibility.ALL & ~Visibility.DIFFUSE)
    sphere(b, Glass(roughness=0.4, ior=1.2), (0.4, 0.4, -0.6), 0.35, **ALWAYS)
    return b


ROOMS = (
    light_below_surfaces,
    lights_that_some_rays_see,
    targets_in_each_other,
    camera_in_a_target,
    target_behind_the_surface,
    rough_glass_before_the_light,
    mesh_that_is_not_convex,
    lamps_of_every_kind,
    lamps_that_no_ray_hits,
    suns,
    one_sided_and_stretched,
)


@functools.cache
def pictures(fill, integrator, seeds, **changes):
    """(seeds, blocks, 3): means over blocks of 6 x 6 pixels of independent pictures."""
    values = {"size": 24, "samples": 256, "max_bounces": 5, "adaptive": 0, **changes}
    images = [picture(fill(), integrator=integrator, seed=100 * integrator + seed, **values) for seed in range(seeds)]
    return np.array(images, float)[..., :3].reshape(seeds, 4, 6, 4, 6, 3).mean(axis=(2, 4)).reshape(seeds, 16, 3)


def assert_same(fill, one, other, seeds=8, **changes):
    """No block is further apart than its noise explains, nor is the whole."""
    a, b = (pictures(fill, kind, seeds, **changes) for kind in (one, other))
    whole = [x.mean(axis=(1, 2)) for x in (a, b)]
    error = math.sqrt(sum(w.var(ddof=1) for w in whole) / seeds)
    assert error < 0.015 * whole[0].mean(), "too noisy to prove anything"
    assert abs(whole[0].mean() - whole[1].mean()) < 4.5 * error
    deviation = a.mean(axis=0) - b.mean(axis=0)
    errors = np.sqrt((a.var(axis=0, ddof=1) + b.var(axis=0, ddof=1)) / seeds) + 1e-6
    assert (np.abs(deviation) / errors).max() < 8.0  # Student's t with some ten degrees of freedom, of 48


@pytest.mark.parametrize("fill", ROOMS, ids=lambda fill: fill.__name__)
@pytest.mark.parametrize("kind", [IntegratorKind.MIXTURE, IntegratorKind.BRUTE_FORCE])
def test_an_integrator_agrees_with_the_path_tracer(fill, kind):
    assert_same(fill, kind, IntegratorKind.PATH)


def mixed_materials():
    b = room(Mix(0.5, Diffuse((0.9, 0.9, 0.9)), Metallic((0.9, 0.9, 0.9), (1, 1, 1), roughness=0.5)))
    quad(b, LIGHT, DOWN)
    sphere(b, Glass(roughness=0.3), (0.4, 0.4, -0.6), 0.35, **ALWAYS)
    return b


@pytest.mark.parametrize("kind", [IntegratorKind.MIXTURE, IntegratorKind.BRUTE_FORCE])
def test_bounces_are_counted_alike(kind):
    """A direction towards a target is put down to the lobe that would have chosen it: else limits would cut others."""
    limits = {"max_bounces": 20, "diffuse_bounces": 1, "glossy_bounces": 3, "transmission_bounces": 2}
    assert_same(mixed_materials, kind, IntegratorKind.PATH, **limits)


@pytest.mark.parametrize("kind", [IntegratorKind.MIXTURE, IntegratorKind.BRUTE_FORCE])
def test_roulette_takes_nothing_away(kind):
    """A mixture's throughput goes up and down; whatever ends a path early has to be made up for."""
    assert_same(targets_in_each_other, kind, IntegratorKind.PATH, max_bounces=20, min_bounces=0)


@pytest.mark.parametrize("kind", [IntegratorKind.PATH, IntegratorKind.BRUTE_FORCE])
@pytest.mark.parametrize("radius", [0.0, 0.2])
def test_matt_walls_are_dark_where_only_glossy_rays_see_the_lamp(kind, radius):
    """As Cycles does it; a lamp without a radius is found by sampling alone."""
    b = room()
    b.point_light(
        "Lamp", (0.3, 0.3, 0.1), (1, 1, 1), radius, soft=False, visibility=Visibility.GLOSSY | Visibility.SHADOW
    )
    assert not picture(b, integrator=kind, samples=4, size=24)[..., :3].any()
