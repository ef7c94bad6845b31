# SPDX-License-Identifier: GPL-3.0-or-later
"""The path integrator: next-event estimation and scattering, each weighted by MIS (Veach 1997, chapters 9 and 10)."""

import numpy as np

from ..guiding.trail import new_trail, teach
from ..jit import kernel
from ..linalg.vec3 import BLACK, load3
from ..sampling.sobol import half_of, sample_2d
from ..sampling.sobol8 import sample_vertex
from ..tables import LobeKind
from .direct import sample_direct
from .guided import leave_trail, sample_guided, set_guide
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
    """The PathSample that a CameraRay finds, at a time of the shutter. What it teaches is left on the film."""
    walk, bsdf, trail = new_walk(), new_bsdf(), new_trail()
    set_out(scene, walk, ray, time)
    trail.count = 0
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
        dimension = dimension_of(walk)
        u = sample_vertex(sampler, dimension)
        wo = make_bsdf(scene, settings, walk, it, bsdf)
        if bsdf.count == 0:
            break
        set_guide(scene, it, bsdf)
        looks = 2 if walk.bounces == 0 and scene.world[0].two_looks != 0 else 1

        # ---- Light that reaches us directly ----------------------------------------------------------------------
        if walk.ends_here == 0 and scene.world[0].light_count > 0:
            Ld = BLACK
            for look in range(looks):
                u0, u1 = u.light_u0, u.light_u1
                if looks == 2:
                    u0, u1 = sample_2d(half_of(sampler, look), dimension + 1)
                Ld = Ld + sample_direct(scene, settings, walk, it, bsdf, wo, looks, u.light, u0, u1)
            gather_direct(settings, walk, Ld)

        # ---- Choose where to go ----------------------------------------------------------------------------------
        s = sample_guided(scene, bsdf, wo, u.lobe, u.u0, u.u1)
        if s.kind == LobeKind.SUBSURFACE:
            go_below(walk, sampler, it, bsdf, u.lobe)
        leave_trail(scene, trail, walk, bsdf, s)
        if not follow(scene, settings, walk, it, s, ZERO if s.is_delta else s.pdf / np.float32(looks)):
            break

        # ---- Is it worth going on? -------------------------------------------------------------------------------
        if not survives(settings, walk, u.roulette):
            break
    teach(film, trail, load3(walk, "L"))
    return outcome(walk)
