# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers and vectors: Math, Vector Math, Map Range, Clamp, Mix, and what takes colours and vectors apart."""

import numpy as np

from ..jit import kernel
from ..linalg import color, scalar_math, vector_math
from ..linalg.scalar_math import clamp, clamp_range
from ..linalg.vec3 import Vec3, luminance
from .opcodes import CLAMPED, CLAMPED_RESULT, Op, Range
from .operands import give_both, give_number, give_vector, number, vector

THIRD = np.float32(1.0 / 3.0)


def run(scene, op, point, registers):
    """One step: see `opcodes.SIGNATURES`."""
    code = op.code
    if code == Op.MATH:
        a, b, c = number(op, registers, 0), number(op, registers, 1), number(op, registers, 2)
        x = scalar_math.evaluate(op.mode & ~CLAMPED_RESULT, a, b, c)
        give_number(op, registers, saturate(x) if op.mode & CLAMPED_RESULT else x)
    elif code == Op.VECTOR_MATH:
        a, b, c = vector(op, registers, 0), vector(op, registers, 1), vector(op, registers, 2)
        both = vector_math.evaluate(op.mode, a, b, c, number(op, registers, 3))
        give_both(op, registers, both.vector, both.value)
    elif code == Op.MIX_NUMBER:
        t, a = number(op, registers, 0), number(op, registers, 1)
        t = saturate(t) if op.mode & CLAMPED else t
        give_number(op, registers, a * (1.0 - t) + number(op, registers, 2) * t)
    elif code == Op.MIX_VECTOR:
        t, a = vector(op, registers, 0), vector(op, registers, 1)
        t = color.saturate(t) if op.mode & CLAMPED else t
        give_vector(op, registers, a + (vector(op, registers, 2) - a) * t)
    elif code == Op.COMBINE:
        give_vector(op, registers, Vec3(number(op, registers, 0), number(op, registers, 1), number(op, registers, 2)))
    elif code == Op.AVERAGE:
        v = vector(op, registers, 0)
        give_number(op, registers, (v.x + v.y + v.z) * THIRD)
    elif code == Op.LUMINANCE:
        give_number(op, registers, luminance(vector(op, registers, 0)))
    elif code == Op.SCALE:
        give_vector(op, registers, vector(op, registers, 0) * number(op, registers, 1))
    elif code == Op.CLAMP:
        x, low, high = number(op, registers, 0), number(op, registers, 1), number(op, registers, 2)
        give_number(op, registers, clamp_range(x, low, high) if op.mode == 1 else clamp(x, low, high))
    elif code == Op.MAP_RANGE:
        map_range(op, registers)
    elif code == Op.MAP_RANGE_VECTOR:
        low, high = vector(op, registers, 3), vector(op, registers, 4)
        v, a, b = vector(op, registers, 0), vector(op, registers, 1), vector(op, registers, 2)
        steps, kind = vector(op, registers, 5), op.mode & ~CLAMPED
        give_vector(op, registers, vector_math.map_range(kind, v, a, b, low, high, steps, is_clamped(op)))


@kernel
def saturate(x):
    return min(max(x, 0.0), 1.0)


@kernel
def is_clamped(op):
    """Whether Map Range has to hold what it gives in the second range; what is smooth stays there anyway."""
    return op.mode & CLAMPED != 0 and op.mode & ~CLAMPED <= Range.STEPPED


@kernel
def map_range(op, registers):
    x, a, b = number(op, registers, 0), number(op, registers, 1), number(op, registers, 2)
    low, high, steps = number(op, registers, 3), number(op, registers, 4), number(op, registers, 5)
    x = scalar_math.map_range(op.mode & ~CLAMPED, x, a, b, low, high, steps)
    give_number(op, registers, clamp_range(x, low, high) if is_clamped(op) else x)
