# SPDX-License-Identifier: GPL-3.0-or-later
"""Brute force: scatter by the material alone, and find lights by luck.

P. Shirley, "Ray Tracing in One Weekend". The density of the directions knows nothing of where light is; hence the name
of the file.
"""

from ..bsdf import dispatch as bsdf_dispatch
from ..jit import kernel
from ..sampling.sobol8 import sample_vertex
from ..tables import LobeKind
from .direct import sample_delta
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
        s = bsdf_dispatch.sample(bsdf, wo, u.lobe, u.u0, u.u1)
        if s.kind == LobeKind.SUBSURFACE:
            go_below(walk, sampler, it, bsdf, u.lobe)
        if not follow(scene, settings, walk, it, s, ZERO):
            break

        # ---- Is it worth going on? -------------------------------------------------------------------------------
        if not survives(settings, walk, u.roulette):
            break
    return outcome(walk)
