# SPDX-License-Identifier: GPL-3.0-or-later
"""Matt through the surface: Lambert, the same radiance everywhere on the far side; or as rough as alpha_x says.

The BSDF is albedo / pi, or that of `rough_diffuse` in the mirror of the face.
"""

from ..jit import kernel
from ..linalg.vec3 import WHITE, Vec3
from ..sampling.warp import square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf
from . import rough_diffuse
from .lobe import LobeSample, LobeValue


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    if lobe.alpha_x > 0.0:
        return rough_diffuse.evaluate_and_pdf(lobe, wo, Vec3(wi.x, wi.y, -wi.z))
    pdf = square_to_cosine_hemisphere_pdf(-wi)
    return LobeValue(WHITE * pdf, pdf)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    """Of Lambert's the density is f |cos| itself, so that the weight is 1."""
    if lobe.alpha_x > 0.0:
        s = rough_diffuse.sample(lobe, wo, u_choice, u0, u1)
        return LobeSample(Vec3(s.wi.x, s.wi.y, -s.wi.z), s.weight, s.pdf, False)
    up = square_to_cosine_hemisphere(u0, u1)
    return LobeSample(-up, WHITE, square_to_cosine_hemisphere_pdf(up), False)


@kernel
def albedo(lobe, wo):
    return rough_diffuse.albedo(lobe, wo) if lobe.alpha_x > 0.0 else WHITE
