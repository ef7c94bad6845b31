# SPDX-License-Identifier: GPL-3.0-or-later
"""A world with a program, made ready to be sampled: a map of its radiance, and the sun in its sky as a light apart."""

import math

import numpy as np

from ..jit import kernel
from ..light.background import direction_at, is_in_disk, make_map
from ..linalg.color import not_negative
from ..linalg.frame import frame_from_normal, from_local
from ..linalg.vec3 import Vec3, average, load3, store3
from ..program_tables import CELL
from ..sampling.warp import square_to_cone
from ..shader.evaluate import run_program
from ..shader.graph import is_constant, nodes_below
from ..shader.opcodes import InputVector, Op
from ..shader.point import new_point, set_world
from ..tables import LIGHT, LightKind, Visibility
from ..texture.sky import direction_of

BAKED = np.dtype([("radiance", "f4", (3,))])
MAP_WIDTH, LARGE_MAP_WIDTH = 1024, 2048  # columns of the world's map; the larger for images of more columns
DIRECTIONS = (InputVector.POSITION, InputVector.GENERATED, InputVector.OBJECT)  # which are the same in the world
WIDER = 1.0 + 1e-3  # than the sun's disk: its edge is rounded differently where it is evaluated
DISK_SAMPLES = 256


def light_rows(world, radiance, visibility):
    """Rows of LIGHT of the world, and of the sun in its sky, as far as there are any: a list."""
    if not world["background"].any():
        return []
    row = np.zeros(1, LIGHT)
    row["kind"], row["visibility"] = LightKind.BACKGROUND, visibility
    row["emission"], row["program"] = world["background"], world["background_program"]
    row["instance"] = row["prim"] = row["lamp"] = -1
    world["background_visibility"] = visibility
    disks = disk_row(radiance, visibility)
    for disk in disks:
        disk["program"], disk["emission"] = row["program"][0], row["emission"][0]
    return [row[0], *disks]


def disk_row(radiance, visibility):
    """The row of LIGHT of the sun's disk in the sky, if the world's radiance depends on one: a list of at most one.

    Of a single one, and if its sky is looked up in the direction of the ray: other suns are left to the map.
    """
    if is_constant(radiance):
        return []
    skies = [n for n in nodes_below([radiance]) if n.op == Op.SKY and n.operands[3] > 0.0]
    if len(skies) != 1:
        return []
    d, elevation, azimuth, size = skies[0].operands[:4]
    if is_constant(d) or d.op != Op.INPUT_VECTOR or d.mode not in DIRECTIONS:
        return []
    row = np.zeros(1, LIGHT)
    row["kind"], row["visibility"], row["instance"], row["prim"], row["lamp"] = LightKind.SUN, visibility, -1, -1, -1
    row["n"] = -np.array(tuple(direction_of(np.float32(elevation), np.float32(azimuth))))
    row["height"] = 2.0 * math.sin(min(WIDER * size, math.pi) / 4.0) ** 2
    row["aimed_at"] = 1
    return [row[0]]


def bake_world(scene, lights, largest_image):
    """Make the map of a world with a program: sets its size and mean radiance in WORLD, and means of its rows of
    `lights`, LIGHT. Returns the table CELL."""
    width = LARGE_MAP_WIDTH if largest_image > MAP_WIDTH else MAP_WIDTH
    height = width // 2
    cells = np.zeros(width * height + 1, BAKED).view(np.recarray)
    _bake_world(scene, cells, width, height, 2)
    radiance = cells["radiance"][:-1].reshape(height, width, 3)
    weight = np.cos(((np.arange(height) + 0.5) / height - 0.5) * np.pi)
    mean = (radiance.astype(np.float64).mean(axis=1) * weight[:, None]).sum(axis=0) / weight.sum()
    world = scene.world
    world["background"] = lights["emission"][world["background_light"]] = mean
    if world["disk_light"][0] >= 0:
        lights["emission"][world["disk_light"]] = cells["radiance"][-1]
    if not mean.any():
        return np.zeros(0, CELL)
    world["map_width"], world["map_height"] = width, height
    return make_map(radiance).view(CELL)


@kernel
def _bake_world(scene, cells, width, height, per_side):
    """Means of per_side^2 directions in each cell, those of the sun's disk left out; behind them that of the disk."""
    point, world = new_point(), scene.world[0]
    for row in range(height):
        for column in range(width):
            total, count = Vec3(0.0, 0.0, 0.0), 0
            for i in range(per_side):
                v = (np.float32(row) + (np.float32(i) + 0.5) / np.float32(per_side)) / np.float32(height)
                for j in range(per_side):
                    u = (np.float32(column) + (np.float32(j) + 0.5) / np.float32(per_side)) / np.float32(width)
                    d, _ = direction_at(u, v)
                    if not is_in_disk(scene, d):
                        total = total + radiance_along(scene, point, d)
                        count += 1
            store3(cells[row * width + column], "radiance", total * (1.0 / np.float32(max(count, 1))))
    if world.disk_light >= 0:
        light = scene.lights[world.disk_light]
        axis = -load3(light, "n")
        s, t = frame_from_normal(axis)
        total = Vec3(0.0, 0.0, 0.0)
        for i in range(DISK_SAMPLES):
            u0, u1 = (np.float32(i) + 0.5) / np.float32(DISK_SAMPLES), (np.float32(i) + 0.5) * np.float32(0.618034)
            d = from_local(s, t, axis, square_to_cone(u0, u1 - np.floor(u1), light.height))
            total = total + radiance_along(scene, point, d)
        store3(cells[width * height], "radiance", total * (1.0 / np.float32(DISK_SAMPLES)))


@kernel
def radiance_along(scene, point, d):
    set_world(point, d, Visibility.DIFFUSE.value)
    L = run_program(scene, scene.world[0].background_program, point)
    return not_negative(L) if np.isfinite(average(L)) else Vec3(0.0, 0.0, 0.0)
