# SPDX-License-Identifier: GPL-3.0-or-later
"""Single triangles: rows of TRIANGLE. Both sides can be hit; the front is where the corners run counter-clockwise.

Trees of triangles do not come here: `accel/traverse` tests four at once.
"""

import math

from ..jit import kernel
from ..linalg.vec3 import cross, dot, load3_at
from .hit import INFINITY, ZERO, ShapeHit


@kernel
def intersect(triangle, o, d, t_min, t_max):
    """The hit with t_min < t < t_max; b1, b2 are the weights of the corners 1 and 2 (Moeller and Trumbore 1997)."""
    p0 = load3_at(triangle, "p", 0)
    e1 = load3_at(triangle, "p", 1) - p0
    e2 = load3_at(triangle, "p", 2) - p0
    h = cross(d, e2)
    s = o - p0
    q = cross(s, e1)
    scale = 1.0 / dot(e1, h)
    b1 = dot(s, h) * scale
    b2 = dot(d, q) * scale
    t = dot(e2, q) * scale
    if b1 >= 0.0 and b2 >= 0.0 and b1 + b2 <= 1.0 and t > t_min and t < t_max:
        return ShapeHit(t, b1, b2)
    return ShapeHit(INFINITY, ZERO, ZERO)


@kernel
def normal(triangle, p):
    """Unit geometric normal, along (p1 - p0) x (p2 - p0)."""
    p0 = load3_at(triangle, "p", 0)
    n = cross(load3_at(triangle, "p", 1) - p0, load3_at(triangle, "p", 2) - p0)
    return n * (1.0 / math.sqrt(dot(n, n)))
