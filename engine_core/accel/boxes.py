# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays against boxes: from one leaf of a tree to the next that a ray meets.

What the speed comes from, measured on trees of 1 000 000 and of 14 000 triangles: eight triangles a leaf instead of
four, 17 and 6 %, since a ray of the large tree waits for memory, and half as many nodes wait in it; compiling the
descent into the loops over leaves, which keeps the ray in registers, 8 to 12 %; a child and its distance in one
integer, so that sorting is a minimum and a maximum without a branch, 2 to 10 %; prefetching the nodes that are left for
later, 4 % (occluded: 3 to 10 %) of the large tree, nothing of the small one, and the leaves, 1 % (3 % among 10 000
instances); tables that start at a cache line, 2 %.

A third of the time among instances goes into branches foretold wrongly, so what can do without one does: choosing
between two rows to prefetch, 2 %; axes of triangles by selection, 3 to 5 %; and where order does not matter, pushing
all that is left of a node as one number, 2 to 4 %, and 5 % in a tree of two nodes.

What it is spent on: a test of boxes that stays exact far from the origin costs 3 % over one fused multiply-add a plane,
the watertight test of triangles 3 % over Moeller and Trumbore's. Tried to no avail: sorting farther children fully; a
margin of error for the fused multiply-add; a stack of nodes with the distances of all their children in a register, the
nearest found by SIMD without any branch, 12 to 20 % slower, since a branch foretold rightly waits for no result;
dividing by a triangle's area only where it is hit, nothing.
"""

from typing import NamedTuple

import numpy as np

from ..jit import inlined_kernel
from ..linalg.records import scratch_record
from ..linalg.simd import (
    bits,
    f32x8,
    key_number,
    load1,
    load8,
    lowest_bit,
    make_key,
    maximum,
    minimum,
    prefetch_either,
    splat8,
    store1,
    store_keys,
    without_lowest_bit,
)
from ..linalg.vec3 import WHITE
from .binary import MAX_DEPTH

ZERO = np.float32(0.0)
NO_LEAF = np.int32(0)  # stands where leaves, which are negative, are expected

STACK = np.dtype(
    [
        ("keys", "i8", (7 * MAX_DEPTH + 8,)),  # children still to be visited: each level leaves at most seven behind
        ("children", "i8", (8,)),  # keys of the children of one node
    ]
)
stack_scratch = scratch_record(STACK)

# Rounding may put the far side of a flat box in front of its near side. Seen as far as this, it never does (Ize 2013).
FAR_SCALE = np.float32(1.0 + 4 * 2.0**-23)


class Slabs(NamedTuple):
    """A ray, prepared for boxes."""

    near_x: int  # rows of NODE.bounds with the planes that the ray meets first
    near_y: int
    near_z: int
    ox: f32x8
    oy: f32x8
    oz: f32x8
    near_ix: f32x8  # 1 / direction, for the near planes
    near_iy: f32x8
    near_iz: f32x8
    far_ix: f32x8
    far_iy: f32x8
    far_iz: f32x8


@inlined_kernel
def make_slabs(o, d):
    """The ray o + t d, prepared for boxes."""
    inverse = WHITE / d
    ix, iy, iz = inverse.x, inverse.y, inverse.z
    return Slabs(
        0 if ix >= 0.0 else 3,
        1 if iy >= 0.0 else 4,
        2 if iz >= 0.0 else 5,
        splat8(o.x),
        splat8(o.y),
        splat8(o.z),
        splat8(ix),
        splat8(iy),
        splat8(iz),
        splat8(ix * FAR_SCALE),
        splat8(iy * FAR_SCALE),
        splat8(iz * FAR_SCALE),
    )


@inlined_kernel
def enter_boxes(node, slabs, t_min, t_max):
    """Which children of a node the ray meets from `t_min` to `t_max`, as bits, and in lanes where it enters them.

    A ray within the plane of a side of a box gets 0 times infinity there, not a number. `maximum` and `minimum` then
    return their second argument; so that side bounds nothing, nor perhaps the one before it, and the ray gets in.
    """
    near = maximum(
        maximum(
            (load8(node, "bounds", slabs.near_x) - slabs.ox) * slabs.near_ix,
            (load8(node, "bounds", slabs.near_y) - slabs.oy) * slabs.near_iy,
        ),
        maximum((load8(node, "bounds", slabs.near_z) - slabs.oz) * slabs.near_iz, splat8(t_min)),
    )
    far = minimum(
        minimum(
            (load8(node, "bounds", 3 - slabs.near_x) - slabs.ox) * slabs.far_ix,
            (load8(node, "bounds", 5 - slabs.near_y) - slabs.oy) * slabs.far_iy,
        ),
        minimum((load8(node, "bounds", 7 - slabs.near_z) - slabs.oz) * slabs.far_iz, splat8(t_max)),
    )
    return bits(near <= far), near


@inlined_kernel
def prefetch_child(scene, leaves, child):
    """Have a child, a node or a row of `leaves`, brought from memory."""
    prefetch_either(child >= 0, scene.nodes[child], leaves[~child])


# ---- Nearest first ---------------------------------------------------------------------------------------------------


@inlined_kernel
def start(stack, root):
    """Put the root of a tree onto the stack for `next_leaf`; returns the top of the stack."""
    store1(stack, "keys", 0, make_key(np.int32(root), ZERO))
    return 1


@inlined_kernel
def next_leaf(scene, leaves, slabs, stack, top, t_min, t_max):
    """From the top of the stack down to the next leaf that the ray meets beyond `t_min`, nearest children first.

    Returns the leaf, or NO_LEAF, and the new top of the stack. Of three or more children the farther ones are not fully
    sorted: that costs more than the few nodes it saves.
    """
    beyond = make_key(NO_LEAF, t_max)
    while top > 0:
        top -= 1
        key = load1(stack, "keys", top)
        if key >= beyond:
            continue
        child = key_number(key)
        while child >= 0:
            node = scene.nodes[child]
            hits, entry = enter_boxes(node, slabs, t_min, t_max)
            if hits == 0:
                break
            i = lowest_bit(hits)
            hits = without_lowest_bit(hits)
            if hits == 0:
                child = load1(node, "child", i)
                continue
            store_keys(stack, "children", load8(node, "child", 0), entry)
            nearest = load1(stack, "children", i)
            while hits != 0:
                key = load1(stack, "children", lowest_bit(hits))
                hits = without_lowest_bit(hits)
                farther, nearest = max(key, nearest), min(key, nearest)
                store1(stack, "keys", top, farther)
                prefetch_child(scene, leaves, key_number(farther))
                top += 1
            child = key_number(nearest)
        if child < 0:
            return child, top
    return NO_LEAF, top


# ---- In any order ----------------------------------------------------------------------------------------------------


@inlined_kernel
def start_any(scene, stack, slabs, root, t_max):
    """Put the root of a tree onto the stack for `any_leaf`; returns the top of the stack."""
    hits, _ = enter_boxes(scene.nodes[root], slabs, ZERO, t_max)
    store1(stack, "keys", 0, make_group(np.int32(root), hits))
    return 1


@inlined_kernel
def make_group(row, hits):
    """A node, and those of its children that are still to be visited, as bits."""
    return (np.int64(row) << 8) | np.int64(hits)


@inlined_kernel
def any_leaf(scene, leaves, slabs, stack, top, t_max):
    """As `next_leaf`, in the order in which children stand in their node: the stack holds groups of them, so that
    however many are met, there is one number to push."""
    while top > 0:
        top -= 1
        group = load1(stack, "keys", top)
        row, hits = np.int32(group >> 8), np.int32(group & 255)
        while hits != 0:
            child = load1(scene.nodes[row], "child", lowest_bit(hits))
            hits = without_lowest_bit(hits)
            if hits != 0:
                store1(stack, "keys", top, make_group(row, hits))
                top += 1
                prefetch_child(scene, leaves, load1(scene.nodes[row], "child", lowest_bit(hits)))
            if child < 0:
                return child, top
            row = child
            hits, _ = enter_boxes(scene.nodes[row], slabs, ZERO, t_max)
    return NO_LEAF, top
