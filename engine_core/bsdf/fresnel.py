# SPDX-License-Identifier: GPL-3.0-or-later
"""Fresnel reflectance of unpolarised light: the share that an ideally smooth surface reflects.

`cos` is the cosine between the ray and the normal, 0 to 1. `fresnel_..._average` is the mean over a hemisphere of
light, the integral of 2 cos F(cos) d cos.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import WHITE, Vec3, lerp
from .lobe import ONE, ZERO

F82_COS = np.float32(1.0 / 7.0)  # 81.8 degrees
SCHLICK_F82 = np.float32((6.0 / 7.0) ** 5)
F82_TO_B = np.float32(7.0 / (6.0 / 7.0) ** 6)

# ---- Dielectrics -----------------------------------------------------------------------------------------------------


@kernel
def fresnel_dielectric(cos, ior):
    """(reflectance, cosine of the refracted ray against the reversed normal), for `ior` = far side over near side.

    Both polarisations by Fresnel's equations, averaged. Total internal reflection: (1, 0).
    """
    cos2_t = 1.0 - (1.0 - cos * cos) / (ior * ior)
    if cos2_t <= 0.0:
        return ONE, ZERO
    cos_t = math.sqrt(cos2_t)
    s = (cos - ior * cos_t) / (cos + ior * cos_t)
    p = (ior * cos - cos_t) / (ior * cos + cos_t)
    return 0.5 * (s * s + p * p), cos_t


@kernel
def f0_of_ior(ior):
    """Reflectance at normal incidence."""
    r = (ior - 1.0) / (ior + 1.0)
    return r * r


@kernel
def fresnel_dielectric_average(ior):
    """A fit by Kulla and Conty (2017, "Revisiting Physically Based Shading at Imageworks"), to 0.5 %."""
    if ior < 1.0:
        return 0.997118 + ior * (0.1014 - ior * (0.965241 + ior * 0.130607))
    return (ior - 1.0) / (4.08567 + 1.00071 * ior)


@kernel
def fresnel_coating(cos, ior, tint):
    """The Fresnel curve of `ior`, as a colour, see `tinted`."""
    reflectance, _ = fresnel_dielectric(cos, ior)
    return tinted(reflectance, ior, tint)


@kernel
def tinted(reflectance, ior, tint):
    """A reflectance on the Fresnel curve of `ior` as a colour: F0 takes the colour `tint`, grazing light stays white.

    The curve's way from F0 to 1 becomes the way from `f0_of_coating` to 1, as in Cycles' generalized Schlick term.
    """
    if tint.x == 1.0 and tint.y == 1.0 and tint.z == 1.0:
        return tint * reflectance
    f0 = f0_of_ior(ior)
    return lerp(f0_of_coating(ior, tint), WHITE, max((reflectance - f0) / (1.0 - f0), 0.0))


@kernel
def f0_of_coating(ior, tint):
    f0 = tint * f0_of_ior(ior)
    return Vec3(min(f0.x, 1.0), min(f0.y, 1.0), min(f0.z, 1.0))


@kernel
def fresnel_coating_average(ior, tint):
    f0 = f0_of_ior(ior)
    s = max((fresnel_dielectric_average(ior) - f0) / (1.0 - f0), 0.0)
    return lerp(f0_of_coating(ior, tint), WHITE, s)


# ---- Metals ----------------------------------------------------------------------------------------------------------


@kernel
def schlick(cos):
    """(1 - cos) ** 5 (Schlick 1994)."""
    m = max(1.0 - cos, 0.0)
    m2 = m * m
    return m2 * m2 * m


@kernel
def f82_b(f0, reflectance_82):
    """The factor b with which the F82 curve, see `fresnel_f82`, meets its value at 82 degrees."""
    return (lerp(f0, WHITE, SCHLICK_F82) - reflectance_82) * F82_TO_B


@kernel
def f82_tint_b(f0, tint):
    """As `f82_b`; the value at 82 degrees is Schlick's times `tint` (Kutz et al. 2021, "Novel aspects of the Adobe
    Standard Material")."""
    return lerp(f0, WHITE, SCHLICK_F82) * (WHITE - tint) * F82_TO_B


@kernel
def fresnel_f82(cos, f0, b):
    """Reflectance of a metal by its colour: f0 + (1 - f0) (1 - cos)^5 - b cos (1 - cos)^6, kept within 0 and 1."""
    s = schlick(cos)
    f = lerp(f0, WHITE, s) - b * (cos * s * max(1.0 - cos, 0.0))
    return Vec3(min(max(f.x, 0.0), 1.0), min(max(f.y, 0.0), 1.0), min(max(f.z, 0.0), 1.0))


@kernel
def fresnel_f82_average(f0, b):
    return lerp(f0, WHITE, np.float32(1.0 / 21.0)) - b * np.float32(1.0 / 126.0)


@kernel
def fresnel_conductor(cos, n, k):
    """Reflectance of a metal by its complex index of refraction n + i k, per channel."""
    return Vec3(_conductor(cos, n.x, k.x), _conductor(cos, n.y, k.y), _conductor(cos, n.z, k.z))


@kernel
def _conductor(cos, n, k):
    """Born and Wolf, Principles of Optics, section 14.2; in the form of Walter's and Lagarde's notes."""
    cos2 = cos * cos
    sin2 = 1.0 - cos2
    t = n * n - k * k - sin2
    a2_plus_b2 = math.sqrt(t * t + 4.0 * n * n * k * k)
    a = math.sqrt(max(0.5 * (a2_plus_b2 + t), 0.0))
    s_plus, s_minus = a2_plus_b2 + cos2, 2.0 * cos * a
    s = (s_plus - s_minus) / (s_plus + s_minus)
    p_plus, p_minus = cos2 * a2_plus_b2 + sin2 * sin2, s_minus * sin2
    return 0.5 * s * (1.0 + (p_plus - p_minus) / (p_plus + p_minus))
