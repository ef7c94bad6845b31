# SPDX-License-Identifier: GPL-3.0-or-later
"""Oren and Nayar's rough matt surface (1994), in Fujii's form without dents, with what further bounces give back.

Of the lobe: alpha_x is the roughness, 0 (Lambert) to 1, and f0 the colour, which further bounces take on again; the
weight holds it too, for the first bounce. As Blender's Diffuse BSDF and Principled, and OpenPBR's EON (Portsmouth, Kutz
and Hill 2025): a white surface gives back all that it gets. Stays lit where a smooth normal turns away, as `diffuse`.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import WHITE, Vec3, dot, load3
from ..sampling.warp import square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf
from .lobe import LobeSample, LobeValue, nothing

INV_PI = np.float32(1.0 / np.pi)
LOST = np.float32(np.pi / 2.0 - 2.0 / 3.0)  # 1 - E(cos) is `slope` times LOST - G(cos)
LOST_ON_AVERAGE = np.float32(np.pi / 2.0 - 2.0 / 3.0 - (2.0 * np.pi - 5.6) / 3.0)  # 5.6 is a fit


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    if wi.z <= 0.0:
        return nothing()
    base, slope = _line(lobe)
    zo = max(wo.z, 0.0)
    t = dot(wo, wi) - zo * wi.z
    if t > 0.0:
        t /= max(zo, wi.z)
    pdf = square_to_cosine_hemisphere_pdf(wi)
    again = _colour_of_further_bounces(lobe, slope)
    again = again * (_lost(slope, zo) * _lost(slope, wi.z) / (slope * LOST_ON_AVERAGE))
    once = (base + slope * t) * np.float32(np.pi)
    return LobeValue((Vec3(once, once, once) + again) * pdf, pdf)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    wi = square_to_cosine_hemisphere(u0, u1)
    value = evaluate_and_pdf(lobe, wo, wi)
    return LobeSample(wi, value.f * (1.0 / value.pdf) if value.pdf > 0.0 else WHITE, value.pdf, False)


@kernel
def albedo(lobe, wo):
    _, slope = _line(lobe)
    lost = _lost(slope, max(wo.z, 0.0))
    return WHITE * (1.0 - lost) + _colour_of_further_bounces(lobe, slope) * lost


@kernel
def _line(lobe):
    """A and B of A + B t, the light that leaves after one bounce."""
    roughness = min(max(lobe.alpha_x, 1e-5), 1.0)
    base = 1.0 / (np.float32(np.pi) + roughness * LOST)
    return base, roughness * base


@kernel
def _lost(slope, cos):
    """Share of light from `cos` that does not leave after one bounce: 1 - E, written without cancellation."""
    if cos < 1e-6:
        return slope * cos
    theta, sin = math.acos(min(cos, 1.0)), math.sqrt(max(1.0 - cos * cos, 0.0))
    third = np.float32(2.0 / 3.0)
    g = sin * (theta - third - sin * cos) + third * (sin / cos) * (1.0 - sin * sin * sin)
    return slope * max(LOST - g, 0.0)


@kernel
def _colour_of_further_bounces(lobe, slope):
    """By how much light that did not leave at once is dimmed when it leaves, beside the first bounce."""
    lost, color = slope * LOST_ON_AVERAGE, load3(lobe, "f0")
    return Vec3(_again(color.x, lost), _again(color.y, lost), _again(color.z, lost))


@kernel
def _again(color, lost):
    c = min(max(color, 0.0), 1.0)
    return c * c * (1.0 - lost) / (1.0 - c * lost)
