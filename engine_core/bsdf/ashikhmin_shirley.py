# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin and Shirley's glossy reflection ("An Anisotropic Phong BRDF Model", 2000), without Fresnel.

Half vectors have a density of cos^n, with one exponent along x and another along y: n = 2 / alpha^2 - 2. Blender's
Glossy BSDF with the distribution of that name. A width of 0 is taken for a thousandth; a mirror is better a CONDUCTOR.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE, Vec3, dot, normalize
from .lobe import ONE, ZERO, LobeSample, LobeValue, no_direction, nothing

INV_EIGHT_PI = np.float32(1.0 / (8.0 * np.pi))
TWO_PI = np.float32(2.0 * np.pi)


class Exponents(NamedTuple):
    x: np.float32
    y: np.float32


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    if wo.z <= 0.0 or wi.z <= 0.0:
        return nothing()
    n = _exponents(lobe)
    h = normalize(wo + wi)
    sin2 = h.x * h.x + h.y * h.y
    exponent = (n.x * h.x * h.x + n.y * h.y * h.y) / sin2 if sin2 > 0.0 else n.x
    cos_power = math.exp(0.5 * exponent * math.log1p(-min(sin2, 0.999999)))  # cos^n, from the sine: cos is nearly 1
    pdf = INV_EIGHT_PI * math.sqrt((n.x + 1.0) * (n.y + 1.0)) * cos_power / max(dot(h, wo), 1e-6)
    return LobeValue(WHITE * (pdf * _weight(wo, wi)), pdf)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    if wo.z <= 0.0:
        return no_direction()
    wi = _mirrored(_exponents(lobe), wo, u0, u1)
    if wi.z <= 0.0:
        return no_direction()
    return LobeSample(wi, WHITE * _weight(wo, wi), evaluate_and_pdf(lobe, wo, wi).pdf, False)


@kernel
def albedo(lobe, wo):
    """The mean over sixteen samples, an estimate: a closed form there is not."""
    if wo.z <= 0.0:
        return BLACK
    n, total = _exponents(lobe), ZERO
    for i in range(4):
        for j in range(4):
            wi = _mirrored(n, wo, 0.25 * (np.float32(i) + 0.5), 0.25 * (np.float32(j) + 0.5))
            total += _weight(wo, wi) if wi.z > 0.0 else ZERO
    return WHITE * (total / 16.0)


@kernel
def _weight(wo, wi):
    """f |cos| / pdf: what shadows take away."""
    return wi.z / max(wo.z, wi.z)


@kernel
def _exponents(lobe):
    x, y = min(max(lobe.alpha_x, 1e-3), 1.0), min(max(lobe.alpha_y, 1e-3), 1.0)
    return Exponents(2.0 / (x * x) - 2.0, 2.0 / (y * y) - 2.0)


@kernel
def _mirrored(n, wo, u0, u1):
    """`wo`, mirrored about a half vector that the square is mapped to (sections 3.2 and 4)."""
    x, y = math.cos(TWO_PI * u0) * math.sqrt(n.y + 1.0), math.sin(TWO_PI * u0) * math.sqrt(n.x + 1.0)
    inverse = 1.0 / math.sqrt(x * x + y * y)
    x, y = x * inverse, y * inverse
    exponent = n.x * x * x + n.y * y * y
    sin2 = -math.expm1(2.0 * math.log(max(1.0 - u1, 1e-7)) / (exponent + 1.0))
    sin = math.sqrt(sin2)
    h = Vec3(x * sin, y * sin, math.sqrt(max(ONE - sin2, 0.0)))
    return h * (2.0 * dot(wo, h)) - wo
