# SPDX-License-Identifier: GPL-3.0-or-later
"""Which light to sample: one of all, by its power; and what that power is."""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..tables import LightKind

ONE_MINUS = np.float32(1.0 - 2.0**-24)  # the largest number below 1
QUANTA = 2**24  # probabilities are whole multiples of 1 / QUANTA: exact in float32, as are the sums of them, and `u`


class Selection(NamedTuple):
    light: int  # row of LIGHT
    pmf: float  # 0: there is nothing to select
    u: float  # what is left of the random number: again in [0, 1), with as many bits less as the choice took


@kernel
def select(scene, u):
    """Choose a light with probability `pmf`: the first whose `cdf` is above `u`, by bisection."""
    first, last = 0, scene.world[0].light_count - 1
    while first < last:
        middle = (first + last) >> 1
        if u < scene.lights[middle].cdf:
            last = middle
        else:
            first = middle + 1
    light = scene.lights[first]
    if light.pmf > 0.0:
        u = min((u - (light.cdf - light.pmf)) / light.pmf, ONE_MINUS)
    return Selection(first, light.pmf, u)


def set_probabilities(lights, scene_radius):
    """Fill in `pmf` and `cdf` of all rows of LIGHT. `scene_radius`: of a ball around everything, metres.

    By power; but how much of the power of a sun reaches what the camera sees, nobody knows, so half of all samples are
    shared out evenly: one share for each sun, one for all other lights together. Constant background gets none:
    scattering by the material finds it better, since it is everywhere.
    """
    power = light_power(lights, scene_radius)
    power[lights["kind"] == LightKind.BACKGROUND] = 0.0
    is_sun = lights["kind"] == LightKind.SUN
    shares = np.where(is_sun, np.where(power > 0.0, 1.0, 0.0), power / max(power[~is_sun].sum(), 1e-300))
    counts = apportion(0.5 * _normalised(power) + 0.5 * _normalised(shares), QUANTA)
    lights["pmf"] = counts / QUANTA
    lights["cdf"] = np.cumsum(counts) / QUANTA


def apportion(weights, total):
    """Whole numbers with the sum `total`, in proportion to `weights`; at least 1 where a weight is not 0.

    All 0 if the weights are.
    """
    counts = np.where(weights > 0.0, np.maximum(np.rint(_normalised(weights) * total), 1.0), 0.0).astype(np.int64)
    rest = total - counts.sum() if counts.any() else 0
    while rest:  # what rounding left: nearly always to the largest alone
        largest = int(np.argmax(counts))
        step = max(rest, 1 - counts[largest])
        counts[largest] += step
        rest -= step
    return counts


def light_power(lights, scene_radius):
    """Radiant flux of rows of LIGHT, the mean of red, green and blue, W: (n,).

    Of suns and background, what enters the ball of `scene_radius` around the scene.
    """
    emission = lights["emission"].astype(np.float64).mean(axis=-1)
    radius, area = lights["radius"].astype(np.float64), lights["area"].astype(np.float64)
    is_delta, kind = lights["is_delta"] != 0, lights["kind"]
    disk = np.pi * scene_radius**2

    ball = np.where(is_delta, 4.0 * np.pi, 4.0 * np.pi**2 * radius**2)
    height = lights["height"].astype(np.float64)
    sides = np.where(lights["two_sided"] != 0, 2.0, 1.0)
    factors = {
        LightKind.POINT: ball,
        LightKind.SPOT: ball * np.where(kind == LightKind.SPOT, _spot_fraction(lights), 1.0),
        LightKind.SUN: disk * np.where(is_delta, 1.0, np.pi * height * (2.0 - height)),  # pi sin^2
        LightKind.QUAD: area * np.where(is_delta, 1.0, np.pi * _spread_fraction(lights)),
        LightKind.DISK: area * np.where(is_delta, 1.0, np.pi * _spread_fraction(lights)),
        LightKind.TRIANGLE: np.pi * area * sides,
        LightKind.SPHERE: 4.0 * np.pi**2 * radius**2,
        LightKind.BACKGROUND: 4.0 * np.pi * disk,
    }
    return emission * np.select([kind == k for k in factors], list(factors.values()))


def _spot_fraction(lights):
    """The part of a point light's power that passes the cone: its solid angle, half of the blended edge; over 4 pi.

    For an elliptic cone about: its solid angle shrinks with both axes.
    """
    with np.errstate(divide="ignore"):
        width = 1.0 / lights["blend"].astype(np.float64)
    cosines = 1.0 - lights["cos_angle"].astype(np.float64) - 0.5 * width
    squeeze = np.linalg.norm(lights["u"], axis=-1) * np.linalg.norm(lights["v"], axis=-1)
    return np.minimum(0.5 * cosines / np.maximum(squeeze, 1e-6), 1.0)


def _spread_fraction(lights):
    """Flux of a light that shines within an angle `a`, over that of a Lambertian one: 1 - a / tan a."""
    tangent = lights["spread"].astype(np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.isinf(tangent), 1.0, 1.0 - np.arctan(tangent) / tangent)


def _normalised(weights):
    total = weights.sum()
    return weights / total if total > 0.0 else weights
