# SPDX-License-Identifier: GPL-3.0-or-later
"""Lambert: scatters the same radiance everywhere above the surface. The BSDF is albedo / pi.

Does not ask where wo is: a smooth normal may turn away from a viewer who sees the face, and the face stays lit.
"""

from ..jit import kernel
from ..linalg.vec3 import WHITE
from ..sampling.warp import square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf
from .lobe import LobeSample, LobeValue


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    pdf = square_to_cosine_hemisphere_pdf(wi)
    return LobeValue(WHITE * pdf, pdf)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    """The density is f |cos| itself, so that the weight is 1."""
    wi = square_to_cosine_hemisphere(u0, u1)
    return LobeSample(wi, WHITE, square_to_cosine_hemisphere_pdf(wi), False)


@kernel
def albedo(lobe, wo):
    return WHITE
