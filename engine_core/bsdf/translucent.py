# SPDX-License-Identifier: GPL-3.0-or-later
"""Lambert through the surface: scatters the same radiance everywhere on the far side. The BSDF is albedo / pi."""

from ..jit import kernel
from ..linalg.vec3 import WHITE
from ..sampling.warp import square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf
from .lobe import LobeSample, LobeValue


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    pdf = square_to_cosine_hemisphere_pdf(-wi)
    return LobeValue(WHITE * pdf, pdf)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    """The density is f |cos| itself, so that the weight is 1."""
    up = square_to_cosine_hemisphere(u0, u1)
    return LobeSample(-up, WHITE, square_to_cosine_hemisphere_pdf(up), False)


@kernel
def albedo(lobe, wo):
    return WHITE
