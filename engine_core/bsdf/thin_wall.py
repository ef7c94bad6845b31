# SPDX-License-Identifier: GPL-3.0-or-later
"""A pane so thin that light leaves it where it entered: Principled BSDF with Thin Wall, as OpenPBR has it.

Light that bounces inside the pane is summed up: it reflects and transmits shares of what comes in, see `shares`. What
is reflected is a CONDUCTOR with FresnelKind THIN_WALL. The lobe here transmits: a GGX reflection, seen in the mirror of
the pane, as wide as two refractions make it (see `shader/closures.py`). Its shares become part of the weight in
`compensate`. Of the lobe: `ior`, never inverted; `f0` tints the reflectance head on; `refract_tint` is the share of
light that passes straight through, once.
"""

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE, Vec3, load3
from . import energy, microfacet
from .fresnel import f0_of_coating, fresnel_dielectric, tinted
from .lobe import ONE, ZERO, LobeSample, LobeValue, mirror_direction, no_direction, nothing
from .thin_film import film_over_dielectric, has_film, tinted_film


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    if wo.z <= 0.0 or wi.z >= 0.0 or microfacet.is_smooth(lobe):
        return nothing()
    f, pdf, _ = microfacet.evaluate_reflection(lobe, wo, Vec3(wi.x, wi.y, -wi.z))
    return LobeValue(WHITE * (f * lobe.energy_scale), pdf)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    if wo.z <= 0.0:
        return no_direction()
    if microfacet.is_smooth(lobe):
        wi = mirror_direction(wo)
        return LobeSample(Vec3(wi.x, wi.y, -wi.z), WHITE, ONE, True)
    wi, weight, pdf, _ = microfacet.sample_reflection(lobe, wo, u0, u1)
    if wi.z <= 0.0:
        return no_direction()
    return LobeSample(Vec3(wi.x, wi.y, -wi.z), WHITE * (weight * lobe.energy_scale), pdf, False)


@kernel
def albedo(lobe, wo):
    return WHITE * energy.mirror_share(lobe) if wo.z > 0.0 else BLACK


@kernel
def compensate(lobe, wo):
    """Set `energy_scale`; gives a factor for the weight."""
    _, transmitted = shares(lobe, wo.z)
    if not microfacet.is_smooth(lobe):
        energy.compensate_reflection(lobe, WHITE)
    return transmitted


@kernel
def shares(lobe, cos):
    """(colour reflected, colour transmitted) by the whole pane, all bounces inside it summed up."""
    tint = f0_of_coating(lobe.ior, load3(lobe, "f0"))
    real, cos_t = fresnel_dielectric(cos, lobe.ior)
    if cos_t <= 0.0:
        return WHITE, BLACK
    if has_film(lobe):
        thickness = lobe.film_thickness
        front = tinted_film(film_over_dielectric(cos, thickness, lobe.film_ior, lobe.ior), lobe.ior, tint)
        back = film_over_dielectric(cos_t, thickness, lobe.film_ior / lobe.ior, 1.0 / lobe.ior)
        back = tinted_film(back, lobe.ior, tint)
    else:
        front = tinted(real, lobe.ior, load3(lobe, "f0"))
        back = front
    color, depth = load3(lobe, "refract_tint"), 1.0 / cos_t
    passes = Vec3(color.x**depth, color.y**depth, color.z**depth)
    again = back * passes
    transmitted = passes * (WHITE - front) * (WHITE - back)
    transmitted = Vec3(_over(transmitted.x, again.x), _over(transmitted.y, again.y), _over(transmitted.z, again.z))
    return front + transmitted * again, transmitted


@kernel
def _over(first, again):
    """Sum of first, first again^2, first again^4, ..."""
    rest = 1.0 - again * again
    return first / rest if rest > 0.0 else ZERO
