# SPDX-License-Identifier: GPL-3.0-or-later
"""All lobes of a point together, in directions of the world. What a lobe does by its kind is in `kinds`.

`sample` chooses a lobe by its `pmf`; evaluate and pdf are those of the mixture, sum f_i and sum pmf_i pdf_i, over the
lobes that are not deltas. So light sampling and scattering see the same BSDF, and their MIS weights add up to one.

Each lobe has a frame, and most often all have the first, whose normal is the smooth one of the surface; maps of bumps
and normals bend the others. Directions are turned into a frame once for all lobes in a row that have it.

Shading normals and faces: a lobe scatters in its shading frame, and only where the face agrees. Reflection has to leave
on the side of wo and refraction on the other, judged by `ng` too; else the value is zero, in `sample` and in `evaluate`
alike. Cycles has the test in sampling alone: for closed objects that is the same, as a ray below the face is blocked;
an open surface with smooth normals lets light through there and not here. What leaves a bent frame has to be on the
same side of the smooth normal as well, and what matt lobes scatter there fades towards its horizon: `bump_shadowing`.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE, Vec3, average, dot, is_black, load3, max_component, store3
from ..tables import FresnelKind, LobeKind, Visibility
from . import coating, conductor, dielectric, hair, hair_facets, thin_wall
from .energy import look_as_at, look_at_glass, look_at_mirror
from .kinds import is_delta, is_mirror, lobe_albedo, lobe_evaluate_and_pdf, lobe_sample, mirror_value
from .lobe import ONE, ZERO, has_no_sides, is_fibre, is_matt
from .microfacet import Reflection, evaluate_reflection, has_facets_of, is_smooth, passes_straight

BELOW_ONE = np.float32(1.0 - 2.0**-24)
HALF_PI = np.float32(0.5 * math.pi)


class BsdfSample(NamedTuple):
    """A direction chosen by a BSDF."""

    wi: Vec3
    weight: Vec3  # f |cos| / pdf of all lobes
    pdf: np.float32  # per solid angle; of a delta: the probability; 0: no direction, the path ends
    kind: np.int32  # LobeKind of the lobe that chose it
    is_delta: bool  # light sampling cannot find this direction
    is_transmission: bool  # wi is on the other side of the face


class BumpShadowing(NamedTuple):
    """What gets away of light that is scattered about a bent normal."""

    matt: np.float32
    glossy: np.float32


UNSHADOWED = BumpShadowing(ONE, ONE)

# ---- The trio --------------------------------------------------------------------------------------------------------


@kernel
def evaluate(bsdf, wo, wi):
    """f |cos(wi)|, deltas left out."""
    return evaluate_and_pdf(bsdf, wo, wi)[0]


@kernel
def pdf(bsdf, wo, wi):
    """Density per solid angle with which `sample` chooses wi, deltas left out."""
    return evaluate_and_pdf(bsdf, wo, wi)[1]


@kernel
def evaluate_and_pdf(bsdf, wo, wi):
    """(f |cos(wi)|, pdf)"""
    return _sum_lobes(bsdf, wo, wi, -1, load3(bsdf, "ng"))


@kernel
def evaluate_lit(bsdf, wo, wi, n):
    """The same for light from wi, the sides of the face being those of `n`: a smooth one may be lit by what is below
    the horizon of the flat one."""
    return _sum_lobes(bsdf, wo, wi, -1, n)


@kernel
def sample(bsdf, wo, u_lobe, u0, u1):
    """Choose a direction: a lobe by u_lobe (what is left of it chooses between reflection and refraction), then wi."""
    chosen, pmf, u = _choose_lobe(bsdf, u_lobe)
    if chosen < 0:
        return BsdfSample(BLACK, BLACK, ZERO, np.int32(0), False, False)
    lobe = bsdf.lobes[chosen]
    frame = bsdf.frames[lobe.frame]
    s = lobe_sample(lobe, to_local(frame, wo), u, u0, u1)
    wi = to_world(frame, s.wi)
    is_transmission = is_behind(bsdf, wi)
    if s.pdf == 0.0 or (is_transmission != (s.wi.z < 0.0) and not has_no_sides(lobe.kind)):
        return BsdfSample(BLACK, BLACK, ZERO, lobe.kind, False, False)
    if lobe.kind == LobeKind.HAIR:  # what counts is whether light has been inside, not where it leaves
        is_transmission = hair.goes_through(lobe, to_local(frame, wo), u)
    if lobe.kind == LobeKind.HAIR_FACETS:
        is_transmission = hair_facets.goes_through(lobe, to_local(frame, wo), u)
    weight, density = load3(lobe, "weight") * s.weight, pmf * s.pdf
    if lobe.frame > 0 and not s.is_delta:
        weight = weight * let_away(lobe.kind, bump_shadowing(bsdf, lobe.frame, wi, s.wi.z))
    if bsdf.shadow_stretch > 1.0 and not is_transmission:
        weight = weight * _stretched(bsdf.shadow_stretch, s.wi.z)
    if bsdf.count > 1:
        if s.is_delta:
            weight = weight * (1.0 / pmf)
        else:
            f, others = _sum_lobes(bsdf, wo, wi, chosen, load3(bsdf, "ng"))
            f, density = f + weight * s.pdf, others + density
            weight = f * (1.0 / density)
    return BsdfSample(wi, weight, density, lobe.kind, s.is_delta, is_transmission)


@kernel
def spread(bsdf):
    """Probability that `sample` chooses a lobe that is no delta."""
    total = ZERO
    for i in range(bsdf.count):
        if not is_delta(bsdf.lobes[i]):
            total += bsdf.lobes[i].pmf
    return total


@kernel
def kind_of_lobe(bsdf, wo, wi, u):
    """Kind of a lobe that scatters to wi: of several one by chance, as often as it is the one that chooses wi."""
    if bsdf.count == 1:
        return bsdf.lobes[0].kind
    _, total = _sum_lobes(bsdf, wo, wi, -1, load3(bsdf, "ng"))
    rest, kind = u * total, bsdf.lobes[0].kind
    for i in range(bsdf.count):
        lobe = bsdf.lobes[i]
        if lobe.pmf > 0.0:
            share = _density_of_lobe(bsdf, lobe, wo, wi)
            if share > 0.0:
                kind = lobe.kind
                if rest < share:
                    break
            rest -= share
    return kind


@kernel
def share_seeing(bsdf, wo, wi, visibility):
    """Share of the paths scattered to wi whose rays see what has that Visibility: by the lobe that chose wi."""
    if is_behind(bsdf, wi):
        return ONE if visibility & Visibility.TRANSMISSION.value else ZERO
    matt_see, glossy_see = visibility & Visibility.DIFFUSE.value != 0, visibility & Visibility.GLOSSY.value != 0
    if matt_see == glossy_see:
        return ONE if matt_see else ZERO
    seeing, total = ZERO, ZERO
    for i in range(bsdf.count):
        lobe = bsdf.lobes[i]
        if lobe.pmf > 0.0:
            density = _density_of_lobe(bsdf, lobe, wo, wi)
            total += density
            if is_matt(lobe.kind) == matt_see:
                seeing += density
    return seeing / total if total > 0.0 else ZERO


@kernel
def is_behind(bsdf, wi):
    """Whether wi is on the other side of the face than wo."""
    return dot(load3(bsdf, "ng"), wi) < 0.0


@kernel
def albedo(bsdf, wo):
    """Share of light from everywhere that leaves towards wo, by colour; see the models for how exact."""
    if bsdf.count != 1:
        return load3(bsdf, "albedo")
    lobe = bsdf.lobes[0]
    return load3(lobe, "weight") * lobe_albedo(lobe, to_local(bsdf.frames[lobe.frame], wo))


@kernel
def chosen_lobe(bsdf, u_lobe):
    """Number of the lobe that `sample` chooses by `u_lobe`; -1 if all are black."""
    return _choose_lobe(bsdf, u_lobe)[0]


@kernel
def become_matt(bsdf):
    """Nothing but a white diffuse lobe: where light comes out that was scattered below the surface."""
    frame = 0
    for i in range(bsdf.count):
        if bsdf.lobes[i].kind == LobeKind.SUBSURFACE:
            frame = bsdf.lobes[i].frame
    bsdf.count = 1
    lobe = bsdf.lobes[0]
    lobe.frame = frame
    lobe.kind = LobeKind.DIFFUSE
    store3(lobe, "weight", WHITE)
    lobe.multiscatter = 0


@kernel
def _choose_lobe(bsdf, u):
    """(lobe, its pmf, u as good as new); -1 if all are black."""
    if bsdf.count == 1:
        return (0 if bsdf.lobes[0].pmf > 0.0 else -1), ONE, u
    chosen, pmf, rest = -1, ONE, u
    for i in range(bsdf.count):
        p = bsdf.lobes[i].pmf
        if p > 0.0:
            chosen, pmf, rest = i, p, u
            if u < p:
                break
        u -= p
    return chosen, pmf, min(rest / pmf, BELOW_ONE)


@kernel
def _sum_lobes(bsdf, wo, wi, but, n):
    """(sum f, sum pmf pdf) over all lobes but one, where they agree with `n` on which side wi is.

    Lobes of equal microfacets, such as a metal and the varnish on it, share the work on these.
    """
    f, density = BLACK, ZERO
    is_above = dot(n, wi) > 0.0
    frame, wo_local, wi_local, shadowing = -1, wo, wi, UNSHADOWED
    mirror, reflection = -1, Reflection(ZERO, ZERO, ZERO)
    for i in range(bsdf.count):
        lobe = bsdf.lobes[i]
        if i != but and lobe.pmf > 0.0:
            if lobe.frame != frame:
                frame, mirror = lobe.frame, -1
                wo_local, wi_local = to_local(bsdf.frames[frame], wo), to_local(bsdf.frames[frame], wi)
                if frame > 0:
                    shadowing = bump_shadowing(bsdf, frame, wi, wi_local.z)
            if (wi_local.z > 0.0) == is_above or has_no_sides(lobe.kind):
                if is_mirror(lobe.kind):
                    if mirror < 0 or not has_facets_of(lobe, bsdf.lobes[mirror]):
                        mirror, reflection = i, evaluate_reflection(lobe, wo_local, wi_local)
                    value = mirror_value(lobe, reflection)
                else:
                    value = lobe_evaluate_and_pdf(lobe, wo_local, wi_local)
                lit = load3(lobe, "weight") * value.f
                if frame > 0:
                    lit = lit * let_away(lobe.kind, shadowing)
                if bsdf.shadow_stretch > 1.0:
                    lit = lit * _stretched(bsdf.shadow_stretch, wi_local.z)
                f, density = f + lit, density + lobe.pmf * value.pdf
    return f, density


@kernel
def _density_of_lobe(bsdf, lobe, wo, wi):
    """What the lobe adds to the density of wi."""
    frame = bsdf.frames[lobe.frame]
    wi_local = to_local(frame, wi)
    if (wi_local.z > 0.0) != (dot(load3(bsdf, "ng"), wi) > 0.0) and not has_no_sides(lobe.kind):
        return ZERO
    return lobe.pmf * lobe_evaluate_and_pdf(lobe, to_local(frame, wo), wi_local).pdf


@kernel
def bump_shadowing(bsdf, row, wi, z):
    """Share of what lobes with a bent normal scatter to wi that gets away, a BumpShadowing; z: its height in the frame.

    None where the smooth normal and the bent one disagree on which side wi is. What matt lobes scatter is shadowed as
    by microfacets as steep as the bend (Conty Estevez, Lecocq and Stein 2019, "A Microfacet-Based Shadowing Function to
    Solve the Bump Terminator Problem"), so that light fades towards the horizon and is not cut off.
    """
    frame, smooth = bsdf.frames[row], load3(bsdf.frames[0], "n")
    cos = dot(smooth, wi)
    if cos * z * dot(smooth, load3(frame, "n")) < 0.0:
        return BumpShadowing(ZERO, ZERO)
    cos = abs(cos)
    if cos < 1e-6:
        return BumpShadowing(ZERO, ONE)
    return BumpShadowing(2.0 * cos / (cos + math.sqrt(cos * cos + frame.bend * (1.0 - cos * cos))), ONE)


@kernel
def let_away(kind, shadowing):
    """The share that gets away of what a lobe of that LobeKind scatters."""
    if is_fibre(kind):
        return ONE
    if (is_matt(kind) or kind == LobeKind.TRANSLUCENT) and kind != LobeKind.VELVET:
        return shadowing.matt
    return shadowing.glossy


@kernel
def _stretched(factor, cos):
    """Of light that a lobe reflects at that cosine to its normal, the share that is left if angles were larger by a
    factor: so shadows set in before faces turn away (Blender's Shading Offset of the shadow terminator)."""
    if cos <= 0.0:
        return ONE
    angle = factor * math.acos(min(cos, ONE))
    return math.cos(angle) / cos if angle < HALF_PI else ZERO


# ---- Preparation -----------------------------------------------------------------------------------------------------


@kernel
def prepare(bsdf, wo, backfacing):
    """Make the lobes ready for this hit, once they and the frame are set.

    Turns indices of refraction around at a back face, compensates for the energy that single scattering loses, lets
    what coatings reflect not reach what lies below, and shares out the lobes' probability by what they give back.
    """
    total = BLACK
    for i in range(bsdf.count):
        lobe = bsdf.lobes[i]
        wo_local = to_local(bsdf.frames[lobe.frame], wo)
        if wo_local.z > 0.0:
            _look_at(bsdf, i, wo_local)
        if backfacing and (lobe.kind == LobeKind.DIELECTRIC or lobe.kind == LobeKind.REFRACTION):
            lobe.film_ior /= lobe.ior
            lobe.ior = 1.0 / lobe.ior
        lobe.energy_scale = ONE
        darkening = WHITE
        if lobe.multiscatter and wo_local.z > 0.0:
            darkening = _compensate(lobe, wo_local)
            store3(lobe, "weight", load3(lobe, "weight") * darkening)
        if bsdf.count == 1:
            lobe.pmf = ZERO if is_black(load3(lobe, "weight")) else ONE
            return
        share = lobe_albedo(lobe, wo_local)
        given = load3(lobe, "weight") * share
        lobe.pmf = average(given)
        total = total + given
        if lobe.covers > 0.0:
            _cover(bsdf, i, wo_local, share * darkening)
    store3(bsdf, "albedo", total)
    scale = 1.0 / average(total) if not is_black(total) else ZERO
    for i in range(bsdf.count):
        bsdf.lobes[i].pmf *= scale


@kernel
def _look_at(bsdf, row, wo):
    """Ask the tables for a lobe of microfacets; most often that before it has the same, such as the metal below a
    varnish."""
    lobe, before = bsdf.lobes[row], bsdf.lobes[max(row - 1, 0)]
    if is_mirror(lobe.kind) or lobe.kind == LobeKind.THIN_WALL:
        if row > 0 and is_mirror(before.kind) and before.frame == lobe.frame and has_facets_of(lobe, before):
            look_as_at(lobe, before)
        else:
            look_at_mirror(lobe, wo.z)
    elif lobe.kind == LobeKind.DIELECTRIC or lobe.kind == LobeKind.REFRACTION:
        look_at_glass(lobe, wo.z)


@kernel
def _compensate(lobe, wo):
    """Set `energy_scale` of a lobe that has one; gives a factor for its weight."""
    if lobe.kind == LobeKind.CONDUCTOR and (lobe.fresnel == FresnelKind.THIN_WALL or not is_smooth(lobe)):
        return conductor.compensate(lobe, wo)
    if lobe.kind == LobeKind.THIN_WALL:
        return thin_wall.compensate(lobe, wo)
    if lobe.kind == LobeKind.COATING and not is_smooth(lobe):
        return coating.compensate(lobe)
    if lobe.kind == LobeKind.DIELECTRIC and not passes_straight(lobe):
        return dielectric.compensate(lobe)
    return WHITE


@kernel
def _cover(bsdf, cover, wo, share):
    """Reduce the lobes below the coating `cover` by the largest component of `share`, its albedo, and by its tint.

    By the largest, so that no colour gets more than what comes in, at the price of a little dark (as Cycles); a varnish
    that loses light covers as if it reflected that.
    """
    coat = bsdf.lobes[cover]
    if coat.kind == LobeKind.COATING and not coat.multiscatter:
        share = coating.seeming_albedo(coat, wo)
    passing = coating.absorption(coat, wo) * max(1.0 - coat.covers * max_component(share), 0.0)
    for i in range(cover + 1, bsdf.count):
        lobe = bsdf.lobes[i]
        if lobe.layer == coat.layer and coat.layer != 0:
            store3(lobe, "weight", load3(lobe, "weight") * passing)


# ---- Frames ----------------------------------------------------------------------------------------------------------


@kernel
def to_local(frame, w):
    return Vec3(dot(load3(frame, "s"), w), dot(load3(frame, "t"), w), dot(load3(frame, "n"), w))


@kernel
def to_world(frame, w):
    return load3(frame, "s") * w.x + load3(frame, "t") * w.y + load3(frame, "n") * w.z
