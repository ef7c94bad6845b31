# SPDX-License-Identifier: GPL-3.0-or-later
"""Points scattered over the cells of a lattice, one in each, in one to four dimensions; and distances to them.

A cell is named by its number among the 3^n or 5^n around another, x fastest. What is asked for one cell gets numbers,
what is asked for eight of them gets lanes.
"""

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from ..jit import inlined_kernel, kernel
from ..linalg.simd import f32x8, lane, lanes_of, maximum, minimum, splat4, splat8
from ..linalg.simd_int import (
    absolutes,
    bits_of_floats,
    choose,
    floors,
    lane_bit,
    lane_numbers,
    least_lane,
    powers,
    splat_int8,
    spread,
    square_roots,
    to_floats,
    to_integers,
)
from ..linalg.vec3 import Vec3, lerp
from . import hash8
from .hash import Random4, pcg2, pcg3, pcg4, random_color, random_of_1

ZERO, ONE, TWO, THREE, FIVE = (np.float32(x) for x in (0.0, 1.0, 2.0, 3.0, 5.0))
HALF, THIRD, FIFTH = np.float32(0.5), np.float32(1.0 / 3.0), np.float32(0.2)
SAFE = np.float32(0.99999)  # a bound that rounding does not pass


class VoronoiMetric(IntEnum):
    """How distance is measured; names and numbers are Blender's."""

    EUCLIDEAN = 0
    MANHATTAN = 1
    CHEBYCHEV = 2
    MINKOWSKI = 3


class Point4(NamedTuple):
    """A point of up to four dimensions: the first counts in one dimension, the first two in two ..."""

    x: np.float32
    y: np.float32
    z: np.float32
    w: np.float32


class Lattice(NamedTuple):
    """What decides where the points lie, and how far they are."""

    dimensions: int
    metric: int  # VoronoiMetric
    exponent: np.float32  # of MINKOWSKI
    randomness: np.float32  # 0: at the corners of their cells


# ---- Points ----------------------------------------------------------------------------------------------------------


@inlined_kernel
def cell_count(side, dimensions):
    """How many cells a cube of 3 or 5 cells a side has."""
    count = side
    for _ in range(dimensions - 1):
        count *= side
    return count


@kernel
def offset_of(lattice, number, side):
    """Which of the side^n cells a number means: -1, 0 or 1 along each axis, or up to 2 where there are five."""
    n, middle = lattice.dimensions, side // 2
    y, z, w = number // side, number // (side * side), number // (side * side * side)
    return Point4(
        np.float32(number % side - middle),
        np.float32(y % side - middle if n > 1 else 0),
        np.float32(z % side - middle if n > 2 else 0),
        np.float32(w - middle if n > 3 else 0),
    )


@kernel
def point_of(lattice, cell, offset):
    """The point of one cell, from the corner of the cell that offsets are counted from."""
    u, r = place_in(lattice.dimensions, added(cell, offset)), lattice.randomness
    return Point4(offset.x + u.x * r, offset.y + u.y * r, offset.z + u.z * r, offset.w + u.w * r)


@kernel
def place_in(n, at):
    """Where in its cell the point is that belongs to a cell: n numbers in 0 to 1."""
    if n == 1:
        return Random4(random_of_1(at.x), ZERO, ZERO, ZERO)
    if n == 2:
        return pcg2(np.int32(at.x), np.int32(at.y))
    if n == 3:
        return pcg3(np.int32(at.x), np.int32(at.y), np.int32(at.z))
    return pcg4(np.int32(at.x), np.int32(at.y), np.int32(at.z), np.int32(at.w))


@kernel
def color_of(lattice, cell, offset):
    n = lattice.dimensions
    at = added(cell, offset)
    if n == 1:
        return random_color(at.x, ZERO, ZERO, ZERO, 1)
    if n == 4:
        u = pcg4(np.int32(at.x), np.int32(at.y), np.int32(at.z), np.int32(at.w))
    else:
        u = pcg3(np.int32(at.x), np.int32(at.y), np.int32(at.z))  # z is 0 in two dimensions
    return Vec3(u.x, u.y, u.z)


@inlined_kernel
def cells_beside(lattice, p):
    """Numbers, 3 a side, of the 2^n cells that are most likely to have the nearest point to `p`: this one, and its
    neighbours on the nearer side along each axis. Up to three dimensions."""
    numbers = splat_int8(side_of(lattice, p.x)) + lane_bit(0)
    if lattice.dimensions > 1:
        numbers = numbers + (splat_int8(side_of(lattice, p.y)) + lane_bit(1)) * splat_int8(np.int32(3))
    if lattice.dimensions > 2:
        numbers = numbers + (splat_int8(side_of(lattice, p.z)) + lane_bit(2)) * splat_int8(np.int32(9))
    return numbers


@inlined_kernel
def side_of(lattice, x):
    """0 where the lower neighbour is nearer to the place `x` in a cell, else 1."""
    return np.int32(x + (1.0 - lattice.randomness) >= 1.0 - x)


@kernel
def nearest_in_space(p, randomness):
    """Square of the Euclidean distance from `p` to the nearest point in three dimensions: what `nearest` finds, for
    those who need no more than that, as most do."""
    p4, r = lanes_of(p, ZERO), splat8(randomness)
    cell = floors(p4)
    f = p4 - cell
    lower, upper = f + splat4(ONE - randomness), splat4(ONE) - f
    side = choose(lower < upper, splat4(-ONE), splat4(ZERO))
    least = least_lane(
        squares_to(cell, side - f, side, to_floats(lane_bit(0)), to_floats(lane_bit(1)), to_floats(lane_bit(2)), r)
    )
    beyond = maximum(lower, upper) * splat4(SAFE)
    beyond = min(lane(beyond, np.int32(0)), lane(beyond, np.int32(1)), lane(beyond, np.int32(2)))
    if least < beyond * beyond:
        return least
    best, all_below = splat8(least), splat4(-ONE)
    for first in range(0, 27, 8):
        x, q = _digit(to_floats(splat_int8(np.int32(first)) + lane_numbers()), splat8(THIRD), splat8(THREE))
        y, z = _digit(q, splat8(THIRD), splat8(THREE))
        squares = squares_to(cell, all_below - f, all_below, x, y, z, r)
        best = minimum(best, choose(z < splat8(THREE), squares, best))  # behind the last cell z is 3
    return least_lane(best)


@inlined_kernel
def squares_to(cell, way, side, x, y, z, r):
    """Of the distances to the points of eight cells, `x`, `y` and `z` from the one beside `cell` that `side` means."""
    first = cell + side
    u = places_in(3, Points8(spread(first, 0) + x, spread(first, 1) + y, spread(first, 2) + z, splat8(ZERO)))
    x, y, z = spread(way, 0) + x + u.x * r, spread(way, 1) + y + u.y * r, spread(way, 2) + z + u.z * r
    return x * x + y * y + z * z


class Points8(NamedTuple):
    x: f32x8
    y: f32x8
    z: f32x8
    w: f32x8


@inlined_kernel
def points_of(lattice, cell, number, side):
    """The points of eight cells by their numbers, as `point_of`; `side` is 3 or 5."""
    n, r, zero = lattice.dimensions, splat8(lattice.randomness), splat8(ZERO)
    width, share = splat8(THREE if side == 3 else FIVE), splat8(THIRD if side == 3 else FIFTH)
    middle = splat8(ONE if side == 3 else TWO)
    q = to_floats(number)
    x, q = _digit(q, share, width)
    x, y, z, w = x - middle, zero, zero, zero
    if n > 1:
        y, q = _digit(q, share, width)
        y = y - middle
    if n > 2:
        z, q = _digit(q, share, width)
        z = z - middle
    if n > 3:
        w = q - middle
    u = places_in(n, Points8(x + splat8(cell.x), y + splat8(cell.y), z + splat8(cell.z), w + splat8(cell.w)))
    return Points8(x + u.x * r, y + u.y * r, z + u.z * r, w + u.w * r)


@inlined_kernel
def places_in(n, at):
    """`place_in` of eight cells."""
    zero = splat8(ZERO)
    if n == 1:
        none = splat_int8(np.int32(0))
        u = hash8.unit_floats(hash8.lookup3(bits_of_floats(at.x), none, none, 1))
        return hash8.Random4Lanes(u, zero, zero, zero)
    x, y = to_integers(at.x), to_integers(at.y)
    if n == 2:
        return hash8.pcg2(x, y)
    if n == 3:
        return hash8.pcg3(x, y, to_integers(at.z))
    return hash8.pcg4(x, y, to_integers(at.z), to_integers(at.w))


@inlined_kernel
def _digit(q, share, width):
    """The last digit of whole numbers, in the system with base `width`, and the numbers without it."""
    rest = floors((q + splat8(HALF)) * share)
    return q - rest * width, rest


# ---- Distances -------------------------------------------------------------------------------------------------------


@kernel
def distance_of(lattice, d):
    """The length of a vector."""
    x, y, z, w = abs(d.x), abs(d.y), abs(d.z), abs(d.w)
    if lattice.dimensions == 1:
        return x
    if lattice.metric == VoronoiMetric.MANHATTAN:
        return (x + y) + (z + w)
    if lattice.metric == VoronoiMetric.CHEBYCHEV:
        return max(max(x, y), max(z, w))
    if lattice.metric == VoronoiMetric.MINKOWSKI:
        e = lattice.exponent
        return math.pow(math.pow(x, e) + math.pow(y, e) + math.pow(z, e) + math.pow(w, e), 1.0 / e)
    return math.sqrt(x * x + y * y + z * z + w * w)


@inlined_kernel
def bounds_from(lattice, points, p):
    """What grows with the distance of eight points from `p`, and costs less.

    Sums are made in pairs, as by Cycles: points of cells like (1, 2, 1, 2) can be equally far, which rounding decides.
    """
    x, y = absolutes(points.x - splat8(p.x)), absolutes(points.y - splat8(p.y))
    z, w = absolutes(points.z - splat8(p.z)), absolutes(points.w - splat8(p.w))
    if lattice.metric == VoronoiMetric.EUCLIDEAN or lattice.dimensions == 1:
        return x * x + y * y + z * z + w * w
    if lattice.metric == VoronoiMetric.MANHATTAN:
        return (x + y) + (z + w)
    if lattice.metric == VoronoiMetric.CHEBYCHEV:
        return maximum(maximum(x, y), maximum(z, w))
    e = splat8(lattice.exponent)
    s = powers(x, e) + powers(y, e)
    if lattice.dimensions > 2:
        s = s + powers(z, e)
    return s + powers(w, e) if lattice.dimensions > 3 else s


@kernel
def bound_beyond(lattice, p):
    """What `bounds_from` gives for points outside of `cells_beside`, at least."""
    if lattice.metric == VoronoiMetric.MINKOWSKI:
        return ZERO  # seldom, and costly to find out
    bound = distance_beyond(lattice, p.x)
    if lattice.dimensions > 1:
        bound = min(bound, distance_beyond(lattice, p.y))
    if lattice.dimensions > 2:
        bound = min(bound, distance_beyond(lattice, p.z))
    bound *= SAFE
    return bound * bound if lattice.metric == VoronoiMetric.EUCLIDEAN or lattice.dimensions == 1 else bound


@inlined_kernel
def distance_beyond(lattice, x):
    """Along an axis to the points of the farther one of two neighbours: how far they can be is `randomness`."""
    return max(x + (1.0 - lattice.randomness), 1.0 - x)


@kernel
def length_of(lattice, bound):
    """The distance for which `bounds_from` gives `bound`."""
    if lattice.metric == VoronoiMetric.EUCLIDEAN or lattice.dimensions == 1:
        return math.sqrt(bound)
    return math.pow(bound, 1.0 / lattice.exponent) if lattice.metric == VoronoiMetric.MINKOWSKI else bound


@kernel
def distances_from(lattice, points, p):
    """Of eight points from `p`."""
    d = bounds_from(lattice, points, p)
    if lattice.metric == VoronoiMetric.EUCLIDEAN or lattice.dimensions == 1:
        return square_roots(d)
    return powers(d, splat8(1.0 / lattice.exponent)) if lattice.metric == VoronoiMetric.MINKOWSKI else d


# ---- Points of up to four dimensions ---------------------------------------------------------------------------------


@kernel
def floored(p):
    return Point4(np.floor(p.x), np.floor(p.y), np.floor(p.z), np.floor(p.w))


@kernel
def added(p, q):
    return Point4(p.x + q.x, p.y + q.y, p.z + q.z, p.w + q.w)


@kernel
def subtracted(p, q):
    return Point4(p.x - q.x, p.y - q.y, p.z - q.z, p.w - q.w)


@kernel
def scaled(p, s):
    return Point4(p.x * s, p.y * s, p.z * s, p.w * s)


@kernel
def mixed(p, q, t):
    return Point4(lerp(p.x, q.x, t), lerp(p.y, q.y, t), lerp(p.z, q.z, t), lerp(p.w, q.w, t))


@kernel
def lessened(lattice, p, c):
    """A number taken from each coordinate that counts."""
    n = lattice.dimensions
    return Point4(p.x - c, p.y - c if n > 1 else ZERO, p.z - c if n > 2 else ZERO, p.w - c if n > 3 else ZERO)
