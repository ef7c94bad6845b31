# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattering by dust (Draine 2003): Henyey and Greenstein's lobe times 1 + alpha cos^2.

alpha = 1 is Cornette and Shanks' function; with g = 0 as well it is Rayleigh's.
"""

import math

import numpy as np

from ..jit import kernel
from ..sampling.warp import TWO_PI
from . import henyey_greenstein

MOST_STEPS = 40  # four or five are usual
CLOSE = np.float32(1e-7)


@kernel
def evaluate(phase, cosine):
    """Density per solid angle at the cosine of the angle between the directions of travel before and after."""
    return share(phase) * (1.0 + phase.alpha * cosine * cosine) * henyey_greenstein.evaluate(phase, cosine)


@kernel
def share(phase):
    """What makes a density of the product: 1 / (1 + alpha E[cos^2])."""
    return 1.0 / (1.0 + phase.alpha * (1.0 + 2.0 * phase.g * phase.g) * np.float32(1.0 / 3.0))


@kernel
def cumulative(phase, cosine):
    """Probability of a smaller cosine; in double precision, since for small g nearly all digits cancel."""
    g, alpha, mu = np.float64(phase.g), np.float64(phase.alpha), np.float64(cosine)
    if g == 0.0:
        return 0.5 * (mu + 1.0 + alpha * (mu * mu * mu + 1.0) / 3.0) / (1.0 + alpha / 3.0)
    a = 1.0 + g * g
    s, s0 = math.sqrt(max(a - 2.0 * g * mu, 0.0)), 1.0 + g  # s0 at the cosine -1
    plain = (1.0 / s - 1.0 / s0) / g
    squared = (a * a * (1.0 / s - 1.0 / s0) + 2.0 * a * (s - s0) - (s * s * s - s0 * s0 * s0) / 3.0) / (4.0 * g * g * g)
    return 0.5 * (1.0 - g * g) * (plain + alpha * squared) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0)


@kernel
def sample_cosine(phase, u):
    """Where `cumulative` is u: by Newton's steps, and by halving the interval where they leave it.

    There is a root in closed form (Jendersie and d'Eon 2023); in single precision it is off for small g and alpha.
    """
    low, high = np.float32(-1.0), np.float32(1.0)
    cosine = henyey_greenstein.sample_cosine(phase, u)
    for _ in range(MOST_STEPS):
        excess = np.float32(cumulative(phase, cosine) - u)
        if excess > 0.0:
            high = cosine
        else:
            low = cosine
        following = cosine - excess / (TWO_PI * evaluate(phase, cosine))
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - cosine) < CLOSE:
            return following
        cosine = following
    return cosine
