# SPDX-License-Identifier: GPL-3.0-or-later
"""Disks: ellipses with centre `p` and half axes `u` and `v`, front along u x v; and facing disks, turned to the viewer.

Both sides of an ellipse can be hit. A facing disk has a `radius` only: to a ray from `o` it is the disk across the line
from `o` to its centre, as Blender's point and spot lights with soft falloff are.
"""

import math

from ..jit import kernel
from ..linalg.vec3 import dot, load3
from .hit import INFINITY, ZERO, ShapeHit
from .quad import intersect_plane, normal, snap, uv  # noqa: F401 - of an ellipse the same as of the quad around it


@kernel
def intersect(shape, o, d, t_min, t_max):
    """The hit with t_min < t < t_max; b1, b2 from 0 to 1 along u and v, in the square around the disk."""
    t, x, y = intersect_plane(shape, o, d)
    if t > t_min and t < t_max and x * x + y * y <= 1.0:
        return ShapeHit(t, 0.5 * x + 0.5, 0.5 * y + 0.5)
    return ShapeHit(INFINITY, ZERO, ZERO)


@kernel
def intersect_facing(shape, o, d, t_min, t_max):
    """The hit of a facing disk with t_min < t < t_max; b1 = b2 = 0."""
    f = load3(shape, "p") - o
    t = dot(f, f) / dot(d, f)
    miss = d * t - f
    if t > t_min and t < t_max and dot(miss, miss) <= shape.radius * shape.radius:
        return ShapeHit(t, ZERO, ZERO)
    return ShapeHit(INFINITY, ZERO, ZERO)


@kernel
def normal_facing(shape, o):
    """Unit, towards the viewer at `o`."""
    n = o - load3(shape, "p")
    return n * (1.0 / math.sqrt(dot(n, n)))
