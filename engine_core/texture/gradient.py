# SPDX-License-Identifier: GPL-3.0-or-later
"""The Gradient texture."""

import math
from enum import IntEnum

import numpy as np

from ..jit import kernel
from ..linalg.scalar_math import TAU, clamp, smoothstep
from ..linalg.vec3 import length

JUST_BELOW_ONE = np.float32(0.999999)  # exactly 0 on the unit sphere, whatever rounding does


class GradientKind(IntEnum):
    """What the value grows with; names and numbers are Blender's."""

    LINEAR = 0  # x
    QUADRATIC = 1  # x squared
    EASING = 2  # x, level at both ends
    DIAGONAL = 3  # the mean of x and y
    RADIAL = 4  # the angle about z
    QUADRATIC_SPHERE = 5  # the square of the next
    SPHERICAL = 6  # nearness to the origin


@kernel
def gradient(p, kind):
    """0 to 1; `kind` is a GradientKind."""
    return clamp(_unclamped(p, kind), 0.0, 1.0)


@kernel
def _unclamped(p, kind):
    if kind == GradientKind.LINEAR:
        return p.x
    if kind == GradientKind.QUADRATIC:
        x = max(p.x, 0.0)
        return x * x
    if kind == GradientKind.EASING:
        return smoothstep(p.x)
    if kind == GradientKind.DIAGONAL:
        return 0.5 * (p.x + p.y)
    if kind == GradientKind.RADIAL:
        return math.atan2(p.y, p.x) / TAU + 0.5
    near = max(JUST_BELOW_ONE - length(p), 0.0)
    return near * near if kind == GradientKind.QUADRATIC_SPHERE else near
