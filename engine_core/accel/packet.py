# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays against packets of eight triangles, watertight: no ray slips between two triangles that share an edge."""

from typing import NamedTuple

import numpy as np

from ..jit import inlined_kernel
from ..linalg.simd import bits, difference_of_products, f32x8, load8, maximum, minimum, splat8, splat_axis
from ..linalg.vec3 import WHITE

ZERO, ONE = np.float32(0.0), np.float32(1.0)


class Shear(NamedTuple):
    """A ray, prepared for triangles: axes exchanged and sheared so that it runs along z from the origin."""

    kx: int  # axes of the world that become x, y and z; the ray advances fastest along z
    ky: int
    kz: int
    ox: f32x8  # its origin, axes exchanged
    oy: f32x8
    oz: f32x8
    sx: f32x8  # the shear
    sy: f32x8
    sz: f32x8


class PacketHit(NamedTuple):
    hits: int  # a bit for each triangle that is hit
    t: f32x8
    b1: f32x8
    b2: f32x8


@inlined_kernel
def make_shear(o, d):
    """The ray o + t d, prepared for triangles."""
    ax, ay, az = abs(d.x), abs(d.y), abs(d.z)
    along_x, along_y = (ax >= ay) & (ax >= az), ay >= az
    # Three choices of a number, not one of three branches: nobody could foretell which.
    kx = 1 if along_x else (2 if along_y else 0)
    ky = 2 if along_x else (0 if along_y else 1)
    kz = 0 if along_x else (1 if along_y else 2)
    sz = splat_axis(WHITE / d, kz)
    sx, sy = splat_axis(d, kx) * sz, splat_axis(d, ky) * sz
    return Shear(kx, ky, kz, splat_axis(o, kx), splat_axis(o, ky), splat_axis(o, kz), sx, sy, sz)


@inlined_kernel
def intersect_packet(packet, shear, t_min, t_max):
    """Triangles that the ray hits at t_min < t < t_max, from either side (Woop, Benthin and Wald 2013).

    u, v and w are the areas that the ray spans with the three edges. Two triangles compute the one of an edge that they
    share to exactly opposite numbers, and 0 is inside: that leaves no gap.
    """
    kx, ky, kz = shear.kx, shear.ky, shear.kz
    az = load8(packet, "p", kz) - shear.oz
    bz = load8(packet, "p", kz + 3) - shear.oz
    cz = load8(packet, "p", kz + 6) - shear.oz
    ax = load8(packet, "p", kx) - shear.ox - shear.sx * az
    ay = load8(packet, "p", ky) - shear.oy - shear.sy * az
    bx = load8(packet, "p", kx + 3) - shear.ox - shear.sx * bz
    by = load8(packet, "p", ky + 3) - shear.oy - shear.sy * bz
    cx = load8(packet, "p", kx + 6) - shear.ox - shear.sx * cz
    cy = load8(packet, "p", ky + 6) - shear.oy - shear.sy * cz
    u = difference_of_products(cx, by, cy, bx)
    v = difference_of_products(ax, cy, ay, cx)
    w = difference_of_products(bx, ay, by, ax)
    zero = splat8(ZERO)
    inside = (minimum(minimum(u, v), w) >= zero) | (maximum(maximum(u, v), w) <= zero)
    scale = splat8(ONE) / (u + v + w)  # infinite for a triangle without area; t is then not a number, and no hit
    t = (u * az + v * bz + w * cz) * shear.sz * scale
    return PacketHit(bits(inside & (t > splat8(t_min)) & (t < splat8(t_max))), t, v * scale, w * scale)
