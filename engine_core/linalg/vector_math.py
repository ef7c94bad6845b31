# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations on vectors, as artists choose them: Blender's Vector Math, Vector Rotate, Mapping and Map Range nodes.

As in `scalar_math`, what is not defined gives what Cycles gives.
"""

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from . import scalar_math
from .scalar_math import clamp_range, safe_divide, safe_power
from .vec3 import BLACK, Vec3, cross, dot, length


class VectorMathOp(IntEnum):
    """Operations of the Vector Math node; names and numbers are Blender's."""

    ADD = 0
    SUBTRACT = 1
    MULTIPLY = 2
    DIVIDE = 3
    CROSS_PRODUCT = 4
    PROJECT = 5
    REFLECT = 6
    DOT_PRODUCT = 7
    DISTANCE = 8
    LENGTH = 9
    SCALE = 10
    NORMALIZE = 11
    SNAP = 12
    FLOOR = 13
    CEIL = 14
    MODULO = 15
    FRACTION = 16
    ABSOLUTE = 17
    MINIMUM = 18
    MAXIMUM = 19
    WRAP = 20
    SINE = 21
    COSINE = 22
    TANGENT = 23
    REFRACT = 24
    FACEFORWARD = 25
    MULTIPLY_ADD = 26
    POWER = 27
    SIGN = 28
    ROUND = 29


class RotationKind(IntEnum):
    """What the Vector Rotate node turns about; names and numbers are Blender's."""

    AXIS_ANGLE = 0
    X_AXIS = 1
    Y_AXIS = 2
    Z_AXIS = 3
    EULER_XYZ = 4


class MappingKind(IntEnum):
    """What the Mapping node takes its vector for; names and numbers are Blender's."""

    POINT = 0  # scaled, turned, moved
    TEXTURE = 1  # the inverse: moves the texture instead of the point
    VECTOR = 2  # scaled and turned
    NORMAL = 3  # divided by the scale, turned, made unit


class VectorValue(NamedTuple):
    """Both outputs of the Vector Math node; an operation fills one, the other is 0."""

    vector: Vec3
    value: np.float32


@kernel
def evaluate(op, a, b, c, scale):
    """The Vector Math node: `op`, a VectorMathOp, of up to three vectors.

    `scale` is the factor of SCALE, and the ratio of the indices of REFRACT.
    """
    if op == VectorMathOp.DOT_PRODUCT:
        return VectorValue(BLACK, dot(a, b))
    if op == VectorMathOp.DISTANCE:
        return VectorValue(BLACK, length(a - b))
    if op == VectorMathOp.LENGTH:
        return VectorValue(BLACK, length(a))
    return VectorValue(_vector(op, a, b, c, scale), np.float32(0.0))


@kernel
def _vector(op, a, b, c, scale):
    """Those that give a vector and look at it as a whole; the others go by component."""
    if op == VectorMathOp.ADD:
        return a + b
    if op == VectorMathOp.SUBTRACT:
        return a - b
    if op == VectorMathOp.MULTIPLY:
        return a * b
    if op == VectorMathOp.MULTIPLY_ADD:
        return a * b + c
    if op == VectorMathOp.SCALE:
        return a * scale
    if op == VectorMathOp.NORMALIZE:
        return safe_normalize(a)
    if op == VectorMathOp.CROSS_PRODUCT:
        return cross(a, b)
    if op == VectorMathOp.PROJECT:
        return b * safe_divide(dot(a, b), dot(b, b))
    if op == VectorMathOp.REFLECT:
        n = safe_normalize(b)
        return a - n * (2.0 * dot(a, n))
    if op == VectorMathOp.REFRACT:
        return refract_incident(a, safe_normalize(b), scale)
    if op == VectorMathOp.FACEFORWARD:
        return a if dot(c, b) < 0.0 else -a
    return Vec3(_number(op, a.x, b.x, c.x), _number(op, a.y, b.y, c.y), _number(op, a.z, b.z, c.z))


@kernel
def _number(op, a, b, c):
    """One component of what goes by component. Not all of `scalar_math.evaluate`, which is long, and here is thrice."""
    if op == VectorMathOp.DIVIDE:
        return safe_divide(a, b)
    if op == VectorMathOp.SNAP:
        return np.floor(safe_divide(a, b)) * b
    if op == VectorMathOp.FLOOR:
        return np.floor(a)
    if op == VectorMathOp.CEIL:
        return np.ceil(a)
    if op == VectorMathOp.ROUND:
        return np.floor(a + 0.5)
    if op == VectorMathOp.FRACTION:
        return a - np.floor(a)
    if op == VectorMathOp.MODULO:
        return scalar_math.safe_modulo(a, b)
    if op == VectorMathOp.WRAP:
        return scalar_math.floored_modulo(a - c, b - c) + c
    if op == VectorMathOp.ABSOLUTE:
        return abs(a)
    if op == VectorMathOp.SIGN:
        return scalar_math.sign(a)
    if op == VectorMathOp.POWER:
        return safe_power(a, b)
    if op == VectorMathOp.MINIMUM:
        return min(a, b)
    if op == VectorMathOp.MAXIMUM:
        return max(a, b)
    if op == VectorMathOp.SINE:
        return math.sin(a)
    if op == VectorMathOp.COSINE:
        return math.cos(a)
    if op == VectorMathOp.TANGENT:
        return math.tan(a)
    return np.float32(0.0)


@kernel
def safe_normalize(a):
    """The unit vector along `a`; the zero vector stays what it is."""
    size = length(a)
    return a * (1.0 / size) if size != 0.0 else a


@kernel
def safe_divide3(a, b):
    """a / b by component, and 0 where b is 0."""
    return Vec3(safe_divide(a.x, b.x), safe_divide(a.y, b.y), safe_divide(a.z, b.z))


@kernel
def refract_incident(d, n, eta):
    """Snell's law for a direction `d` that arrives at a surface with normal `n`; black at total reflection.

    `eta` is the ratio of the indices, before over behind. As GLSL's refract.
    """
    cos = dot(n, d)
    k = 1.0 - eta * eta * (1.0 - cos * cos)
    return d * eta - n * (eta * cos + math.sqrt(k)) if k >= 0.0 else BLACK


# ---- Turning ---------------------------------------------------------------------------------------------------------


@kernel
def rotate(kind, v, centre, axis, angle, euler, invert):
    """The Vector Rotate node: `v` turned about `centre`; `kind`, a RotationKind, says by which of the arguments.

    `angle` and `euler` are in radians; a zero axis leaves `v` as it is. `invert` turns back.
    """
    if kind == RotationKind.EULER_XYZ:
        d = v - centre
        return (rotate_euler_back(d, euler) if invert else rotate_euler(d, euler)) + centre
    if kind == RotationKind.X_AXIS:
        unit = Vec3(1.0, 0.0, 0.0)
    elif kind == RotationKind.Y_AXIS:
        unit = Vec3(0.0, 1.0, 0.0)
    elif kind == RotationKind.Z_AXIS:
        unit = Vec3(0.0, 0.0, 1.0)
    else:
        unit = safe_normalize(axis)
    if unit.x == 0.0 and unit.y == 0.0 and unit.z == 0.0:
        return v
    return rotate_about(v - centre, unit, -angle if invert else angle) + centre


@kernel
def rotate_about(v, axis, angle):
    """`v` turned about a unit axis through the origin (Rodrigues)."""
    cos = math.cos(angle)
    return v * cos + cross(axis, v) * math.sin(angle) + axis * (dot(axis, v) * (1.0 - cos))


class EulerMatrix(NamedTuple):
    """A rotation by its columns: where the axes go."""

    x: Vec3
    y: Vec3
    z: Vec3


@kernel
def euler_matrix(euler):
    """About x, then y, then z, by three angles in radians."""
    cx, cy, cz = math.cos(euler.x), math.cos(euler.y), math.cos(euler.z)
    sx, sy, sz = math.sin(euler.x), math.sin(euler.y), math.sin(euler.z)
    return EulerMatrix(
        Vec3(cy * cz, cy * sz, -sy),
        Vec3(sy * sx * cz - cx * sz, sy * sx * sz + cx * cz, cy * sx),
        Vec3(sy * cx * cz + sx * sz, sy * cx * sz - sx * cz, cy * cx),
    )


@kernel
def rotate_euler(v, euler):
    m = euler_matrix(euler)
    return m.x * v.x + m.y * v.y + m.z * v.z


@kernel
def rotate_euler_back(v, euler):
    m = euler_matrix(euler)
    return Vec3(dot(m.x, v), dot(m.y, v), dot(m.z, v))


@kernel
def mapping(kind, v, location, euler, scale):
    """The Mapping node; `kind` is a MappingKind, angles are in radians."""
    if kind == MappingKind.TEXTURE:
        return safe_divide3(rotate_euler_back(v - location, euler), scale)
    if kind == MappingKind.NORMAL:
        return safe_normalize(rotate_euler(safe_divide3(v, scale), euler))
    turned = rotate_euler(v * scale, euler)
    return turned + location if kind == MappingKind.POINT else turned


@kernel
def map_range(interpolation, v, from_min, from_max, to_min, to_max, steps, clamped):
    """Map Range of a vector, by component; `clamped` holds what is not smooth anyway in the second range."""
    d = safe_divide3(v - from_min, from_max - from_min)
    t = Vec3(
        scalar_math.interpolate(interpolation, d.x, steps.x),
        scalar_math.interpolate(interpolation, d.y, steps.y),
        scalar_math.interpolate(interpolation, d.z, steps.z),
    )
    mapped = to_min + t * (to_max - to_min)
    if not clamped:
        return mapped
    return Vec3(
        clamp_range(mapped.x, to_min.x, to_max.x),
        clamp_range(mapped.y, to_min.y, to_max.y),
        clamp_range(mapped.z, to_min.z, to_max.z),
    )
