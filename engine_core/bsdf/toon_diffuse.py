# SPDX-License-Identifier: GPL-3.0-or-later
"""Matt toon: light from a cone about the normal, wherever it is seen from. `toon` says what its parameters are."""

from ..jit import kernel
from .lobe import UP, nothing
from .toon import albedo_of_cone, sample_cone, value_in_cone


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    return value_in_cone(lobe, UP, wi) if wi.z > 0.0 else nothing()


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    return sample_cone(lobe, u0, u1)


@kernel
def albedo(lobe, wo):
    return albedo_of_cone(lobe)
