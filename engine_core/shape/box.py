# SPDX-License-Identifier: GPL-3.0-or-later
"""Boxes: centre `p`, half edges `u` and `v` at right angles, and across both of them a third one of length `radius`.

Both sides can be hit; the normal points outwards.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import Vec3, cross, dot, length, load3
from .hit import INFINITY, ZERO, ShapeHit
from .quad import IN_PLANE


class Axes(NamedTuple):
    """The unit directions of a box's edges, and half of their lengths."""

    x: Vec3
    y: Vec3
    z: Vec3
    half: Vec3


class Face(NamedTuple):
    axis: int  # 0, 1, 2: the direction of its normal among the axes
    normal: Vec3  # unit, outwards
    height: float  # of a point over its plane; negative inside


class Slab(NamedTuple):
    near: float  # t where the ray comes between two opposite faces, and where it leaves
    far: float


@kernel
def axes(shape):
    u, v = load3(shape, "u"), load3(shape, "v")
    half = Vec3(length(u), length(v), shape.radius)
    x, y = u * (1.0 / half.x), v * (1.0 / half.y)
    return Axes(x, y, cross(x, y), half)


@kernel
def local(frame, h):
    """A direction, or a point as seen from the centre, along the edges."""
    return Vec3(dot(h, frame.x), dot(h, frame.y), dot(h, frame.z))


@kernel
def intersect(shape, o, d, t_min, t_max):
    """First hit with t_min < t < t_max; `d` need not be unit. b1 = b2 = 0.

    What rounding may have moved out of the plane of a face, or into it, counts as lying there: a ray that leaves the
    surface does not hit there again.
    """
    frame = axes(shape)
    h = o - load3(shape, "p")
    at, along = local(frame, h), local(frame, d)
    in_plane = IN_PLANE * length(h)
    x = slab(at.x, along.x, frame.half.x, in_plane)
    y = slab(at.y, along.y, frame.half.y, in_plane)
    z = slab(at.z, along.z, frame.half.z, in_plane)
    near, far = max(x.near, max(y.near, z.near)), min(x.far, min(y.far, z.far))
    if near <= far:
        if near > t_min and near < t_max:
            return ShapeHit(near, ZERO, ZERO)
        if near <= t_min and far > t_min and far < t_max:
            return ShapeHit(far, ZERO, ZERO)
    return ShapeHit(INFINITY, ZERO, ZERO)


@kernel
def slab(at, along, half, in_plane):
    """Where a ray from `at` is between the planes at -half and +half; a ray within one of them is not."""
    side = math.copysign(half, along)
    to_near, to_far = -side - at, side - at
    to_near = ZERO if abs(to_near) <= in_plane else to_near
    to_far = ZERO if abs(to_far) <= in_plane else to_far
    if along == 0.0:
        inside = to_near * to_far < 0.0
        return Slab(-INFINITY, INFINITY) if inside else Slab(INFINITY, -INFINITY)
    return Slab(to_near / along, to_far / along)


@kernel
def nearest_face(shape, p):
    """The face on which a point of the surface lies, whatever rounding did to it."""
    frame = axes(shape)
    at = local(frame, p - load3(shape, "p"))
    x, y, z = abs(at.x) - frame.half.x, abs(at.y) - frame.half.y, abs(at.z) - frame.half.z
    if x >= y and x >= z:
        return Face(0, frame.x * math.copysign(np.float32(1.0), at.x), x)
    if y >= z:
        return Face(1, frame.y * math.copysign(np.float32(1.0), at.y), y)
    return Face(2, frame.z * math.copysign(np.float32(1.0), at.z), z)


@kernel
def normal(shape, p):
    """Unit, outwards."""
    return nearest_face(shape, p).normal


@kernel
def snap(shape, p):
    """The point of the face nearest to `p`."""
    face = nearest_face(shape, p)
    return p - face.normal * face.height


@kernel
def uv(shape, p):
    """From 0 to 1 over each face, seen from outside: up is the third edge, or on the two faces across it the second."""
    frame = axes(shape)
    at = local(frame, p - load3(shape, "p"))
    x, y, z = 0.5 * at.x / frame.half.x, 0.5 * at.y / frame.half.y, 0.5 * at.z / frame.half.z
    axis = nearest_face(shape, p).axis
    if axis == 0:
        return 0.5 + math.copysign(y, y * at.x), 0.5 + z
    if axis == 1:
        return 0.5 - math.copysign(x, x * at.y), 0.5 + z
    return 0.5 + math.copysign(x, x * at.z), 0.5 + y
