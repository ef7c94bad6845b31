# SPDX-License-Identifier: GPL-3.0-or-later
"""Glass: GGX reflection and refraction, shared out by Fresnel's equations (Walter et al. 2007).

`ior` is that of the far side over that of the near one, where wo is. Radiance is not scaled by ior ** 2 as it passes,
as in Cycles: what is kept is power. `f0` tints the reflectance at normal incidence, `reflect_tint` and `refract_tint`
all of what is reflected and refracted. So f(wo, wi) = ior ** 2 f(wi, wo), the second seen from the other side.
"""

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE, Vec3, average, dot, load3, reflect
from . import energy, microfacet
from .fresnel import f0_of_coating, fresnel_dielectric, tinted
from .lobe import UP, ZERO, LobeSample, LobeValue, no_direction, nothing
from .thin_film import film_over_dielectric, has_film, tinted_film


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    if wo.z <= 0.0 or wi.z == 0.0 or microfacet.passes_straight(lobe):
        return nothing()
    is_reflection = wi.z > 0.0
    h, cos_h, jacobian = microfacet.half_vector(lobe, wo, wi, 1.0 if is_reflection else lobe.ior)
    if jacobian == 0.0:
        return nothing()
    reflected, refracted, p, _ = halves(lobe, cos_h)
    so = microfacet.stretched_length(lobe, wo)
    density = microfacet.visible_normal_pdf(lobe, wo, so, h, cos_h) * jacobian
    scale = density * microfacet.unshadowed(lobe, wo, so, wi) * lobe.energy_scale
    if is_reflection:
        return LobeValue(reflected * scale, p * density)
    return LobeValue(refracted * scale, (1.0 - p) * density)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    """Choose a microfacet that wo sees, then reflection or refraction by their shares there."""
    if wo.z <= 0.0:
        return no_direction()
    is_delta = microfacet.passes_straight(lobe)
    so = microfacet.stretched_length(lobe, wo)
    h = UP if is_delta else microfacet.sample_visible_normal(lobe, wo, so, u0, u1)
    cos_h = dot(wo, h)
    reflected, refracted, p, cos_t = halves(lobe, cos_h)
    is_reflection = u_choice < p
    if is_reflection:
        wi, weight = reflect(wo, h), reflected * (1.0 / p)
    else:
        p = 1.0 - p
        wi, weight = microfacet.refract(wo, h, cos_h, cos_t, lobe.ior), refracted * (1.0 / p)
    if p <= 0.0 or is_reflection != (wi.z > 0.0):
        return no_direction()
    if is_delta:
        return LobeSample(wi, weight, p, True)
    jacobian = microfacet.jacobian(wo, wi, h, 1.0 if is_reflection else lobe.ior)
    pdf = p * microfacet.visible_normal_pdf(lobe, wo, so, h, cos_h) * jacobian
    return LobeSample(wi, weight * (microfacet.unshadowed(lobe, wo, so, wi) * lobe.energy_scale), pdf, False)


@kernel
def albedo(lobe, wo):
    """Of untinted glass exact, else from inside an estimate: the halves are then taken as those of a smooth surface."""
    if wo.z <= 0.0:
        return BLACK
    if microfacet.passes_straight(lobe):
        reflected, refracted, _, _ = halves(lobe, wo.z)
        return reflected + refracted
    share = energy.glass_albedo(lobe)
    if has_film(lobe):
        reflected, refracted, _, _ = halves(lobe, wo.z)
        return (reflected + refracted) * (share * lobe.energy_scale)
    mean = tinted(energy.mean_dielectric(lobe, wo.z), lobe.ior, load3(lobe, "f0")) * energy.ggx_albedo(lobe, wo.z)
    reflection = Vec3(min(mean.x, share), min(mean.y, share), min(mean.z, share))
    both = load3(lobe, "reflect_tint") * reflection + load3(lobe, "refract_tint") * (WHITE * share - reflection)
    return both * lobe.energy_scale


@kernel
def halves(lobe, cos_h):
    """(colour reflected, colour refracted, probability to sample reflection, cosine of the refracted ray)."""
    real, cos_t = fresnel_dielectric(cos_h, lobe.ior)
    if has_film(lobe) and cos_t > 0.0:
        film = film_over_dielectric(cos_h, lobe.film_thickness, lobe.film_ior, lobe.ior)
        reflectance = tinted_film(film, lobe.ior, f0_of_coating(lobe.ior, load3(lobe, "f0")))
    else:
        reflectance = tinted(real, lobe.ior, load3(lobe, "f0"))
    reflected = load3(lobe, "reflect_tint") * reflectance
    refracted = load3(lobe, "refract_tint") * (WHITE - reflectance)
    r, t = average(reflected), average(refracted)
    return reflected, refracted, r / (r + t) if r > 0.0 else ZERO, cos_t


@kernel
def compensate(lobe):
    """Set `energy_scale`; gives the colour that the further bounces add, a factor for the weight.

    Most of that light has been refracted, so it takes the tint of refraction, as in Cycles.
    """
    return energy.compensate_glass(lobe, load3(lobe, "refract_tint"))
