# SPDX-License-Identifier: GPL-3.0-or-later
"""Varnish: GGX reflection with the Fresnel term of a dielectric. The specular and coat layers of the Principled BSDF.

What it does not reflect reaches the lobes below: see `covers` of a lobe and `dispatch.prepare`. The index of refraction
is not inverted at a back face: as in Cycles, both sides of a face are varnished.
`f0` tints the reflectance at normal incidence, `refract_tint` is the colour of light that passes the varnish once.
"""

import math

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE, Vec3, lerp, load3
from . import energy, microfacet
from .fresnel import f0_of_coating, fresnel_coating, fresnel_coating_average
from .lobe import ONE, LobeSample, LobeValue, mirror_direction, no_direction, nothing
from .thin_film import film_over_dielectric, has_film, tinted_film


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
    """To some hundredths, see `seeming_albedo`."""
    return seeming_albedo(lobe, wo) * energy.mirror_share(lobe) if wo.z > 0.0 else BLACK


# ---- Fresnel and what lies below -------------------------------------------------------------------------------------


@kernel
def reflectance(lobe, cos):
    if has_film(lobe):
        film = film_over_dielectric(cos, lobe.film_thickness, lobe.film_ior, lobe.ior)
        return tinted_film(film, lobe.ior, f0_of_coating(lobe.ior, load3(lobe, "f0")))
    return fresnel_coating(cos, lobe.ior, load3(lobe, "f0"))


@kernel
def seeming_albedo(lobe, wo):
    """The share of light that it keeps from what lies below, by Cycles' estimate: see `energy.seeming_rise`.

    As if no light was lost, also by single scattering; under a film, that of a smooth surface.
    """
    if wo.z <= 0.0:
        return BLACK
    if has_film(lobe):
        return reflectance(lobe, wo.z)
    return lerp(f0_of_coating(lobe.ior, load3(lobe, "f0")), WHITE, energy.seeming_rise(lobe, wo.z))


@kernel
def compensate(lobe):
    """Set `energy_scale`; gives the colour that the further bounces add, a factor for the weight."""
    return energy.compensate_reflection(lobe, fresnel_coating_average(lobe.ior, load3(lobe, "f0")))


@kernel
def absorption(lobe, wo):
    """The share of light, by colour, that a tinted varnish lets through: refract_tint ** (path / thickness).

    Beer's law along the refracted view ray; the tint is that of light which passes straight down.
    """
    tint = load3(lobe, "refract_tint")
    if wo.z <= 0.0 or (tint.x == 1.0 and tint.y == 1.0 and tint.z == 1.0):
        return WHITE
    depth = 1.0 / math.sqrt(max(1.0 - (1.0 - wo.z * wo.z) / (lobe.ior * lobe.ior), 1e-4))
    return lerp(WHITE, Vec3(tint.x**depth, tint.y**depth, tint.z**depth), lobe.covers)
