# SPDX-License-Identifier: GPL-3.0-or-later
"""From the binary tree to one with eight children a node: the cheapest way, by dynamic programming.

Ylitie et al. 2017, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", section 4.2.
"""

import numpy as np

from ..jit import kernel
from ..linalg.records import Tables
from ..linalg.simd import load4
from ..linalg.vec3 import load3_at
from ..tables import NODE, PACKET
from .binary import BINARY, BOX, MAX_DEPTH, half_area
from .nodes import CORNERS, WIDTH

CHOICE = np.dtype(  # how a node of the binary tree is best split into at most i + 1 roots, i = 0 .. 6
    [
        ("cost", "f4", (7,)),
        ("split", "i1", (8,)),  # roots that the left child gets; 0: a leaf; -1: as with one root less
    ]
)
OPEN = np.dtype([("node", "i4"), ("parent", "i4"), ("slot", "i4")])  # a node that is still to be written
SHARE = np.dtype([("node", "i4", (16,)), ("roots", "i4", (16,)), ("child", "i4", (8,))])
OPEN_ROWS = 7 * MAX_DEPTH + 8  # each level leaves seven behind
# What visiting a node costs, where testing one packet of triangles costs 1.
NODE_COST = np.float32(1.0)
INFINITY = np.float32(np.inf)


class ChooseWork(Tables):
    binary = BINARY
    choices = CHOICE


class CollapseWork(Tables):
    boxes = BOX
    binary = BINARY
    choices = CHOICE
    corners = CORNERS
    open = OPEN
    share = SHARE
    nodes = NODE
    packets = PACKET


@kernel
def choose(work, first, end, leaf_shift):
    """Fill `work.choices` for the nodes first to end, children first. A leaf of the wide tree has up to 2 ** leaf_shift
    boxes."""
    leaf_size = 1 << leaf_shift
    for n in range(end - 1, first - 1, -1):
        node, choice = work.binary[n], work.choices[n]
        area = half_area(load4(node, "lo", 0), load4(node, "hi", 0))
        as_leaf = INFINITY
        if node.count <= leaf_size:
            as_leaf = area
        if node.left < 0:
            for i in range(7):
                choice.cost[i], choice.split[i] = as_leaf, 0
            continue
        left, right = work.choices[node.left], work.choices[node.left + 1]
        best, best_k = left.cost[0] + right.cost[6], 1
        for k in range(2, 8):
            cost = left.cost[k - 1] + right.cost[7 - k]
            if cost < best:
                best, best_k = cost, k
        as_node = best + area * NODE_COST
        if as_leaf <= as_node and node.count <= leaf_size:
            choice.cost[0], choice.split[0] = as_leaf, 0
        else:
            choice.cost[0], choice.split[0] = as_node, best_k
        for i in range(1, 7):
            best, best_k = choice.cost[i - 1], -1
            for k in range(1, i + 1):
                cost = left.cost[k - 1] + right.cost[i - k]
                if cost < best:
                    best, best_k = cost, k
            choice.cost[i], choice.split[i] = best, best_k


@kernel
def find_children(work, n):
    """The roots into which the inner node `n` is best split, in `work.share`. Returns their number, 2 to 8."""
    share, node = work.share[0], work.binary[n]
    share.node[0], share.roots[0] = node.left, work.choices[n].split[0]
    share.node[1], share.roots[1] = node.left + 1, 8 - work.choices[n].split[0]
    todo, found = 2, 0
    while todo > 0:
        todo -= 1
        n, i = share.node[todo], share.roots[todo] - 1
        choice, left = work.choices[n], work.binary[n].left
        while i > 0 and choice.split[i] == -1:
            i -= 1
        if i == 0 or left < 0:
            share.child[found] = n
            found += 1
        else:
            k = choice.split[i]
            share.node[todo], share.roots[todo] = left, k
            share.node[todo + 1], share.roots[todo + 1] = left + 1, i + 1 - k
            todo += 2
    return found


@kernel
def first_box(work, n):
    """The first of the boxes below a node."""
    left = work.binary[n].left
    while left >= 0:
        left = work.binary[left].left
    return ~left


@kernel
def pack(work, first, count, packed):
    """Write the triangles of `count` boxes to the packet of row `packed`."""
    packet = work.packets[packed]
    for k in range(WIDTH):
        # what is missing stands as a triangle without area in a corner of another one
        prim = work.boxes[first + min(k, count - 1)].prim
        corners = work.corners[prim]
        for corner in range(3):
            p = load3_at(corners, "p", corner if k < count else 0)
            packet.p[corner, 0, k], packet.p[corner, 1, k], packet.p[corner, 2, k] = p.x, p.y, p.z
        packet.prim[k] = prim if k < count else -1


@kernel
def emit(work, with_packets):
    """Write the wide tree, depth first, so that what is below a node lies together. Returns its nodes and leaf rows.

    The rows of leaves are packets, or with `with_packets` = False the boxes themselves.
    """
    work.open[0].node, work.open[0].parent, work.open[0].slot = 0, -1, 0
    top, made, packed = 1, 0, 0
    share = work.share[0]
    while top > 0:
        top -= 1
        task = work.open[top]
        n, parent, slot = task.node, task.parent, task.slot
        if parent >= 0:
            work.nodes[parent].child[slot] = made
        if work.binary[n].left < 0 or work.choices[n].split[0] == 0:  # the whole tree is one leaf
            share.child[0] = n
            found = 1
        else:
            found = find_children(work, n)
        row = work.nodes[made]
        for c in range(8):
            row.child[c] = ~0  # a leaf: a ray that is not a number, which gets everywhere, comes to an end
            for axis in range(3):
                row.bounds[axis, c], row.bounds[3 + axis, c] = INFINITY, -INFINITY
        for c in range(found):
            n = share.child[c]
            node = work.binary[n]
            for axis in range(3):
                row.bounds[axis, c], row.bounds[3 + axis, c] = node.lo[axis], node.hi[axis]
            if node.left >= 0 and work.choices[n].split[0] != 0:
                work.open[top].node, work.open[top].parent, work.open[top].slot = n, made, c
                top += 1
            elif with_packets:
                pack(work, first_box(work, n), node.count, packed)
                row.child[c] = ~packed
                packed += 1
            else:
                row.child[c] = ~first_box(work, n)
        made += 1
    return made, packed
