# SPDX-License-Identifier: GPL-3.0-or-later
"""What toon shading does alike, matt and glossy: a cone of light, as bright in the middle as at its edge.

Of the lobe: alpha_x is the size of the cone and alpha_y of the edge that fades out, both in quarters of a turn.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import WHITE, length
from ..sampling.warp import square_to_cone, square_to_cone_pdf
from .lobe import ONE, LobeSample, LobeValue, nothing

HALF_PI = np.float32(np.pi / 2.0)


class Cone(NamedTuple):
    inner: np.float32  # half angle of the part that does not fade, radians
    fade: np.float32  # angle over which the light would go down to nothing
    outer: np.float32  # half angle of the whole, up to a right angle


@kernel
def make_cone(lobe):
    inner, fade = min(max(lobe.alpha_x, 1e-5), 1.0) * HALF_PI, min(max(lobe.alpha_y, 0.0), 1.0) * HALF_PI
    return Cone(inner, fade, min(inner + fade, HALF_PI))


@kernel
def value_in_cone(lobe, axis, wi):
    """The value and density towards `wi` of a cone about a unit vector."""
    cone = make_cone(lobe)
    angle = 2.0 * math.asin(min(0.5 * length(wi - axis), 1.0))
    if angle >= cone.outer:
        return nothing()
    pdf = square_to_cone_pdf(_height(cone.outer))
    return LobeValue(WHITE * (_brightness(cone, angle) * pdf), pdf)


@kernel
def sample_cone(lobe, u0, u1):
    """A direction in the cone about z."""
    cone = make_cone(lobe)
    wi = square_to_cone(u0, u1, _height(cone.outer))
    angle = math.atan2(math.sqrt(wi.x * wi.x + wi.y * wi.y), wi.z)
    return LobeSample(wi, WHITE * _brightness(cone, angle), square_to_cone_pdf(_height(cone.outer)), False)


@kernel
def albedo_of_cone(lobe):
    """The mean brightness over the cone: the integral of its profile times the sine of the angle."""
    cone = make_cone(lobe)
    total = _height(cone.inner)
    if cone.outer > cone.inner:
        left = 1.0 - (cone.outer - cone.inner) / cone.fade
        rise = (math.sin(cone.outer) - math.sin(cone.inner)) / cone.fade
        total += math.cos(cone.inner) - left * math.cos(cone.outer) - rise
    return WHITE * min(total / _height(cone.outer), ONE)


@kernel
def _brightness(cone, angle):
    if angle < cone.inner or cone.fade == 0.0:
        return ONE
    return max(1.0 - (angle - cone.inner) / cone.fade, 0.0)


@kernel
def _height(angle):
    """1 - cos, without cancellation."""
    s = math.sin(0.5 * angle)
    return 2.0 * s * s
