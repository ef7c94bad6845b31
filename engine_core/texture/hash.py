# SPDX-License-Identifier: GPL-3.0-or-later
"""Random numbers that belong to points of a lattice: the hashes on which Blender's procedural textures stand.

A texture has to look the same in every renderer, so these are not free to choose. Noise, White Noise, Gabor and 1D
Voronoi use Jenkins' lookup3 (2006); Voronoi in more dimensions uses PCG (Jarzynski and Olano, "Hash Functions for GPU
Rendering", 2020), on signed integers.

numba widens every sum and product of integers to 64 bits, so each line narrows its result again.
"""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.scalar_math import float_bits
from ..linalg.vec3 import Vec3

START = np.uint32(0xDEADBEEF + 13)  # lookup3's, plus four for each number that is hashed
ZERO = np.uint32(0)
TO_UNIT_FLOAT = np.float32(1.0 / 0xFFFFFFFF)  # of 32 bits, both ends included
PCG_FACTOR, PCG_TERM = np.int32(1664525), np.int32(1013904223)
PCG_MASK = np.int32(0x7FFFFFFF)
PCG_TO_UNIT_FLOAT = np.float32(1.0 / 0x7FFFFFFF)


class Random4(NamedTuple):
    """Four numbers in 0 to 1."""

    x: np.float32
    y: np.float32
    z: np.float32
    w: np.float32


# ---- Jenkins' lookup3, of one to four numbers of 32 bits -------------------------------------------------------------


@kernel
def hash1(x):
    start = np.uint32(START + 4)
    return _final(np.uint32(start + x), start, start)


@kernel
def hash2(x, y):
    start = np.uint32(START + 8)
    return _final(np.uint32(start + x), np.uint32(start + y), start)


@kernel
def hash3(x, y, z):
    start = np.uint32(START + 12)
    return _final(np.uint32(start + x), np.uint32(start + y), np.uint32(start + z))


@kernel
def hash4(x, y, z, w):
    start = np.uint32(START + 16)
    a, b, c = np.uint32(start + x), np.uint32(start + y), np.uint32(start + z)
    a = np.uint32(np.uint32(a - c) ^ _rotate(c, 4))
    c = np.uint32(c + b)
    b = np.uint32(np.uint32(b - a) ^ _rotate(a, 6))
    a = np.uint32(a + c)
    c = np.uint32(np.uint32(c - b) ^ _rotate(b, 8))
    b = np.uint32(b + a)
    a = np.uint32(np.uint32(a - c) ^ _rotate(c, 16))
    c = np.uint32(c + b)
    b = np.uint32(np.uint32(b - a) ^ _rotate(a, 19))
    a = np.uint32(a + c)
    c = np.uint32(np.uint32(c - b) ^ _rotate(b, 4))
    b = np.uint32(b + a)
    return _final(np.uint32(a + w), b, c)


@kernel
def _final(a, b, c):
    c = np.uint32(np.uint32(c ^ b) - _rotate(b, 14))
    a = np.uint32(np.uint32(a ^ c) - _rotate(c, 11))
    b = np.uint32(np.uint32(b ^ a) - _rotate(a, 25))
    c = np.uint32(np.uint32(c ^ b) - _rotate(b, 16))
    a = np.uint32(np.uint32(a ^ c) - _rotate(c, 4))
    b = np.uint32(np.uint32(b ^ a) - _rotate(a, 14))
    return np.uint32(np.uint32(c ^ b) - _rotate(b, 24))


@kernel
def _rotate(x, n):
    return np.uint32(np.uint32(x << np.uint32(n)) | np.uint32(x >> np.uint32(32 - n)))


# ---- Of floats, by their bits, to numbers in 0 to 1 ------------------------------------------------------------------


@kernel
def random_of_1(x):
    return to_unit_float(hash1(float_bits(x)))


@kernel
def random_of_2(x, y):
    return to_unit_float(hash2(float_bits(x), float_bits(y)))


@kernel
def random_of_3(x, y, z):
    return to_unit_float(hash3(float_bits(x), float_bits(y), float_bits(z)))


@kernel
def random_of_4(x, y, z, w):
    return to_unit_float(hash4(float_bits(x), float_bits(y), float_bits(z), float_bits(w)))


@kernel
def to_unit_float(bits):
    return np.float32(bits) * TO_UNIT_FLOAT


@kernel
def random(x, y, z, w, dimensions):
    """Of the first one to four floats."""
    if dimensions == 1:
        return random_of_1(x)
    if dimensions == 2:
        return random_of_2(x, y)
    if dimensions == 3:
        return random_of_3(x, y, z)
    return random_of_4(x, y, z, w)


@kernel
def random_color(x, y, z, w, dimensions):
    """Three numbers of the first one to four floats; red is `random`.

    The others hash one float more, or, where there are four already, the four in another order.
    """
    one, two = np.float32(1.0), np.float32(2.0)
    if dimensions == 1:
        return Vec3(random_of_1(x), random_of_2(x, one), random_of_2(x, two))
    if dimensions == 2:
        return Vec3(random_of_2(x, y), random_of_3(x, y, one), random_of_3(x, y, two))
    if dimensions == 3:
        return Vec3(random_of_3(x, y, z), random_of_4(x, y, z, one), random_of_4(x, y, z, two))
    return Vec3(random_of_4(x, y, z, w), random_of_4(z, x, w, y), random_of_4(w, z, y, x))


# ---- PCG, of two to four integers ------------------------------------------------------------------------------------


@kernel
def pcg2(x, y):
    """Two numbers in 0 to 1 that belong to two integers."""
    x, y = _pcg_step(x), _pcg_step(y)
    x = np.int32(x + np.int32(y * PCG_FACTOR))
    y = np.int32(y + np.int32(x * PCG_FACTOR))
    x, y = _pcg_fold(x), _pcg_fold(y)
    x = np.int32(x + np.int32(y * PCG_FACTOR))
    y = np.int32(y + np.int32(x * PCG_FACTOR))
    return Random4(_pcg_float(x), _pcg_float(y), np.float32(0.0), np.float32(0.0))


@kernel
def pcg3(x, y, z):
    """Three numbers in 0 to 1 that belong to three integers."""
    x, y, z = _pcg_step(x), _pcg_step(y), _pcg_step(z)
    x = np.int32(x + np.int32(y * z))
    y = np.int32(y + np.int32(z * x))
    z = np.int32(z + np.int32(x * y))
    x, y, z = _pcg_fold(x), _pcg_fold(y), _pcg_fold(z)
    x = np.int32(x + np.int32(y * z))
    y = np.int32(y + np.int32(z * x))
    z = np.int32(z + np.int32(x * y))
    return Random4(_pcg_float(x), _pcg_float(y), _pcg_float(z), np.float32(0.0))


@kernel
def pcg4(x, y, z, w):
    """Four numbers in 0 to 1 that belong to four integers."""
    x, y, z, w = _pcg_step(x), _pcg_step(y), _pcg_step(z), _pcg_step(w)
    x = np.int32(x + np.int32(y * w))
    y = np.int32(y + np.int32(z * x))
    z = np.int32(z + np.int32(x * y))
    w = np.int32(w + np.int32(y * z))
    x, y, z, w = _pcg_fold(x), _pcg_fold(y), _pcg_fold(z), _pcg_fold(w)
    x = np.int32(x + np.int32(y * w))
    y = np.int32(y + np.int32(z * x))
    z = np.int32(z + np.int32(x * y))
    w = np.int32(w + np.int32(y * z))
    return Random4(_pcg_float(x), _pcg_float(y), _pcg_float(z), _pcg_float(w))


@kernel
def _pcg_step(x):
    return np.int32(np.int32(x * PCG_FACTOR) + PCG_TERM)


@kernel
def _pcg_fold(x):
    return np.int32(x ^ (x >> np.int32(16)))


@kernel
def _pcg_float(x):
    return np.float32(np.int32(x & PCG_MASK)) * PCG_TO_UNIT_FLOAT
