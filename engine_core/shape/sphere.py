# SPDX-License-Identifier: GPL-3.0-or-later
"""Spheres: centre `p`, `radius`. Both sides can be hit; the normal points outwards."""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import dot, load3
from .hit import INFINITY, ZERO, ShapeHit

# For an origin that is meant to lie on the surface, |o - p|^2 - radius^2 is wrong by some 10 roundings of radius^2.
# Closer than this, in units of radius^2, an origin counts as on it.
ON_SURFACE = np.float32(12 * 2.0**-24)
INV_PI = np.float32(1.0 / math.pi)
INV_2PI = np.float32(0.5 / math.pi)


@kernel
def intersect(shape, o, d, t_min, t_max):
    """First hit with t_min < t < t_max; `d` need not be unit. b1 = b2 = 0.

    The discriminant is taken from the distance of the centre to the ray, so that small spheres far away keep their
    outline, and the near root as c / q without a difference of close numbers (Haines et al. 2019, Ray Tracing Gems,
    chapter 7). A ray that starts on the surface does not hit there again, however large the sphere.
    """
    f = load3(shape, "p") - o
    r2 = shape.radius * shape.radius
    a = dot(d, d)
    b = dot(f, d)
    miss = f - d * (b / a)
    discriminant = r2 - dot(miss, miss)
    if not discriminant >= 0.0:
        return ShapeHit(INFINITY, ZERO, ZERO)
    c = dot(f, f) - r2
    if abs(c) <= ON_SURFACE * r2:
        c = ZERO
    q = b + math.copysign(math.sqrt(a * discriminant), b)
    if q == 0.0:
        return ShapeHit(INFINITY, ZERO, ZERO)
    t0 = c / q
    t1 = q / a
    near = min(t0, t1)
    far = max(t0, t1)
    if near > t_min and near < t_max:
        return ShapeHit(near, ZERO, ZERO)
    if far > t_min and far < t_max:
        return ShapeHit(far, ZERO, ZERO)
    return ShapeHit(INFINITY, ZERO, ZERO)


@kernel
def normal(shape, p):
    """Unit, outwards."""
    n = p - load3(shape, "p")
    return n * (1.0 / math.sqrt(dot(n, n)))


@kernel
def snap(shape, p):
    """The point of the surface nearest to `p`."""
    return load3(shape, "p") + normal(shape, p) * shape.radius


@kernel
def uv(shape, p):
    """Blender's mapping onto a sphere: u once around z, counter-clockwise from -y; v from bottom to top."""
    n = normal(shape, p)
    u = 0.5 - math.atan2(n.x, n.y) * INV_2PI
    v = 1.0 - math.acos(min(max(n.z, -1.0), 1.0)) * INV_PI
    return u, v
