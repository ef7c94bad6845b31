# SPDX-License-Identifier: GPL-3.0-or-later
"""What a fibre along x reflects, as Cycles' Hair node has it: around the fibre by a cosine of the width `alpha_y`.

Along the fibre see `fibre`. After the first lobe of Marschner et al. (2003), "Light Scattering from Human Hair Fibers".
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE
from . import fibre
from .lobe import nothing

HALF_PI = np.float32(0.5 * np.pi)


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    phi = fibre.angle_around(wo, wi)
    if wo.z <= 0.0 or wi.z <= 0.0 or phi > min(HALF_PI, 2.0 * HALF_PI * lobe.alpha_y):
        return nothing()
    around = 0.25 * math.cos(0.5 * phi / lobe.alpha_y) / lobe.alpha_y
    return fibre.value_of(around * fibre.density_along(lobe, wo, wi))


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    """What would go below the surface, or back around the fibre, is lost."""
    theta_i = fibre.sample_along(lobe, fibre.latitude(wo), u0)
    wi = fibre.direction(wo, theta_i, 2.0 * math.asin(1.0 - 2.0 * u1) * lobe.alpha_y)
    return fibre.sample_of(wi, evaluate_and_pdf(lobe, wo, wi).pdf)


@kernel
def albedo(lobe, wo):
    """As if nothing were lost."""
    return WHITE if wo.z > 0.0 else BLACK
