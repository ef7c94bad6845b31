# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers that `sobol` draws for a vertex of a path, in its four dimensions at once, in lanes.

A draw is one long chain of multiplications, each of which waits for the one before. Eight chains side by side take as
long as one.
"""

from typing import NamedTuple

import numpy as np

from ..jit import inlined_kernel, kernel
from ..linalg.simd import lane, splat8
from ..linalg.simd_int import choose, lane_bit, lane_numbers, reverse_bits8, shift_down, splat_int8, to_floats
from .rng import LOWBIAS_1, LOWBIAS_2, TWO_TO_MINUS_24
from .sobol import DIMENSION, FOLDS, LK_1, LK_2, LK_3, SCRAMBLE_0, SCRAMBLE_1

DIMENSIONS_PER_VERTEX = 4


class VertexSample(NamedTuple):
    """What a vertex needs: two choices, a point on a light or more choices, a direction, and Russian roulette."""

    light: np.float32  # which light
    lobe: np.float32
    light_u0: np.float32
    light_u1: np.float32
    u0: np.float32
    u1: np.float32
    roulette: np.float32


@kernel
def sample_vertex(sampler, dimension):
    """`sobol.sample_2d` in `dimension` and the three that follow; of the last only the first number."""
    number = splat_int8(np.int32(dimension)) + shift_down(lane_numbers(), 1)
    seed = _hash(_splat(sampler.seed) + number * _splat(DIMENSION))
    index = reverse_bits8(_permute_upwards(_splat(sampler.reversed_index), seed))
    is_second = lane_bit(0) == splat_int8(np.int32(1))
    scramble = choose(is_second, _splat(SCRAMBLE_1), _splat(SCRAMBLE_0))
    point = choose(is_second, _multiply_by_pascal(index), index)
    bits = reverse_bits8(_permute_upwards(point, _hash(seed ^ scramble)))
    u = to_floats(shift_down(bits, 8)) * splat8(TWO_TO_MINUS_24)
    return VertexSample(
        lane(u, np.int32(0)),
        lane(u, np.int32(1)),
        lane(u, np.int32(2)),
        lane(u, np.int32(3)),
        lane(u, np.int32(4)),
        lane(u, np.int32(5)),
        lane(u, np.int32(6)),
    )


@inlined_kernel
def _splat(bits):
    return splat_int8(np.int32(np.uint32(bits)))


@inlined_kernel
def _hash(x):
    x = (x ^ shift_down(x, 16)) * _splat(LOWBIAS_1)
    x = (x ^ shift_down(x, 15)) * _splat(LOWBIAS_2)
    return x ^ shift_down(x, 15)


@inlined_kernel
def _permute_upwards(x, seed):
    x = x ^ x * _splat(LK_1)
    x = x + seed
    x = x * (shift_down(seed, 16) | splat_int8(np.int32(1)))
    x = x ^ x * _splat(LK_2)
    return x ^ x * _splat(LK_3)


@inlined_kernel
def _multiply_by_pascal(x):
    x = x ^ shift_down(x, 16)
    x = x ^ shift_down(x & _splat(FOLDS[0]), 8)
    x = x ^ shift_down(x & _splat(FOLDS[1]), 4)
    x = x ^ shift_down(x & _splat(FOLDS[2]), 2)
    return x ^ shift_down(x & _splat(FOLDS[3]), 1)
