# SPDX-License-Identifier: GPL-3.0-or-later
"""All phase functions of a point together. The one place that asks for their kind.

The names and arguments are those of `bsdf/dispatch.py`, so that a place in a medium can stand where a place on a
surface can: `phases` for the BSDF, wo against the direction of travel, f without a cosine.
"""

import numpy as np

from ..jit import kernel
from ..linalg.records import copy_record
from ..linalg.vec3 import BLACK, Vec3, average, dot, load3, store3
from ..medium_tables import MAX_PHASES, PhaseKind
from ..tables import Visibility
from . import draine, fournier_forand, henyey_greenstein, rayleigh
from .phase import direction_around

ZERO, ONE = np.float32(0.0), np.float32(1.0)
BELOW_ONE = np.float32(1.0 - 2.0**-24)


# ---- One phase function ----------------------------------------------------------------------------------------------


@kernel
def phase_value(phase, cosine):
    """Density per solid angle; its integral over all directions is 1."""
    if phase.kind == PhaseKind.HENYEY_GREENSTEIN:
        return henyey_greenstein.evaluate(phase, cosine)
    if phase.kind == PhaseKind.RAYLEIGH:
        return rayleigh.evaluate(phase, cosine)
    if phase.kind == PhaseKind.DRAINE:
        return draine.evaluate(phase, cosine)
    return fournier_forand.evaluate(phase, cosine)


@kernel
def sample_cosine(phase, u):
    """The cosine between the directions of travel before and after, with the density of `phase_value`."""
    if phase.kind == PhaseKind.HENYEY_GREENSTEIN:
        return henyey_greenstein.sample_cosine(phase, u)
    if phase.kind == PhaseKind.RAYLEIGH:
        return rayleigh.sample_cosine(phase, u)
    if phase.kind == PhaseKind.DRAINE:
        return draine.sample_cosine(phase, u)
    return fournier_forand.sample_cosine(phase, u)


# ---- All that are at a point -----------------------------------------------------------------------------------------


@kernel
def gather_phases(scene, media, beta, phases):
    """Make `phases` of the media of a place, for a path of throughput `beta`, which brings their scattering already."""
    sigma_s = load3(media, "sigma_s")
    phases.count = 0
    total = ZERO
    for i in range(media.count):
        medium = scene.media[media.medium[i]]
        for row in range(medium.phases, medium.phases + medium.phase_count):
            if phases.count < MAX_PHASES:
                phase = phases.phases[phases.count]
                copy_record(phase, scene.phases[row])
                weight = share_of(load3(phase, "weight"), sigma_s)
                store3(phase, "weight", weight)
                phase.pmf = average(beta * weight)
                total += phase.pmf
                phases.count += 1
    for i in range(phases.count):
        phases.phases[i].pmf = phases.phases[i].pmf / total if total > 0.0 else ZERO


@kernel
def share_of(part, whole):
    return Vec3(
        part.x / whole.x if whole.x > 0.0 else ZERO,
        part.y / whole.y if whole.y > 0.0 else ZERO,
        part.z / whole.z if whole.z > 0.0 else ZERO,
    )


@kernel
def evaluate_and_pdf(phases, wo, wi):
    """(f, pdf)"""
    cosine = min(max(-dot(wo, wi), -1.0), 1.0)
    f, density = BLACK, ZERO
    for i in range(phases.count):
        phase = phases.phases[i]
        value = phase_value(phase, cosine)
        f, density = f + load3(phase, "weight") * value, density + phase.pmf * value
    return f, density


@kernel
def sample(phases, wo, u_phase, u0, u1):
    """(wi, f / pdf, pdf): a direction by one of the phase functions. A pdf of 0: there is none."""
    chosen = -1
    for i in range(phases.count):
        if phases.phases[i].pmf > 0.0:
            chosen = i
            if u_phase < phases.phases[i].pmf:
                break
        u_phase -= phases.phases[i].pmf
    if chosen < 0:
        return BLACK, BLACK, ZERO
    wi = direction_around(-wo, sample_cosine(phases.phases[chosen], u0), u1)
    f, density = evaluate_and_pdf(phases, wo, wi)
    return wi, f * (1.0 / density) if density > 0.0 else BLACK, density


@kernel
def share_seeing(phases, wo, wi, visibility):
    """Share of the paths scattered to wi whose rays see what has that Visibility."""
    return ONE if visibility & Visibility.SCATTER.value else ZERO
