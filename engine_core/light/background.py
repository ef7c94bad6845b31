# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: all directions alike where it is constant, else in proportion to a map of its radiance.

The map is a lat-long picture of map_height rows, from below to above, and map_width columns (`texture.image` says where
directions are on it). A sun in the sky is left out of it: its disk is a light of its own, sampled as sun lamps are, and
each direction belongs to one of the two. `scene.world_map` holds sums, each from 0 to 1: over the rows by their light,
map_height + 1 numbers, and for each row over its columns, map_width + 1 numbers. (pbrt's piecewise-constant
Distribution2D.)
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import Vec3, load3
from ..sampling.warp import INV_FOUR_PI, cos_sin_turn, square_to_sphere
from ..texture.image import equirectangular
from . import sun
from .light_sample import INFINITY, LightSample, no_light

AROUND = np.float32(2.0 * math.pi * math.pi)  # solid angle of the square on the map, over the cosine of the latitude


@kernel
def sample(scene, light, u0, u1):
    world = scene.world[0]
    if world.map_width == 0:
        return LightSample(square_to_sphere(u0, u1), INFINITY, load3(light, "emission"), INV_FOUR_PI, False)
    row, v, density_v = choose(scene, 0, world.map_height, u1)
    _, u, density_u = choose(scene, first_of_row(world, row), world.map_width, u0)
    wi, cosine = direction_at(u, v)
    if cosine <= 0.0 or density_v == 0.0 or density_u == 0.0 or is_in_disk(scene, wi):
        return no_light()
    return LightSample(wi, INFINITY, load3(light, "emission"), density_u * density_v / (AROUND * cosine), False)


@kernel
def is_in_disk(scene, wi):
    """Whether `wi` belongs to the world's other row of LIGHT, that of the sun in its sky."""
    row = scene.world[0].disk_light
    return row >= 0 and sun.is_inside(scene.lights[row], wi)


@kernel
def direction_at(u, v):
    """(direction, cosine of its latitude) of a place on the map: the inverse of `texture.image.equirectangular`."""
    # its latitude is (v - 1/2) pi and its longitude (1/2 - u) 2 pi: both a quarter or a half turn from what is asked
    minus_z, cosine = cos_sin_turn(0.5 * v)
    minus_x, y = cos_sin_turn(u)
    return Vec3(-cosine * minus_x, cosine * y, -minus_z), cosine


@kernel
def emitted(light):
    return load3(light, "emission")


@kernel
def pdf(scene, wi):
    world = scene.world[0]
    if world.map_width == 0:
        return INV_FOUR_PI
    u, v = equirectangular(wi)
    row = max(min(np.int32(v * np.float32(world.map_height)), world.map_height - 1), 0)
    column = max(min(np.int32(u * np.float32(world.map_width)), world.map_width - 1), 0)
    cosine = math.sqrt(max(1.0 - wi.z * wi.z, 1e-12))
    density = density_of(scene, 0, world.map_height, row)
    return density * density_of(scene, first_of_row(world, row), world.map_width, column) / (AROUND * cosine)


@kernel
def first_of_row(world, row):
    """Where the sums of a row of the map begin."""
    return world.map_height + 1 + row * (world.map_width + 1)


@kernel
def density_of(scene, first, count, cell):
    """Density on the unit interval of a cell of the `count` whose sums begin at `first`."""
    return (scene.world_map[first + cell + 1].cdf - scene.world_map[first + cell].cdf) * np.float32(count)


@kernel
def choose(scene, first, count, u):
    """(cell, place between 0 and 1, density there) by inverting the sums, by bisection."""
    low, high = 0, count
    while high - low > 1:
        middle = (low + high) >> 1
        if scene.world_map[first + middle].cdf <= u:
            low = middle
        else:
            high = middle
    begin = scene.world_map[first + low].cdf
    span = scene.world_map[first + low + 1].cdf - begin
    within = min((u - begin) / span, 1.0) if span > 0.0 else np.float32(0.5)
    return low, (np.float32(low) + within) / np.float32(count), span * np.float32(count)


# ---- Preparation -----------------------------------------------------------------------------------------------------


def make_map(radiance):
    """Sums for `sample` from a map of radiance, (height, width, 3): float32, (height + 1 + height * (width + 1),).

    What is everywhere scattering finds as well: only what is brighter than the mean is sampled, if there is any
    (MIS compensation, Karlik et al. 2019).
    """
    height, width, _ = radiance.shape
    light = np.maximum(radiance.astype(np.float64).mean(axis=-1), 0.0)
    cosine = np.cos(((np.arange(height) + 0.5) / height - 0.5) * math.pi)[:, None]
    brighter = np.maximum(light - (light * cosine).sum() / (cosine.sum() * width), 0.0)
    light = (brighter if brighter.any() else light) * cosine
    sums = np.zeros((height, width + 1))
    np.cumsum(light, axis=1, out=sums[:, 1:])
    totals = np.concatenate([[0.0], np.cumsum(sums[:, -1])])
    sums /= np.maximum(sums[:, -1:], 1e-300)
    return np.concatenate([totals / totals[-1], sums.ravel()]).astype(np.float32)
