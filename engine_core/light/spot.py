# SPDX-License-Identifier: GPL-3.0-or-later
"""Spot lights: point lights that shine into a cone with a smooth edge, by Cycles' formula (kernel/light/spot.h)."""

import math

from ..jit import kernel
from ..linalg.vec3 import dot, load3
from . import point
from .light_sample import LightSample


@kernel
def sample(light, p, u0, u1):
    s = point.sample(light, p, u0, u1)
    if s.pdf == 0.0:
        return s
    return LightSample(s.wi, s.distance, s.radiance * attenuation(light, -s.wi), s.pdf, s.is_delta)


@kernel
def emitted(light, p, wi, t):
    return point.emitted(light, p, wi, t) * attenuation(light, -wi)


@kernel
def pdf(light, p, wi, t):
    return point.pdf(light, p, wi, t)


@kernel
def attenuation(light, w):
    """From 1 inside of the cone to 0 outside, for light that leaves along `w`.

    The edge is blended over the cosine, in the space where the cone is round: a lamp that is scaled unequally has an
    elliptic one. By the direction alone, so the cone begins at each point of the lamp anew.
    """
    x, y, z = dot(w, load3(light, "u")), dot(w, load3(light, "v")), dot(w, load3(light, "n"))
    cosine = z / math.sqrt(x * x + y * y + z * z)
    above = cosine - light.cos_angle
    if not above > 0.0:
        return above * 0.0
    return smoothstep(above * light.blend)


@kernel
def smoothstep(x):
    """0 below 0, 1 above 1, and between them 3 x^2 - 2 x^3."""
    x = min(max(x, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)
