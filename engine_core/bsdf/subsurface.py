# SPDX-License-Identifier: GPL-3.0-or-later
"""Where light enters that is scattered below the surface: a direction to begin with.

What becomes of it is a walk (`integrator/subsurface.py`), which no light sampling can foresee: hence a delta. The lobe
carries what the walk needs: `f0` is the colour, `f82` the radius, `g` the anisotropy, `fresnel` the SubsurfaceKind.
The way in is refracted by a rough surface, alpha_x wide; only its directions are taken from there, nothing is lost.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import WHITE, dot
from ..sampling.warp import square_to_cosine_hemisphere
from ..tables import SubsurfaceKind
from . import microfacet
from .lobe import ONE, LobeSample, no_direction, nothing

HALF = np.float32(0.5)


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    """A delta: zero in all that can be asked for."""
    return nothing()


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    """Skin lets half of the light in as if it were matt."""
    if lobe.fresnel == SubsurfaceKind.SKIN and u_choice < HALF:
        return LobeSample(-square_to_cosine_hemisphere(u0, u1), WHITE, ONE, True)
    if wo.z <= 0.0:
        return no_direction()
    h = microfacet.sample_visible_normal(lobe, wo, microfacet.stretched_length(lobe, wo), u0, u1)
    cos_h = dot(wo, h)
    cos_t = math.sqrt(max(1.0 - (1.0 - cos_h * cos_h) / (lobe.ior * lobe.ior), 0.0))
    wi = microfacet.refract(wo, h, cos_h, cos_t, lobe.ior)
    if wi.z >= 0.0:
        return no_direction()
    return LobeSample(wi, WHITE, ONE, True)


@kernel
def albedo(lobe, wo):
    return WHITE
