# SPDX-License-Identifier: GPL-3.0-or-later
"""From what an artist sets of hair to the numbers of its lobes, as Cycles does it.

Chiang, Bitterli, Tappan and Burley, "A Practical and Controllable Hair and Fur Model for Production Path Tracing"
(2016).
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import Vec3, load3, store3
from ..program_tables import ClosureKind
from ..tables import LobeKind
from .maths import saturate

ZERO = np.float32(0.0)
ONE, LEAST_ROUGHNESS, LEAST_LIGHT = np.float32(1.0), np.float32(0.001), np.float32(1e-4)
LEAST_COLOR = np.float32(1e-30)
ROOT_PI_8 = np.float32(math.sqrt(math.pi / 8.0))


@kernel
def set_strand(lobe, c):
    """Of the Hair node."""
    lobe.alpha_x, lobe.alpha_y = _rough(c.roughness), _rough(c.smooth)
    lobe.g = -c.tilt


@kernel
def set_fibre(lobe, c):
    """Of Principled Hair."""
    change = 1.0 + 2.0 * (c.random - 0.5) * c.random_roughness
    along, around = c.roughness * change, c.smooth * change
    color = load3(c, "color")
    if c.kind == ClosureKind.HAIR_ABSORPTION:
        store3(lobe, "f82", color)
    else:
        absorbed = absorption_of_color(color, around)
        if c.kind == ClosureKind.HAIR_MELANIN:
            amount = c.melanin * (1.0 + 2.0 * (c.random - 0.5) * saturate(c.random_color))
            amount = -math.log(max(1.0 - amount, LEAST_LIGHT))  # what the artist sets is how dark it looks
            absorbed = absorbed + absorption_of_melanin(amount * (1.0 - c.redness), amount * c.redness)
        store3(lobe, "f82", absorbed)
    along = _rough(along)
    lobe.ior = max(c.ior, ONE)
    lobe.g = math.sin(c.tilt)
    if lobe.kind == LobeKind.HAIR_FACETS:
        shares = load3(c, "edge_tint")
        store3(lobe, "f0", Vec3(max(shares.x, ZERO), max(shares.y, ZERO), max(shares.z, ZERO)))
        lobe.alpha_x = lobe.alpha_y = along
        return
    lobe.alpha_x = longitudinal_variance(along)
    lobe.alpha_y = azimuthal_scale(_rough(around))
    lobe.alpha_r = longitudinal_variance(_rough(along * (1.0 - saturate(c.coat))))


@kernel
def _rough(roughness):
    return min(max(roughness, LEAST_ROUGHNESS), ONE)


@kernel
def longitudinal_variance(r):
    """v of a roughness from 0 to 1 (equation 7)."""
    r2 = r * r
    r4 = r2 * r2
    r20 = r4 * r4 * (r4 * r4 * r4)
    root = 0.726 * r + 0.812 * r2 + 3.7 * r20
    return root * root


@kernel
def azimuthal_scale(r):
    """s of a radial roughness from 0 to 1 (equation 8)."""
    r2 = r * r
    r4 = r2 * r2
    r22 = r4 * r4 * (r4 * r4 * r4) * r2
    return (0.265 * r + 1.194 * r2 + 5.372 * r22) * ROOT_PI_8


@kernel
def absorption_of_color(color, radial_roughness):
    """In one radius, of hair that has the colour `color` where there is much of it (equation 9)."""
    b = radial_roughness
    scale = 1.0 / (5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245)))))
    x = math.log(max(color.x, LEAST_COLOR)) * scale
    y = math.log(max(color.y, LEAST_COLOR)) * scale
    z = math.log(max(color.z, LEAST_COLOR)) * scale
    return Vec3(x * x, y * y, z * z)


@kernel
def absorption_of_melanin(eumelanin, pheomelanin):
    """By the concentrations of both (d'Eon et al. 2011, "An Energy-Conserving Hair Reflectance Model")."""
    return Vec3(0.506, 0.841, 1.653) * eumelanin + Vec3(0.343, 0.733, 1.924) * pheomelanin
