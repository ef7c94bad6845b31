# SPDX-License-Identifier: GPL-3.0-or-later
"""What the place of a hit tells: coordinates, normals, attributes, the object, the ray."""

import numpy as np

from ..jit import kernel
from ..linalg.registers import store_float
from ..linalg.transform import transform_normal, transform_point, transform_vector
from ..linalg.vec3 import BLACK, Vec3, cross, dot, length, load3, load3_at, reflect
from ..linalg.vector_math import safe_normalize
from ..motion import instance_at, new_instance
from ..shape import dispatch as shapes
from ..shape import strand
from ..tables import CameraKind, ShapeKind, TreeKind, Visibility
from .opcodes import DIRECTION_BITS, STEPS_PER_FOOTPRINT, InputNumber, InputVector, Op
from .operands import give_number, give_vector
from .point import WORLD, surface_tangents

STEP = np.float32(1.0 / STEPS_PER_FOOTPRINT)
ZERO, ONE = np.float32(0.0), np.float32(1.0)


def run(scene, op, point, registers):
    """One step: see `opcodes.SIGNATURES`."""
    if op.code == Op.INPUT_NUMBER:
        give_number(op, registers, input_number(scene, point, op.mode))
    elif op.code == Op.INPUT_VECTOR:
        give_vector(op, registers, input_vector(scene, point, op.mode, op.shift))
    elif op.code == Op.ATTRIBUTE:
        attribute(scene, op, point, registers)
    else:
        instance_value(scene, op, point, registers)


@kernel
def flag(condition):
    return ONE if condition else ZERO


@kernel
def input_number(scene, point, mode):
    if mode == InputNumber.BACKFACING:
        return flag(point.backfacing != 0)
    if mode <= InputNumber.OBJECT_ALPHA:
        return object_number(scene, point, mode)
    if mode >= InputNumber.IS_STRAND:
        return strand_number(scene, point, mode)
    if mode == InputNumber.VIEW_DEPTH:
        return camera_space(scene, point, load3(point, "p")).z
    if mode == InputNumber.VIEW_DISTANCE:
        return length(camera_space(scene, point, load3(point, "p")))
    return ray_number(point, mode)


@kernel
def object_number(scene, point, mode):
    if mode == InputNumber.MATERIAL_INDEX:
        return np.float32(scene.materials[point.material].pass_index)
    if point.instance < 0:
        return ZERO
    instance = scene.instances[point.instance]
    if mode == InputNumber.RANDOM:
        return instance.random
    if mode == InputNumber.OBJECT_INDEX:
        return np.float32(instance.pass_index)
    return scene.objects[point.instance].color[3]


@kernel
def is_on_strand(scene, point):
    return point.kind == TreeKind.SHAPES and scene.shapes[point.prim].kind == ShapeKind.STRAND


@kernel
def strand_number(scene, point, mode):
    """Blender's Curves Info node; 0 where there is no strand."""
    if not is_on_strand(scene, point):
        return ZERO
    if mode == InputNumber.IS_STRAND:
        return ONE
    shape = scene.shapes[point.prim]
    told = scene.strands[shape.strand]
    if mode == InputNumber.STRAND_LENGTH:
        return told.length
    if mode == InputNumber.STRAND_RANDOM:
        return told.random
    y, _ = strand.place(shape, strand_place(scene, point, shape))
    if mode == InputNumber.INTERCEPT:
        return told.start + (told.end - told.start) * y
    thickness = 2.0 * (shape.radius + (shape.radius_end - shape.radius) * y)
    if shape.instance >= 0:
        return thickness
    instance = instance_at(scene, point.instance, point.time, new_instance())
    across = Vec3(thickness, thickness, thickness) * np.float32(3.0**-0.5)
    return length(transform_vector(instance, "to_world", across))


@kernel
def strand_place(scene, point, shape):
    """The point in the space where the shape stands."""
    p = load3(point, "p")
    if shape.instance >= 0:
        return p
    return transform_point(instance_at(scene, point.instance, point.time, new_instance()), "to_object", p)


@kernel
def strand_normal(scene, point):
    """At right angles to the strand, towards whoever looks."""
    if not is_on_strand(scene, point):
        return BLACK
    shape, wo = scene.shapes[point.prim], load3(point, "wo")
    along = strand.tangent(shape, strand_place(scene, point, shape))
    if shape.instance < 0:
        instance = instance_at(scene, point.instance, point.time, new_instance())
        along = transform_vector(instance, "to_world", along)
    return safe_normalize(wo - along * (dot(along, wo) / dot(along, along)))


@kernel
def ray_number(point, mode):
    """Blender's Light Path node."""
    ray = point.visibility
    if mode == InputNumber.IS_CAMERA:
        return flag(ray == Visibility.CAMERA.value)
    if mode == InputNumber.IS_SHADOW:
        return flag(ray == Visibility.SHADOW.value)
    if mode == InputNumber.IS_DIFFUSE:
        return flag(ray == Visibility.DIFFUSE.value)
    if mode == InputNumber.IS_GLOSSY:
        return flag(ray == Visibility.GLOSSY.value)
    if mode == InputNumber.IS_TRANSMISSION:
        return flag(ray == Visibility.TRANSMISSION.value)
    if mode == InputNumber.IS_REFLECTION:
        return flag(ray == Visibility.DIFFUSE.value or ray == Visibility.GLOSSY.value)
    if mode == InputNumber.IS_VOLUME:
        return flag(ray == Visibility.SCATTER.value)
    if mode == InputNumber.RAY_LENGTH:
        return point.ray_length
    if mode == InputNumber.RAY_DEPTH:
        return np.float32(point.bounces)
    if mode == InputNumber.DIFFUSE_DEPTH:
        return np.float32(point.diffuse_bounces)
    if mode == InputNumber.GLOSSY_DEPTH:
        return np.float32(point.glossy_bounces)
    if mode == InputNumber.TRANSPARENT_DEPTH:
        return np.float32(point.transparent_bounces)
    return np.float32(point.transmission_bounces)


@kernel
def input_vector(scene, point, mode, shift):
    """In the world, which has no surface, the position is the direction that one looks in."""
    p = place(point, shift)
    if mode == InputVector.POSITION:
        return p
    if mode == InputVector.UV:
        return texture_uv(scene, point, p, shift)
    if mode <= InputVector.INCOMING:
        return direction(point, mode)
    if mode == InputVector.CAMERA:
        return camera_space(scene, point, p)
    if mode == InputVector.WINDOW:
        return window(scene, point, p)
    if mode == InputVector.REFLECTION:
        return reflect(load3(point, "wo"), load3(point, "ns"))
    if mode == InputVector.STRAND_NORMAL:
        return strand_normal(scene, point)
    if mode == InputVector.PARAMETRIC:
        return Vec3(1.0 - point.b1 - point.b2, point.b1, 0.0)
    if point.instance < 0:
        return load3(point, "ns") if mode == InputVector.OBJECT_NORMAL else p
    return object_vector(scene, point, mode, p)


@kernel
def direction(point, mode):
    if mode == InputVector.NORMAL:
        return load3(point, "ns")
    return load3(point, "ng") if mode == InputVector.TRUE_NORMAL else load3(point, "wo")


@kernel
def object_vector(scene, point, mode, p):
    """What only objects have. `p`: world space."""
    instance = instance_at(scene, point.instance, point.time, new_instance())
    if mode == InputVector.OBJECT_NORMAL:
        return safe_normalize(transform_normal(instance, "to_world", load3(point, "ns")))
    if mode == InputVector.OBJECT_LOCATION:
        return transform_point(instance, "to_world", BLACK)
    if mode == InputVector.OBJECT_COLOR:
        color = scene.objects[point.instance].color
        return Vec3(color[0], color[1], color[2])
    p = transform_point(instance, "to_object", p)
    if mode == InputVector.OBJECT:
        return p
    told = scene.objects[point.instance]
    p = p * load3(told, "texture_scale") + load3(told, "texture_offset")
    if is_on_strand(scene, point):
        p = p + load3(scene.strands[scene.shapes[point.prim].strand], "generated")
    if mode == InputVector.GENERATED:
        return p
    if mode == InputVector.RADIAL_TANGENT_X:
        around = Vec3(0.0, 0.5 - p.z, p.y - 0.5)
    elif mode == InputVector.RADIAL_TANGENT_Y:
        around = Vec3(0.5 - p.z, 0.0, p.x - 0.5)
    else:
        around = Vec3(0.5 - p.y, p.x - 0.5, 0.0)
    around = transform_normal(instance, "to_object", around)
    n = load3(point, "ns")
    return cross(n, safe_normalize(cross(around, n)))


# ---- A bit further along the surface ---------------------------------------------------------------------------------


@kernel
def place(point, shift):
    """The point, or for a `shift` of `graph.shifted` a neighbour of it in one of two directions."""
    p = load3(point, "p")
    if shift == 0:
        return p
    s, t = surface_tangents(load3(point, "ng"))
    step = point.footprint * (np.float32(shift >> DIRECTION_BITS) * STEP)
    return p + (s if shift & 3 == 1 else t) * step


@kernel
def barycentrics(scene, point, shift):
    """(b1, b2) of the hit triangle at `place(point, shift)`."""
    if shift == 0 or point.kind != TreeKind.TRIANGLES:
        return point.b1, point.b2
    return barycentrics_at(scene, point.instance, point.prim, place(point, shift), point.time)


@kernel
def barycentrics_at(scene, instance, prim, p, time):
    """(b1, b2) of the triangle `prim` of the instance at `p`, world space, in or beside it."""
    triangle = scene.triangles[prim]
    p0 = load3_at(triangle, "p", 0)
    u, v = load3_at(triangle, "p", 1) - p0, load3_at(triangle, "p", 2) - p0
    if triangle.instance < 0:  # its corners are in object space
        p = transform_point(instance_at(scene, instance, time, new_instance()), "to_object", p)
    w = p - p0
    uu, uv, vv, uw, vw = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    scale = 1.0 / max(uu * vv - uv * uv, 1e-37)
    return (uw * vv - vw * uv) * scale, (vw * uu - uw * uv) * scale


@kernel
def texture_uv(scene, point, p, shift):
    if shift == 0 or point.kind < 0:  # the world and lamps have no neighbours
        return Vec3(point.uv[0], point.uv[1], 0.0)
    if point.kind == TreeKind.SHAPES:
        shape = scene.shapes[point.prim]
        if shape.kind == ShapeKind.STRAND:
            return Vec3(point.uv[0], point.uv[1], 0.0)
        if shape.instance < 0:
            p = transform_point(instance_at(scene, point.instance, point.time, new_instance()), "to_object", p)
        u, v = shapes.uv(shape, p)
        return Vec3(u, v, 0.0)
    b1, b2 = barycentrics(scene, point, shift)
    b0, uv = 1.0 - b1 - b2, scene.triangles[point.prim].uv
    u = uv[0, 0] * b0 + uv[1, 0] * b1 + uv[2, 0] * b2
    return Vec3(u, uv[0, 1] * b0 + uv[1, 1] * b1 + uv[2, 1] * b2, 0.0)


@kernel
def attribute(scene, op, point, registers):
    """Four floats interpolated over a triangle, or along a strand; zeros where there is no such attribute."""
    for k in range(4):
        store_float(registers, op.out + k, ZERO)
    if point.instance < 0:
        return
    prim = point.prim
    if point.kind != TreeKind.TRIANGLES:
        if not is_on_strand(scene, point):
            return
        prim = scene.shapes[prim].strand
    told = scene.objects[point.instance]
    if told.attributes < 0:
        return
    first = scene.attribute_maps[told.attributes + op.data].first
    if first < 0:
        return
    index = first + prim - told.first_prim
    if index < 0 or index >= scene.world[0].attribute_count:
        return
    row = scene.attributes[index]
    b1, b2 = barycentrics(scene, point, op.shift)
    b0 = 1.0 - b1 - b2
    for k in range(4):
        store_float(registers, op.out + k, row.value[0, k] * b0 + row.value[1, k] * b1 + row.value[2, k] * b2)


@kernel
def instance_value(scene, op, point, registers):
    """Four floats that belong to the whole instance; zeros in the world, which is none."""
    for k in range(4):
        store_float(registers, op.out + k, ZERO)
    if point.instance < 0:
        return
    row = scene.instance_values[op.data * scene.world[0].value_stride + scene.objects[point.instance].number]
    for k in range(4):
        store_float(registers, op.out + k, row.value[k])


# ---- The camera ------------------------------------------------------------------------------------------------------


@kernel
def camera_space(scene, point, p):
    """x to the right, y up, z away from the camera."""
    camera = scene.camera[0]
    if point.kind != WORLD:
        p = p - transform_point(camera, "to_world", BLACK)
    p = transform_normal(camera, "to_world", p)
    return Vec3(p.x, p.y, -p.z)


@kernel
def window(scene, point, p):
    """Where a point is in the picture: (0, 0) is the lower left corner, (1, 1) the upper right one."""
    camera = scene.camera[0]
    p = camera_space(scene, point, p)
    scale = 1.0 / p.z if camera.kind == CameraKind.PERSPECTIVE and p.z != 0.0 else ONE
    left, right, bottom, top = camera.screen[0], camera.screen[1], camera.screen[2], camera.screen[3]
    return Vec3((p.x * scale - left) / (right - left), (p.y * scale - bottom) / (top - bottom), 0.0)
