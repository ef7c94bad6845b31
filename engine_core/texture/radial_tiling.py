# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Radial Tiling: the plane in segments around the origin, with coordinates that follow a rounded polygon.

Each segment has a half angle; its side of the polygon is straight in the middle and a circle's arc at the corners. With
a number of sides that is no integer the last segment is narrower: its corners are arcs of a circle that touches both
neighbouring sides.

A corner is described by four numbers: `start`, the angle from the corner to where its arc begins; `rest`, the angle
from there to the middle of the segment; `spline`, where the coordinate along the arc becomes linear; and `roundness`.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel

PI, TAU = np.float32(math.pi), np.float32(2.0 * math.pi)
ZERO, ONE = np.float32(0.0), np.float32(1.0)
STRIP = np.float32(0.499 * math.pi)  # half angles beyond this belong to a polygon of two sides


class Tile(NamedTuple):
    along: np.float32  # the coordinate along the side; normalized: 0 to 1 over the segment
    across: np.float32  # the distance to the origin, 1 on the polygon; not normalized: 0 there
    width: np.float32  # of `along` from the middle of the side to its end, on the polygon
    rotation: np.float32  # angle of the middle of the segment
    segment: np.float32  # its number


class Corner(NamedTuple):
    start: np.float32
    rest: np.float32
    spline: np.float32
    roundness: np.float32


@kernel
def corner_of(half, start, roundness):
    return Corner(start, half - start, (1.0 - roundness) * start, roundness)


@kernel
def bevel_start(half, roundness):
    return half - math.atan((1.0 - roundness) * math.tan(half))


@kernel
def extent(corner, x):
    """Length of the side from its middle to the corner, where its distance to the origin is x on the straight part."""
    return x * math.tan(corner.rest) + rounded_extent(corner, x)


@kernel
def extent_around(corner, x):
    """The same by the distance x along the arc."""
    return x * math.sin(corner.rest) + rounded_extent(corner, x * math.cos(corner.rest))


@kernel
def rounded_extent(corner, x):
    return corner.spline * (0.5 * x + 0.5) + corner.roundness * corner.start


@kernel
def along_arc(corner, x, angle):
    """Coordinate along the side at the distance x from the origin, `angle` before the corner."""
    t, near = corner.start - angle, x * math.cos(corner.rest)
    if t < corner.spline:
        return x * math.sin(corner.rest) + near * t + 0.5 * (1.0 - near) * t * t / corner.spline
    return x * math.sin(corner.rest) + corner.spline * (0.5 * near - 0.5) + t


@kernel
def extent_on_arc(corner, straight, x, angle):
    """What normalizes `along_arc`: from one extent to the other over the arc."""
    t = (corner.start - angle) / corner.start
    return extent(corner, straight) * (1.0 - t) + extent_around(corner, x) * t


class Side(NamedTuple):
    """A place in its segment, of which only the half counts that it is in."""

    along: np.float32  # from the middle of the side
    across: np.float32
    width: np.float32  # of the side, on the polygon
    extent: np.float32  # largest `along` here
    middle: np.float32  # half angle of the segment


@kernel
def on_straight(r, within, half, corner, end):
    """On the straight part of a side whose arc here is that of `end`."""
    across = r * math.cos(half - within)
    along = across * math.tan(abs(half - within))
    return Side(along, across, extent(corner, ONE), extent(end, across), half)


@kernel
def on_arc(r, within, half, corner):
    """On the arc between two sides of equal length; `corner` has the roundness of the whole."""
    angle = abs(within - 2.0 * half if within > half else within)
    centre = (1.0 - corner.roundness) / math.cos(half)  # of the arc, along the corner
    near = math.cos(angle) * centre
    across = r / (near + math.sqrt(max(near * near + corner.roundness * corner.roundness - centre * centre, ZERO)))
    along, most = along_arc(corner, r, angle), extent_on_arc(corner, across, r, angle)
    return Side(along, across, extent(corner, ONE), most, half)


@kernel
def is_straight(within, half, corner):
    return within >= corner.start and within < 2.0 * half - corner.start


@kernel
def regular(r, within, half, corner):
    """A place in a segment like all others."""
    if corner.roundness == 0.0 and half > STRIP:  # two sides have no corner
        return Side(r * math.sin(abs(half - within)), r * math.cos(half - within), ZERO, ONE, half)
    if is_straight(within, half, corner):
        return on_straight(r, within, half, corner, corner)
    return on_arc(r, within, half, corner)


@kernel
def irregular(r, angle, around, within, half, last, corner):
    """A place where the last segment is narrower: its half angle is `last`. `around` is `angle` in 0 to 2 pi."""
    roundness = corner.roundness
    inner = corner_of(last, bevel_start(last, roundness), roundness)
    # the circle in the corners of the last segment, which touches its side and the next one
    radius = roundness * math.tan(last) / math.tan(0.5 * (half + last))
    along_side = 1.0 / math.cos(last - inner.start)
    cx = math.cos(inner.start) * along_side - radius * math.cos(last)
    cy = radius * math.sin(last) - math.sin(inner.start) * along_side
    start = math.atan((cy + radius * math.sin(half)) / (cx + radius * math.cos(half)))
    outer = corner_of(half, start, 1.0 - math.tan(half - start) / math.tan(half))
    end = TAU - 2.0 * last  # where the last segment begins
    if around >= start and around < end - start:
        if around >= end - half or around < half:  # beside the last segment
            if around >= end - corner.start or around < corner.start or is_straight(within, half, corner):
                return on_straight(r, within, half, corner, outer)
            return on_arc(r, within, half, corner)
        return regular(r, within, half, corner)
    scale = math.cos(half) / math.cos(last)  # all sides lie at a distance of 1
    width = math.tan(inner.rest) + scale * (inner.spline * (0.5 / scale + 0.5) + roundness * inner.start)
    if around >= end + inner.start and around < TAU - inner.start:
        side = on_straight(r, within, last, inner, inner)
        return Side(scale * side.along, scale * side.across, width, scale * side.extent, last)
    # its corners, mirrored to one
    beside = -(angle + 2.0 * last) if around >= end - start and around < TAU - last else angle
    near = math.sin(beside) * cy + math.cos(beside) * cx
    own = r / (near + math.sqrt(max(near * near + radius * radius - cx * cx - cy * cy, ZERO)))
    across = scale * own
    if beside < 0.0:
        along, most = along_arc(inner, r, -beside), extent_on_arc(inner, own, r, -beside)
        return Side(scale * along, across, width, scale * most, last)
    along, most = along_arc(outer, r, beside), extent_on_arc(outer, across, r, beside)
    return Side(along, across, extent(corner, ONE), most, half)


@kernel
def radial_tiling(x, y, sides, roundness, normalized):
    """The Tile of the point (x, y). `sides` from 2 on, `roundness` 0 to 1."""
    sides, roundness = max(sides, np.float32(2.0)), min(max(roundness, ZERO), ONE)
    r, angle, half = math.sqrt(x * x + y * y), math.atan2(y, x), PI / sides
    around = angle + TAU if y < 0.0 else angle
    number = np.float32(math.floor(around / (2.0 * half)))
    within = around - number * (2.0 * half)
    corner = corner_of(half, bevel_start(half, roundness), roundness)
    whole = np.float32(math.floor(sides))
    if sides == whole:
        side = regular(r, within, half, corner)
    else:
        side = irregular(r, angle, around, within, half, PI - whole * half, corner)
    along = -side.along if within < side.middle else side.along
    if r == 0.0:
        along = ZERO
    rotation, segment = number * (2.0 * half) + side.middle, np.float32(math.floor(sides * around / TAU))
    if normalized:
        return Tile(0.5 * along / side.extent + 0.5, side.across, side.width, rotation, segment)
    return Tile(along, side.across - 1.0, side.width, rotation, segment)
