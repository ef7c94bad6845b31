# SPDX-License-Identifier: GPL-3.0-or-later
"""Nothing in the way: light goes straight on."""

from ..jit import kernel
from ..linalg.vec3 import WHITE
from .lobe import ONE, LobeSample, nothing


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    """A delta in one direction: zero in all that can be asked for."""
    return nothing()


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    return LobeSample(-wo, WHITE, ONE, True)


@kernel
def albedo(lobe, wo):
    return WHITE
