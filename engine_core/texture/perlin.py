# SPDX-License-Identifier: GPL-3.0-or-later
"""Gradient noise (Perlin, "Improving Noise", 2002) in one to four dimensions, with the gradients of Blender's noise.

The eight corners of a cell are hashed and interpolated side by side, in lanes. The number of dimensions is an argument:
in fewer than three all corners beyond the line or the square weigh nothing, which costs less than code for each.
"""

import numpy as np

from ..jit import inlined_kernel, kernel
from ..linalg.simd import lane, lanes_of, splat4, splat8
from ..linalg.simd_int import (
    absolutes,
    choose,
    floors,
    interpolated,
    lane_bit,
    negate_where_bit,
    splat_int8,
    spread,
    to_floats,
    to_integers,
    truncated,
)
from .hash8 import lookup3, lookup3_of_4

PERIOD = np.float32(100000.0)  # the lattice repeats, so that far from the origin there still are fractions
FAR = np.float32(1000000.0)  # where there are none, half a cell is added: not all points shall be corners
# Scales the sum of gradients to -1 to 1, for one to four dimensions; found by experiment (Open Shading Language).
SCALE_1, SCALE_2, SCALE_3, SCALE_4 = np.float32(0.25), np.float32(0.6616), np.float32(0.982), np.float32(0.8344)
ZERO, ZERO_FLOAT = np.int32(0), np.float32(0.0)
HALF, ONE, SIX, TEN, FIFTEEN = (np.float32(x) for x in (0.5, 1.0, 6.0, 10.0, 15.0))


@kernel
def perlin(p, w, dimensions):
    """Noise at a point, -1 to 1, and 0 at all corners of the lattice.

    `p` is a Vec3. In one dimension p.x counts and in two p.x and p.y; the others have to be 0, and `w` too in less than
    four.
    """
    if dimensions == 3:
        return perlin_in_space(p)
    p4 = _repeated(lanes_of(p, w))
    cell = floors(p4)
    f = p4 - cell
    share = _fade(f)
    dx = spread(f, 0) - to_floats(lane_bit(0))  # from each corner
    dy = spread(f, 1) - to_floats(lane_bit(1))
    dz = spread(f, 2) - to_floats(lane_bit(2))
    ix = to_integers(spread(cell, 0)) + lane_bit(0)
    if dimensions == 1:
        return SCALE_1 * interpolated(_slope1(lookup3(ix, splat_int8(ZERO), splat_int8(ZERO), 1), dx), share)
    iy = to_integers(spread(cell, 1)) + lane_bit(1)
    if dimensions == 2:
        return SCALE_2 * interpolated(_slope2(lookup3(ix, iy, splat_int8(ZERO), 2), dx, dy), share)
    iz = to_integers(spread(cell, 2)) + lane_bit(2)
    iw, dw = to_integers(spread(cell, 3)), spread(f, 3)
    here = interpolated(_slope4(lookup3_of_4(ix, iy, iz, iw), dx, dy, dz, dw), share)
    iw = iw + splat_int8(np.int32(1))
    there = interpolated(_slope4(lookup3_of_4(ix, iy, iz, iw), dx, dy, dz, dw - splat8(ONE)), share)
    return SCALE_4 * (here + lane(share, np.int32(3)) * (there - here))


@inlined_kernel
def perlin_in_space(p):
    """`perlin` of three dimensions, which most materials ask for: put into its callers, who have it in loops."""
    p4 = _repeated(lanes_of(p, ZERO_FLOAT))
    cell = floors(p4)
    f = p4 - cell
    dx = spread(f, 0) - to_floats(lane_bit(0))
    dy = spread(f, 1) - to_floats(lane_bit(1))
    dz = spread(f, 2) - to_floats(lane_bit(2))
    ix, iy = to_integers(spread(cell, 0)) + lane_bit(0), to_integers(spread(cell, 1)) + lane_bit(1)
    h = lookup3(ix, iy, to_integers(spread(cell, 2)) + lane_bit(2), 3)
    return SCALE_3 * interpolated(_slope3(h, dx, dy, dz), _fade(f))


@inlined_kernel
def _repeated(p):
    moved = p - truncated(p * splat4(ONE / PERIOD)) * splat4(PERIOD)
    return choose(splat4(FAR) <= absolutes(p), moved + splat4(HALF), moved)


@inlined_kernel
def _fade(t):
    """From 0 to 1 with two derivatives that vanish at both ends."""
    return t * t * t * (t * (t * splat4(SIX) - splat4(FIFTEEN)) + splat4(TEN))


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
    """Towards the 32 edges of a hypercube."""
    k = h & splat_int8(np.int32(31))
    u = choose(k < splat_int8(np.int32(24)), x, y)
    v = choose(k < splat_int8(np.int32(16)), y, z)
    s = choose(k < splat_int8(np.int32(8)), z, w)
    return negate_where_bit(u, h, 0) + negate_where_bit(v, h, 1) + negate_where_bit(s, h, 2)
