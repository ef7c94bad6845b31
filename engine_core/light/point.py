# SPDX-License-Identifier: GPL-3.0-or-later
"""Point lights: a point without extent; a sphere; or, soft, a disk that turns its face to whoever looks.

The soft one has no counterpart in nature, but never ends at a sharp horizon: Blender's "soft falloff".
"""

import math

from ..jit import kernel
from ..linalg.frame import frame_from_normal
from ..linalg.vec3 import dot, load3
from ..sampling.warp import PI, square_to_disk
from . import sphere
from .light_sample import ONE, ZERO, LightSample, area_pdf, no_light


@kernel
def sample(light, p, u0, u1):
    to_centre = load3(light, "p") - p
    d2 = dot(to_centre, to_centre)
    if d2 == 0.0:
        return no_light()
    if light.is_delta != 0:
        d = math.sqrt(d2)
        return LightSample(to_centre * (1.0 / d), d, load3(light, "emission") * (1.0 / d2), ONE, True)
    if light.soft == 0:
        return sphere.sample(light, p, u0, u1)

    n = to_centre * (1.0 / math.sqrt(d2))
    s, t = frame_from_normal(n)
    x, y = square_to_disk(u0, u1)
    to_light = to_centre + (s * x + t * y) * light.radius
    distance = math.sqrt(dot(to_light, to_light))
    wi = to_light * (1.0 / distance)
    density = area_pdf(PI * light.radius * light.radius, distance, dot(n, wi))
    return LightSample(wi, distance, load3(light, "emission"), density, False)


@kernel
def emitted(light, p, wi, t):
    return load3(light, "emission") if light.soft != 0 else sphere.emitted(light, p, wi, t)


@kernel
def pdf(light, p, wi, t):
    if light.is_delta != 0:
        return ZERO
    if light.soft == 0:
        return sphere.pdf(light, p)
    to_centre = load3(light, "p") - p
    d2 = dot(to_centre, to_centre)
    along = dot(to_centre, wi)
    if along <= 0.0:
        return ZERO
    return area_pdf(PI * light.radius * light.radius, t, along / math.sqrt(d2))
