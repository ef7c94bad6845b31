# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays against boxes: from one leaf of a tree to the next that a ray meets.

What the speed comes from, measured on trees of 1 000 000 and of 14 000 triangles: eight triangles a leaf instead of
four, 17 and 6 %, since a ray of the large tree waits for memory, and half as many nodes wait in it; compiling the
descent into the loops over leaves, which keeps the ray in registers, 8 to 12 %; a child and its distance in one
integer, so that sorting is a minimum and a maximum without a branch, 2 to 10 %; prefetching the nodes that are left for
later, 4 % (occluded: 3 to 10 %) of the large tree, nothing of the small one, and the leaves, 1 % (3 % among 10 000
instances); tables that start at a cache line, 2 %. What it is spent on: a test of boxes that stays exact far from the
origin costs 3 % over one fused multiply-add a plane, the watertight test of triangles 3 % over Moeller and Trumbore's.
Tried to no avail: sorting farther children fully, a margin of error for the fused multiply-add.
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
    prefetch,
    splat8,
    store1,
    store_keys,
    without_lowest_bit,
)
from .binary import MAX_DEPTH

ZERO, ONE = np.float32(0.0), np.float32(1.0)
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
    ix, iy, iz = ONE / d.x, ONE / d.y, ONE / d.z
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
def enter_boxes(node, slabs, t_max):
    """Which children of a node the ray meets before `t_max`, as bits, and in lanes where it enters them.

    A ray within the plane of a side of a box gets 0 times infinity there, not a number. `maximum` and `minimum` then
    return their second argument; so that side bounds nothing, nor perhaps the one before it, and the ray gets in.
    """
    near = maximum(
        maximum(
            (load8(node, "bounds", slabs.near_x) - slabs.ox) * slabs.near_ix,
            (load8(node, "bounds", slabs.near_y) - slabs.oy) * slabs.near_iy,
        ),
        maximum((load8(node, "bounds", slabs.near_z) - slabs.oz) * slabs.near_iz, splat8(ZERO)),
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
def start(stack, root):
    """Put the root of a tree onto the stack; returns the top of the stack."""
    store1(stack, "keys", 0, make_key(np.int32(root), ZERO))
    return 1


@inlined_kernel
def leave_for_later(scene, leaves, stack, top, key):
    """Push a child, and have it brought from memory until it is popped."""
    store1(stack, "keys", top, key)
    child = key_number(key)
    if child >= 0:
        prefetch(scene.nodes[child])
    else:
        prefetch(leaves[~child])


@inlined_kernel
def next_leaf(scene, leaves, slabs, stack, top, t_max):
    """From the top of the stack down to the next leaf that the ray meets before `t_max`, nearest children first.

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
            hits, entry = enter_boxes(node, slabs, t_max)
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
                leave_for_later(scene, leaves, stack, top, max(key, nearest))
                nearest = min(key, nearest)
                top += 1
            child = key_number(nearest)
        if child < 0:
            return child, top
    return NO_LEAF, top


@inlined_kernel
def any_leaf(scene, leaves, slabs, stack, top, t_max):
    """As `next_leaf`, in no particular order."""
    while top > 0:
        top -= 1
        child = key_number(load1(stack, "keys", top))
        while child >= 0:
            node = scene.nodes[child]
            hits, _ = enter_boxes(node, slabs, t_max)
            if hits == 0:
                break
            child = load1(node, "child", lowest_bit(hits))
            hits = without_lowest_bit(hits)
            while hits != 0:
                other = load1(node, "child", lowest_bit(hits))
                hits = without_lowest_bit(hits)
                leave_for_later(scene, leaves, stack, top, np.int64(other))
                top += 1
        if child < 0:
            return child, top
    return NO_LEAF, top
