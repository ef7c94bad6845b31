# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions by the names of `bsdf.dispatch`: what scatters in a medium, to those who know surfaces."""

import numpy as np

from ..bsdf.dispatch import BsdfSample
from ..jit import kernel
from ..medium import dispatch
from ..medium.dispatch import evaluate_and_pdf, share_seeing

NO_LOBE = np.int32(-1)


@kernel
def sample(phases, wo, u_phase, u0, u1):
    wi, weight, pdf = dispatch.sample(phases, wo, u_phase, u0, u1)
    return BsdfSample(wi, weight, pdf, NO_LOBE, False, False)


@kernel
def evaluate_lit(phases, wo, wi, n):
    return evaluate_and_pdf(phases, wo, wi)


@kernel
def spread(phases):
    return np.float32(1.0)


@kernel
def kind_of_lobe(phases, wo, wi, u):
    return NO_LOBE


@kernel
def is_behind(phases, wi):
    return False


@kernel
def guided_pdf(scene, phases, wi, pdf):
    """As `guided.guided_pdf`: nothing guides what is scattered in a medium."""
    return pdf


__all__ = [
    "evaluate_and_pdf",
    "evaluate_lit",
    "guided_pdf",
    "is_behind",
    "kind_of_lobe",
    "sample",
    "share_seeing",
    "spread",
]
