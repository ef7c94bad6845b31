# SPDX-License-Identifier: GPL-3.0-or-later
"""The questions that rays ask: what do I hit first, and is anything in my way?

The world has up to five trees: triangles and shapes in world space, instances with trees of their own, those that move,
and lamps, which rays can see but which block none. A ray is sent at a `time` of the shutter, 0 to 1.
"""

from typing import NamedTuple

import numpy as np

from ..jit import inlined_kernel, kernel
from ..linalg.simd import lane, load1, lowest_bit, prefetch, without_lowest_bit
from ..linalg.transform import transform_point, transform_vector
from ..motion import instance_at, new_instance
from ..shape import dispatch
from ..tables import TreeKind, Visibility
from .boxes import NO_LEAF, any_leaf, make_slabs, next_leaf, stack_scratch, start, start_any
from .packet import intersect_packet, make_shear

ZERO = np.float32(0.0)
NONE = -1
TRIANGLES, SHAPES = int(TreeKind.TRIANGLES), int(TreeKind.SHAPES)  # as a Hit holds them
SHADOW = np.int32(Visibility.SHADOW)


class Hit(NamedTuple):
    """The first thing on a ray."""

    t: float  # distance in units of the ray's direction; t_max if nothing was hit
    kind: int  # TreeKind.TRIANGLES or SHAPES
    prim: int  # row of TRIANGLE or SHAPE; -1: nothing was hit
    instance: int  # row of INSTANCE in whose tree it was found; -1: in one of the world's own trees
    b1: float  # triangles: weights of the corners 1 and 2; shapes: see shape/
    b2: float


class Face(NamedTuple):
    """The triangle that a ray leaves, which is flat and cannot be hit by it."""

    prim: int  # row of TRIANGLE; -1: it leaves none
    instance: int  # as in a Hit


NO_FACE = Face(NONE, NONE)


class TreeHit(NamedTuple):
    t: float
    prim: int  # -1: nothing was hit before t
    b1: float
    b2: float


# ---- What is hit first -----------------------------------------------------------------------------------------------


@inlined_kernel
def intersect_closest(scene, o, d, t_min, t_max, visibility, time, left):
    """The first triangle or shape on the ray o + t d, t_min < t < t_max, among objects that `visibility` rays can see.

    `d` need not be unit. Lamps are not met; see `intersect_lamps`. All rays see what is in the world's own trees.
    `left`: the Face that the ray leaves. Its own plane may seem to be in front of the origin, moved off it as it is:
    where a triangle is long and thin, rounding errors are as large as that step.
    """
    world, visibility = scene.world[0], np.int32(visibility)  # one type, so that all below is compiled once
    hit = Hit(t_max, TRIANGLES, NONE, NONE, ZERO, ZERO)
    if world.instance_root >= 0:  # first, since a ground or a room is behind what stands in it
        hit = intersect_instances(scene, world.instance_root, o, d, t_min, t_max, visibility, left)
    if world.moving_root >= 0:
        found = intersect_moving(scene, world.moving_root, o, d, t_min, hit.t, visibility, time, left)
        if found.prim >= 0:
            hit = found
    if world.triangle_root >= 0:
        found = intersect_triangles(scene, world.triangle_root, o, d, t_min, hit.t, of_tree(left, NONE))
        if found.prim >= 0:
            hit = Hit(found.t, TRIANGLES, found.prim, NONE, found.b1, found.b2)
    if world.shape_root >= 0:
        found = intersect_shapes(scene, world.shape_root, o, d, t_min, hit.t)
        if found.prim >= 0:
            hit = Hit(found.t, SHAPES, found.prim, NONE, found.b1, found.b2)
    return hit


@inlined_kernel
def of_tree(left, instance):
    """The triangle of the Face `left`, if it is in the tree of that instance; else -1."""
    return left.prim if left.instance == instance else NONE


@kernel
def intersect_lamps(scene, o, d, t_min, t_max):
    """The first shape of a lamp on the ray o + t d, t_min < t < t_max."""
    root = scene.world[0].lamp_root
    if root < 0:
        return Hit(t_max, SHAPES, NONE, NONE, ZERO, ZERO)
    hit = intersect_shapes(scene, root, o, d, t_min, t_max)
    return Hit(hit.t, SHAPES, hit.prim, NONE, hit.b1, hit.b2)


@kernel
def intersect_triangles(scene, root, o, d, t_min, t_max, left):
    """The first triangle of the tree below `root`, beyond t_min, but the row `left`."""
    stack, slabs, shear = stack_scratch(), make_slabs(o, d), make_shear(o, d)
    prim, b1, b2 = NONE, ZERO, ZERO
    top = start(stack, root)
    while True:
        leaf, top = next_leaf(scene, scene.packets, slabs, stack, top, t_min, t_max)
        if leaf == NO_LEAF:
            return TreeHit(t_max, prim, b1, b2)
        packet = scene.packets[~leaf]
        found = intersect_packet(packet, shear, t_min, t_max)
        hits = found.hits
        while hits != 0:
            i = lowest_bit(hits)
            hits = without_lowest_bit(hits)
            t, candidate = lane(found.t, i), load1(packet, "prim", i)
            if t < t_max and candidate != left:
                t_max, prim, b1, b2 = t, candidate, lane(found.b1, i), lane(found.b2, i)


@kernel
def intersect_shapes(scene, root, o, d, t_min, t_max):
    """The first shape of the tree below `root`, beyond t_min."""
    stack, slabs = stack_scratch(), make_slabs(o, d)
    prim, b1, b2 = NONE, ZERO, ZERO
    top = start(stack, root)
    while True:
        leaf, top = next_leaf(scene, scene.shapes, slabs, stack, top, t_min, t_max)
        if leaf == NO_LEAF:
            return TreeHit(t_max, prim, b1, b2)
        row = ~leaf
        found = dispatch.intersect(scene.shapes[row], o, d, t_min, t_max)
        if found.t < t_max:
            t_max, prim, b1, b2 = found.t, row, found.b1, found.b2


@kernel
def intersect_instances(scene, root, o, d, t_min, t_max, visibility, left):
    """The first triangle or shape of the instances in the tree below `root`, beyond t_min."""
    stack, slabs = stack_scratch(), make_slabs(o, d)
    result = Hit(t_max, TRIANGLES, NONE, NONE, ZERO, ZERO)
    top = start(stack, root)
    while True:
        leaf, top = next_leaf(scene, scene.instances, slabs, stack, top, t_min, result.t)
        if leaf == NO_LEAF:
            return result
        row = ~leaf
        instance = scene.instances[row]
        if instance.visibility & visibility == 0:
            continue
        found = intersect_instance(scene, instance, o, d, t_min, result.t, of_tree(left, row))
        if found.prim >= 0:
            result = Hit(found.t, np.int64(instance.kind), found.prim, row, found.b1, found.b2)


@kernel
def intersect_instance(scene, instance, o, d, t_min, t_max, left):
    """The first triangle or shape of one instance that has a tree of its own, beyond t_min, but the triangle `left`."""
    local_o = transform_point(instance, "to_object", o)
    local_d = transform_vector(instance, "to_object", d)  # not normalised: t stays what it is
    if instance.kind == TRIANGLES:
        found = intersect_triangles(scene, instance.root, local_o, local_d, t_min, t_max, left)
        if found.prim >= 0:  # it will be shaded, unless another instance is nearer: there is time to bring it
            prefetch(scene.triangles[found.prim])
        return found
    return intersect_shapes(scene, instance.root, local_o, local_d, t_min, t_max)


@kernel
def intersect_moving(scene, root, o, d, t_min, t_max, visibility, time, left):
    """As `intersect_instances`, among those that move, where they stand at `time`."""
    stack, slabs, scratch = stack_scratch(), make_slabs(o, d), new_instance()
    result = Hit(t_max, TRIANGLES, NONE, NONE, ZERO, ZERO)
    top = start(stack, root)
    while True:
        leaf, top = next_leaf(scene, scene.instances, slabs, stack, top, t_min, result.t)
        if leaf == NO_LEAF:
            return result
        row = ~leaf
        if scene.instances[row].visibility & visibility == 0:
            continue
        instance = instance_at(scene, row, time, scratch)
        found = intersect_instance(scene, instance, o, d, t_min, result.t, of_tree(left, row))
        if found.prim >= 0:
            result = Hit(found.t, np.int64(instance.kind), found.prim, row, found.b1, found.b2)


# ---- Is anything in the way ------------------------------------------------------------------------------------------


@kernel
def occluded(scene, o, d, t_max, time, left):
    """Whether anything is on the ray o + t d, 0 < t < t_max: transparent or not, but no lamp, nor the Face `left`."""
    world = scene.world[0]
    if world.triangle_root >= 0 and triangles_occlude(scene, world.triangle_root, o, d, t_max, of_tree(left, NONE)):
        return True
    if world.shape_root >= 0 and shapes_occlude(scene, world.shape_root, o, d, t_max):
        return True
    if world.instance_root >= 0 and instances_occlude(scene, world.instance_root, o, d, t_max, left):
        return True
    return world.moving_root >= 0 and moving_occlude(scene, world.moving_root, o, d, t_max, time, left)


@kernel
def triangles_occlude(scene, root, o, d, t_max, left):
    """Whether a triangle of the tree below `root` is hit, but the row `left`."""
    stack, slabs, shear = stack_scratch(), make_slabs(o, d), make_shear(o, d)
    top = start_any(scene, stack, slabs, root, t_max)
    while True:
        leaf, top = any_leaf(scene, scene.packets, slabs, stack, top, t_max)
        if leaf == NO_LEAF:
            return False
        packet = scene.packets[~leaf]
        hits = intersect_packet(packet, shear, ZERO, t_max).hits
        while hits != 0:
            if load1(packet, "prim", lowest_bit(hits)) != left:
                return True
            hits = without_lowest_bit(hits)


@kernel
def shapes_occlude(scene, root, o, d, t_max):
    """Whether a shape of the tree below `root` is hit."""
    stack, slabs = stack_scratch(), make_slabs(o, d)
    top = start_any(scene, stack, slabs, root, t_max)
    while True:
        leaf, top = any_leaf(scene, scene.shapes, slabs, stack, top, t_max)
        if leaf == NO_LEAF:
            return False
        if dispatch.intersect(scene.shapes[~leaf], o, d, ZERO, t_max).t < t_max:
            return True


@kernel
def instances_occlude(scene, root, o, d, t_max, left):
    """Whether an instance in the tree below `root` is hit."""
    stack, slabs = stack_scratch(), make_slabs(o, d)
    top = start_any(scene, stack, slabs, root, t_max)
    while True:
        leaf, top = any_leaf(scene, scene.instances, slabs, stack, top, t_max)
        if leaf == NO_LEAF:
            return False
        instance = scene.instances[~leaf]
        if instance.visibility & SHADOW == 0:
            continue
        local_o = transform_point(instance, "to_object", o)
        local_d = transform_vector(instance, "to_object", d)
        if instance.kind == TRIANGLES:
            if triangles_occlude(scene, instance.root, local_o, local_d, t_max, of_tree(left, ~leaf)):
                return True
        elif shapes_occlude(scene, instance.root, local_o, local_d, t_max):
            return True


@kernel
def moving_occlude(scene, root, o, d, t_max, time, left):
    """Whether an instance that moves is hit where it stands at `time`."""
    stack, slabs, scratch = stack_scratch(), make_slabs(o, d), new_instance()
    top = start_any(scene, stack, slabs, root, t_max)
    while True:
        leaf, top = any_leaf(scene, scene.instances, slabs, stack, top, t_max)
        if leaf == NO_LEAF:
            return False
        if scene.instances[~leaf].visibility & SHADOW == 0:
            continue
        instance = instance_at(scene, ~leaf, time, scratch)
        local_o = transform_point(instance, "to_object", o)
        local_d = transform_vector(instance, "to_object", d)
        if instance.kind == TRIANGLES:
            if triangles_occlude(scene, instance.root, local_o, local_d, t_max, of_tree(left, ~leaf)):
                return True
        elif shapes_occlude(scene, instance.root, local_o, local_d, t_max):
            return True
