# SPDX-License-Identifier: GPL-3.0-or-later
"""Build trees: from triangles or boxes to rows of NODE and PACKET. Called from Python when a scene is prepared.

    nodes, packets = build_triangles(p)          # p: float32 (n, 3 corners, 3)
    nodes, order = build_boxes(lo, hi)           # the rows of leaves index rows[order]

Root, children and rows of leaves count from 0; `rebase` stands trees behind one another in one table. Large trees are
built on all cores, without the GIL, and are the same on any number of them. Coordinates have to be finite; an axis of
1e18 metres or more costs the tree its quality, not its correctness.
"""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from ..jit import kernel
from ..linalg.records import Tables
from ..linalg.vec3 import load3_at
from ..tables import NODE, PACKET
from .binary import BINARY, BINS, BOX, MAX_DEPTH, MAX_LATER, TASK, BinaryWork, split_later, split_root
from .collapse import CHOICE, OPEN, OPEN_ROWS, SHARE, ChooseWork, CollapseWork, choose, emit
from .nodes import CACHE_LINE, CORNERS, aligned_rows, rebase, rebase_packets

__all__ = ["CACHE_LINE", "aligned_rows", "build_boxes", "build_triangles", "rebase", "rebase_packets"]

THREADS = os.cpu_count() or 1
PIECES = 32  # the upper part of a tree ends at nodes with less than this part of it
WORTH_THREADS = 1 << 15  # primitives
MAX_PRIMITIVES = 2**30  # that the children of a node can number


class TriangleWork(Tables):
    boxes = BOX
    corners = CORNERS


def build_triangles(p):
    """The tree over triangles with corners `p`, float32 (n, 3, 3). Returns rows of NODE and of PACKET."""
    p = np.ascontiguousarray(p, np.float32)
    _check(len(p))
    boxes = aligned_rows(len(p), BOX)
    corners = p.reshape(-1).view(CORNERS)
    box_triangles(TriangleWork(boxes=boxes, corners=corners), len(p))
    return _build(boxes, corners, leaf_shift=3)


def build_boxes(lo, hi):
    """The tree over boxes from `lo` to `hi`, (n, 3), one a leaf. Returns rows of NODE and the order of leaves, int32.

    Boxes are widened by some roundings: of these numbers, if they are float64, and of the arithmetic by which rays meet
    what is in them, in a space of its own.
    """
    _check(len(lo))
    boxes = aligned_rows(len(lo), BOX)
    lo, hi = np.asarray(lo, np.float64), np.asarray(hi, np.float64)
    margin = 8 * 2.0**-24 * np.maximum(np.abs(lo), np.abs(hi))
    boxes["lo"], boxes["hi"], boxes["prim"] = lo - margin, hi + margin, np.arange(len(lo))
    nodes, _ = _build(boxes, np.empty(0, CORNERS), leaf_shift=0)
    return nodes, boxes["prim"].copy()


def _check(count):
    if not 0 < count < MAX_PRIMITIVES:
        raise ValueError(f"a tree holds 1 to {MAX_PRIMITIVES - 1} primitives, not {count}")


def _build(boxes, corners, leaf_shift):
    count = len(boxes)
    # More than are needed: what is not written to costs no memory.
    binary, choices = np.empty(2 * count - 1, BINARY), np.empty(2 * count - 1, CHOICE)
    with_packets = len(corners) > 0
    leaves = _build_binary(boxes, binary, choices, leaf_shift)
    nodes = aligned_rows(max(leaves - 1, 1), NODE)
    packets = aligned_rows(leaves if with_packets else 0, PACKET)
    work = CollapseWork(
        boxes=boxes,
        binary=binary,
        choices=choices,
        corners=corners,
        open=np.empty(OPEN_ROWS, OPEN),
        share=np.empty(1, SHARE),
        nodes=nodes,
        packets=packets,
    )
    node_count, packet_count = emit(work, with_packets)
    return trimmed(nodes, node_count), trimmed(packets, packet_count)


def _build_binary(boxes, binary, choices, leaf_shift):
    """Fill `binary`, and `choices` for collapsing it. Returns the number of its leaves.

    The upper part of the tree is made first; what is below is left to threads, and stands in rows of its own whoever
    makes it, so the tree does not depend on them.
    """
    count, later = len(boxes), np.empty(MAX_LATER, TASK)
    choosing = ChooseWork(binary=binary, choices=choices)

    def work():
        tasks, bins = np.empty(MAX_DEPTH + 2, TASK), np.empty(1, BINS)
        return BinaryWork(boxes=boxes, binary=binary, later=later, tasks=tasks, bins=bins)

    made, waiting = split_root(work(), count, leaf_shift, count // PIECES)
    sizes = 2 * (later["end"] - later["start"])[:waiting].astype(np.int64) - 2
    free = made + np.cumsum(sizes) - sizes

    def finish(i):
        end = split_later(work(), i, free[i], leaf_shift)
        choose(choosing, free[i], end, leaf_shift)
        return end - free[i]

    largest_first = np.argsort(-sizes, kind="stable")
    below = finish(largest_first[-1]) if waiting else 0  # in this thread, which compiles
    if waiting and count >= WORTH_THREADS:
        with ThreadPoolExecutor(THREADS) as threads:
            below += sum(threads.map(finish, largest_first[:-1]))
    else:
        below += sum(map(finish, largest_first[:-1]))
    choose(choosing, 0, made, leaf_shift)
    return (made + below + 1) // 2


def trimmed(rows, count):
    """The first `count` rows, in memory of just their size."""
    if count == len(rows):
        return rows
    result = aligned_rows(count, rows.dtype)
    result[:] = rows[:count]
    return result


@kernel
def box_triangles(work, count):
    """Fill `work.boxes` with the bounds of `count` triangles."""
    for i in range(count):
        corners, box = work.corners[i], work.boxes[i]
        a, b, c = load3_at(corners, "p", 0), load3_at(corners, "p", 1), load3_at(corners, "p", 2)
        box.lo[0], box.lo[1], box.lo[2] = min(a.x, b.x, c.x), min(a.y, b.y, c.y), min(a.z, b.z, c.z)
        box.hi[0], box.hi[1], box.hi[2] = max(a.x, b.x, c.x), max(a.y, b.y, c.y), max(a.z, b.z, c.z)
        box.prim = i
