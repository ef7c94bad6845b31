# SPDX-License-Identifier: GPL-3.0-or-later
"""Integer hashes, and numbers in [0, 1) made of 32 random bits.

numba widens every sum and product of uint32 to 64 bits. Each line here narrows its result again, so that the
machine code is 32-bit throughout, and the hashes are those of the papers.
"""

import numpy as np

from ..jit import kernel

LOWBIAS_1, LOWBIAS_2 = np.uint32(0x21F0AAAD), np.uint32(0xD35A2D97)
GOLDEN = np.uint32(0x9E3779B9)  # 2^32 over the golden ratio: keeps a number 0 from hashing to 0
TWO_TO_MINUS_24 = np.float32(2.0**-24)


@kernel
def hash_u32(x):
    """Scramble 32 bits: each input bit flips each output bit with probability near 1/2.

    "lowbias32" in the form of Wellons' hash prospector, constants by its user TheIronBorn (2018): two
    multiplications, bias 0.107. A bijection with hash_u32(0) = 0.
    """
    x = np.uint32(x)
    x = np.uint32((x ^ (x >> 16)) * LOWBIAS_1)
    x = np.uint32((x ^ (x >> 15)) * LOWBIAS_2)
    return np.uint32(x ^ (x >> 15))


@kernel
def hash_combine(seed, x):
    """A hash of two numbers of 32 bits; the order matters."""
    return hash_u32(np.uint32(hash_u32(np.uint32(np.uint32(x) + GOLDEN)) + np.uint32(seed)))


@kernel
def hash_float(a, b, c):
    """A random number in [0, 1) that belongs to three integers of 32 bits."""
    return to_unit_float(hash_combine(hash_combine(a, b), c))


@kernel
def to_unit_float(bits):
    """The upper 24 of 32 bits as a float32 in [0, 1): the largest value is 1 - 2 ** -24."""
    return np.float32(np.int32(np.uint32(bits) >> 8)) * TWO_TO_MINUS_24
