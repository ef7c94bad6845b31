# SPDX-License-Identifier: GPL-3.0-or-later
"""The path integrator: next-event estimation and scattering, each weighted by MIS (Veach 1997, chapters 9 and 10).

Brute force is the same loop without light sampling: lights are found by scattering alone, and count in full.
"""

import math
from typing import NamedTuple

import numpy as np

from ..accel.traverse import intersect_closest
from ..bsdf import dispatch as bsdf_dispatch
from ..jit import kernel
from ..linalg.ray import offset_ray_origin
from ..linalg.records import scratch_record
from ..linalg.vec3 import BLACK, WHITE, Vec3, average, dot, is_black, max_component
from ..sampling.sobol import sample_1d, sample_2d
from ..settings import IntegratorKind
from ..shader.evaluate import fill_bsdf
from ..shape.interaction import make_interaction
from ..tables import BSDF, LobeKind, MaterialFlag, Visibility
from .direct import Origin, background_radiance, lamp_radiance, sample_direct, surface_emission

new_bsdf = scratch_record(BSDF)

# Dimensions of a sample, in pairs: 0 the pixel filter, 1 the lens, then four for each vertex of the path:
# which light and which lobe, a point on the light, a direction, Russian roulette.
FIRST_DIMENSION, DIMENSIONS_PER_VERTEX = 2, 4
FAR = np.float32(np.inf)


class PathSample(NamedTuple):
    """What one path brought, and what its first vertex was."""

    L: Vec3
    alpha: float  # 0 where the camera sees the background
    p: Vec3
    normal: Vec3
    albedo: Vec3
    hit: bool


@kernel
def clamped(L, limit):
    """`L` with its largest component no larger than `limit`; 0 means no limit."""
    largest = max_component(L)
    if limit > 0.0 and largest > limit:
        return L * (limit / largest)
    return L


@kernel
def trace_path(scene, settings, sampler, o, d, t_max):
    """Radiance that arrives at `o` from the unit direction `d`; the camera sees no further than `t_max`."""
    bsdf = new_bsdf()
    samples_lights = settings.integrator == IntegratorKind.PATH
    beta = WHITE  # throughput
    L = BLACK  # radiance gathered so far
    alpha = np.float32(1.0)

    origin = Origin(o, d, False, np.float32(0.0))  # the last place that scattered
    distance = np.float32(0.0)  # from there to `o`; more than 0 after passing through something transparent
    visibility = Visibility.CAMERA.value

    bounces = diffuse_bounces = glossy_bounces = transmission_bounces = transparent_bounces = 0
    ends_here = False  # the limits allow no more scattering: gather emission and stop
    first_p, first_normal, first_albedo, first_hit = BLACK, BLACK, BLACK, False

    while True:
        # ---- Where are we? ---------------------------------------------------------------------------------------
        hit = intersect_closest(scene, o, d, t_max, visibility)
        limit = settings.clamp_direct if bounces <= 1 else settings.clamp_indirect

        # ---- Light that this ray runs into -----------------------------------------------------------------------
        if scene.world[0].lamp_root >= 0:
            Le = lamp_radiance(scene, o, d, hit.t, origin, distance, visibility)
            L = L + clamped(beta * Le, limit)
        if hit.prim < 0:
            if visibility == Visibility.CAMERA.value and settings.transparent_background != 0:
                alpha = 1.0 - average(beta)
            else:
                L = L + clamped(beta * background_radiance(scene, d, origin, visibility), limit)
            break
        it = make_interaction(scene, hit, o, d)
        material = scene.materials[it.material]
        if material.flags & MaterialFlag.EMISSIVE.value:
            Le = surface_emission(scene, it, d, origin, distance + hit.t)
            L = L + clamped(beta * Le, limit)

        # ---- How does this place scatter? ------------------------------------------------------------------------
        if ends_here and not material.flags & MaterialFlag.TRANSPARENT.value:
            break
        wo = -d
        spreads = diffuse_bounces > 0
        fill_bsdf(
            scene,
            it,
            bsdf,
            not spreads or settings.reflective_caustics != 0,
            not spreads or settings.refractive_caustics != 0,
        )
        bsdf_dispatch.prepare(bsdf, wo, it.backfacing)
        both_sides = material.flags & MaterialFlag.TRANSMITS.value != 0
        if not first_hit:
            first_p, first_normal, first_hit = it.p, it.ns, True
            first_albedo = bsdf_dispatch.albedo(bsdf, wo)

        # ---- Light that reaches us directly ----------------------------------------------------------------------
        dimension = FIRST_DIMENSION + DIMENSIONS_PER_VERTEX * (bounces + transparent_bounces)
        u_select, u_lobe = sample_2d(sampler, dimension)
        if samples_lights and not ends_here and scene.world[0].light_count > 0:
            u0, u1 = sample_2d(sampler, dimension + 1)
            Ld = sample_direct(scene, settings, it, bsdf, wo, visibility, both_sides, u_select, u0, u1)
            L = L + clamped(beta * Ld, settings.clamp_direct if bounces == 0 else settings.clamp_indirect)

        # ---- Choose where to go ----------------------------------------------------------------------------------
        u0, u1 = sample_2d(sampler, dimension + 2)
        s = bsdf_dispatch.sample(bsdf, wo, u_lobe, u0, u1)
        if s.pdf <= 0.0:
            break
        if s.kind == LobeKind.TRANSPARENT:
            transparent_bounces += 1
            if transparent_bounces > settings.transparent_bounces:
                break
            distance += hit.t
            t_max -= hit.t
        else:
            if ends_here:
                break
            bounces += 1
            if s.is_transmission:
                transmission_bounces += 1
                visibility = Visibility.TRANSMISSION.value
            elif s.kind == LobeKind.DIFFUSE:
                diffuse_bounces += 1
                visibility = Visibility.DIFFUSE.value
            else:
                glossy_bounces += 1
                visibility = Visibility.GLOSSY.value
            ends_here = (
                bounces > settings.max_bounces
                or diffuse_bounces > settings.diffuse_bounces
                or glossy_bounces > settings.glossy_bounces
                or transmission_bounces > settings.transmission_bounces
            )
            pdf = np.float32(0.0) if s.is_delta or not samples_lights else s.pdf
            origin, distance, t_max = Origin(it.p, it.ns, both_sides, pdf), np.float32(0.0), FAR
        beta = beta * s.weight
        if is_black(beta):
            break
        o = offset_ray_origin(it.p, it.ng if dot(s.wi, it.ng) > 0.0 else -it.ng)
        d = s.wi

        # ---- Is it worth going on? -------------------------------------------------------------------------------
        if bounces > settings.min_bounces:
            # the root keeps dim paths longer than their throughput says, since they may still find a bright light
            survival = min(1.0, math.sqrt(max_component(beta)))
            if sample_1d(sampler, dimension + 3) >= survival:
                break
            beta = beta * (1.0 / survival)

    if not first_hit:
        first_albedo = WHITE
    return PathSample(L, alpha, first_p, first_normal, first_albedo, first_hit)
