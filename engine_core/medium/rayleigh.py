# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattering by what is much smaller than a wavelength, such as air (Rayleigh 1871)."""

import math

import numpy as np

from ..jit import kernel

THREE_OVER_16_PI = np.float32(3.0 / (16.0 * math.pi))


@kernel
def evaluate(phase, cosine):
    """Density per solid angle at the cosine of the angle between the directions of travel before and after."""
    return THREE_OVER_16_PI * (1.0 + cosine * cosine)


@kernel
def sample_cosine(phase, u):
    """Cardano's root of the cumulative distribution (Frisvad 2011, "Importance sampling the Rayleigh phase function").

    mu^3 + 3 mu = 2 a has the solution mu = c - 1 / c with c^3 = a + sqrt(a^2 + 1); of both signs of a, the one is the
    mirrored other, which saves the digits that would cancel.
    """
    a = 4.0 * u - 2.0
    c = np.cbrt(abs(a) + math.sqrt(a * a + 1.0))
    return math.copysign(c - 1.0 / c, a)
