# SPDX-License-Identifier: GPL-3.0-or-later
"""The Voronoi texture (Worley 1996): space is divided among points, one at random in each cell of a lattice.

In one to four dimensions, by one body of code: the cells around a point are gone through eight at a time, in lanes, and
the number of dimensions says how many there are, 3 or 5 to the power of it.
"""

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.records import scratch_record
from ..linalg.simd import load1, splat8, store8
from ..linalg.simd_int import choose, lane_numbers, least_lane, splat_int8, square_roots, to_floats
from ..linalg.vec3 import BLACK, Vec3, lerp
from .cells import (
    Lattice,
    Point4,
    VoronoiMetric,
    added,
    bound_beyond,
    bounds_from,
    cell_count,
    cells_beside,
    color_of,
    distance_of,
    distances_from,
    floored,
    length_of,
    lessened,
    mixed,
    nearest_in_space,
    offset_of,
    point_of,
    points_of,
    scaled,
    subtracted,
)

ZERO, ONE, HALF = np.float32(0.0), np.float32(1.0), np.float32(0.5)
INFINITY = np.float32(np.inf)
NONE = np.int32(-1)
DIAGONAL = np.float32(math.sqrt(3.0))


class VoronoiFeature(IntEnum):
    """What is measured; names and numbers are Blender's."""

    F1 = 0  # the nearest point
    F2 = 1  # the second nearest
    SMOOTH_F1 = 2  # the nearest, with neighbours blended into each other
    DISTANCE_TO_EDGE = 3  # of the division
    N_SPHERE_RADIUS = 4  # half the distance of the nearest point to the one nearest to that


class VoronoiSample(NamedTuple):
    """The node's outputs; what a feature does not have is 0."""

    distance: np.float32
    color: Vec3  # of the point that was found: three numbers in 0 to 1
    position: Vec3  # where it is, scale undone; 0 in dimensions that do not count
    w: np.float32
    radius: np.float32


class Octave(NamedTuple):
    distance: np.float32
    color: Vec3
    position: Point4


SCRATCH_POINTS = np.dtype([(name, "f4", (8,)) for name in ("x", "y", "z", "w", "distance")])
scratch_points = scratch_record(SCRATCH_POINTS)


@kernel
def voronoi(
    p,
    w,
    dimensions,
    feature,
    metric,
    scale,
    detail,
    roughness,
    lacunarity,
    smoothness,
    exponent,
    randomness,
    normalize,
    only_distance,
):
    """The node, at a point that is not scaled yet. In one dimension `w` counts, in four p and `w`, else p.

    `detail`, `roughness` and `lacunarity` are those of fBM noise, and lay octaves over each other. `normalize` divides
    a distance by the largest there can be. `only_distance`: nobody asks for the other outputs, which may be anything.
    """
    # Integers of one size, so that nothing below is compiled for another one too.
    dimensions, metric, feature, normalize = np.int64(dimensions), np.int64(metric), np.int64(feature), normalize != 0
    only_distance = only_distance != 0
    detail, roughness = min(max(detail, 0.0), 15.0), min(max(roughness, 0.0), 1.0)
    randomness = min(max(randomness, 0.0), 1.0)
    smoothness = min(max(0.5 * smoothness, 0.0), 0.5)
    p, w = p * scale, w * scale
    plain = dimensions == 3 and metric == VoronoiMetric.EUCLIDEAN and feature == VoronoiFeature.F1
    if plain and only_distance and (detail == 0.0 or roughness == 0.0):
        distance = math.sqrt(nearest_in_space(p, randomness))
        if normalize:
            distance /= DIAGONAL * (0.5 + 0.5 * randomness)
        return VoronoiSample(distance, BLACK, BLACK, ZERO, ZERO)
    lattice = Lattice(dimensions, metric, exponent, randomness)
    if dimensions == 1:
        point = Point4(w, ZERO, ZERO, ZERO)
    else:
        point = Point4(p.x, p.y, p.z if dimensions > 2 else ZERO, w if dimensions > 3 else ZERO)
    if feature == VoronoiFeature.N_SPHERE_RADIUS:
        return VoronoiSample(ZERO, BLACK, BLACK, ZERO, sphere_radius(lattice, point))
    if feature == VoronoiFeature.DISTANCE_TO_EDGE:
        distance = octaves_of_edges(lattice, point, detail, roughness, lacunarity, normalize)
        return VoronoiSample(distance, BLACK, BLACK, ZERO, ZERO)
    found = octaves(lattice, point, feature, smoothness, detail, roughness, lacunarity, normalize, only_distance)
    if only_distance:
        return VoronoiSample(found.distance, BLACK, BLACK, ZERO, ZERO)
    q = found.position
    undo = 1.0 / scale if scale != 0.0 else ZERO
    if dimensions == 1:
        return VoronoiSample(found.distance, found.color, BLACK, q.x * undo, ZERO)
    return VoronoiSample(found.distance, found.color, Vec3(q.x, q.y, q.z) * undo, q.w * undo, ZERO)


# ---- Octaves ---------------------------------------------------------------------------------------------------------


@kernel
def octaves(lattice, p, feature, smoothness, detail, roughness, lacunarity, normalize, only_distance):
    """Octaves of F1, F2 or smooth F1: distances and colours added, positions mixed."""
    scale, amplitude, total = ONE, ONE, ZERO
    distance, color, position = ZERO, BLACK, Point4(ZERO, ZERO, ZERO, ZERO)
    single = detail == 0.0 or roughness == 0.0
    whole = int(detail) + 1
    for octave in range(1 if single else int(np.ceil(detail)) + 1):
        share = ONE if octave < whole else detail - np.floor(detail)
        found = octave_of(lattice, scaled(p, scale), feature, smoothness, only_distance)
        if single:
            distance, color, position, total = found.distance, found.color, found.position, ONE
        else:
            weight = share * amplitude
            total += weight
            distance += weight * found.distance
            color = color + found.color * weight
            position = mixed(position, scaled(found.position, 1.0 / scale), weight)
        scale *= lacunarity
        amplitude *= roughness
    if normalize:
        distance /= total * _greatest_distance(lattice, feature)
        color = color * (1.0 / total)
    return Octave(distance, color, position)


@kernel
def octave_of(lattice, p, feature, smoothness, only_distance):
    if feature == VoronoiFeature.SMOOTH_F1 and smoothness > 0.0:
        return smooth_nearest(lattice, p, smoothness)
    cell = floored(p)
    local = subtracted(p, cell)
    found = nearest(lattice, cell, local, NONE)
    if feature == VoronoiFeature.F2:
        found = nearest(lattice, cell, local, found.number)
    distance = length_of(lattice, found.bound)
    if only_distance:
        return Octave(distance, BLACK, cell)
    offset = offset_of(lattice, found.number, 3)
    return Octave(distance, color_of(lattice, cell, offset), added(point_of(lattice, cell, offset), cell))


@kernel
def octaves_of_edges(lattice, p, detail, roughness, lacunarity, normalize):
    """Octaves of the distance to the edge: an octave cuts finer edges into the cells, as deep as its amplitude."""
    scale, amplitude, distance = ONE, ONE, np.float32(8.0)
    greatest = 0.5 + 0.5 * lattice.randomness
    total = greatest
    if detail == 0.0 or roughness == 0.0:
        distance = edge_distance(lattice, p)
        return distance / total if normalize else distance
    whole = int(detail) + 1
    for octave in range(int(np.ceil(detail)) + 1):
        near = min(distance, edge_distance(lattice, scaled(p, scale)) / scale)
        near = lerp(distance, near, amplitude)
        reach = lerp(total, greatest / scale, amplitude)
        if octave < whole:
            distance, total = near, reach
        else:
            share = detail - np.floor(detail)
            distance, total = lerp(distance, min(distance, near), share), lerp(total, reach, share)
        scale *= lacunarity
        amplitude *= roughness
    return distance / total if normalize else distance


@kernel
def _greatest_distance(lattice, feature):
    """Of a point of a cell to its own point."""
    side = 0.5 + 0.5 * lattice.randomness
    n = lattice.dimensions
    d = distance_of(lattice, Point4(side, side if n > 1 else ZERO, side if n > 2 else ZERO, side if n > 3 else ZERO))
    return 2.0 * d if feature == VoronoiFeature.F2 else d


# ---- Searches. A cell is named by its number among its neighbours, x fastest -----------------------------------------


class Nearest(NamedTuple):
    number: np.int32  # of the cell
    bound: np.float32  # of its point's distance, as by `bounds_from`


@kernel
def nearest(lattice, cell, p, excluded):
    """That of the 3^n cells around `cell` whose point is nearest to `p`, given from the cell's corner.

    Two times of three the eight cells beside `p` have a point that is nearer than all others can be.
    """
    count = cell_count(3, lattice.dimensions)
    best, best_number, least = splat8(INFINITY), splat_int8(np.int32(0)), INFINITY
    first = -8 if lattice.dimensions < 4 else 0
    while first < count:
        number = splat_int8(np.int32(first)) + lane_numbers() if first >= 0 else cells_beside(lattice, p)
        points = points_of(lattice, cell, number, 3)
        d = bounds_from(lattice, points, p)
        unfit = (splat_int8(np.int32(count - 1)) < number) | (number == splat_int8(np.int32(excluded)))
        d = choose(unfit, splat8(INFINITY), d)
        closer = (d < best) | ((d <= best) & (number < best_number))
        best, best_number = choose(closer, d, best), choose(closer, number, best_number)
        if first < 0:
            least = least_lane(best)
            if least < bound_beyond(lattice, p):
                break
        first += 8
    if first >= 0:
        least = least_lane(best)
    ties = to_floats(choose(best <= splat8(least), best_number, splat_int8(np.int32(count))))
    return Nearest(np.int32(least_lane(ties)), least)


@kernel
def smooth_nearest(lattice, p, smoothness):
    """The nearest point, where those at about the same distance are blended by a smooth minimum.

    Goes on from cell to cell, and the order of the 5^n cells matters. Most points are too far to change anything.
    """
    cell = floored(p)
    local = subtracted(p, cell)
    row = scratch_points()
    distance, color, position = ZERO, BLACK, Point4(ZERO, ZERO, ZERO, ZERO)
    count = cell_count(5, lattice.dimensions)
    for first in range(0, count, 8):
        number = splat_int8(np.int32(first)) + lane_numbers()
        points = points_of(lattice, cell, number, 5)
        store8(row, "x", 0, points.x)
        store8(row, "y", 0, points.y)
        store8(row, "z", 0, points.z)
        store8(row, "w", 0, points.w)
        store8(row, "distance", 0, distances_from(lattice, points, local))
        for i in range(min(8, count - first)):
            d = load1(row, "distance", i)
            h = ONE
            if first + i > 0:
                h = 0.5 + 0.5 * (distance - d) / smoothness
                if h <= 0.0:
                    continue
                h = min(h, 1.0)
                h = h * h * (3.0 - 2.0 * h)
            correction = smoothness * h * (1.0 - h)
            distance = lerp(distance, d, h) - correction
            correction /= 1.0 + 3.0 * smoothness
            tint = color_of(lattice, cell, offset_of(lattice, first + i, 5))
            color = lerp(color, tint, h) - Vec3(correction, correction, correction)
            point = Point4(load1(row, "x", i), load1(row, "y", i), load1(row, "z", i), load1(row, "w", i))
            position = mixed(position, point, h)
            position = lessened(lattice, position, correction)
    return Octave(distance, color, added(position, cell))


@kernel
def edge_distance(lattice, p):
    """To the nearest plane between the point whose cell this is and another; Euclidean always (Quilez 2012)."""
    lattice = Lattice(lattice.dimensions, np.int64(VoronoiMetric.EUCLIDEAN), ONE, lattice.randomness)
    cell = floored(p)
    local = subtracted(p, cell)
    if lattice.dimensions == 1:
        middle = point_of(lattice, cell, Point4(ZERO, ZERO, ZERO, ZERO)).x
        left = point_of(lattice, cell, Point4(-ONE, ZERO, ZERO, ZERO)).x
        right = point_of(lattice, cell, Point4(ONE, ZERO, ZERO, ZERO)).x
        return min(abs(0.5 * (middle + left) - local.x), abs(0.5 * (middle + right) - local.x))
    found = nearest(lattice, cell, local, NONE).number
    here = subtracted(point_of(lattice, cell, offset_of(lattice, found, 3)), local)
    count = cell_count(3, lattice.dimensions)
    best = splat8(np.float32(3.4e38))
    for first in range(0, count, 8):
        number = splat_int8(np.int32(first)) + lane_numbers()
        points = points_of(lattice, cell, number, 3)
        x, y, z, w = (
            points.x - splat8(local.x),
            points.y - splat8(local.y),
            points.z - splat8(local.z),
            points.w - splat8(local.w),
        )
        ax, ay, az, aw = x - splat8(here.x), y - splat8(here.y), z - splat8(here.z), w - splat8(here.w)
        mx, my, mz, mw = x + splat8(here.x), y + splat8(here.y), z + splat8(here.z), w + splat8(here.w)
        across2 = ax * ax + ay * ay + az * az + aw * aw  # of the way from point to point
        d = splat8(HALF) * (ax * mx + ay * my + az * mz + aw * mw) / square_roots(across2)
        fit = (splat8(np.float32(0.0001)) < across2) & (number < splat_int8(np.int32(count)))
        best = choose(fit & (d < best), d, best)
    return least_lane(best)


@kernel
def sphere_radius(lattice, p):
    """Half the distance of the nearest point to the one nearest to it, in any case Euclidean."""
    lattice = Lattice(lattice.dimensions, np.int64(VoronoiMetric.EUCLIDEAN), ONE, lattice.randomness)
    cell = floored(p)
    offset = offset_of(lattice, nearest(lattice, cell, subtracted(p, cell), NONE).number, 3)
    point = point_of(lattice, cell, offset)
    cell = added(cell, offset)  # the search goes on around the point that was found
    point = subtracted(point, offset)
    centre = np.int32(cell_count(3, lattice.dimensions) // 2)
    other = point_of(lattice, cell, offset_of(lattice, nearest(lattice, cell, point, centre).number, 3))
    return 0.5 * distance_of(lattice, subtracted(other, point))
