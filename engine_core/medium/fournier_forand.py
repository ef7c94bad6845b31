# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattering by what floats in sea water: spheres of many sizes, by a power law (Fournier and Forand 1994).

In the form of Fournier and Jonasz 1999 ("Computer-based underwater imaging analysis"), with delta = scale (1 - cos);
the singularity straight ahead can be integrated. All in double precision: near delta = 1 two small numbers are divided.
"""

import numpy as np

from ..jit import kernel
from ..sampling.warp import INV_FOUR_PI, TWO_PI

MOST_STEPS = 60
CLOSE = np.float32(1e-7)
STRAIGHT = np.float32(1.0 - 2.0**-22)  # the largest cosine that is told from 1
NEAR_ONE = np.float32(1e-4)  # how near to 1 delta may come


@kernel
def delta_of(phase, cosine):
    """(delta, delta^nu, sin^2 of half the angle)"""
    versine = 1.0 - np.float64(min(cosine, STRAIGHT))
    delta = phase.scale * versine
    if abs(delta - 1.0) < NEAR_ONE:
        delta = np.float64(1.0 + NEAR_ONE)
    return delta, delta**phase.nu, 0.5 * versine


@kernel
def evaluate(phase, cosine):
    """Density per solid angle at the cosine of the angle between the directions of travel before and after."""
    delta, power, half = delta_of(phase, cosine)
    rest, lost = 1.0 - delta, 1.0 - power
    peak = phase.nu * rest - lost + (delta * lost - phase.nu * rest) / half
    tail = 0.25 * phase.backward * (3.0 * np.float64(cosine) * cosine - 1.0)
    return np.float32(max(INV_FOUR_PI * (peak / (rest * rest * power) + tail), 0.0))


@kernel
def beyond(phase, cosine):
    """Probability of a larger cosine."""
    delta, power, half = delta_of(phase, cosine)
    peak = (1.0 - delta * power - (1.0 - power) * half) / ((1.0 - delta) * power)
    return peak + 0.125 * phase.backward * cosine * (1.0 - np.float64(cosine) * cosine)


@kernel
def sample_cosine(phase, u):
    """Where `beyond` is u: by Newton's steps, and by halving the interval where they leave it."""
    low, high = np.float32(-1.0), STRAIGHT
    cosine = np.float32(0.64)  # of 50 degrees
    for _ in range(MOST_STEPS):
        excess = np.float32(beyond(phase, cosine) - u)
        if excess > 0.0:
            low = cosine
        else:
            high = cosine
        density = TWO_PI * evaluate(phase, cosine)
        following = cosine + excess / density if density > 0.0 else high
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - cosine) < CLOSE:
            return following
        cosine = following
    return cosine
