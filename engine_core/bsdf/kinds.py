# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes by their kind: each model's trio behind one name, in the local frame and without the lobe's weight."""

from ..jit import kernel
from ..linalg.vec3 import BLACK
from ..tables import LobeKind
from . import (
    ashikhmin_shirley,
    coating,
    conductor,
    dielectric,
    diffuse,
    hair,
    hair_facets,
    hair_reflection,
    hair_transmission,
    refraction,
    rough_diffuse,
    sheen,
    subsurface,
    thin_wall,
    toon_diffuse,
    toon_glossy,
    translucent,
    transparent,
    velvet,
)
from .lobe import no_direction, nothing
from .microfacet import is_smooth, passes_straight


@kernel
def lobe_evaluate_and_pdf(lobe, wo, wi):
    if lobe.kind == LobeKind.DIFFUSE:
        return diffuse.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.CONDUCTOR:
        return conductor.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.COATING:
        return coating.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.DIELECTRIC:
        return dielectric.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.REFRACTION:
        return refraction.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.TRANSLUCENT:
        return translucent.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.TRANSPARENT:
        return transparent.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.ROUGH_DIFFUSE:
        return rough_diffuse.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.TOON_DIFFUSE:
        return toon_diffuse.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.TOON_GLOSSY:
        return toon_glossy.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.SHEEN:
        return sheen.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.VELVET:
        return velvet.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.ASHIKHMIN_SHIRLEY:
        return ashikhmin_shirley.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.SUBSURFACE:
        return subsurface.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.THIN_WALL:
        return thin_wall.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.HAIR:
        return hair.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.HAIR_REFLECTION:
        return hair_reflection.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.HAIR_TRANSMISSION:
        return hair_transmission.evaluate_and_pdf(lobe, wo, wi)
    if lobe.kind == LobeKind.HAIR_FACETS:
        return hair_facets.evaluate_and_pdf(lobe, wo, wi)
    return nothing()


@kernel
def is_mirror(kind):
    """Whether a LobeKind is made of microfacets that reflect and do nothing else."""
    return kind == LobeKind.CONDUCTOR or kind == LobeKind.COATING


@kernel
def mirror_value(lobe, m):
    """`lobe_evaluate_and_pdf` of such a kind, whose Reflection `m` is known."""
    return conductor.value_of(lobe, m) if lobe.kind == LobeKind.CONDUCTOR else coating.value_of(lobe, m)


@kernel
def lobe_sample(lobe, wo, u_choice, u0, u1):
    if lobe.kind == LobeKind.DIFFUSE:
        return diffuse.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.CONDUCTOR:
        return conductor.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.COATING:
        return coating.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.DIELECTRIC:
        return dielectric.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.REFRACTION:
        return refraction.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.TRANSLUCENT:
        return translucent.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.TRANSPARENT:
        return transparent.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.ROUGH_DIFFUSE:
        return rough_diffuse.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.TOON_DIFFUSE:
        return toon_diffuse.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.TOON_GLOSSY:
        return toon_glossy.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.SHEEN:
        return sheen.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.VELVET:
        return velvet.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.ASHIKHMIN_SHIRLEY:
        return ashikhmin_shirley.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.SUBSURFACE:
        return subsurface.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.THIN_WALL:
        return thin_wall.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.HAIR:
        return hair.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.HAIR_REFLECTION:
        return hair_reflection.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.HAIR_TRANSMISSION:
        return hair_transmission.sample(lobe, wo, u_choice, u0, u1)
    if lobe.kind == LobeKind.HAIR_FACETS:
        return hair_facets.sample(lobe, wo, u_choice, u0, u1)
    return no_direction()


@kernel
def lobe_albedo(lobe, wo):
    """Without the lobe's weight."""
    if lobe.kind == LobeKind.CONDUCTOR:
        return conductor.albedo(lobe, wo)
    if lobe.kind == LobeKind.COATING:
        return coating.albedo(lobe, wo)
    if lobe.kind == LobeKind.DIELECTRIC:
        return dielectric.albedo(lobe, wo)
    if lobe.kind == LobeKind.REFRACTION:
        return refraction.albedo(lobe, wo)
    if lobe.kind == LobeKind.DIFFUSE:
        return diffuse.albedo(lobe, wo)
    if lobe.kind == LobeKind.TRANSLUCENT:
        return translucent.albedo(lobe, wo)
    if lobe.kind == LobeKind.TRANSPARENT:
        return transparent.albedo(lobe, wo)
    if lobe.kind == LobeKind.ROUGH_DIFFUSE:
        return rough_diffuse.albedo(lobe, wo)
    if lobe.kind == LobeKind.TOON_DIFFUSE:
        return toon_diffuse.albedo(lobe, wo)
    if lobe.kind == LobeKind.TOON_GLOSSY:
        return toon_glossy.albedo(lobe, wo)
    if lobe.kind == LobeKind.SHEEN:
        return sheen.albedo(lobe, wo)
    if lobe.kind == LobeKind.VELVET:
        return velvet.albedo(lobe, wo)
    if lobe.kind == LobeKind.ASHIKHMIN_SHIRLEY:
        return ashikhmin_shirley.albedo(lobe, wo)
    if lobe.kind == LobeKind.SUBSURFACE:
        return subsurface.albedo(lobe, wo)
    if lobe.kind == LobeKind.THIN_WALL:
        return thin_wall.albedo(lobe, wo)
    if lobe.kind == LobeKind.HAIR:
        return hair.albedo(lobe, wo)
    if lobe.kind == LobeKind.HAIR_REFLECTION:
        return hair_reflection.albedo(lobe, wo)
    if lobe.kind == LobeKind.HAIR_TRANSMISSION:
        return hair_transmission.albedo(lobe, wo)
    if lobe.kind == LobeKind.HAIR_FACETS:
        return hair_facets.albedo(lobe, wo)
    return BLACK


@kernel
def is_delta(lobe):
    """Whether it scatters in single directions only."""
    kind = lobe.kind
    if kind == LobeKind.DIELECTRIC or kind == LobeKind.REFRACTION:
        return passes_straight(lobe)
    if kind == LobeKind.CONDUCTOR or kind == LobeKind.COATING or kind == LobeKind.THIN_WALL:
        return is_smooth(lobe)
    return kind == LobeKind.TRANSPARENT or kind == LobeKind.SUBSURFACE
