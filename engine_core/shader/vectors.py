# SPDX-License-Identifier: GPL-3.0-or-later
"""Vectors: Mapping, rotations and spaces, normals that are bumped or mapped, and what depends on the angle of view."""

import math

import numpy as np

from ..jit import kernel
from ..linalg.transform import transform_normal, transform_point, transform_vector
from ..linalg.vec3 import BLACK, Vec3, cross, dot, is_black, load3, load3_at
from ..linalg.vector_math import mapping, rotate, safe_normalize
from ..motion import instance_at, new_instance
from ..tables import TreeKind
from .opcodes import CLAMPED, FOOTPRINT, INVERTED, NormalSpace, Op, Space
from .operands import give_number, give_vector, number, vector
from .point import surface_tangents

PER_PIXEL = np.float32(1.0 / FOOTPRINT)
ONE = np.float32(1.0)


def run(scene, op, point, registers):
    """One step: see `opcodes.SIGNATURES`."""
    code = op.code
    if code == Op.MAPPING:
        location, rotation = vector(op, registers, 1), vector(op, registers, 2)
        give_vector(
            op, registers, mapping(op.mode, vector(op, registers, 0), location, rotation, vector(op, registers, 3))
        )
    elif code == Op.TRANSFORM:
        p, x, y = vector(op, registers, 0), vector(op, registers, 1), vector(op, registers, 2)
        z, offset = vector(op, registers, 3), vector(op, registers, 4)
        give_vector(op, registers, Vec3(dot(x, p), dot(y, p), dot(z, p)) + offset)
    elif code == Op.ROTATE:
        v, centre, axis = vector(op, registers, 0), vector(op, registers, 1), vector(op, registers, 2)
        angle, euler, back = number(op, registers, 3), vector(op, registers, 4), op.mode & CLAMPED != 0
        give_vector(op, registers, rotate(op.mode & ~CLAMPED, v, centre, axis, angle, euler, back))
    elif code == Op.CHANGE_SPACE:
        change_space(scene, op, point, registers)
    elif code == Op.BUMP:
        bump(op, point, registers)
    elif code == Op.NORMAL_MAP:
        normal_map(scene, op, point, registers)
    elif code == Op.FRESNEL:
        ior = max(number(op, registers, 0), 1e-5)
        give_number(op, registers, fresnel(point, vector(op, registers, 1), 1.0 / ior if point.backfacing else ior))
    elif code == Op.LAYER_WEIGHT:
        layer_weight(op, point, registers)


# ---- Spaces ----------------------------------------------------------------------------------------------------------


@kernel
def change_space(scene, op, point, registers):
    """Blender's Vector Transform. Normals keep to directions, made unit, as in Cycles; kind 3 are those of planes."""
    kind, start, end = op.mode // 9, (op.mode // 3) % 3, op.mode % 3
    v = vector(op, registers, 0)
    is_point = kind == 0
    if start == Space.OBJECT and point.instance >= 0:
        instance = instance_at(scene, point.instance, point.time, new_instance())
        if is_point:
            v = transform_point(instance, "to_world", v)
        elif kind == 3:
            v = transform_normal(instance, "to_object", v)
        else:
            v = transform_vector(instance, "to_world", v)
    elif start == Space.CAMERA:
        v = Vec3(v.x, v.y, -v.z)
        camera = scene.camera[0]
        v = transform_point(camera, "to_world", v) if is_point else transform_vector(camera, "to_world", v)
    if end == Space.OBJECT and point.instance >= 0:
        instance = instance_at(scene, point.instance, point.time, new_instance())
        if is_point:
            v = transform_point(instance, "to_object", v)
        elif kind == 3:
            v = transform_normal(instance, "to_world", v)
        else:
            v = transform_vector(instance, "to_object", v)
    elif end == Space.CAMERA:
        camera = scene.camera[0]
        if is_point:
            v = v - transform_point(camera, "to_world", BLACK)
        v = transform_normal(camera, "to_world", v)
        v = Vec3(v.x, v.y, -v.z)
    give_vector(op, registers, safe_normalize(v) if kind >= 2 else v)


# ---- Normals ---------------------------------------------------------------------------------------------------------


@kernel
def normal_or(point, n):
    """A normal that is given, or that of the surface where none (zero) is."""
    return load3(point, "ns") if is_black(n) else n


@kernel
def bump(op, point, registers):
    """Tilt the normal as if the surface had a height (Mikkelsen 2010), known here and so many pixels further."""
    strength, distance = max(number(op, registers, 0), 0.0), number(op, registers, 1)
    height = number(op, registers, 2)
    slope_s, slope_t = number(op, registers, 3) - height, number(op, registers, 4) - height
    n = normal_or(point, vector(op, registers, 5))
    step = point.footprint * (number(op, registers, 6) * PER_PIXEL)
    if op.mode & INVERTED:
        distance = -distance
    if point.backfacing:
        distance = -distance
    s, t = surface_tangents(load3(point, "ng"))
    ds, dt = s * step, t * step
    rs, rt = cross(dt, n), cross(n, ds)
    det = dot(ds, rs)
    gradient = rs * slope_s + rt * slope_t
    tilted = safe_normalize(n * abs(det) - gradient * math.copysign(distance, distance * det))
    if is_black(tilted):
        tilted = n
    give_vector(op, registers, safe_normalize(tilted * strength + n * (1.0 - strength)))


@kernel
def normal_map(scene, op, point, registers):
    """A normal from a colour: 0 to 1 stands for -1 to 1, in the frame of the UV map or in object or world space."""
    c, strength = vector(op, registers, 0), max(number(op, registers, 1), 0.0)
    v = c * 2.0 - Vec3(1.0, 1.0, 1.0)
    n = load3(point, "ns")
    outside = -n if point.backfacing else n
    is_tangent = op.mode == NormalSpace.TANGENT or op.mode == NormalSpace.TANGENT_OF_4
    if is_tangent:
        v = Vec3(v.x * strength, v.y * strength, 1.0 + (v.z - 1.0) * min(strength, ONE))
        tangent, sign = vector(op, registers, 2), number(op, registers, 3)
        mapped = in_tangent_space(scene, point, tangent, sign, v, outside, op.mode == NormalSpace.TANGENT)
    elif op.mode == NormalSpace.OBJECT and point.instance >= 0:
        mapped = safe_normalize(
            transform_normal(instance_at(scene, point.instance, point.time, new_instance()), "to_object", v)
        )
    else:
        mapped = safe_normalize(v)
    if point.backfacing:
        mapped = -mapped
    if not is_tangent:
        mapped = safe_normalize(n + (mapped - n) * strength)
    give_vector(op, registers, n if is_black(mapped) else mapped)


@kernel
def in_tangent_space(scene, point, tangent, sign, v, outside, normalized):
    """The vector `v` of the frame that normal and tangent make in object space. The tangent is as long as interpolation
    leaves it, for which pictures of normals are made; so is the normal unless it is to be `normalized`. `outside`, the
    normal, where there is no tangent."""
    if is_black(tangent) or point.kind != TreeKind.TRIANGLES or point.instance < 0:
        return outside
    instance = instance_at(scene, point.instance, point.time, new_instance())
    triangle = scene.triangles[point.prim]
    n0, n1, n2 = load3_at(triangle, "n", 0), load3_at(triangle, "n", 1), load3_at(triangle, "n", 2)
    scale = scene.objects[point.instance].scale
    is_in_world = triangle.instance >= 0  # so are its normals
    if is_in_world and scale == 0.0:
        n0 = safe_normalize(transform_normal(instance, "to_world", n0))
        n1 = safe_normalize(transform_normal(instance, "to_world", n1))
        n2 = safe_normalize(transform_normal(instance, "to_world", n2))
    n = n0 * (1.0 - point.b1 - point.b2) + n1 * point.b1 + n2 * point.b2
    if is_in_world and scale > 0.0:
        n = transform_normal(instance, "to_world", n) * (1.0 / scale)
    if normalized:
        n = safe_normalize(n)
    mapped = tangent * v.x + cross(n, tangent) * (sign * v.y) + n * v.z
    return safe_normalize(transform_normal(instance, "to_object", mapped))


# ---- What depends on the angle of view -------------------------------------------------------------------------------


@kernel
def fresnel(point, n, eta):
    """Reflectance of a smooth dielectric of relative index of refraction `eta`."""
    c = abs(dot(load3(point, "wo"), normal_or(point, n)))
    g2 = eta * eta - 1.0 + c * c
    if g2 <= 0.0:
        return ONE
    g = math.sqrt(g2)
    a = (g - c) / (g + c)
    b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
    return 0.5 * a * a * (1.0 + b * b)


@kernel
def layer_weight(op, point, registers):
    """Mode 0: Fresnel, 1: Facing."""
    blend, n = number(op, registers, 0), vector(op, registers, 1)
    if op.mode == 0:
        eta = max(1.0 - blend, 1e-5)
        give_number(op, registers, fresnel(point, n, eta if point.backfacing else 1.0 / eta))
        return
    facing = abs(dot(load3(point, "wo"), normal_or(point, n)))
    if blend != 0.5:
        blend = min(max(blend, 0.0), np.float32(1.0 - 1e-5))
        facing = facing ** (2.0 * blend if blend < 0.5 else 0.5 / (1.0 - blend))
    give_number(op, registers, 1.0 - facing)
