# SPDX-License-Identifier: GPL-3.0-or-later
"""The Magic texture: sines of sines."""

import math

import numpy as np

from ..jit import kernel
from ..linalg.scalar_math import TAU, remainder
from ..linalg.vec3 import Vec3


@kernel
def magic(p, depth, distortion):
    """A colour around 1/2, at a point that is scaled already; the node's value is its average.

    `depth`, 0 to 10, is how many steps are taken; each makes one of three numbers anew of all three.
    """
    px, py, pz = remainder(p.x, TAU), remainder(p.y, TAU), remainder(p.z, TAU)
    x = math.sin((px + py + pz) * 5.0)
    y = math.cos((py - px - pz) * 5.0)
    z = -math.cos((pz - px - py) * 5.0)
    if depth > 0:
        x, y, z = x * distortion, y * distortion, z * distortion
        y = -math.cos(x - y + z) * distortion
    if depth > 1:
        x = math.cos(x - y - z) * distortion
    if depth > 2:
        z = math.sin(-x - y - z) * distortion
    if depth > 3:
        x = -math.cos(-x + y - z) * distortion
    if depth > 4:
        y = -math.sin(-x + y + z) * distortion
    if depth > 5:
        y = -math.cos(-x + y + z) * distortion
    if depth > 6:
        x = math.cos(x + y + z) * distortion
    if depth > 7:
        z = math.sin(x + y - z) * distortion
    if depth > 8:
        x = -math.cos(-x - y + z) * distortion
    if depth > 9:
        y = -math.sin(x - y + z) * distortion
    scale = 0.5 / distortion if distortion != 0.0 else np.float32(1.0)
    return Vec3(0.5 - x * scale, 0.5 - y * scale, 0.5 - z * scale)
