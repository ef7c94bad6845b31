# SPDX-License-Identifier: GPL-3.0-or-later
"""The GGX distribution of microfacets, its shadowing, and how to choose a normal that is seen. Beckmann's: `beckmann`.

Widths alpha_x and alpha_y along the axes of the local frame. With s(w) the length of w stretched by (alpha_x, alpha_y,
1), Smith's masking is G1(w) = 2 z / (z + s), and masking and shadowing of two directions, correlated by height
(Heitz 2014, equation 99), G2 = 2 zo zi / (zi so + zo si). Written so, nothing divides by a cosine that goes to zero.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import Vec3, dot, normalize, reflect
from ..sampling.warp import INV_PI, cos_sin_turn
from ..tables import Facets
from . import beckmann
from .lobe import ONE, ZERO

SMOOTH = np.float32(2e-10)  # alpha_x * alpha_y below which a lobe is a perfect mirror: Cycles' threshold in Blender 5.2
MATCHED = np.float32(1e-4)  # |ior - 1| below which light is not bent, however rough the surface


@kernel
def is_smooth(lobe):
    return lobe.alpha_x * lobe.alpha_y < SMOOTH


@kernel
def has_facets_of(lobe, other):
    """Whether two lobes have equal microfacets."""
    return lobe.alpha_x == other.alpha_x and lobe.alpha_y == other.alpha_y and lobe.facets == other.facets


@kernel
def passes_straight(lobe):
    """A dielectric that scatters in single directions only: smooth, or of the same index on both sides."""
    return is_smooth(lobe) or abs(lobe.ior - 1.0) < MATCHED


@kernel
def stretched_length(lobe, w):
    """s(w): length of w after stretching it by (alpha_x, alpha_y, 1); or what stands for that, see `beckmann`."""
    if lobe.facets == Facets.BECKMANN:
        return beckmann.masked_length(lobe, w)
    x, y = lobe.alpha_x * w.x, lobe.alpha_y * w.y
    return math.sqrt(x * x + y * y + w.z * w.z)


@kernel
def distribution(lobe, h):
    """D(h): area of microfacets with normal h, per solid angle and area of the surface (Walter et al. 2007, eq. 33)."""
    if lobe.facets == Facets.BECKMANN:
        return beckmann.distribution(lobe, h)
    return _ggx(lobe, h, ONE)


@kernel
def _ggx(lobe, v, length2):
    """D of the normal along `v`, whose squared length is `length2`."""
    both = lobe.alpha_x * lobe.alpha_y
    x, y, z = v.x * lobe.alpha_y, v.y * lobe.alpha_x, v.z * both
    t = both * length2 / (x * x + y * y + z * z)  # squeezed by the widths, times their product: no underflow
    return INV_PI * both * t * t


# ---- Visible normals -------------------------------------------------------------------------------------------------


@kernel
def sample_visible_normal(lobe, wo, so, u0, u1):
    """A microfacet's normal as wo sees them (Heitz 2018), by `visible_normal_pdf`. Here and below `so` is s(wo)."""
    return _normal_of_cap(lobe, wo, so, u0, u1, ONE)


@kernel
def visible_normal_pdf(lobe, wo, so, h, cos_h):
    """D(h) G1(wo) (wo . h) / zo, per solid angle of h; `cos_h` = wo . h."""
    return 2.0 * distribution(lobe, h) * cos_h / (wo.z + so)


@kernel
def unshadowed(lobe, wo, so, wi):
    """G2 / G1(wo): share of the light of a visible microfacet that gets away towards wi, on either side."""
    zi = abs(wi.z)
    return zi * (wo.z + so) / (zi * so + wo.z * stretched_length(lobe, wi))


@kernel
def _normal_of_cap(lobe, wo, so, u0, u1, bound):
    """The normal that mirrors the stretched wo to a uniform point of the unit sphere above z = -bound * its own z.

    Dupuy and Benyoub (2023), "Sampling Visible GGX Normals with Spherical Caps".
    """
    if lobe.facets == Facets.BECKMANN:
        return beckmann.sample_visible_normal(lobe, wo, u0, u1)
    scale = 1.0 / so
    x, y, z = wo.x * lobe.alpha_x * scale, wo.y * lobe.alpha_y * scale, wo.z * scale
    bottom = -bound * z
    height = 1.0 - u1 * (1.0 - bottom)
    r = math.sqrt(max(1.0 - height * height, 0.0))
    c, s = cos_sin_turn(u0)
    return normalize(Vec3((r * c + x) * lobe.alpha_x, (r * s + y) * lobe.alpha_y, height + z))


# ---- Reflection ------------------------------------------------------------------------------------------------------


@kernel
def reflection_bound(lobe, wo):
    """k: how much of the cap below the horizon can be left out, as what it reflects cannot leave the surface.

    Eto and Tokuyoshi (2023), "Bounded VNDF Sampling for Smith-GGX Reflections", equation 5. Of Beckmann's, all is used.
    """
    if lobe.facets == Facets.BECKMANN:
        return ONE
    a = min(min(lobe.alpha_x, lobe.alpha_y), 1.0)
    a2 = a * a
    s = 1.0 + math.sqrt(wo.x * wo.x + wo.y * wo.y)
    s2 = s * s
    return (1.0 - a2) * s2 / (s2 + a2 * wo.z * wo.z)


class Reflection(NamedTuple):
    """What microfacets reflect from one direction to another, whatever they are made of."""

    f: float  # f |cos| without Fresnel
    pdf: float  # of `sample_reflection`
    cos_h: float  # wo . h


@kernel
def evaluate_reflection(lobe, wo, wi):
    """The Reflection from wi to wo; nothing from below the horizon, and of what is smooth."""
    if wo.z <= 0.0 or wi.z <= 0.0 or is_smooth(lobe):
        return Reflection(ZERO, ZERO, ZERO)
    v = wo + wi  # along the microfacet's normal h, and as long as 2 (wo . h)
    length2 = dot(v, v)
    cos_h = 0.5 * math.sqrt(length2)
    d = _ggx(lobe, v, length2) if lobe.facets == Facets.GGX else distribution(lobe, v * (0.5 / cos_h))
    so, si = stretched_length(lobe, wo), stretched_length(lobe, wi)
    for_f, for_pdf = wi.z * so + wo.z * si, reflection_bound(lobe, wo) * wo.z + so
    scale = 0.5 * d / (for_f * for_pdf)
    return Reflection(scale * wi.z * for_pdf, scale * for_f, cos_h)


@kernel
def sample_reflection(lobe, wo, u0, u1):
    """(wi, f |cos| / pdf without Fresnel, pdf, wo . h) for wo above the horizon; wi below it has weight 0."""
    so, bound = stretched_length(lobe, wo), reflection_bound(lobe, wo)
    h = _normal_of_cap(lobe, wo, so, u0, u1, bound)
    wi = reflect(wo, h)
    across = bound * wo.z + so
    weight = wi.z * across / (wi.z * so + wo.z * stretched_length(lobe, wi))
    return wi, max(weight, 0.0), 0.5 * distribution(lobe, h) / across, dot(wo, h)


# ---- Reflection and refraction ---------------------------------------------------------------------------------------


@kernel
def refract(wo, h, cos_h, cos_t, ior):
    """Direction of the refracted ray, by Snell's law; `cos_t` from `fresnel_dielectric(cos_h, ior)`."""
    return h * (cos_h / ior - cos_t) - wo * (1.0 / ior)


@kernel
def half_vector(lobe, wo, wi, ior):
    """(h, wo . h, d omega_h / d omega_i): the microfacet that takes wo to wi; the last is 0 if none does.

    `ior` is 1 for reflection (Walter et al. 2007, equations 13 to 17). A `loose` lobe takes the microfacet that would
    if it were seen from behind.
    """
    v = wo + wi * ior
    length2 = dot(v, v)
    h = v * ((1.0 if v.z > 0.0 else -1.0) / math.sqrt(length2))
    cos_o, cos_i = dot(wo, h), dot(wi, h)
    if lobe.loose == 0 and (cos_o <= 0.0 or (cos_i > 0.0) != (wi.z > 0.0)):
        return h, cos_o, ZERO
    return h, abs(cos_o), ior * ior * abs(cos_i) / length2


@kernel
def jacobian(wo, wi, h, ior):
    """d omega_h / d omega_i of a known microfacet; see `half_vector`."""
    v = wo + wi * ior
    return ior * ior * abs(dot(wi, h)) / dot(v, v)
