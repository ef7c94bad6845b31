# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattering by one number, the mean cosine g; g = 0 scatters everywhere alike."""

from ..jit import kernel
from . import phase as formulas


@kernel
def evaluate(phase, cosine):
    """Density per solid angle at the cosine of the angle between the directions of travel before and after."""
    return formulas.henyey_greenstein(cosine, phase.g)


@kernel
def sample_cosine(phase, u):
    return formulas.sample_cosine(phase.g, u)
