# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions: where light goes that a medium scatters.

`cos` is that of the angle between the directions of travel before and after: 1 is straight on.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.frame import frame_from_normal, from_local
from ..linalg.vec3 import Vec3
from ..sampling.warp import cos_sin_turn

INV_FOUR_PI = np.float32(0.25 / np.pi)
ISOTROPIC = np.float32(1e-3)  # |g| below which the formulas lose their digits


@kernel
def henyey_greenstein(cos, g):
    """Density per solid angle (Henyey and Greenstein 1941); `g`, the mean of the cosine, from -1 to 1."""
    below = 1.0 + g * (g - 2.0 * cos)
    return INV_FOUR_PI * (1.0 - g * g) / (below * math.sqrt(below))


@kernel
def sample_henyey_greenstein(d, g, u0, u1):
    """The direction after scattering of light that travels along the unit direction `d`."""
    return direction_around(d, sample_cosine(g, u0), u1)


@kernel
def sample_cosine(g, u):
    """The cosine, with the density of `henyey_greenstein`."""
    if abs(g) < ISOTROPIC:
        return 1.0 - 2.0 * u
    s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u)
    return (1.0 + g * g - s * s) / (2.0 * g)


@kernel
def direction_around(axis, cos, u):
    """The unit direction at that cosine from the unit `axis`, turned about it by `u` full turns."""
    sin = math.sqrt(max(1.0 - cos * cos, 0.0))
    x, y = cos_sin_turn(u)
    s, t = frame_from_normal(axis)
    return from_local(s, t, axis, Vec3(sin * x, sin * y, cos))
