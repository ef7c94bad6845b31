# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays against boxes: from one leaf of a tree to the next that a ray meets."""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.simd import (
    bits,
    f32x8,
    load8,
    lowest_bit,
    maximum,
    minimum,
    splat8,
    stack_record,
    store8,
)
from .binary import MAX_DEPTH

ZERO, ONE = np.float32(0.0), np.float32(1.0)
ONE_BIT = np.int32(1)
NO_LEAF = np.int32(0)  # stands where leaves, which are negative, are expected

STACK_ROWS = 7 * MAX_DEPTH + 8  # each level of a tree leaves at most seven children behind
STACK = np.dtype(
    [
        ("child", "i4", (STACK_ROWS,)),
        ("t", "f4", (STACK_ROWS,)),  # where the ray enters it
        ("lanes", "f4", (8,)),
    ]
)
stack_scratch = stack_record(STACK)

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


@kernel
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


@kernel
def enter_boxes(node, slabs, t_max):
    """Which children of a node the ray meets before `t_max`, as bits, and in lanes where it enters them.

    A ray along a plane of a box gets 0 times infinity there. `maximum` and `minimum` return their second argument if
    the first is not a number: so that plane does not count, and the ray is taken to be inside.
    """
    near = maximum((load8(node, "bounds", slabs.near_z) - slabs.oz) * slabs.near_iz, splat8(ZERO))
    near = maximum((load8(node, "bounds", slabs.near_y) - slabs.oy) * slabs.near_iy, near)
    near = maximum((load8(node, "bounds", slabs.near_x) - slabs.ox) * slabs.near_ix, near)
    far = minimum((load8(node, "bounds", 7 - slabs.near_z) - slabs.oz) * slabs.far_iz, splat8(t_max))
    far = minimum((load8(node, "bounds", 5 - slabs.near_y) - slabs.oy) * slabs.far_iy, far)
    far = minimum((load8(node, "bounds", 3 - slabs.near_x) - slabs.ox) * slabs.far_ix, far)
    return bits(near <= far), near


@kernel
def start(stack, root):
    """Put the root of a tree onto the stack; returns the top of the stack."""
    stack.child[0], stack.t[0] = root, ZERO
    return 1


@kernel
def next_leaf(scene, slabs, stack, top, t_max):
    """From the top of the stack down to the next leaf that the ray meets before `t_max`, nearest children first.

    Returns the leaf, or NO_LEAF, and the new top of the stack.
    """
    while top > 0:
        top -= 1
        child = stack.child[top]
        if stack.t[top] >= t_max:
            continue
        while child >= 0:
            node = scene.nodes[child]
            hits, entry = enter_boxes(node, slabs, t_max)
            if hits == 0:
                break
            i = lowest_bit(hits)
            hits &= hits - ONE_BIT
            if hits == 0:
                child = node.child[i]
                continue
            store8(stack, "lanes", 0, entry)
            bottom = top
            stack.child[top], stack.t[top] = node.child[i], stack.lanes[i]
            top += 1
            while hits != 0:  # sort the others in: the nearest ends on top
                i = lowest_bit(hits)
                hits &= hits - ONE_BIT
                t = stack.lanes[i]
                j = top
                while j > bottom and stack.t[j - 1] < t:
                    stack.t[j], stack.child[j] = stack.t[j - 1], stack.child[j - 1]
                    j -= 1
                stack.t[j], stack.child[j] = t, node.child[i]
                top += 1
            top -= 1
            child = stack.child[top]
        if child < 0:
            return child, top
    return NO_LEAF, top


@kernel
def any_leaf(scene, slabs, stack, top, t_max):
    """As `next_leaf`, in no particular order."""
    while top > 0:
        top -= 1
        child = stack.child[top]
        while child >= 0:
            node = scene.nodes[child]
            hits, _ = enter_boxes(node, slabs, t_max)
            if hits == 0:
                break
            child = node.child[lowest_bit(hits)]
            hits &= hits - ONE_BIT
            while hits != 0:
                stack.child[top] = node.child[lowest_bit(hits)]
                hits &= hits - ONE_BIT
                top += 1
        if child < 0:
            return child, top
    return NO_LEAF, top
