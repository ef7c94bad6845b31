# SPDX-License-Identifier: GPL-3.0-or-later
"""Media of constant density: what gets through, what they emit, and how far light goes before it is scattered."""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE, Vec3
from . import equiangular

ZERO = np.float32(0.0)
FARTHEST = np.float32(1e30)  # metres: so that nothing over an infinite distance is still nothing
BELOW_ONE = np.float32(1.0 - 2.0**-24)


class Flight(NamedTuple):
    """How far a path goes in a medium."""

    t: float  # to where it is scattered
    scatters: bool  # False: it gets through
    weight: Vec3  # by what its throughput changes; of a scattering, sigma_s is in it


@kernel
def transmittance(sigma_t, t):
    """The part of light that gets through `t` metres (Beer's law)."""
    t = min(t, FARTHEST)
    return Vec3(math.exp(-sigma_t.x * t), math.exp(-sigma_t.y * t), math.exp(-sigma_t.z * t))


@kernel
def held_back(sigma_t, t):
    """1 - transmittance, without loss of digits in thin media."""
    t = min(t, FARTHEST)
    return Vec3(-math.expm1(-sigma_t.x * t), -math.expm1(-sigma_t.y * t), -math.expm1(-sigma_t.z * t))


@kernel
def emitted(emission, sigma_t, t):
    """Radiance that `t` metres of an emitting medium send to their end."""
    held = held_back(sigma_t, t)
    return emission * Vec3(
        held.x / sigma_t.x if sigma_t.x > 0.0 else t,
        held.y / sigma_t.y if sigma_t.y > 0.0 else t,
        held.z / sigma_t.z if sigma_t.z > 0.0 else t,
    )


@kernel
def fly(sigma_t, sigma_s, beta, t_max, aim, ends_in_nothing, u_event, u_t):
    """The Flight of a path of throughput `beta` through `t_max` metres. `ends_in_nothing`: getting through is no use.

    Getting through, and scattering as each of three colours would, are four ways to go on. One is chosen by the
    throughput that it promises, and its weight is that of all of them together (the balance heuristic over colours,
    Veach 1997, section 9.2.4; Wilkie et al. 2014). So the colours' sum of the throughput after the flight is always
    the same: all that is neither absorbed nor lost. Absorption dims paths, and never ends them.

    `aim`: at a light near which to scatter is a fifth way, at the expense of the colours.
    """
    held = held_back(sigma_t, t_max)
    scattered = beta * albedo(sigma_t, sigma_s) * held
    passing = BLACK if ends_in_nothing else beta * transmittance(sigma_t, t_max)
    through = passing.x + passing.y + passing.z
    total = through + scattered.x + scattered.y + scattered.z
    u = u_event * total - through
    if u < 0.0 or total <= through:
        weight = transmittance(sigma_t, t_max) * (total / through) if through > 0.0 else BLACK
        return Flight(t_max, False, weight)

    aimed = aim.share * (total - through)
    if u < aimed:
        t = min(max(equiangular.sample(aim, u_t), 0.0), t_max)
    else:  # by the distances of one colour; what u is left with decides which
        u = (u - aimed) / (1.0 - aim.share)
        sigma, part = sigma_t.z, held.z
        if u < scattered.x:
            sigma, part = sigma_t.x, held.x
        elif u < scattered.x + scattered.y or scattered.z <= 0.0:
            sigma, part = (sigma_t.y, held.y) if scattered.y > 0.0 else (sigma_t.x, held.x)
        t = min(-math.log1p(-u_t * part) / sigma, t_max)
    reaching = sigma_s * transmittance(sigma_t, t)
    by_color = beta * reaching
    density = (1.0 - aim.share) * (by_color.x + by_color.y + by_color.z)
    if aim.share > 0.0:
        density += aimed * equiangular.pdf(aim, t)
    return Flight(t, True, reaching * (total / density))


@kernel
def albedo(sigma_t, sigma_s):
    """Share of what a medium takes out of a ray that it scatters."""
    return WHITE * Vec3(
        sigma_s.x / sigma_t.x if sigma_t.x > 0.0 else ZERO,
        sigma_s.y / sigma_t.y if sigma_t.y > 0.0 else ZERO,
        sigma_s.z / sigma_t.z if sigma_t.z > 0.0 else ZERO,
    )
