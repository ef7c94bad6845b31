# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers and vectors: Math, Vector Math, Map Range, Clamp, Mix; as in Cycles where arguments make no sense."""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, Vec3, cross, dot, length, luminance
from .opcodes import CLAMPED, CLAMPED_RESULT, Math, Op, Range, VectorMath
from .operands import give_both, give_number, give_vector, number, vector

ZERO, ONE = np.float32(0.0), np.float32(1.0)
RADIAN, DEGREE = np.float32(math.pi / 180.0), np.float32(180.0 / math.pi)
EPSILON = np.float32(2.0**-23)


def run(scene, op, point, registers):
    """One step: see `opcodes.SIGNATURES`."""
    code = op.code
    if code == Op.MATH:
        x = calculate(
            op.mode & ~CLAMPED_RESULT, number(op, registers, 0), number(op, registers, 1), number(op, registers, 2)
        )
        if op.mode & CLAMPED_RESULT:
            x = saturate(x)
        give_number(op, registers, x)
    elif code == Op.VECTOR_MATH:
        vector_math(op, registers)
    elif code == Op.CLAMP:
        give_number(op, registers, clamp_mode(op, number(op, registers, 0), registers))
    elif code == Op.MAP_RANGE:
        map_range(op, registers)
    elif code == Op.MAP_RANGE_VECTOR:
        map_range_vector(op, registers)
    elif code == Op.MIX_NUMBER:
        t = number(op, registers, 0)
        if op.mode & CLAMPED:
            t = saturate(t)
        a = number(op, registers, 1)
        give_number(op, registers, a * (1.0 - t) + number(op, registers, 2) * t)
    elif code == Op.MIX_VECTOR:
        t = vector(op, registers, 0)
        if op.mode & CLAMPED:
            t = Vec3(saturate(t.x), saturate(t.y), saturate(t.z))
        a = vector(op, registers, 1)
        give_vector(op, registers, a + (vector(op, registers, 2) - a) * t)
    elif code == Op.COMBINE:
        give_vector(op, registers, Vec3(number(op, registers, 0), number(op, registers, 1), number(op, registers, 2)))
    elif code == Op.AVERAGE:
        v = vector(op, registers, 0)
        give_number(op, registers, (v.x + v.y + v.z) * np.float32(1.0 / 3.0))
    elif code == Op.LUMINANCE:
        give_number(op, registers, luminance(vector(op, registers, 0)))
    elif code == Op.SCALE:
        give_vector(op, registers, vector(op, registers, 0) * number(op, registers, 1))


# ---- Numbers ---------------------------------------------------------------------------------------------------------


@kernel
def saturate(x):
    return min(max(x, ZERO), ONE)


@kernel
def divide(a, b):
    """a / b; 0 where that is nothing."""
    return a / b if b != 0.0 else ZERO


@kernel
def power(a, b):
    """a ** b; 0 for fractional powers of negative numbers."""
    if b == 0.0:
        return ONE
    if a == 0.0:
        return ZERO
    if a < 0.0:
        if b != np.floor(b):
            return ZERO
        magnitude = (-a) ** b
        return magnitude if np.fmod(-b, 2.0) == 0.0 else -magnitude
    return a**b


@kernel
def modulo(a, b):
    return np.fmod(a, b) if b != 0.0 else ZERO


@kernel
def wrap(a, high, low):
    span = high - low
    return a - span * np.floor((a - low) / span) if span != 0.0 else low


@kernel
def snap(a, b):
    return np.floor(divide(a, b)) * b


@kernel
def sign(a):
    return ZERO if a == 0.0 else math.copysign(ONE, a)


@kernel
def smooth_minimum(a, b, distance):
    if distance == 0.0:
        return min(a, b)
    h = max(distance - abs(a - b), ZERO) / distance
    return min(a, b) - h * h * h * distance * np.float32(1.0 / 6.0)


@kernel
def calculate(mode, a, b, c):
    """Blender's Math node."""
    if mode < Math.LESS_THAN:
        return arithmetic(mode, a, b, c)
    if mode < Math.SINE:
        return comparison(mode, a, b, c)
    return trigonometry(mode, a, b)


@kernel
def arithmetic(mode, a, b, c):
    if mode == Math.ADD:
        return a + b
    if mode == Math.SUBTRACT:
        return a - b
    if mode == Math.MULTIPLY:
        return a * b
    if mode == Math.DIVIDE:
        return divide(a, b)
    if mode == Math.MULTIPLY_ADD:
        return a * b + c
    if mode == Math.POWER:
        return power(a, b)
    if mode == Math.LOGARITHM:
        return divide(math.log(a), math.log(b)) if a > 0.0 and b > 0.0 else ZERO
    if mode == Math.SQRT:
        return math.sqrt(max(a, ZERO))
    if mode == Math.INVERSE_SQRT:
        return 1.0 / math.sqrt(a) if a > 0.0 else ZERO
    if mode == Math.ABSOLUTE:
        return abs(a)
    if mode == Math.EXPONENT:
        return math.exp(a)
    if mode == Math.MINIMUM:
        return min(a, b)
    return max(a, b)


@kernel
def comparison(mode, a, b, c):
    if mode == Math.LESS_THAN:
        return ONE if a < b else ZERO
    if mode == Math.GREATER_THAN:
        return ONE if a > b else ZERO
    if mode == Math.SIGN:
        return sign(a)
    if mode == Math.COMPARE:
        return ONE if a == b or abs(a - b) <= max(c, EPSILON) else ZERO
    if mode == Math.SMOOTH_MIN:
        return smooth_minimum(a, b, c)
    if mode == Math.SMOOTH_MAX:
        return -smooth_minimum(-a, -b, c)
    if mode == Math.ROUND:
        return np.floor(a + 0.5)
    if mode == Math.FLOOR:
        return np.floor(a)
    if mode == Math.CEIL:
        return np.ceil(a)
    if mode == Math.TRUNC:
        return np.floor(a) if a >= 0.0 else np.ceil(a)
    if mode == Math.FRACT:
        return a - np.floor(a)
    if mode == Math.MODULO:
        return modulo(a, b)
    if mode == Math.FLOORED_MODULO:
        return a - np.floor(a / b) * b if b != 0.0 else ZERO
    if mode == Math.WRAP:
        return wrap(a, b, c)
    if mode == Math.SNAP:
        return snap(a, b)
    if b == 0.0:
        return ZERO
    x = (a - b) / (b * 2.0)
    return abs((x - np.floor(x)) * b * 2.0 - b)  # PINGPONG


@kernel
def trigonometry(mode, a, b):
    if mode == Math.SINE:
        return math.sin(a)
    if mode == Math.COSINE:
        return math.cos(a)
    if mode == Math.TANGENT:
        return math.tan(a)
    if mode == Math.ARCSINE:
        return math.asin(min(max(a, -1.0), 1.0))
    if mode == Math.ARCCOSINE:
        return math.acos(min(max(a, -1.0), 1.0))
    if mode == Math.ARCTANGENT:
        return math.atan(a)
    if mode == Math.ARCTAN2:
        return math.atan2(a, b)
    if mode == Math.SINH:
        return math.sinh(a)
    if mode == Math.COSH:
        return math.cosh(a)
    if mode == Math.TANH:
        return math.tanh(a)
    return a * (RADIAN if mode == Math.RADIANS else DEGREE)


# ---- Vectors ---------------------------------------------------------------------------------------------------------


@kernel
def unit(v):
    """`v` made unit; zero stays zero."""
    size = length(v)
    return v * (1.0 / size) if size > 0.0 else BLACK


@kernel
def vector_math(op, registers):
    a, b, c = vector(op, registers, 0), vector(op, registers, 1), vector(op, registers, 2)
    mode, x, v = op.mode, ZERO, BLACK
    if mode == VectorMath.DOT_PRODUCT:
        x = dot(a, b)
    elif mode == VectorMath.DISTANCE:
        x = length(a - b)
    elif mode == VectorMath.LENGTH:
        x = length(a)
    elif mode == VectorMath.ADD:
        v = a + b
    elif mode == VectorMath.SUBTRACT:
        v = a - b
    elif mode == VectorMath.MULTIPLY:
        v = a * b
    elif mode == VectorMath.MULTIPLY_ADD:
        v = a * b + c
    elif mode == VectorMath.SCALE:
        v = a * number(op, registers, 3)
    elif mode == VectorMath.NORMALIZE:
        v = unit(a)
    elif mode == VectorMath.CROSS_PRODUCT:
        v = cross(a, b)
    elif mode == VectorMath.PROJECT:
        v = b * divide(dot(a, b), dot(b, b))
    elif mode == VectorMath.REFLECT:
        n = unit(b)
        v = a - n * (2.0 * dot(a, n))
    elif mode == VectorMath.REFRACT:
        v = refracted(a, unit(b), number(op, registers, 3))
    elif mode == VectorMath.FACEFORWARD:
        v = a if dot(c, b) < 0.0 else -a
    else:
        v = Vec3(
            component_math(mode, a.x, b.x, c.x),
            component_math(mode, a.y, b.y, c.y),
            component_math(mode, a.z, b.z, c.z),
        )
    give_both(op, registers, v, x)


@kernel
def refracted(a, n, eta):
    cosine = dot(n, a)
    k = 1.0 - eta * eta * (1.0 - cosine * cosine)
    return a * eta - n * (eta * cosine + math.sqrt(k)) if k >= 0.0 else BLACK


@kernel
def component_math(mode, a, b, c):
    if mode == VectorMath.DIVIDE:
        return divide(a, b)
    if mode == VectorMath.ABSOLUTE:
        return abs(a)
    if mode == VectorMath.POWER:
        return power(a, b)
    if mode == VectorMath.SIGN:
        return sign(a)
    if mode == VectorMath.MINIMUM:
        return min(a, b)
    if mode == VectorMath.MAXIMUM:
        return max(a, b)
    if mode == VectorMath.FLOOR:
        return np.floor(a)
    if mode == VectorMath.CEIL:
        return np.ceil(a)
    if mode == VectorMath.FRACTION:
        return a - np.floor(a)
    if mode == VectorMath.MODULO:
        return modulo(a, b)
    if mode == VectorMath.WRAP:
        return wrap(a, b, c)
    if mode == VectorMath.SNAP:
        return snap(a, b)
    if mode == VectorMath.SINE:
        return math.sin(a)
    if mode == VectorMath.COSINE:
        return math.cos(a)
    if mode == VectorMath.ROUND:
        return np.floor(a + 0.5)
    return math.tan(a)


# ---- Ranges ----------------------------------------------------------------------------------------------------------


@kernel
def clamp_between(x, low, high):
    """Whichever way round the two limits are."""
    return min(max(x, min(low, high)), max(low, high))


@kernel
def clamp_mode(op, x, registers):
    low, high = number(op, registers, 1), number(op, registers, 2)
    return clamp_between(x, low, high) if op.mode == 1 else min(max(x, low), high)


@kernel
def smoothstep(low, high, x):
    t = saturate(divide(x - low, high - low)) if high != low else (ONE if x >= high else ZERO)
    return t * t * (3.0 - 2.0 * t)


@kernel
def smootherstep(low, high, x):
    t = saturate(divide(x - low, high - low))
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)


@kernel
def mapped(mode, x, from_low, from_high, to_low, to_high, steps):
    """Blender's Map Range of one number."""
    kind = mode & ~CLAMPED
    if from_low == from_high:
        return to_low * 0.0
    if kind == Range.SMOOTHSTEP:
        t = smoothstep(from_low, from_high, x) if from_low < from_high else 1.0 - smoothstep(from_high, from_low, x)
    elif kind == Range.SMOOTHERSTEP:
        t = smootherstep(from_low, from_high, x) if from_low < from_high else 1.0 - smootherstep(from_high, from_low, x)
    else:
        t = (x - from_low) / (from_high - from_low)
        if kind == Range.STEPPED:
            t = np.floor(t * (steps + 1.0)) / steps if steps > 0.0 else ZERO
    x = to_low + t * (to_high - to_low)
    return clamp_between(x, to_low, to_high) if mode & CLAMPED else x


@kernel
def map_range(op, registers):
    x = mapped(
        op.mode,
        number(op, registers, 0),
        number(op, registers, 1),
        number(op, registers, 2),
        number(op, registers, 3),
        number(op, registers, 4),
        number(op, registers, 5),
    )
    give_number(op, registers, x)


@kernel
def map_range_vector(op, registers):
    x, a, b = vector(op, registers, 0), vector(op, registers, 1), vector(op, registers, 2)
    c, d, steps = vector(op, registers, 3), vector(op, registers, 4), vector(op, registers, 5)
    mapped_x = mapped(op.mode, x.x, a.x, b.x, c.x, d.x, steps.x)
    mapped_y = mapped(op.mode, x.y, a.y, b.y, c.y, d.y, steps.y)
    mapped_z = mapped(op.mode, x.z, a.z, b.z, c.z, d.z, steps.z)
    give_vector(op, registers, Vec3(mapped_x, mapped_y, mapped_z))
