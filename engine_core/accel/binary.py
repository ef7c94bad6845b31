# SPDX-License-Identifier: GPL-3.0-or-later
"""The binary tree from which the wide one is made: binned SAH (Wald 2007) over boxes.

The boxes are sorted in place, so that each node owns a run of them. Four lanes wide, and without an allocation.
"""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.records import Tables, copy_record
from ..linalg.simd import f32x4, lane, lanes4, load4, load8, maximum, minimum, splat4, store4, store8, xyz

BOX = np.dtype([("lo", "f4", (3,)), ("prim", "i4"), ("hi", "f4", (3,)), ("unused", "i4")])  # around a primitive
BINARY = np.dtype(
    [
        ("lo", "f4", (3,)),
        ("left", "i4"),  # >= 0: row of the left child, the right one follows it; < 0: a leaf, ~(its first BOX)
        ("hi", "f4", (3,)),
        ("count", "i4"),  # of boxes below
    ]
)
TASK = np.dtype(  # a node that may have to be split, and the bounds of its centres
    [("node", "i4"), ("start", "i4"), ("end", "i4"), ("depth", "i4"), ("lo", "f4", (4,)), ("hi", "f4", (4,))]
)
MAX_BINS = 16
BINS = np.dtype(
    [
        ("lo", "f4", (3 * MAX_BINS, 4)),
        ("hi", "f4", (3 * MAX_BINS, 4)),
        ("count", "i4", (3 * MAX_BINS,)),
        ("right_area", "f4", (MAX_BINS,)),
    ]
)
# Nodes below SAH_DEPTH are halved, so that no input makes a tree deeper than MAX_DEPTH: 30 more do for 2 ** 30 boxes.
SAH_DEPTH = 48
MAX_DEPTH = SAH_DEPTH + 30
MAX_LATER = 256
INFINITY = np.float32(np.inf)


class BinaryWork(Tables):
    boxes = BOX  # these are shared by threads ...
    binary = BINARY
    later = TASK
    tasks = TASK  # ... these are not
    bins = BINS


class Bounds(NamedTuple):
    lo: f32x4
    hi: f32x4
    centre_lo: f32x4  # of the centres; a centre is lo + hi, twice as far out as it should be
    centre_hi: f32x4


class Split(NamedTuple):
    axis: int  # -1: there is none
    bin: int  # the last one of the left side


@kernel
def half_area(lo, hi):
    """Half the surface of a box."""
    d = hi - lo
    x, y, z = lane(d, 0), lane(d, 1), lane(d, 2)
    return x * y + y * z + z * x


@kernel
def bounds_of(work, start, end):
    """Bounds of the boxes start to end."""
    lo, hi = splat4(INFINITY), splat4(-INFINITY)
    centre_lo, centre_hi = lo, hi
    for i in range(start, end):
        box = work.boxes[i]
        a, b = xyz(load4(box, "lo", 0)), xyz(load4(box, "hi", 0))
        centre = a + b
        lo, hi = minimum(a, lo), maximum(b, hi)
        centre_lo, centre_hi = minimum(centre, centre_lo), maximum(centre, centre_hi)
    return Bounds(lo, hi, centre_lo, centre_hi)


@kernel
def bin_scale(extent, count):
    """Bins for each unit along an axis; 0 for an axis along which the centres do not differ."""
    return count / extent if extent > 1e-30 else 0.0


@kernel
def bin_of(box, origin, scale, last):
    """The bins, in lanes, that the centre of a box falls into. A centre that is not finite falls into the last one."""
    return minimum((xyz(load4(box, "lo", 0)) + xyz(load4(box, "hi", 0)) - origin) * scale, last)


@kernel
def fill_bins(work, start, end, origin, scale, count):
    """Sort the boxes start to end by their centres into `count` bins along each axis."""
    bins = work.bins[0]
    for axis in range(3):
        for i in range(axis * MAX_BINS, axis * MAX_BINS + count):
            store4(bins, "lo", i, splat4(INFINITY))
            store4(bins, "hi", i, splat4(-INFINITY))
            bins.count[i] = 0
    last = splat4(np.float32(count - 1))
    for i in range(start, end):
        box = work.boxes[i]
        lo, hi = load4(box, "lo", 0), load4(box, "hi", 0)
        k = bin_of(box, origin, scale, last)
        for axis in range(3):
            b = axis * MAX_BINS + np.int32(lane(k, np.int32(axis)))
            store4(bins, "lo", b, minimum(load4(bins, "lo", b), lo))
            store4(bins, "hi", b, maximum(load4(bins, "hi", b), hi))
            bins.count[b] += 1


@kernel
def leaves(count, leaf_shift):
    """Leaves that `count` boxes fill, with up to 2 ** leaf_shift in each."""
    return np.float32((count + (1 << leaf_shift) - 1) >> leaf_shift)


@kernel
def find_split(work, boxes, count, leaf_shift):
    """The cheapest border between two of the `count` bins of an axis, by the surface area heuristic."""
    bins = work.bins[0]
    best, best_axis, best_bin = INFINITY, -1, 0
    for axis in range(3):
        first = axis * MAX_BINS
        lo, hi = splat4(INFINITY), splat4(-INFINITY)
        for k in range(count - 1, 0, -1):
            lo, hi = minimum(load4(bins, "lo", first + k), lo), maximum(load4(bins, "hi", first + k), hi)
            bins.right_area[k] = half_area(lo, hi)
        lo, hi = splat4(INFINITY), splat4(-INFINITY)
        left = 0
        for k in range(count - 1):
            lo, hi = minimum(load4(bins, "lo", first + k), lo), maximum(load4(bins, "hi", first + k), hi)
            left += bins.count[first + k]
            if 0 < left < boxes:
                right_cost = bins.right_area[k + 1] * leaves(boxes - left, leaf_shift)
                cost = half_area(lo, hi) * leaves(left, leaf_shift) + right_cost
                if cost < best:
                    best, best_axis, best_bin = cost, axis, k
    return Split(best_axis, best_bin)


@kernel
def partition(work, start, end, origin, scale, count, split):
    """Bring the boxes left of the split before the others. Returns where the right ones start."""
    last = splat4(np.float32(count - 1))
    axis = np.int32(split.axis)
    i, j = start, end - 1
    while i <= j:
        box = work.boxes[i]
        if np.int32(lane(bin_of(box, origin, scale, last), axis)) <= split.bin:
            i += 1
        else:
            other = work.boxes[j]
            swapped = load8(other, "lo", 0)
            store8(other, "lo", 0, load8(box, "lo", 0))
            store8(box, "lo", 0, swapped)
            j -= 1
    return i


@kernel
def push(work, top, node, start, end, depth):
    """Write the node of the boxes start to end, and the task to split it."""
    bounds = bounds_of(work, start, end)
    row = work.binary[node]
    store4(row, "lo", 0, bounds.lo)
    store4(row, "hi", 0, bounds.hi)
    row.left, row.count = ~start, end - start
    task = work.tasks[top]
    task.node, task.start, task.end, task.depth = node, start, end, depth
    store4(task, "lo", 0, bounds.centre_lo)
    store4(task, "hi", 0, bounds.centre_hi)


@kernel
def split_root(work, count, leaf_shift, smallest):
    """Begin the tree over `count` > 0 boxes. Nodes of at most `smallest` boxes wait in `work.later`, if it holds them.

    Those are independent of each other. Returns how many nodes there are, and how many of them wait.
    """
    push(work, 0, 0, 0, count, 0)
    return split_all(work, 1, leaf_shift, smallest)


@kernel
def split_later(work, i, free, leaf_shift):
    """Go on with a node that waits; those below it come to the rows from `free`. Returns the row after the last one."""
    copy_record(work.tasks[0], work.later[i])
    made, _ = split_all(work, free, leaf_shift, 0)
    return made


@kernel
def split_all(work, free, leaf_shift, smallest):
    """Split the node of the first task, and those below it, down to nodes of at most 2 ** leaf_shift boxes.

    A parent stands before its children. Below a node of n boxes there are at most 2 n - 2, and MAX_DEPTH + 2 tasks.
    """
    top, made, waiting = 1, free, 0
    while top > 0:
        top -= 1
        task = work.tasks[top]
        node, start, end, depth = task.node, task.start, task.end, task.depth
        boxes = end - start
        if boxes <= 1 << leaf_shift:
            continue
        if boxes <= smallest and waiting < MAX_LATER:
            copy_record(work.later[waiting], task)
            waiting += 1
            continue
        middle = start
        if depth < SAH_DEPTH:
            bin_count = min(MAX_BINS, 4 + (boxes >> 2))
            origin = load4(task, "lo", 0)
            extent = load4(task, "hi", 0) - origin
            wanted = np.float32(bin_count)
            scale = lanes4(
                bin_scale(lane(extent, 0), wanted),
                bin_scale(lane(extent, 1), wanted),
                bin_scale(lane(extent, 2), wanted),
            )
            fill_bins(work, start, end, origin, scale, bin_count)
            split = find_split(work, boxes, bin_count, leaf_shift)
            if split.axis >= 0:
                middle = partition(work, start, end, origin, scale, bin_count, split)
        if middle in (start, end):  # too deep, or nothing tells the boxes apart
            middle = (start + end) >> 1
        work.binary[node].left = made
        push(work, top, made, start, middle, depth + 1)
        push(work, top + 1, made + 1, middle, end, depth + 1)
        top += 2
        made += 2
    return made, waiting
