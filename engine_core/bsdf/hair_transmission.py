# SPDX-License-Identifier: GPL-3.0-or-later
"""What passes a fibre along x, as Cycles' Hair node has it: around the fibre by Cauchy's density, `alpha_y` wide.

Along the fibre see `fibre`. After the second lobe of Marschner et al. (2003).
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE
from . import fibre
from .lobe import nothing

PI, HALF_PI = np.float32(np.pi), np.float32(0.5 * np.pi)


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    off, width = PI - fibre.angle_around(wo, wi), lobe.alpha_y
    if wo.z <= 0.0 or wi.z >= 0.0 or off > HALF_PI:
        return nothing()
    around = width / (2.0 * math.atan(HALF_PI / width) * (off * off + width * width))
    return fibre.value_of(around * fibre.density_along(lobe, wo, wi))


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    """What would not leave behind the surface is lost."""
    theta_i = fibre.sample_along(lobe, fibre.latitude(wo), u0)
    off = lobe.alpha_y * math.tan(2.0 * math.atan(HALF_PI / lobe.alpha_y) * (u1 - 0.5))
    wi = fibre.direction(wo, theta_i, off + PI)
    return fibre.sample_of(wi, evaluate_and_pdf(lobe, wo, wi).pdf)


@kernel
def albedo(lobe, wo):
    """As if nothing were lost."""
    return WHITE if wo.z > 0.0 else BLACK
