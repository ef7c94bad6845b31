# SPDX-License-Identifier: GPL-3.0-or-later
"""GGX refraction alone, without Fresnel's shares; what would be reflected totally is lost. Blender's Refraction BSDF.

`ior` and the scale of radiance as in `dielectric`.
"""

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE, dot
from . import microfacet
from .fresnel import fresnel_dielectric
from .lobe import ONE, UP, LobeSample, LobeValue, no_direction, nothing


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    if wo.z <= 0.0 or wi.z >= 0.0 or microfacet.passes_straight(lobe):
        return nothing()
    h, cos_h, jacobian = microfacet.half_vector(lobe, wo, wi, lobe.ior)
    if jacobian == 0.0:
        return nothing()
    so = microfacet.stretched_length(lobe, wo)
    density = microfacet.visible_normal_pdf(lobe, wo, so, h, cos_h) * jacobian
    return LobeValue(WHITE * (density * microfacet.unshadowed(lobe, wo, so, wi)), density)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    if wo.z <= 0.0:
        return no_direction()
    is_delta = microfacet.passes_straight(lobe)
    so = microfacet.stretched_length(lobe, wo)
    h = UP if is_delta else microfacet.sample_visible_normal(lobe, wo, so, u0, u1)
    cos_h = dot(wo, h)
    _, cos_t = fresnel_dielectric(cos_h, lobe.ior)
    wi = microfacet.refract(wo, h, cos_h, cos_t, lobe.ior)
    if cos_t == 0.0 or wi.z >= 0.0:
        return no_direction()
    if is_delta:
        return LobeSample(wi, WHITE, ONE, True)
    pdf = microfacet.visible_normal_pdf(lobe, wo, so, h, cos_h) * microfacet.jacobian(wo, wi, h, lobe.ior)
    return LobeSample(wi, WHITE * microfacet.unshadowed(lobe, wo, so, wi), pdf, False)


@kernel
def albedo(lobe, wo):
    """An estimate, as if the surface were smooth: all or, beyond the critical angle, nothing."""
    if wo.z <= 0.0:
        return BLACK
    _, cos_t = fresnel_dielectric(wo.z, lobe.ior)
    return WHITE if cos_t > 0.0 else BLACK
