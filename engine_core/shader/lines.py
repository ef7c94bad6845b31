# SPDX-License-Identifier: GPL-3.0-or-later
"""Wireframe, Radial Tiling and Point Info: a family of its own, since few materials ask for them."""

import math

import numpy as np

from ..jit import kernel
from ..linalg.registers import store_float
from ..linalg.transform import transform_point, transform_vector
from ..linalg.vec3 import BLACK, Vec3, cross, dot, length, load3, load3_at
from ..motion import instance_at, new_instance
from ..tables import ShapeKind, TreeKind
from ..texture.hash import TO_UNIT_FLOAT, hash2
from ..texture.radial_tiling import radial_tiling
from .inputs import place
from .opcodes import Op
from .operands import give_both, give_number, give_vector, number, vector
from .point import surface_tangents

ZERO, ONE = np.float32(0.0), np.float32(1.0)
FOOTPRINTS = np.float32(5.0)  # that half of a pixel has
DIAGONAL = np.float32(1.0 / math.sqrt(3.0))


def run(scene, op, point, registers):
    """One step: see `opcodes.SIGNATURES`."""
    if op.code == Op.WIREFRAME:
        give_number(op, registers, wireframe(scene, point, number(op, registers, 0), op.mode, op.shift))
    elif op.code == Op.RADIAL_TILING:
        v = vector(op, registers, 0)
        tile = radial_tiling(v.x, v.y, number(op, registers, 1), number(op, registers, 2), op.mode != 0)
        give_both(op, registers, Vec3(tile.along, tile.across, 0.0), tile.width)
        store_float(registers, op.out + 4, tile.rotation)
        store_float(registers, op.out + 5, tile.segment)
    else:
        give_point(scene, op, point, registers)


@kernel
def wireframe(scene, point, size, in_pixels, shift):
    """1 within half of `size` of an edge of the triangle that was hit, measured in the world; else 0."""
    if point.kind != TreeKind.TRIANGLES or point.instance < 0:
        return ZERO
    triangle = scene.triangles[point.prim]
    p = place(point, shift)
    a, b, c = load3_at(triangle, "p", 0), load3_at(triangle, "p", 1), load3_at(triangle, "p", 2)
    if triangle.instance < 0:  # its corners are in object space
        instance = instance_at(scene, point.instance, point.time, new_instance())
        a, b = transform_point(instance, "to_world", a), transform_point(instance, "to_world", b)
        c = transform_point(instance, "to_world", c)
    width = 0.5 * size
    if in_pixels:
        width *= pixel_across(point)
    if distance_squared(p, a, b) < width * width or distance_squared(p, b, c) < width * width:
        return ONE
    return ONE if distance_squared(p, c, a) < width * width else ZERO


@kernel
def distance_squared(p, a, b):
    """From a point to the line through two others."""
    edge = b - a
    off = cross(edge, p - a)
    return dot(off, off) / max(dot(edge, edge), 1e-37)


@kernel
def pixel_across(point):
    """Half the size of a pixel across the view, as Cycles takes it: of two directions along the surface the mean."""
    n, wo = load3(point, "ng"), load3(point, "wo")
    s, t = surface_tangents(n)
    return FOOTPRINTS * point.footprint * (length(s - wo * dot(s, wo)) + length(t - wo * dot(t, wo)))


@kernel
def give_point(scene, op, point, registers):
    """Centre and radius in the world, and a random number, of a point of a point cloud; zeros of all else."""
    centre, radius, random = BLACK, ZERO, ZERO
    if point.kind == TreeKind.SHAPES and point.instance >= 0:
        shape = scene.shapes[point.prim]
        if shape.kind == ShapeKind.SPHERE:
            centre, radius = load3(shape, "p"), shape.radius
            random = np.float32(hash2(np.uint32(shape.number), np.uint32(0))) * TO_UNIT_FLOAT
            if shape.instance < 0:
                instance = instance_at(scene, point.instance, point.time, new_instance())
                centre = transform_point(instance, "to_world", centre)
                side = radius * DIAGONAL
                radius = length(transform_vector(instance, "to_world", Vec3(side, side, side)))
    give_vector(op, registers, centre)
    store_float(registers, op.out + 3, radius)
    store_float(registers, op.out + 4, random)
