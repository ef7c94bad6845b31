# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a ray met the scene: from the few numbers of a Hit to all that shading needs."""

import numpy as np

from ..jit import kernel
from ..linalg.records import scratch_record
from ..linalg.transform import transform_normal, transform_point, transform_vector
from ..linalg.vec3 import cross, dot, load3, load3_at, normalize, store3
from ..motion import instance_at, new_instance
from ..tables import ShapeKind, TreeKind
from . import dispatch

INTERACTION = np.dtype(
    [  # a row and no tuple: kernels hand it on as one pointer, not as 17 arguments
        ("p", "f4", (3,)),  # world space
        ("ng", "f4", (3,)),  # unit geometric normal, on the side that the ray came from
        ("ns", "f4", (3,)),  # unit shading normal, likewise
        ("instance", "i4"),  # row of INSTANCE
        ("material", "i4"),  # row of MATERIAL
        ("light", "i4"),  # row of LIGHT, of a divided triangle the whole, if this place emits and can be sampled; or -1
        ("backfacing", "i4"),  # 1: the ray came from behind
        ("time", "f4"),  # of the ray, 0 to 1 while the shutter is open
        ("kind", "i4"),  # kind, prim and instance of the Hit
        ("prim", "i4"),
        ("through", "i4"),
    ]
)
new_interaction = scratch_record(INTERACTION)


@kernel
def make_interaction(scene, it, hit, o, d, time):
    """Let the row of INTERACTION `it` be that of the ray o + t d, `d` unit, with what it hit."""
    scratch = new_instance()
    if hit.kind == TreeKind.TRIANGLES:
        triangle = scene.triangles[hit.prim]
        b1, b2 = hit.b1, hit.b2
        b0 = 1.0 - b1 - b2
        p0, p1, p2 = load3_at(triangle, "p", 0), load3_at(triangle, "p", 1), load3_at(triangle, "p", 2)
        p = p0 * b0 + p1 * b1 + p2 * b2
        ng = cross(p1 - p0, p2 - p0)
        ns = load3_at(triangle, "n", 0) * b0 + load3_at(triangle, "n", 1) * b1 + load3_at(triangle, "n", 2) * b2
        slot, owner, light = triangle.slot, triangle.instance, triangle.light
    else:
        shape = scene.shapes[hit.prim]
        slot, owner, light = shape.slot, shape.instance, shape.light
        if hit.instance >= 0:
            through = instance_at(scene, hit.instance, time, scratch)
            local_o = transform_point(through, "to_object", o)
            p = transform_point(through, "to_object", o + d * hit.t)
        else:
            local_o = o
            p = o + d * hit.t
        p = dispatch.snap(shape, p)
        ng = dispatch.geometric_normal(shape, local_o, p)
        ns = ng

    if hit.instance >= 0:  # its geometry is in object space
        owner = hit.instance
        through = instance_at(scene, hit.instance, time, scratch)
        p = transform_point(through, "to_world", p)
        ng = transform_normal(through, "to_object", ng)
        ns = transform_normal(through, "to_object", ns)

    row = scene.instances[owner]
    material = scene.slots[row.slots + slot].material
    if light >= 0 and row.lights >= 0:
        light += row.lights
    else:
        light = -1

    ng = normalize(ng)
    ns = normalize(ns)
    backfacing = dot(ng, d) > 0.0
    if backfacing:
        ng = -ng
        ns = -ns
    store3(it, "p", p)
    store3(it, "ng", ng)
    store3(it, "ns", ns)
    it.instance, it.material, it.light, it.backfacing, it.time = owner, material, light, np.int32(backfacing), time
    it.kind, it.prim, it.through = hit.kind, hit.prim, hit.instance


@kernel
def tangents(scene, it):
    """Two directions along the surface, not unit, for who asks for a tangent that no map of coordinates gives.

    Of a strand both are whereto it runs; of a triangle they are the edges from its first corner, turned around with the
    normal, as in Cycles.
    """
    scratch = new_instance()
    if it.kind == TreeKind.TRIANGLES:
        triangle = scene.triangles[it.prim]
        p0 = load3_at(triangle, "p", 0)
        s, t = load3_at(triangle, "p", 1) - p0, load3_at(triangle, "p", 2) - p0
    else:
        p = load3(it, "p")
        if it.through >= 0:
            p = transform_point(instance_at(scene, it.through, it.time, scratch), "to_object", p)
        s = dispatch.tangent(scene.shapes[it.prim], p)
        t = s
    if it.through >= 0:
        through = instance_at(scene, it.through, it.time, scratch)
        s, t = transform_vector(through, "to_world", s), transform_vector(through, "to_world", t)
    if it.backfacing:
        return -s, -t
    return s, t


@kernel
def is_strand(scene, it):
    return it.kind == TreeKind.SHAPES and scene.shapes[it.prim].kind == ShapeKind.STRAND


@kernel
def texture_coordinates(scene, hit, p, time):
    """(u, v) of the point `p`, in world space, of what was hit: for whoever has textures."""
    if hit.kind == TreeKind.TRIANGLES:
        uv = scene.triangles[hit.prim].uv
        b0 = 1.0 - hit.b1 - hit.b2
        u = uv[0, 0] * b0 + uv[1, 0] * hit.b1 + uv[2, 0] * hit.b2
        v = uv[0, 1] * b0 + uv[1, 1] * hit.b1 + uv[2, 1] * hit.b2
        return u, v
    shape = scene.shapes[hit.prim]
    if shape.kind == ShapeKind.STRAND:
        uv = scene.strands[shape.strand].uv
        return uv[0], uv[1]
    if hit.instance >= 0:
        p = transform_point(instance_at(scene, hit.instance, time, new_instance()), "to_object", p)
    return dispatch.uv(shape, p)
