# SPDX-License-Identifier: GPL-3.0-or-later
"""The world, where it shines equally from everywhere: directions uniform on the sphere."""

from ..jit import kernel
from ..linalg.vec3 import load3
from ..sampling.warp import INV_FOUR_PI, square_to_sphere
from .light_sample import INFINITY, LightSample


@kernel
def sample(light, u0, u1):
    return LightSample(square_to_sphere(u0, u1), INFINITY, load3(light, "emission"), INV_FOUR_PI, False)


@kernel
def emitted(light):
    return load3(light, "emission")


@kernel
def pdf():
    return INV_FOUR_PI
