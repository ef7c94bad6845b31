# SPDX-License-Identifier: GPL-3.0-or-later
"""Owen-scrambled Sobol points, computed by hashes: any sample of any pixel in any dimension, without tables.

Brent Burley: Practical Hash-based Owen Scrambling (JCGT 9(4), 2020). A path needs hundreds of dimensions, but Sobol
sequences are only good in the first few. So each *dimension* here, a number that names one decision on a path, is the
first two Sobol dimensions with a scrambling of its own, visited in an order of its own ("padding"). Each pair alone is
a (0, 2)-sequence: the first 2^k samples fill every elementary interval of area 2^-k exactly once.

Randomised, every single point is uniform, so that estimates have no bias at any sample count.
"""

from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.extending import intrinsic

from ..jit import kernel
from .rng import hash_combine, hash_u32, to_unit_float

LK_1, LK_2, LK_3 = np.uint32(0x3D20ADEA), np.uint32(0x05526C56), np.uint32(0x53A22864)
DIMENSION, SCRAMBLE_0, SCRAMBLE_1 = np.uint32(0x9E3779B9), np.uint32(0x7F4A7C15), np.uint32(0xF39CC060)
# Which bits move at each step of the multiplication by Pascal's triangle, below.
FOLDS = tuple(np.uint32(mask) for mask in (0xFF00FF00, 0xF0F0F0F0, 0xCCCCCCCC, 0xAAAAAAAA))


class Sampler(NamedTuple):
    """One sample of one pixel: what all its random numbers are made of."""

    seed: np.uint32  # of the pixel
    index: np.uint32  # number of the sample
    reversed_index: np.uint32  # its bits reversed: the form in which every draw needs it


@kernel
def make_sampler(x, y, index, seed):
    """The sampler of sample `index` (0, 1, 2 ...) in pixel (x, y) of a picture with that seed."""
    pixel = np.uint32((np.uint32(y) << np.uint32(16)) ^ np.uint32(x))
    return Sampler(hash_combine(hash_u32(np.uint32(seed)), pixel), np.uint32(index), reverse_bits(np.uint32(index)))


@kernel
def sample_2d(sampler, dimension):
    """Two numbers in [0, 1), well spread together over the samples of a pixel. `dimension`: any integer from 0."""
    seed = dimension_seed(sampler, dimension)
    index = shuffled_index(sampler, seed)
    u0 = to_unit_float(reverse_bits(permute_upwards(index, hash_u32(seed ^ SCRAMBLE_0))))
    u1 = to_unit_float(reverse_bits(permute_upwards(multiply_by_pascal(index), hash_u32(seed ^ SCRAMBLE_1))))
    return u0, u1


@kernel
def sample_1d(sampler, dimension):
    """The first number of `sample_2d`: a dimension is good for one or the other."""
    seed = dimension_seed(sampler, dimension)
    return to_unit_float(reverse_bits(permute_upwards(shuffled_index(sampler, seed), hash_u32(seed ^ SCRAMBLE_0))))


@kernel
def dimension_seed(sampler, dimension):
    """Independent 32 bits for each dimension of a pixel."""
    return hash_u32(np.uint32(sampler.seed + np.uint32(np.uint32(dimension) * DIMENSION)))


@kernel
def shuffled_index(sampler, seed):
    """A random order of the samples that keeps aligned blocks of 2^k together (Burley 2020, section 3.2)."""
    return reverse_bits(permute_upwards(sampler.reversed_index, seed))


@kernel
def permute_upwards(x, seed):
    """Flip each bit of `x` by a hash of the bits below it: Owen scrambling of the reversed number.

    The construction of Laine and Karras (2011, section 3.1), with the improved constants of
    Nathan Vegdahl (Building a Better LK Hash, 2021).
    """
    x = np.uint32(x ^ np.uint32(x * LK_1))
    x = np.uint32(x + seed)
    x = np.uint32(x * ((seed >> np.uint32(16)) | np.uint32(1)))
    x = np.uint32(x ^ np.uint32(x * LK_2))
    return np.uint32(x ^ np.uint32(x * LK_3))


@kernel
def multiply_by_pascal(index):
    """The second Sobol dimension with its bits reversed, as the first is `index` itself.

    Its generator matrix is Pascal's triangle modulo 2. By Lucas' theorem that is the 5-fold Kronecker power of
    [[1, 1], [0, 1]], so the product takes one step for each power (Ahmed 2024).
    """
    x = np.uint32(index ^ (index >> np.uint32(16)))
    x = np.uint32(x ^ ((x & FOLDS[0]) >> np.uint32(8)))
    x = np.uint32(x ^ ((x & FOLDS[1]) >> np.uint32(4)))
    x = np.uint32(x ^ ((x & FOLDS[2]) >> np.uint32(2)))
    return np.uint32(x ^ ((x & FOLDS[3]) >> np.uint32(1)))


@intrinsic
def _reverse_bits(typing_context, x):
    """Bit 0 becomes bit 31, as LLVM does it best on this machine."""

    def lower(context, builder, sig, args):
        i32 = ir.IntType(32)
        reverse = builder.module.declare_intrinsic("llvm.bitreverse", [i32], ir.FunctionType(i32, [i32]))
        return builder.call(reverse, [args[0]])

    return types.uint32(types.uint32), lower


if config.DISABLE_JIT:  # kernels as plain Python, for a debugger

    def reverse_bits(x):
        return np.uint32(int(f"{int(x):032b}"[::-1], 2))
else:
    reverse_bits = _reverse_bits
