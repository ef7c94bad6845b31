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
from ..settings import UNIFORM_SAMPLES, SamplerKind
from .rng import hash_combine, hash_u32, to_unit_float

LK_1, LK_2, LK_3 = np.uint32(0x3D20ADEA), np.uint32(0x05526C56), np.uint32(0x53A22864)
DIMENSION, SCRAMBLE_0, SCRAMBLE_1 = np.uint32(0x9E3779B9), np.uint32(0x7F4A7C15), np.uint32(0xF39CC060)
# Which bits stay at each step of spreading them, and move at each step of the multiplication by Pascal's triangle.
SPREADS = tuple(np.uint32(mask) for mask in (0x00FF00FF, 0x0F0F0F0F, 0x33333333, 0x55555555))
FOLDS = tuple(np.uint32(mask) for mask in (0xFF00FF00, 0xF0F0F0F0, 0xCCCCCCCC, 0xAAAAAAAA))


class Sequence(NamedTuple):
    """The samples of one pixel."""

    seed: np.uint32
    first: np.uint32  # number of the pixel's first sample in a sequence that it shares with others
    independent: bool  # SamplerKind.RANDOM


class Sampler(NamedTuple):
    """One sample of one pixel: what all its random numbers are made of."""

    seed: np.uint32
    reversed_index: np.uint32  # number of the sample, its bits reversed: the form in which every draw needs it


@kernel
def make_sequence(settings, x, y):
    """The samples of pixel (x, y) of the frame.

    All pixels of a large square share one sequence: each takes the next 2^bits of its points, along a Morton curve.
    So neighbours' points fill each other's gaps, and their errors tend to cancel: blue noise, and free of cost
    (Ahmed and Wonka 2020, with base 2 instead of 4). The points of each pixel are as well spread as ever.
    """
    x, y, seed = np.uint32(x), np.uint32(y), hash_u32(np.uint32(settings.seed))
    if settings.sampler == SamplerKind.RANDOM:
        return Sequence(hash_combine(seed, np.uint32((y << np.uint32(16)) ^ x)), np.uint32(0), True)
    bits = index_bits(settings)
    side = np.uint32((32 - bits) // 2)  # log2 of the side of the square
    square = np.uint32(((y >> side) << np.uint32(16)) ^ (x >> side))
    mask = np.uint32((np.uint32(1) << side) - np.uint32(1))
    pixel = np.uint32(spread_bits(np.uint32(x & mask)) | np.uint32(spread_bits(np.uint32(y & mask)) << np.uint32(1)))
    return Sequence(hash_combine(seed, square), np.uint32(pixel << np.uint32(bits)), False)


@kernel
def index_bits(settings):
    """log2 of the largest number of samples that a pixel may get: adaptive sampling may give it four times its share.

    The more a pixel might take, the less neighbours share: adaptive pictures have no blue noise.
    """
    bits = 0
    while (1 << bits) < settings.samples:
        bits += 1
    return bits + 2 if settings.adaptive != 0 and settings.samples > UNIFORM_SAMPLES else bits


@kernel
def spread_bits(x):
    """The lower 16 bits of `x` on the even places."""
    x = np.uint32((x | (x << np.uint32(8))) & SPREADS[0])
    x = np.uint32((x | (x << np.uint32(4))) & SPREADS[1])
    x = np.uint32((x | (x << np.uint32(2))) & SPREADS[2])
    return np.uint32((x | (x << np.uint32(1))) & SPREADS[3])


@kernel
def make_sampler(sequence, index):
    """The sampler of sample `index` (0, 1, 2 ...) of a pixel.

    Independent samples are each the first point of a sequence of their own.
    """
    if sequence.independent:
        return Sampler(hash_combine(sequence.seed, np.uint32(index)), np.uint32(0))
    return Sampler(sequence.seed, reverse_bits(np.uint32(sequence.first + np.uint32(index))))


@kernel
def half_of(sampler, half):
    """The samplers 0 and 1 of two samples that take the place of one, for part of its dimensions.

    Number n becomes 2 n and 2 n + 1: all the halves together are as well spread as if there were twice as many samples.
    """
    bit = np.uint32(np.uint32(half) << np.uint32(31))
    return Sampler(sampler.seed, np.uint32(np.uint32(sampler.reversed_index >> np.uint32(1)) | bit))


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
