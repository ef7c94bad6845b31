# SPDX-License-Identifier: GPL-3.0-or-later
"""The hashes of `texture.hash`, of eight points at once, in lanes."""

from typing import NamedTuple

import numpy as np

from ..jit import inlined_kernel, kernel
from ..linalg.simd import f32x8, splat8
from ..linalg.simd_int import rotate, shift_right, splat_int8, to_floats, unsigned_to_floats
from .hash import PCG_FACTOR, PCG_MASK, PCG_TERM, PCG_TO_UNIT_FLOAT, START, TO_UNIT_FLOAT

ZERO = np.float32(0.0)


class Random4Lanes(NamedTuple):
    """Four numbers in 0 to 1, for each of eight points."""

    x: f32x8
    y: f32x8
    z: f32x8
    w: f32x8


@inlined_kernel
def lookup3(x, y, z, count):
    """Jenkins' hash of one to three integers, those beyond `count` being 0."""
    start = splat_int8(np.int32(START + 4 * count))
    return _final(start + x, start + y, start + z)


@kernel
def lookup3_of_4(x, y, z, w):
    start = splat_int8(np.int32(START + 16))
    a, b, c = start + x, start + y, start + z
    a = (a - c) ^ rotate(c, 4)
    c = c + b
    b = (b - a) ^ rotate(a, 6)
    a = a + c
    c = (c - b) ^ rotate(b, 8)
    b = b + a
    a = (a - c) ^ rotate(c, 16)
    c = c + b
    b = (b - a) ^ rotate(a, 19)
    a = a + c
    c = (c - b) ^ rotate(b, 4)
    b = b + a
    return _final(a + w, b, c)


@inlined_kernel
def _final(a, b, c):
    c = (c ^ b) - rotate(b, 14)
    a = (a ^ c) - rotate(c, 11)
    b = (b ^ a) - rotate(a, 25)
    c = (c ^ b) - rotate(b, 16)
    a = (a ^ c) - rotate(c, 4)
    b = (b ^ a) - rotate(a, 14)
    return (c ^ b) - rotate(b, 24)


@inlined_kernel
def unit_floats(h):
    """32 bits as numbers in 0 to 1."""
    return unsigned_to_floats(h) * splat8(TO_UNIT_FLOAT)


@inlined_kernel
def pcg2(x, y):
    x, y = _pcg_step(x), _pcg_step(y)
    factor = splat_int8(PCG_FACTOR)
    x = x + y * factor
    y = y + x * factor
    x, y = _pcg_fold(x), _pcg_fold(y)
    x = x + y * factor
    y = y + x * factor
    return Random4Lanes(_pcg_floats(x), _pcg_floats(y), splat8(ZERO), splat8(ZERO))


@inlined_kernel
def pcg3(x, y, z):
    x, y, z = _pcg_step(x), _pcg_step(y), _pcg_step(z)
    x = x + y * z
    y = y + z * x
    z = z + x * y
    x, y, z = _pcg_fold(x), _pcg_fold(y), _pcg_fold(z)
    x = x + y * z
    y = y + z * x
    z = z + x * y
    return Random4Lanes(_pcg_floats(x), _pcg_floats(y), _pcg_floats(z), splat8(ZERO))


@inlined_kernel
def pcg4(x, y, z, w):
    x, y, z, w = _pcg_step(x), _pcg_step(y), _pcg_step(z), _pcg_step(w)
    x = x + y * w
    y = y + z * x
    z = z + x * y
    w = w + y * z
    x, y, z, w = _pcg_fold(x), _pcg_fold(y), _pcg_fold(z), _pcg_fold(w)
    x = x + y * w
    y = y + z * x
    z = z + x * y
    w = w + y * z
    return Random4Lanes(_pcg_floats(x), _pcg_floats(y), _pcg_floats(z), _pcg_floats(w))


@inlined_kernel
def _pcg_step(x):
    return x * splat_int8(PCG_FACTOR) + splat_int8(PCG_TERM)


@inlined_kernel
def _pcg_fold(x):
    return x ^ shift_right(x, 16)


@inlined_kernel
def _pcg_floats(x):
    return to_floats(x & splat_int8(PCG_MASK)) * splat8(PCG_TO_UNIT_FLOAT)
