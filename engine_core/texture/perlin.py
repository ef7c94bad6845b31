# SPDX-License-Identifier: GPL-3.0-or-later
"""Gradient noise (Perlin, "Improving Noise", 2002) in one to four dimensions, with the gradients of Blender's noise.

The eight corners of a cell are hashed and interpolated side by side, in lanes. The number of dimensions is an argument:
in fewer than three all corners beyond the line or the square weigh nothing, which costs less than code for each.
"""

import numpy as np

from ..jit import inlined_kernel, kernel
from ..linalg.simd import splat8
from ..linalg.simd_int import choose, lane_bit, negate_where_bit, splat_int8, sum_of_lanes, to_floats
from .hash8 import lookup3, lookup3_of_4

PERIOD = np.float32(100000.0)  # the lattice repeats, so that far from the origin there still are fractions
FAR = np.float32(1000000.0)  # where there are none, half a cell is added: not all points shall be corners
# Scales the sum of gradients to -1 to 1, for one to four dimensions; found by experiment (Open Shading Language).
SCALE_1, SCALE_2, SCALE_3, SCALE_4 = np.float32(0.25), np.float32(0.6616), np.float32(0.982), np.float32(0.8344)
ONE = np.float32(1.0)


@kernel
def perlin(p, w, dimensions):
    """Noise at a point, -1 to 1, and 0 at all corners of the lattice.

    `p` is a Vec3. In one dimension p.x counts and in two p.x and p.y; the others have to be 0, and `w` too in less than
    four.
    """
    x, y, z = _repeat(p.x), _repeat(p.y), _repeat(p.z)
    fx, fy, fz = x - np.floor(x), y - np.floor(y), z - np.floor(z)
    dx = splat8(fx) - to_floats(lane_bit(0))  # from each corner
    dy = splat8(fy) - to_floats(lane_bit(1))
    dz = splat8(fz) - to_floats(lane_bit(2))
    ix = splat_int8(np.int32(np.floor(x))) + lane_bit(0)
    iy = splat_int8(np.int32(np.floor(y))) + lane_bit(1)
    iz = splat_int8(np.int32(np.floor(z))) + lane_bit(2)
    weight = _weight(fx, 0) * _weight(fy, 1) * _weight(fz, 2)
    if dimensions == 4:
        w = _repeat(w)
        fw, iw = w - np.floor(w), splat_int8(np.int32(np.floor(w)))
        here = sum_of_lanes(weight * _slope4(lookup3_of_4(ix, iy, iz, iw), dx, dy, dz, fw))
        iw = iw + splat_int8(np.int32(1))
        there = sum_of_lanes(weight * _slope4(lookup3_of_4(ix, iy, iz, iw), dx, dy, dz, fw - ONE))
        return SCALE_4 * (here + _fade(fw) * (there - here))
    if dimensions == 3:
        return SCALE_3 * sum_of_lanes(weight * _slope3(lookup3(ix, iy, iz, 3), dx, dy, dz))
    zero = splat_int8(np.int32(0))
    if dimensions == 2:
        return SCALE_2 * sum_of_lanes(weight * _slope2(lookup3(ix, iy, zero, 2), dx, dy))
    return SCALE_1 * sum_of_lanes(weight * _slope1(lookup3(ix, zero, zero, 1), dx))


@inlined_kernel
def _repeat(x):
    moved = x - np.trunc(x / PERIOD) * PERIOD
    return moved + 0.5 if abs(x) >= FAR else moved


@inlined_kernel
def _fade(t):
    """From 0 to 1 with two derivatives that vanish at both ends."""
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)


@inlined_kernel
def _weight(t, axis):
    """How much each corner counts, for a point that is the share `t` of a cell along an axis."""
    u = _fade(t)
    return splat8(ONE - u) + to_floats(lane_bit(axis)) * splat8(u + u - ONE)


# ---- Slopes: the product of a corner's gradient and the way from there -----------------------------------------------


@inlined_kernel
def _slope1(h, x):
    """The gradient is one of 1 ... 8, of either sign."""
    size = to_floats((h & splat_int8(np.int32(7))) + splat_int8(np.int32(1)))
    return negate_where_bit(size * x, h, 3)


@inlined_kernel
def _slope2(h, x, y):
    """Eight directions: two along one axis, one along the other."""
    along_x = (h & splat_int8(np.int32(7))) < splat_int8(np.int32(4))
    u, v = choose(along_x, x, y), choose(along_x, y, x)
    return negate_where_bit(u, h, 0) + negate_where_bit(v + v, h, 1)


@inlined_kernel
def _slope3(h, x, y, z):
    """Towards the twelve edges of a cube, four of them twice."""
    k = h & splat_int8(np.int32(15))
    twice = (k & splat_int8(np.int32(13))) == splat_int8(np.int32(12))  # 12 or 14
    u = choose(k < splat_int8(np.int32(8)), x, y)
    v = choose(k < splat_int8(np.int32(4)), y, choose(twice, x, z))
    return negate_where_bit(u, h, 0) + negate_where_bit(v, h, 1)


@inlined_kernel
def _slope4(h, x, y, z, w):
    """Towards the 32 edges of a hypercube; `w` is the same for all lanes."""
    k = h & splat_int8(np.int32(31))
    u = choose(k < splat_int8(np.int32(24)), x, y)
    v = choose(k < splat_int8(np.int32(16)), y, z)
    s = choose(k < splat_int8(np.int32(8)), z, splat8(w))
    return negate_where_bit(u, h, 0) + negate_where_bit(v, h, 1) + negate_where_bit(s, h, 2)
