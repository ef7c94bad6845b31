# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of hairs: cones from `p` to `p + u`, as thick as `radius` at one end and `radius_end` at the other.

Neighbours are cut by the same plane, across the hair's tangent where they meet (`v` at the start, `w` at the end), so
that they fit together. Only what a ray enters by is hit: a ray that a hair's material sends through it meets nothing
inside, as scattering in a hair is what its material stands for.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import dot, load3, normalize
from .hit import MISS, ZERO, ShapeHit

ONE, SMALL = np.float32(1.0), np.float32(1e-20)


@kernel
def intersect(shape, o, d, t_min, t_max):
    """The hit with t_min < t < t_max; b1 from 0 to 1 along the piece, b2 = 0.

    In steps, each of which deals with lengths as small as its result: to where the ray is nearest to the middle, then
    to where it is nearest to the axis, then to the surface. A hair is thin, and the ray may come from far away.
    """
    u = load3(shape, "u")
    uu, dd = dot(u, u), dot(d, d)
    t_middle = dot(load3(shape, "p") + u * 0.5 - o, d) / dd
    q = o + d * t_middle - load3(shape, "p")
    scale = 1.0 / uu
    along, across = dot(d, u) * scale, dot(q, u) * scale  # in parts of u
    d_off, q_off = d - u * along, q - u * across
    a = dot(d_off, d_off)
    t_near = -dot(q_off, d_off) / a
    off = q_off + d_off * t_near
    y = across + along * t_near
    slope = (shape.radius_end - shape.radius) * along
    radius = shape.radius + (shape.radius_end - shape.radius) * y
    # |off + d_off t|^2 = (radius + slope t)^2, and `off` is at right angles to `d_off`
    a -= slope * slope
    half_b = -slope * radius
    discriminant = half_b * half_b - a * (dot(off, off) - radius * radius)
    if not (discriminant >= 0.0 and a > 0.0):
        return MISS
    t_off = (-half_b - math.sqrt(discriminant)) / a
    t = t_middle + (t_near + t_off)
    y += along * t_off
    if not (t > t_min and t < t_max) or radius + slope * t_off < 0.0:
        return MISS
    reach = max(shape.radius, shape.radius_end) / math.sqrt(uu)  # of the edges at a bend, which no cut reaches beyond
    if y < -reach or y > 1.0 + reach:
        return MISS
    q = q + d * (t_near + t_off)
    if dot(q, load3(shape, "v")) < 0.0 or dot(q - u, load3(shape, "w")) >= 0.0:
        return MISS
    return ShapeHit(t, min(max(y, ZERO), ONE), ZERO)


@kernel
def place(shape, p):
    """(how far along the piece `p` is, 0 to 1; from the axis to `p`)"""
    u, q = load3(shape, "u"), p - load3(shape, "p")
    y = dot(q, u) / dot(u, u)
    return min(max(y, ZERO), ONE), q - u * y


@kernel
def normal(shape, p):
    """Unit, outwards."""
    _, off = place(shape, p)
    u = load3(shape, "u")
    n = off * (1.0 / math.sqrt(max(dot(off, off), SMALL)))
    return normalize(n - u * ((shape.radius_end - shape.radius) / dot(u, u)))


@kernel
def snap(shape, p):
    """The point of the surface nearest to `p`."""
    y, off = place(shape, p)
    radius = shape.radius + (shape.radius_end - shape.radius) * y
    return p + off * (radius / math.sqrt(max(dot(off, off), SMALL)) - 1.0)


@kernel
def tangent(shape, p):
    """Whereto the hair runs at `p`, from its root to its tip; not unit."""
    y, _ = place(shape, p)
    return load3(shape, "v") * (1.0 - y) + load3(shape, "w") * y


@kernel
def uv(shape, p):
    """(from 0 to 1 along the piece, 0)"""
    return place(shape, p)[0], ZERO
