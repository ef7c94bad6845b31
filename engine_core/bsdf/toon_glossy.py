# SPDX-License-Identifier: GPL-3.0-or-later
"""Glossy toon: light from a cone about the mirrored view. `toon` says what its parameters are."""

from ..jit import kernel
from ..linalg.frame import frame_from_normal, from_local
from ..linalg.vec3 import BLACK
from .lobe import LobeSample, mirror_direction, no_direction, nothing
from .toon import albedo_of_cone, sample_cone, value_in_cone


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    return value_in_cone(lobe, mirror_direction(wo), wi) if wo.z > 0.0 and wi.z > 0.0 else nothing()


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    """What the cone has below the horizon is lost."""
    if wo.z <= 0.0:
        return no_direction()
    axis = mirror_direction(wo)
    s, t = frame_from_normal(axis)
    found = sample_cone(lobe, u0, u1)
    wi = from_local(s, t, axis, found.wi)
    return LobeSample(wi, found.weight, found.pdf, False) if wi.z > 0.0 else no_direction()


@kernel
def albedo(lobe, wo):
    """Of the whole cone: an estimate from above where a part of it is below the horizon."""
    return albedo_of_cone(lobe) if wo.z > 0.0 else BLACK
