# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays: leaving a surface without hitting it again."""

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.extending import intrinsic

from ..jit import kernel
from .vec3 import Vec3


@intrinsic
def _float_bits(typing_context, x):
    """The bits of a float32 as an int32."""
    return types.int32(types.float32), lambda context, builder, sig, args: builder.bitcast(args[0], ir.IntType(32))


@intrinsic
def _float_from_bits(typing_context, i):
    """The float32 that has the bits of an int32."""
    return types.float32(types.int32), lambda context, builder, sig, args: builder.bitcast(args[0], ir.FloatType())


if config.DISABLE_JIT:  # kernels as plain Python, for a debugger

    def float_bits(x):
        return np.float32(x).view(np.int32)

    def float_from_bits(i):
        return np.int32(i).view(np.float32)
else:
    float_bits, float_from_bits = _float_bits, _float_from_bits


@kernel
def _offset_component(x, n):
    # Near zero the spacing of floats says nothing about the error that `x` carries, so there the step is absolute.
    if abs(x) < 1.0 / 32.0:
        return x + n * (1.0 / 65536.0)
    steps = np.int32(n * 256.0)
    return float_from_bits(np.int32(float_bits(x) + (steps if x > 0.0 else -steps)))


@kernel
def offset_ray_origin(p, ng):
    """A point next to `p`, on the side of its unit normal `ng`, far enough not to hit the surface of `p` again.

    256 steps of the floating-point numbers, whatever the size of the scene (Waechter and Binder 2019, "A fast and
    robust method for avoiding self-intersection"). For a ray that goes through the surface, hand over -ng.
    """
    return Vec3(_offset_component(p.x, ng.x), _offset_component(p.y, ng.y), _offset_component(p.z, ng.z))
