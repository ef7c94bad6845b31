# SPDX-License-Identifier: GPL-3.0-or-later
"""Velvet of Ashikhmin, Premoze and Shirley (2000, section 5.2): microfacets that stand up like hair.

Of the lobe: alpha_x is the roughness, the width sigma of an inverted Gaussian of the slopes. Blender's Sheen BSDF with
the distribution of that name. Sampled uniformly, as it shines at the rim and wherever light comes past.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE, Vec3, dot, normalize
from ..sampling.warp import square_to_cone, square_to_cone_pdf
from .lobe import ONE, ZERO, LobeSample, LobeValue, no_direction, nothing

INV_PI, SIXTH = np.float32(1.0 / np.pi), np.float32(1.0 / 6.0)
LONGEST = np.float32(1e-5)  # half vectors that stand so close to the normal, or across wo, have no value


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    if wo.z <= 0.0 or wi.z <= 0.0:
        return nothing()
    return LobeValue(WHITE * _value(lobe, wo, wi), square_to_cone_pdf(ONE))


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    if wo.z <= 0.0:
        return no_direction()
    wi, pdf = square_to_cone(u0, u1, ONE), square_to_cone_pdf(ONE)
    if wi.z <= 0.0:
        return no_direction()
    return LobeSample(wi, WHITE * (_value(lobe, wo, wi) / pdf), pdf, False)


@kernel
def albedo(lobe, wo):
    """A mean over 6 x 6 directions, as there is no closed form: an estimate. More of them near the horizon."""
    if wo.z <= 0.0:
        return BLACK
    total = ZERO
    side = Vec3(math.sqrt(max(1.0 - wo.z * wo.z, 0.0)), 0.0, wo.z)
    for i in range(6):
        root = SIXTH * (np.float32(i) + 0.5)
        z = root * root
        r = math.sqrt(1.0 - z * z)
        for j in range(6):
            phi = np.float32(np.pi / 6.0) * (np.float32(j) + 0.5)  # the other half turn is the same
            total += 2.0 * root * _value(lobe, side, Vec3(r * math.cos(phi), r * math.sin(phi), z))
    return WHITE * min(total * np.float32(2.0 * np.pi / 36.0), ONE)


@kernel
def _value(lobe, wo, wi):
    """D G / (4 wo.z): the BSDF times the cosine of wi."""
    h = normalize(wo + wi)
    cos_wo_h = abs(dot(wo, h))
    if h.z >= 1.0 - LONGEST or cos_wo_h <= LONGEST:
        return ZERO
    sigma = max(lobe.alpha_x, 0.01)
    sin2 = 1.0 - h.z * h.z
    d = math.exp(-h.z * h.z / (sin2 * sigma * sigma)) * INV_PI / (sigma * sigma * sin2 * sin2)
    g = min(ONE, 2.0 * max(h.z / cos_wo_h, LONGEST) * min(wo.z, wi.z))
    return 0.25 * d * g / wo.z
