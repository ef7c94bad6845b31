# SPDX-License-Identifier: GPL-3.0-or-later
"""The mixture integrator: one direction a bounce, half of the time towards something chosen.

P. Shirley, "Ray Tracing: The Rest of Your Life". Directions come from a mixture of two densities, that of the material
and one that aims at lights and at chosen objects; the weight f |cos| / pdf has the density of the mixture, whichever
of both the direction came from. Light is found by running into it, and counts in full.
"""

import numpy as np

from ..bsdf import dispatch as bsdf_dispatch
from ..bsdf.dispatch import BsdfSample
from ..jit import kernel
from ..linalg.vec3 import BLACK, load3
from ..sampling.sobol8 import sample_vertex
from ..tables import LobeKind
from . import targets
from .direct import sample_delta
from .targets import NO_TARGET
from .vacuum import is_no_surface, is_scattered, scatter_in_media
from .walk import (
    ZERO,
    advance,
    arrive,
    dimension_of,
    follow,
    gather_direct,
    go_below,
    is_last,
    make_bsdf,
    new_bsdf,
    new_walk,
    outcome,
    set_out,
    survives,
)

BELOW_ONE = np.float32(1.0 - 2.0**-24)


@kernel
def trace(scene, settings, film, sampler, ray, time):
    """The PathSample that a CameraRay finds, at a time of the shutter."""
    walk, bsdf = new_walk(), new_bsdf()
    set_out(scene, walk, ray, time)
    while True:
        # ---- Where are we, and what shone on the way? ------------------------------------------------------------
        hit = advance(scene, settings, walk)
        if is_scattered(scene, settings, walk, sampler, hit):
            if scatter_in_media(scene, settings, walk, sampler):
                continue
            break
        if hit.prim < 0:
            break
        it = arrive(scene, settings, walk, hit)
        if is_no_surface(scene, walk, it):
            continue
        if is_last(scene, walk, it):
            break

        # ---- How does this place scatter? ------------------------------------------------------------------------
        u = sample_vertex(sampler, dimension_of(walk))
        wo = make_bsdf(scene, settings, walk, it, bsdf)

        # ---- Light that no ray runs into -------------------------------------------------------------------------
        if walk.ends_here == 0 and scene.world[0].delta_count > 0:
            gather_direct(settings, walk, sample_delta(scene, settings, walk, it, bsdf, wo, u.light))

        # ---- Choose where to go ----------------------------------------------------------------------------------
        s = sample_mixture(scene, load3(it, "p"), bsdf, wo, u.lobe, u.light_u0, u.u0, u.u1)
        if s.kind == LobeKind.SUBSURFACE:
            go_below(walk, sampler, it, bsdf, u.lobe)
        if not follow(scene, settings, walk, it, s, ZERO):
            break

        # ---- Is it worth going on? -------------------------------------------------------------------------------
        if not survives(settings, walk, u.roulette):
            break
    return outcome(walk)


@kernel
def sample_mixture(scene, p, bsdf, wo, u_lobe, u_target, u0, u1):
    """A direction by the material, or towards a target: half and half, where no lobe is a delta.

    Deltas scatter by themselves. A target is aimed at with half of the probability that the other lobes have, so the
    density is (1 - aim) sum pmf_i pdf_i + aim pdf_targets, in which sum the lobes are those without deltas. u0 makes
    this choice, too: the points (u0, u1) on either side of it, stretched, are as well spread as all of them.
    """
    aim = 0.5 * bsdf_dispatch.spread(bsdf) if scene.world[0].target_count > 0 else ZERO
    if u0 < aim:
        aimed = targets.sample(scene, p, u_target, min(u0 / aim, BELOW_ONE), u1)
        if aimed.pdf <= 0.0:
            return BsdfSample(BLACK, BLACK, ZERO, np.int32(0), False, False)
        f, density = bsdf_dispatch.evaluate_and_pdf(bsdf, wo, aimed.wi)
        density = (1.0 - aim) * density + aim * aimed.pdf
        kind = bsdf_dispatch.kind_of_lobe(bsdf, wo, aimed.wi, u_lobe)
        return BsdfSample(aimed.wi, f * (1.0 / density), density, kind, False, bsdf_dispatch.is_behind(bsdf, aimed.wi))

    lobes = 1.0 - aim
    s = bsdf_dispatch.sample(bsdf, wo, u_lobe, min((u0 - aim) / lobes, BELOW_ONE), u1)
    if s.pdf <= 0.0 or aim == 0.0:
        return s
    if s.is_delta:
        return BsdfSample(s.wi, s.weight * (1.0 / lobes), s.pdf * lobes, s.kind, True, s.is_transmission)
    density = lobes * s.pdf + aim * targets.pdf(scene, p, s.wi, NO_TARGET)
    return BsdfSample(s.wi, s.weight * (s.pdf / density), density, s.kind, False, s.is_transmission)
