# SPDX-License-Identifier: GPL-3.0-or-later
"""Orthonormal frames: local coordinates in which z is the normal."""

import math

from ..jit import kernel
from .vec3 import Vec3, dot


@kernel
def frame_from_normal(n):
    """Two unit vectors s, t so that (s, t, n) is right-handed and orthonormal (Duff et al. 2017, listing 3).

    `n` is unit. Without a branch, and continuous but at n.z = 0.
    """
    sign = math.copysign(1.0, n.z)
    a = -1.0 / (sign + n.z)
    b = n.x * n.y * a
    s = Vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x)
    t = Vec3(b, sign + n.y * n.y * a, -n.y)
    return s, t


@kernel
def to_local(s, t, n, w):
    """The world's vector `w` in the frame (s, t, n)."""
    return Vec3(dot(w, s), dot(w, t), dot(w, n))


@kernel
def from_local(s, t, n, w):
    """The vector `w` of the frame (s, t, n) in the world."""
    return s * w.x + t * w.y + n * w.z
