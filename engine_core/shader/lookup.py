# SPDX-License-Identifier: GPL-3.0-or-later
"""Image Texture and Environment Texture: projections onto images."""

import numpy as np

from ..jit import inlined_kernel, kernel
from ..linalg.registers import store_float
from ..linalg.transform import transform_normal
from ..linalg.vec3 import BLACK, Vec3, load3, luminance
from ..linalg.vector_math import safe_normalize
from ..motion import instance_at, new_instance
from ..program_tables import TexelFormat
from ..texture import image as images
from ..texture.image import Rgba
from .maths import saturate
from .opcodes import UNASSOCIATE, Op, Projection
from .operands import give_both, number, vector

ZERO = np.float32(0.0)
MISSING = Rgba(Vec3(1.0, 0.0, 1.0), np.float32(1.0))  # magenta, where there is no tile


def run(scene, op, point, registers):
    """One step. The bits of `mode`: 2 for the interpolation, 2 the extension, 2 the projection, then UNASSOCIATE."""
    p = vector(op, registers, 0)
    projection = (op.mode >> 4) & 3
    if op.code == Op.IMAGE and projection == Projection.BOX:
        rgba = look_at_box(scene, op, p, object_normal(scene, point), number(op, registers, 1))
    else:
        u, v = place(op, p, projection)
        rgba = look(scene, op, u, v)
    give_both(op, registers, rgba.color, rgba.alpha)
    store_float(registers, op.out + 4, luminance(rgba.color))


@kernel
def place(op, p, projection):
    """(u, v) of a place on what is projected along itself, not from the sides of a box."""
    if op.code == Op.ENVIRONMENT:
        w = safe_normalize(p)
        return images.equirectangular(w) if projection == 0 else images.mirror_ball(w)
    if projection == Projection.FLAT:
        return p.x, p.y
    p = (p - Vec3(0.5, 0.5, 0.5)) * 2.0
    return images.sphere_to_square(p) if projection == Projection.SPHERE else images.tube_to_square(p)


@inlined_kernel
def look(scene, op, u, v):
    image = scene.images[op.data]
    if image.format == TexelFormat.TILES:
        column, row = images.tile_at(image, u, v)
        if column < 0:
            return MISSING
        image = scene.images[image.first + row * image.width + column]
        u, v = u - np.float32(column), v - np.float32(row)
    rgba = images.lookup(scene, image, u, v, op.mode & 3, (op.mode >> 2) & 3)
    return images.decoded(image, rgba, (op.mode & UNASSOCIATE) != 0)


@kernel
def object_normal(scene, point):
    n = load3(point, "ns")
    if point.instance < 0:
        return n
    return safe_normalize(
        transform_normal(instance_at(scene, point.instance, point.time, new_instance()), "to_world", n)
    )


@kernel
def look_at_box(scene, op, p, n, blend):
    """The image from the side that the normal points to, blended where it points between sides."""
    weights = box_weights(Vec3(abs(n.x), abs(n.y), abs(n.z)), blend)
    color, alpha = BLACK, ZERO
    for side in range(3):
        if side == 0:
            share, u, v = weights.x, (1.0 - p.y if n.x < 0.0 else p.y), p.z
        elif side == 1:
            share, u, v = weights.y, (1.0 - p.x if n.y > 0.0 else p.x), p.z
        else:
            share, u, v = weights.z, (1.0 - p.y if n.z > 0.0 else p.y), p.x
        if share > 0.0:
            rgba = look(scene, op, u, v)
            color = color + rgba.color * share
            alpha += rgba.alpha * share
    return Rgba(color, alpha)


@kernel
def box_weights(n, blend):
    """How much of each of three sides is seen, for a normal of absolute components, as Cycles blends them."""
    n = n * (1.0 / (n.x + n.y + n.z))
    limit = 0.5 * (1.0 + blend)
    if n.x > limit * (n.x + n.y) and n.x > limit * (n.x + n.z):
        return Vec3(1.0, 0.0, 0.0)
    if n.y > limit * (n.x + n.y) and n.y > limit * (n.y + n.z):
        return Vec3(0.0, 1.0, 0.0)
    if n.z > limit * (n.x + n.z) and n.z > limit * (n.y + n.z):
        return Vec3(0.0, 0.0, 1.0)
    if blend <= 0.0:
        return Vec3(1.0, 0.0, 0.0)
    if n.z < (1.0 - limit) * (n.x + n.y):
        x = between(n.x, n.y, blend)
        return Vec3(x, 1.0 - x, 0.0)
    if n.x < (1.0 - limit) * (n.y + n.z):
        y = between(n.y, n.z, blend)
        return Vec3(0.0, y, 1.0 - y)
    if n.y < (1.0 - limit) * (n.x + n.z):
        x = between(n.x, n.z, blend)
        return Vec3(x, 0.0, 1.0 - x)
    return (n * (2.0 - limit) + Vec3(limit - 1.0, limit - 1.0, limit - 1.0)) * (1.0 / (2.0 * limit - 1.0))


@kernel
def between(a, b, blend):
    return saturate((a / (a + b) - 0.5 * (1.0 - blend)) / blend)
