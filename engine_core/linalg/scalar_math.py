# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations on numbers, as artists choose them: Blender's Math, Map Range and Clamp nodes, and the steps they share.

What an operation gives where it is not defined (a root of -1, a division by 0) is what Cycles gives: mostly 0, so that
one bad pixel does not spread.
"""

import math
from enum import IntEnum

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.extending import intrinsic

from ..jit import kernel

TAU = np.float32(2.0 * np.pi)
DEGREE = np.float32(np.pi / 180.0)
EPSILON = np.finfo(np.float32).eps  # of 1


class MathOp(IntEnum):
    """Operations of the Math node; names and numbers are Blender's."""

    ADD = 0
    SUBTRACT = 1
    MULTIPLY = 2
    DIVIDE = 3
    SINE = 4
    COSINE = 5
    TANGENT = 6
    ARCSINE = 7
    ARCCOSINE = 8
    ARCTANGENT = 9
    POWER = 10
    LOGARITHM = 11
    MINIMUM = 12
    MAXIMUM = 13
    ROUND = 14
    LESS_THAN = 15
    GREATER_THAN = 16
    MODULO = 17
    ABSOLUTE = 18
    ARCTAN2 = 19
    FLOOR = 20
    CEIL = 21
    FRACT = 22
    SQRT = 23
    INVERSE_SQRT = 24
    SIGN = 25
    EXPONENT = 26
    RADIANS = 27
    DEGREES = 28
    SINH = 29
    COSH = 30
    TANH = 31
    TRUNC = 32
    SNAP = 33
    WRAP = 34
    COMPARE = 35
    MULTIPLY_ADD = 36
    PINGPONG = 37
    SMOOTH_MIN = 38
    SMOOTH_MAX = 39
    FLOORED_MODULO = 40


class Interpolation(IntEnum):
    """How Map Range goes from one end to the other; names and numbers are Blender's."""

    LINEAR = 0
    STEPPED = 1
    SMOOTHSTEP = 2
    SMOOTHERSTEP = 3


@kernel
def evaluate(op, a, b, c):
    """The Math node: `op`, a MathOp, of up to three numbers."""
    if op == MathOp.ADD:
        return a + b
    if op == MathOp.SUBTRACT:
        return a - b
    if op == MathOp.MULTIPLY:
        return a * b
    if op == MathOp.DIVIDE:
        return safe_divide(a, b)
    if op == MathOp.MULTIPLY_ADD:
        return a * b + c
    if op == MathOp.POWER:
        return safe_power(a, b)
    if op == MathOp.LOGARITHM:
        return safe_divide(math.log(a), math.log(b)) if a > 0.0 and b > 0.0 else np.float32(0.0)
    if op == MathOp.SQRT:
        return math.sqrt(max(a, 0.0))
    if op == MathOp.INVERSE_SQRT:
        return 1.0 / math.sqrt(a) if a > 0.0 else np.float32(0.0)
    if op == MathOp.ABSOLUTE:
        return abs(a)
    if op == MathOp.EXPONENT:
        return math.exp(a)
    if op == MathOp.MINIMUM:
        return min(a, b)
    if op == MathOp.MAXIMUM:
        return max(a, b)
    if op == MathOp.LESS_THAN:
        return np.float32(a < b)
    if op == MathOp.GREATER_THAN:
        return np.float32(a > b)
    if op == MathOp.SIGN:
        return sign(a)
    if op == MathOp.COMPARE:
        return np.float32(a == b or abs(a - b) <= max(c, EPSILON))
    if op == MathOp.SMOOTH_MIN:
        return smooth_minimum(a, b, c)
    if op == MathOp.SMOOTH_MAX:
        return -smooth_minimum(-a, -b, c)
    if op == MathOp.ROUND:
        return np.floor(a + 0.5)
    if op == MathOp.FLOOR:
        return np.floor(a)
    if op == MathOp.CEIL:
        return np.ceil(a)
    if op == MathOp.TRUNC:
        return np.trunc(a)
    if op == MathOp.FRACT:
        return a - np.floor(a)
    if op == MathOp.MODULO:
        return safe_modulo(a, b)
    if op == MathOp.FLOORED_MODULO:
        return floored_modulo(a, b)
    if op == MathOp.WRAP:
        return wrap(a, b, c)
    if op == MathOp.SNAP:
        return np.floor(safe_divide(a, b)) * b
    if op == MathOp.PINGPONG:
        return pingpong(a, b)
    if op == MathOp.RADIANS:
        return a * DEGREE
    if op == MathOp.DEGREES:
        return a / DEGREE
    return trigonometry(op, a, b)


@kernel
def trigonometry(op, a, b):
    """Those of the Math node that deal with angles."""
    if op == MathOp.SINE:
        return math.sin(a)
    if op == MathOp.COSINE:
        return math.cos(a)
    if op == MathOp.TANGENT:
        return math.tan(a)
    if op == MathOp.ARCSINE:
        return math.asin(min(max(a, -1.0), 1.0))
    if op == MathOp.ARCCOSINE:
        return math.acos(min(max(a, -1.0), 1.0))
    if op == MathOp.ARCTANGENT:
        return math.atan(a)
    if op == MathOp.ARCTAN2:
        return math.atan2(a, b) if a != 0.0 or b != 0.0 else np.float32(0.0)
    if op == MathOp.SINH:
        return math.sinh(a)
    if op == MathOp.COSH:
        return math.cosh(a)
    if op == MathOp.TANH:
        return math.tanh(a)
    return np.float32(0.0)


@kernel
def map_range(interpolation, x, from_min, from_max, to_min, to_max, steps):
    """Map Range of a number, not clamped: as `x` runs over the first range, the result runs over the second."""
    if from_min == from_max:
        return np.float32(0.0)
    t = interpolate(interpolation, (x - from_min) / (from_max - from_min), steps)
    return to_min + t * (to_max - to_min)


@kernel
def interpolate(interpolation, t, steps):
    """How far the second range of Map Range is gone through, when the first is to the share `t`."""
    if interpolation == Interpolation.STEPPED:
        return np.floor(t * (steps + 1.0)) / steps if steps > 0.0 else np.float32(0.0)
    if interpolation == Interpolation.SMOOTHSTEP:
        return smoothstep(t)
    if interpolation == Interpolation.SMOOTHERSTEP:
        t = clamp(t, 0.0, 1.0)
        return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
    return t


@kernel
def clamp(x, low, high):
    """`x`, held between two limits; the upper one wins where they cross."""
    return min(max(x, low), high)


@kernel
def clamp_range(x, a, b):
    """`x`, held between two limits in either order."""
    return clamp(x, min(a, b), max(a, b))


# ---- The steps -------------------------------------------------------------------------------------------------------


@kernel
def safe_divide(a, b):
    """a / b, and 0 where b is 0."""
    return a / b if b != 0.0 else np.float32(0.0)


@kernel
def safe_power(a, b):
    """a to the power b: 1 where b is 0, and 0 where a is negative and b is not whole."""
    if b == 0.0:
        return np.float32(1.0)
    if a == 0.0 or (a < 0.0 and b != np.trunc(b)):
        return np.float32(0.0)
    return math.pow(a, b)


@kernel
def safe_modulo(a, b):
    """The remainder with the sign of `a`, and 0 where b is 0."""
    return remainder(a, b) if b != 0.0 else np.float32(0.0)


@kernel
def floored_modulo(a, b):
    """The remainder with the sign of `b`, and 0 where b is 0."""
    return a - np.floor(a / b) * b if b != 0.0 else np.float32(0.0)


@kernel
def wrap(x, high, low):
    """`x`, moved by whole ranges into low <= x < high."""
    return x - (high - low) * np.floor((x - low) / (high - low)) if high != low else low


@kernel
def pingpong(x, top):
    """A zigzag between 0 and `top`, 0 at x = 0."""
    if top == 0.0:
        return np.float32(0.0)
    t = (x - top) / (top * 2.0)
    return abs((t - np.floor(t)) * top * 2.0 - top)


@kernel
def sign(x):
    """-1, 0 or 1."""
    return np.float32(x > 0.0) - np.float32(x < 0.0)


@kernel
def smoothstep(t):
    """A cubic from 0 at t = 0 to 1 at t = 1, level there and beyond."""
    t = clamp(t, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


@kernel
def smooth_minimum(a, b, k):
    """The lesser of two, rounded off by a cubic where they are nearer than `k` (Quilez, "Smooth minimum")."""
    if k == 0.0:
        return min(a, b)
    h = max(k - abs(a - b), 0.0) / k
    return min(a, b) - h * h * h * k * np.float32(1.0 / 6.0)


@intrinsic
def _remainder(typing_context, a, b):
    lower = lambda context, builder, sig, args: builder.frem(*args)  # noqa: E731
    return types.float32(types.float32, types.float32), lower


@intrinsic
def _float_bits(typing_context, x):
    lower = lambda context, builder, sig, args: builder.bitcast(args[0], ir.IntType(32))  # noqa: E731
    return types.uint32(types.float32), lower


if config.DISABLE_JIT:  # kernels as plain Python, for a debugger

    def remainder(a, b):
        return np.fmod(np.float32(a), np.float32(b))

    def float_bits(x):
        return np.float32(x).view(np.uint32)
else:
    # `remainder(a, b)`: exactly, with the sign of `a`, as C's fmod. `float_bits(x)`: the 32 bits of a float.
    remainder, float_bits = _remainder, _float_bits
