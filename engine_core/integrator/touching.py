# SPDX-License-Identifier: GPL-3.0-or-later
"""Boundaries of media that lie in one place: of two boxes of smoke side by side, or of wine in a glass.

A ray that goes through a surface is moved off it, and must not miss what lies so near that it would begin behind it.
"""

import numpy as np

from ..accel.boxes import NO_LEAF, make_slabs, next_leaf, stack_scratch, start
from ..accel.traverse import NO_FACE, Hit, intersect_instance
from ..jit import kernel
from ..linalg.ray import offset_ray_origin
from ..linalg.records import scratch_record
from ..linalg.vec3 import load3
from ..motion import instance_at, new_instance
from ..shape.interaction import make_interaction, new_interaction
from ..tables import PLAIN_SHIFT

MOST_TOUCHING = 8
TOUCHING = np.dtype(
    [
        ("count", "i4"),
        ("instance", "i4", (MOST_TOUCHING,)),  # row of INSTANCE
        ("medium", "i4", (MOST_TOUCHING,)),  # row of MEDIUM
        ("leaves", "i4", (MOST_TOUCHING,)),  # 1: by its back, out of the medium
    ]
)
new_touching = scratch_record(TOUCHING)
ZERO, ONE = np.float32(0.0), np.float32(1.0)


@kernel
def find_touching(scene, it, visibility, found):
    """Fill `found` with the boundaries that a ray crosses when it goes through at `it`: first that of `it`, if it is
    one, then those of other objects that `visibility` rays see."""
    found.count = 0
    add(scene, found, it)
    world = scene.world[0]
    p, ng = load3(it, "p"), load3(it, "ng")
    before, behind = offset_ray_origin(p, ng), offset_ray_origin(p, -ng)
    if world.instance_root >= 0:
        search(scene, world.instance_root, it.instance, before, behind - before, visibility, it.time, found)
    if world.moving_root >= 0:
        search(scene, world.moving_root, it.instance, before, behind - before, visibility, it.time, found)


@kernel
def search(scene, root, own, o, d, visibility, time, found):
    """Add what lies between o and o + d, of the instances in the tree below `root` but the row `own`."""
    stack, slabs, scratch, it = stack_scratch(), make_slabs(o, d), new_instance(), new_interaction()
    top = start(stack, root)
    while True:
        leaf, top = next_leaf(scene, scene.instances, slabs, stack, top, ZERO, ONE)
        if leaf == NO_LEAF:
            return
        row = ~leaf
        seen = scene.instances[row].visibility
        if row == own or seen & visibility == 0 or seen >> PLAIN_SHIFT != 0:
            continue
        instance = instance_at(scene, row, time, scratch)
        hit = intersect_instance(scene, instance, o, d, ZERO, ONE, NO_FACE.prim)
        if hit.prim >= 0:
            kind = np.int64(instance.kind)
            make_interaction(scene, it, Hit(hit.t, kind, hit.prim, row, hit.b1, hit.b2), o, d, time)
            add(scene, found, it)


@kernel
def add(scene, found, it):
    medium = scene.materials[it.material].medium
    if medium >= 0 and found.count < MOST_TOUCHING:
        found.instance[found.count], found.medium[found.count] = it.instance, medium
        found.leaves[found.count] = it.backfacing
        found.count += 1
