# SPDX-License-Identifier: GPL-3.0-or-later
"""Places along a ray, more of them where it passes near a light: evenly over the angle that the light sees.

C. Kulla and M. Fajardo 2012, "Importance sampling techniques for path tracing in participating media", section 4. Light
falls off by the square of the distance, which the density of these places follows; in thin media it decides much more
than how far a ray gets.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import dot, length

ZERO = np.float32(0.0)
MOST = np.float32(0.5)  # share of what is scattered at places that are chosen by a light, not by the medium
LEAST = np.float32(0.01)


class Aim(NamedTuple):
    """How a ray passes by a light."""

    share: float  # of what is scattered, to be scattered at places near to it; 0: there is no light
    t: float  # of the ray where it is nearest ...
    distance: float  # ... and how near that is
    low: float  # angles that the light sees the ray's ends at, from the nearest place
    high: float


@kernel
def no_aim():
    return Aim(ZERO, ZERO, ZERO, ZERO, ZERO)


@kernel
def aim_at(o, d, t_max, centre, size, sigma_t):
    """The Aim of t_max metres along the ray at a light of that centre and radius, in a medium of `sigma_t`.

    The less of its light gets to the nearest place of the ray and from there to where the ray begins, the less it is
    worth to scatter there.
    """
    to_centre = centre - o
    t = dot(to_centre, d)
    distance = max(length(to_centre - d * t), size)
    nearest = min(max(t, 0.0), t_max)
    way = nearest + max(abs(t - nearest), distance)
    share = MOST * math.exp(-way * (sigma_t.x + sigma_t.y + sigma_t.z) * (1.0 / 3.0))
    if share < LEAST or distance <= 0.0:
        return no_aim()
    return Aim(share, t, distance, math.atan(-t / distance), math.atan((t_max - t) / distance))


@kernel
def pdf(aim, t):
    """Density per metre of the ray."""
    away = t - aim.t
    return aim.distance / ((aim.high - aim.low) * (aim.distance * aim.distance + away * away))


@kernel
def sample(aim, u):
    """Distance along the ray."""
    return aim.t + aim.distance * math.tan(aim.low + u * (aim.high - aim.low))
