# SPDX-License-Identifier: GPL-3.0-or-later
"""The place where a program runs: a row of POINT."""

import numpy as np

from ..jit import kernel
from ..linalg.records import scratch_record
from ..linalg.vec3 import store3
from ..program_tables import POINT
from ..shape.interaction import texture_coordinates

ZERO = np.float32(0.0)
new_point = scratch_record(POINT)


@kernel
def set_surface(scene, point, it, hit, wo, visibility, footprint):
    """A place on a surface: Interaction `it` of the `hit`, seen along -wo by a ray of that kind."""
    point.kind, point.instance, point.prim, point.material = hit.kind, it.instance, hit.prim, it.material
    point.backfacing = np.int32(it.backfacing)
    point.visibility = visibility
    point.bounces = point.diffuse_bounces = point.glossy_bounces = 0
    point.transmission_bounces = point.transparent_bounces = 0
    point.time, point.ray_length, point.footprint = it.time, hit.t, footprint
    point.b1, point.b2 = hit.b1, hit.b2
    point.uv[0], point.uv[1] = texture_coordinates(scene, hit, it.p, it.time)
    store3(point, "p", it.p)
    store3(point, "ng", it.ng)
    store3(point, "ns", it.ns)
    store3(point, "wo", wo)


@kernel
def set_world(point, d, visibility):
    """The world, seen along the unit direction `d`; there the position is the direction, as in Cycles."""
    point.kind, point.instance, point.prim, point.material = -1, -1, -1, 0
    point.backfacing = 0
    point.visibility = visibility
    point.bounces = point.diffuse_bounces = point.glossy_bounces = 0
    point.transmission_bounces = point.transparent_bounces = 0
    point.time = point.ray_length = point.footprint = point.b1 = point.b2 = ZERO
    point.uv[0] = point.uv[1] = ZERO
    store3(point, "p", d)
    store3(point, "ng", -d)
    store3(point, "ns", -d)
    store3(point, "wo", -d)
