# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattering by one number, the mean cosine g (Henyey and Greenstein 1941); g = 0 scatters everywhere alike."""

import math

import numpy as np

from ..jit import kernel
from ..sampling.warp import INV_FOUR_PI

ISOTROPIC = np.float32(1e-3)  # |g| below which the formulas lose their digits


@kernel
def evaluate(phase, cosine):
    """Density per solid angle at the cosine of the angle between the directions of travel before and after."""
    g = phase.g
    below = 1.0 + g * (g - 2.0 * cosine)
    return INV_FOUR_PI * (1.0 - g * g) / (below * math.sqrt(below))


@kernel
def sample_cosine(phase, u):
    g = phase.g
    if abs(g) < ISOTROPIC:
        return 1.0 - 2.0 * u
    s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u)
    return (1.0 + g * g - s * s) / (2.0 * g)
