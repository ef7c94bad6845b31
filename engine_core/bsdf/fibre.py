# SPDX-License-Identifier: GPL-3.0-or-later
"""What the two lobes of the Hair node have in common: how they spread light along a fibre that lies along x.

The angle halfway between view and light, theta_h, is distributed by Cauchy's density about the tilt `g` of the scales
(an angle), with the width `alpha_x`: as far as the light stays between the two ends of the fibre.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import WHITE, Vec3
from ..sampling.warp import angle_of
from .lobe import ZERO, LobeSample, LobeValue, no_direction

HALF_PI = np.float32(0.5 * np.pi)
ALMOST_ALONG = np.float32(0.001)  # as near to the fibre's direction there is no light
LEAST_ACROSS = np.float32(1e-6)


@kernel
def latitude(w):
    """The angle of a direction above the plane across the fibre."""
    return angle_of(w.x, across(w))


@kernel
def across(w):
    """Length of its part across the fibre."""
    return math.sqrt(w.y * w.y + w.z * w.z)


@kernel
def bounds(lobe, theta_o):
    """(lowest, highest) arctangent of (theta_h - g) / alpha_x."""
    low = math.atan((0.5 * (theta_o - HALF_PI) - lobe.g) / lobe.alpha_x)
    return low, math.atan((0.5 * (theta_o + HALF_PI) - lobe.g) / lobe.alpha_x)


@kernel
def density_along(lobe, wo, wi):
    """Per solid angle if times a density of the angle around the fibre; 0 where there is hardly an angle around."""
    theta_o, theta_i = latitude(wo), latitude(wi)
    if HALF_PI - abs(theta_i) < ALMOST_ALONG:
        return ZERO
    low, high = bounds(lobe, theta_o)
    t = 0.5 * (theta_i + theta_o) - lobe.g
    width = lobe.alpha_x
    return width / (2.0 * (t * t + width * width) * (high - low) * across(wi))


@kernel
def sample_along(lobe, theta_o, u):
    """The latitude of a direction."""
    low, high = bounds(lobe, theta_o)
    return 2.0 * (lobe.alpha_x * math.tan(low + u * (high - low)) + lobe.g) - theta_o


@kernel
def angle_around(wo, wi):
    """Between two directions as seen along the fibre, 0 to pi."""
    return abs(angle_of(wo.y * wi.z - wo.z * wi.y, wo.y * wi.y + wo.z * wi.z))


@kernel
def direction(wo, theta, phi):
    """The direction of that latitude, turned by `phi` around the fibre from `wo`."""
    c, s, cos = math.cos(phi), math.sin(phi), math.cos(theta) / max(across(wo), LEAST_ACROSS)
    return Vec3(math.sin(theta), cos * (wo.y * c - wo.z * s), cos * (wo.z * c + wo.y * s))


@kernel
def value_of(density):
    """The lobe is white, and takes directions as it scatters."""
    return LobeValue(WHITE * density, density)


@kernel
def sample_of(wi, density):
    return LobeSample(wi, WHITE, density, False) if density > ZERO else no_direction()
