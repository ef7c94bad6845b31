# SPDX-License-Identifier: GPL-3.0-or-later
"""Quads: parallelograms with centre `p` and half edges `u` and `v`. Both sides can be hit; the front is along u x v."""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import cross, dot, load3
from .hit import INFINITY, ZERO, ShapeHit

# A ray counts as starting in the plane, and so does not hit it, when it starts closer than this times the distance from
# the centre. That is what rounding can make of a point that is meant to lie there.
IN_PLANE = np.float32(8 * 2.0**-24)


@kernel
def intersect(shape, o, d, t_min, t_max):
    """The hit with t_min < t < t_max; b1, b2 from 0 to 1 along u and v."""
    t, x, y = intersect_plane(shape, o, d)
    if t > t_min and t < t_max and abs(x) <= 1.0 and abs(y) <= 1.0:
        return ShapeHit(t, 0.5 * x + 0.5, 0.5 * y + 0.5)
    return ShapeHit(INFINITY, ZERO, ZERO)


@kernel
def intersect_plane(shape, o, d):
    """t, x, y of the point o + t d = p + x u + y v. t is infinite for a ray along the plane or from within it."""
    u, v = load3(shape, "u"), load3(shape, "v")
    n = cross(u, v)
    n2 = dot(n, n)
    h = o - load3(shape, "p")
    height = dot(h, n)
    slope = dot(d, n)
    if slope == 0.0 or height * height <= IN_PLANE * IN_PLANE * dot(h, h) * n2:
        return INFINITY, ZERO, ZERO
    t = -height / slope
    h = h + d * t
    return t, dot(cross(h, v), n) / n2, dot(cross(u, h), n) / n2


@kernel
def normal(shape, p):
    """Unit, along u x v."""
    n = cross(load3(shape, "u"), load3(shape, "v"))
    return n * (1.0 / math.sqrt(dot(n, n)))


@kernel
def snap(shape, p):
    """The point of the plane nearest to `p`."""
    n = normal(shape, p)
    return p - n * dot(p - load3(shape, "p"), n)


@kernel
def coordinates(shape, p):
    """x, y of the point p = centre + x u + y v."""
    u, v = load3(shape, "u"), load3(shape, "v")
    n = cross(u, v)
    h = p - load3(shape, "p")
    scale = 1.0 / dot(n, n)
    return dot(cross(h, v), n) * scale, dot(cross(u, h), n) * scale


@kernel
def uv(shape, p):
    """From 0 to 1 along u and v."""
    x, y = coordinates(shape, p)
    return 0.5 * x + 0.5, 0.5 * y + 0.5
