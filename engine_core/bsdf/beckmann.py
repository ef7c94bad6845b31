# SPDX-License-Identifier: GPL-3.0-or-later
"""Beckmann's distribution of microfacets: slopes are distributed normally (Walter et al. 2007, equations 25 to 28).

In the words of `microfacet`: there all that depends on the shape of the bumps is the distribution D, the choice of a
visible normal, and s(w) = z (1 + 2 Lambda(w)), of which Smith's masking is 2 z / (z + s). For GGX that is the length of
the stretched w; here it is z erf(a) + r exp(-a^2) / sqrt(pi), with r the part of that in the plane and a = z / r.
Cycles has an approximation of it, by which rough metals are brighter there by up to 0.3 %.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import Vec3, normalize
from ..sampling.warp import INV_PI, cos_sin_turn
from .lobe import ONE, ZERO

INV_SQRT_PI = np.float32(1.0 / math.sqrt(math.pi))
LEAST_U, MOST_U = np.float32(1e-6), np.float32(1.0 - 1e-6)


@kernel
def masked_length(lobe, w):
    """s(w)"""
    x, y, z = lobe.alpha_x * w.x, lobe.alpha_y * w.y, abs(w.z)
    r = math.sqrt(x * x + y * y)
    if r * 6.0 <= z:
        return z
    a = z / r
    return z * math.erf(a) + r * math.exp(-a * a) * INV_SQRT_PI


@kernel
def distribution(lobe, h):
    """D(h)"""
    if h.z <= 1e-4:
        return ZERO
    inverse = 1.0 / h.z
    x, y = h.x * inverse / lobe.alpha_x, h.y * inverse / lobe.alpha_y
    inverse *= inverse
    return INV_PI * math.exp(-(x * x + y * y)) * inverse * inverse / (lobe.alpha_x * lobe.alpha_y)


@kernel
def sample_visible_normal(lobe, wo, u0, u1):
    """A microfacet's normal as wo sees them: by slopes, on a surface stretched to a width of 1 (Heitz and d'Eon 2014).

    The slope along the view follows the normal distribution times how much is seen of it, and that across it the
    normal distribution alone.
    """
    w = normalize(Vec3(lobe.alpha_x * wo.x, lobe.alpha_y * wo.y, wo.z))
    u0, u1 = min(max(u0, LEAST_U), MOST_U), min(max(u1, LEAST_U), MOST_U)
    sin = math.sqrt(max(w.x * w.x + w.y * w.y, 0.0))
    if sin < 1e-4:
        r = math.sqrt(-math.log(1.0 - u0))
        c, s = cos_sin_turn(u1)
        x, y = r * c, r * s
    else:
        along, across = _visible_slope(w.z, sin, u0), erf_inverse(2.0 * u1 - 1.0)
        c, s = w.x / sin, w.y / sin
        x, y = c * along - s * across, s * along + c * across
    return normalize(Vec3(-lobe.alpha_x * x, -lobe.alpha_y * y, 1.0))


@kernel
def _visible_slope(cos, sin, u):
    """A slope x up to cot(theta) with a density as (1 - x tan(theta)) exp(-x^2).

    The integral up to x is as 1 + b + k exp(-x^2), in terms of b = erf(x), with k = tan(theta) / sqrt(pi) (Jakob 2014,
    "An improved visible normal sampling routine for the Beckmann distribution"). Solved by Newton's steps, which are
    replaced by bisection where they leave the interval.
    """
    tan = sin / max(cos, 1e-4)
    cot = 1.0 / tan
    k = tan * INV_SQRT_PI
    low, high = -ONE, ONE * math.erf(cot)
    goal = u * (1.0 + high + k * math.exp(-cot * cot))
    b = low + (high - low) * u
    x = erf_inverse(b)
    for _ in range(12):
        error = 1.0 + b + k * math.exp(-x * x) - goal
        if abs(error) < 1e-6 * (1.0 + k):
            break
        if error > 0.0:
            high = b
        else:
            low = b
        slope = 1.0 - x * tan
        step = b - error / slope if abs(slope) > 1e-6 else low
        b = step if low < step < high else 0.5 * (low + high)
        x = erf_inverse(b)
    return x


@kernel
def erf_inverse(y):
    """The x of which y is erf(x), to single precision (Giles 2010, "Approximating the erfinv function", table 5)."""
    y = min(max(y, -0.9999999), 0.9999999)
    w = -math.log((1.0 - y) * (1.0 + y))
    if w < 5.0:
        w -= 2.5
        p = 2.81022636e-08
        p = 3.43273939e-07 + p * w
        p = -3.5233877e-06 + p * w
        p = -4.39150654e-06 + p * w
        p = 0.00021858087 + p * w
        p = -0.00125372503 + p * w
        p = -0.00417768164 + p * w
        p = 0.246640727 + p * w
        return (1.50140941 + p * w) * y
    w = math.sqrt(w) - 3.0
    p = -0.000200214257
    p = 0.000100950558 + p * w
    p = 0.00134934322 + p * w
    p = -0.00367342844 + p * w
    p = 0.00573950773 + p * w
    p = -0.0076224613 + p * w
    p = 0.00943887047 + p * w
    p = 1.00167406 + p * w
    return (2.83297682 + p * w) * y
