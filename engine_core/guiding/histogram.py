# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities over all directions: GUIDE_SIDE x GUIDE_SIDE bins on a square into which the sphere is unfolded.

The sphere is projected onto an octahedron, whose lower half is folded out to the corners of the square (Praun and Hoppe
2003). That takes one root; a solid angle of r^3 du dv belongs to a place of the square from -1 to 1, where r^-1 is the
sum of the direction's components. Bins are numbered along a Morton curve, so that four neighbours lie side by side, and
their sums, and sums of four sums, can be walked down from the top.
"""

import math

import numpy as np

from ..guide_tables import GUIDE_BINS, GUIDE_LEVELS, GUIDE_SIDE, GUIDE_SUMS
from ..jit import kernel
from ..linalg.vec3 import Vec3

SIDE = np.float32(GUIDE_SIDE)
PER_AREA = np.float32(GUIDE_BINS / 4.0)  # from a bin's share to a density on the square
FIRST_BIN = GUIDE_SUMS - GUIDE_BINS
BELOW_ONE = np.float32(1.0 - 2.0**-24)


@kernel
def sample(cell, u0, u1):
    """(direction, its density per solid angle) from the row of GUIDE_CELL."""
    x, y, node, first, count = 0, 0, 0, 0, 4
    for _ in range(GUIDE_LEVELS):
        at = first + 4 * node
        low, high = cell.sums[at] + cell.sums[at + 1], cell.sums[at + 2] + cell.sums[at + 3]
        upper, u1 = choose_half(low, high, u1)
        at += 2 * upper
        right, u0 = choose_half(cell.sums[at], cell.sums[at + 1], u0)
        node = 4 * node + 2 * upper + right
        x, y = 2 * x + right, 2 * y + upper
        first += count
        count *= 4
    step = np.float32(2.0 / GUIDE_SIDE)
    w, r = fold((np.float32(x) + u0) * step - 1.0, (np.float32(y) + u1) * step - 1.0)
    return w, cell.sums[FIRST_BIN + node] * PER_AREA * (r * r * r)


@kernel
def pdf(cell, w):
    """Density per solid angle with which `sample` chooses the unit direction `w`."""
    x, y, r = unfold(w)
    return cell.sums[FIRST_BIN + bin_at(x, y)] * PER_AREA * (r * r * r)


@kernel
def bin_of(w):
    """Number of the bin that the unit direction `w` is in."""
    x, y, _ = unfold(w)
    return bin_at(x, y)


@kernel
def choose_half(a, b, u):
    """(0 or 1, u as good as new): the second with the probability b / (a + b)."""
    share = a / (a + b)
    if u < share:
        return 0, min(u / share, BELOW_ONE)
    return 1, min((u - share) / (1.0 - share), BELOW_ONE)


@kernel
def bin_at(x, y):
    i = min(np.int32((x + 1.0) * (0.5 * SIDE)), GUIDE_SIDE - 1)
    j = min(np.int32((y + 1.0) * (0.5 * SIDE)), GUIDE_SIDE - 1)
    return spread(i) | (spread(j) << 1)


@kernel
def spread(i):
    """The lower 4 bits of `i` on the even places."""
    i = (i | (i << 2)) & 0x33
    return (i | (i << 1)) & 0x55


@kernel
def unfold(w):
    """(x, y, r) of a unit direction: its place on the square from -1 to 1, and the distance to the octahedron."""
    r = 1.0 / (abs(w.x) + abs(w.y) + abs(w.z))
    x, y = w.x * r, w.y * r
    if w.z < 0.0:
        return turn_over(y, x), turn_over(x, y), r
    return x, y, r


@kernel
def fold(x, y):
    """(unit direction, r) at a place on the square: the inverse of `unfold`."""
    z = 1.0 - abs(x) - abs(y)
    if z < 0.0:
        x, y = turn_over(y, x), turn_over(x, y)
    r = math.sqrt(x * x + y * y + z * z)
    return Vec3(x / r, y / r, z / r), r


@kernel
def turn_over(a, sign):
    """A coordinate on the other half of the octahedron: from its middle to the corners of the square, and back."""
    return math.copysign(1.0 - abs(a), sign)
