# SPDX-License-Identifier: GPL-3.0-or-later
"""The place where a program runs: a row of POINT."""

import math

import numpy as np

from ..jit import kernel
from ..linalg.records import scratch_record
from ..linalg.transform import transform_normal, transform_vector
from ..linalg.vec3 import Vec3, cross, dot, load3, normalize, store3
from ..program_tables import POINT
from ..shape.interaction import texture_coordinates
from ..tables import LightKind
from ..texture.image import sphere_to_square

WORLD, LAMP = -1, -2  # kinds of places beside TreeKind
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
    point.uv[0], point.uv[1] = texture_coordinates(scene, hit, load3(it, "p"), it.time)
    store3(point, "p", load3(it, "p"))
    store3(point, "ng", load3(it, "ng"))
    store3(point, "ns", load3(it, "ns"))
    store3(point, "wo", wo)


@kernel
def set_lamp(scene, point, light, q, wo, visibility, distance):
    """The point `q` of a lamp, seen along -wo from that far away. Of a sun the position is the direction towards it
    turned around, as in Cycles."""
    set_world(point, -wo, visibility)
    point.kind, point.instance, point.ray_length = LAMP, light.lamp, distance
    n = normal_of_lamp(light, q, wo)
    store3(point, "p", wo if light.kind == LightKind.SUN else q)
    store3(point, "ng", n)
    store3(point, "ns", n)
    instance = scene.instances[light.lamp]
    if light.kind == LightKind.POINT:
        point.uv[0], point.uv[1] = sphere_to_square(transform_vector(instance, "to_object", n))
    elif light.kind == LightKind.SPOT:
        across = 0.5 * light.cos_angle / math.sqrt(max(1.0 - light.cos_angle * light.cos_angle, 1e-12))
        scale = across / dot(wo, load3(light, "n"))
        point.uv[0] = 0.5 + dot(wo, load3(light, "u")) * scale
        point.uv[1] = 0.5 + dot(wo, load3(light, "v")) * scale
    elif light.kind == LightKind.SUN:
        towards = -wo
        z = dot(wo, load3(light, "n"))
        scale = 0.5 / math.sqrt(max(light.height * (1.0 + z), 1e-12))
        along = transform_normal(instance, "to_world", towards)
        point.uv[0], point.uv[1] = 0.5 + along.x * scale, 0.5 + along.y * scale
    else:
        u, v, w = load3(light, "u"), load3(light, "v"), q - load3(light, "p")
        half = math.copysign(np.float32(0.5), transform_vector(instance, "to_object", v).y)  # it may be turned around
        point.uv[0], point.uv[1] = 0.5 + 0.5 * dot(w, u) / dot(u, u), 0.5 + half * dot(w, v) / dot(v, v)


@kernel
def normal_of_lamp(light, q, wo):
    """Of a sphere and of a plane their own, of what has no extent towards whoever looks."""
    if light.kind == LightKind.QUAD or light.kind == LightKind.DISK:
        return load3(light, "n")
    if light.kind != LightKind.SUN and light.is_delta == 0 and (light.soft == 0 or light.kind == LightKind.SPOT):
        return normalize(q - load3(light, "p"))
    return wo


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


@kernel
def surface_tangents(n):
    """Two unit vectors at right angles to `n` and each other: those that Cycles takes, which have their say in how long
    a step along the surface is seen, and in slopes of what is curved."""
    s = normalize(Vec3(n.z - n.y, n.x - n.z, n.y - n.x))
    if n.x == n.y and n.x == n.z:
        s = normalize(Vec3(n.z - n.y, n.x + n.z, -n.y - n.x))
    return s, cross(n, s)
