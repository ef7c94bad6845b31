# SPDX-License-Identifier: GPL-3.0-or-later
"""Metal: GGX reflection, coloured by a Fresnel term (Walter et al. 2007). Blender's Glossy and Metallic.

f = F D G2 / (4 |cos(wo)| |cos(wi)|), times what `energy.compensate` found that single scattering loses.
"""

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE, load3
from ..tables import FresnelKind
from . import energy, microfacet, thin_wall
from .fresnel import (
    F82_COS,
    f82_b,
    f82_tint_b,
    fresnel_conductor,
    fresnel_f82,
    fresnel_f82_average,
)
from .lobe import ONE, LobeSample, LobeValue, mirror_direction, no_direction, nothing
from .thin_film import film_over_conductor, film_over_f82, has_film


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    return value_of(lobe, microfacet.evaluate_reflection(lobe, wo, wi))


@kernel
def value_of(lobe, m):
    """The LobeValue of a Reflection `m`."""
    if m.pdf <= 0.0:
        return nothing()
    return LobeValue(reflectance(lobe, m.cos_h) * (m.f * lobe.energy_scale), m.pdf)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    if wo.z <= 0.0:
        return no_direction()
    if microfacet.is_smooth(lobe):
        return LobeSample(mirror_direction(wo), reflectance(lobe, wo.z), ONE, True)
    wi, weight, pdf, cos_h = microfacet.sample_reflection(lobe, wo, u0, u1)
    if wi.z <= 0.0:
        return no_direction()
    return LobeSample(wi, reflectance(lobe, cos_h) * (weight * lobe.energy_scale), pdf, False)


@kernel
def albedo(lobe, wo):
    if wo.z <= 0.0:
        return BLACK
    share = energy.mirror_share(lobe)
    if lobe.fresnel == FresnelKind.CONSTANT or lobe.fresnel == FresnelKind.THIN_WALL or has_film(lobe):
        return reflectance(lobe, wo.z) * share
    f0, b = as_f82(lobe)
    return energy.mean_f82(lobe, wo.z, f0, b) * share


# ---- Fresnel ---------------------------------------------------------------------------------------------------------


@kernel
def reflectance(lobe, cos):
    """Fresnel term at the cosine between wo and the microfacet's normal; under a thin film, if there is one."""
    f0 = load3(lobe, "f0")
    if lobe.fresnel == FresnelKind.CONSTANT:
        return f0
    if lobe.fresnel == FresnelKind.THIN_WALL:
        return WHITE
    f82 = load3(lobe, "f82")
    if lobe.fresnel == FresnelKind.F82:
        b = f82_tint_b(f0, f82)
        if has_film(lobe):
            return film_over_f82(cos, lobe.film_thickness, lobe.film_ior, f0, b)
        return fresnel_f82(cos, f0, b)
    if has_film(lobe):
        return film_over_conductor(cos, lobe.film_thickness, lobe.film_ior, f0, f82)
    return fresnel_conductor(cos, f0, f82)


@kernel
def as_f82(lobe):
    """(f0, b) of the F82 curve: of the lobe's own, or of the one through its reflectance at 0 and 82 degrees."""
    f0, f82 = load3(lobe, "f0"), load3(lobe, "f82")
    if lobe.fresnel == FresnelKind.F82:
        return f0, f82_tint_b(f0, f82)
    at_0 = fresnel_conductor(ONE, f0, f82)
    return at_0, f82_b(at_0, fresnel_conductor(F82_COS, f0, f82))


@kernel
def compensate(lobe, wo):
    """Set `energy_scale`; gives the colour that the further bounces add, a factor for the weight."""
    if lobe.fresnel == FresnelKind.THIN_WALL:
        reflected, _ = thin_wall.shares(lobe, wo.z)
        if microfacet.is_smooth(lobe):
            return reflected
        return reflected * energy.compensate_reflection(lobe, load3(lobe, "f0"))
    if lobe.fresnel == FresnelKind.CONSTANT:
        average = load3(lobe, "f0")
    else:
        f0, b = as_f82(lobe)
        average = fresnel_f82_average(f0, b)
    return energy.compensate_reflection(lobe, average)
