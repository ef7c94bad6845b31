# SPDX-License-Identifier: GPL-3.0-or-later
"""What rectangular and elliptic area lights share: the plane they lie in, and how wide they shine (spread).

Lamps shine from their front alone, Lambertian, or narrowed as by a grid of slats in front of them: at an angle with the
tangent x the slats leave 1 - x / spread to see, where `spread` is the tangent of the widest angle that light leaves at
(Cycles: kernel/light/area.h). With a spread of 0 all light leaves straight ahead, as a beam.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, Vec3, dot, length, load3
from ..sampling.spherical import Rectangle
from .light_sample import ONE, LightSample, no_light

LAMBERTIAN = np.float32(np.inf)


class View(NamedTuple):
    """The plane of a light as seen from a point, which is the origin; `axis_z` goes from it straight to the plane."""

    axis_x: Vec3
    axis_y: Vec3
    axis_z: Vec3
    x: float  # the light's centre
    y: float
    half_x: float  # its half edges or half axes
    half_y: float
    lit: Rectangle  # the part of the rectangle around it that can shine at the point; empty or z < 0: none


@kernel
def view_from(light, p):
    u, v, n = load3(light, "u"), load3(light, "v"), load3(light, "n")
    half_x, half_y = length(u), length(v)
    axis_x, axis_y = u * (1.0 / half_x), v * (1.0 / half_y)
    to_centre = load3(light, "p") - p
    is_behind = light.two_sided != 0 and dot(to_centre, n) > 0.0
    axis_z = n if is_behind else -n
    x, y, z = dot(to_centre, axis_x), dot(to_centre, axis_y), dot(to_centre, axis_z)
    x0, x1, y0, y1 = x - half_x, x + half_x, y - half_y, y + half_y
    if light.spread < LAMBERTIAN:
        reach = z * light.spread
        x0, x1, y0, y1 = max(x0, -reach), min(x1, reach), max(y0, -reach), min(y1, reach)
    return View(axis_x, axis_y, axis_z, x, y, half_x, half_y, Rectangle(x0, x1, y0, y1, z))


@kernel
def is_lit(view):
    lit = view.lit
    return lit.z > 0.0 and lit.x1 > lit.x0 and lit.y1 > lit.y0


@kernel
def sample_towards(light, view, x, y, density):
    """The sample in the direction of the light's point (x, y)."""
    z = view.lit.z
    distance = math.sqrt(x * x + y * y + z * z)
    inverse = 1.0 / distance
    wi = (view.axis_x * x + view.axis_y * y + view.axis_z * z) * inverse
    return LightSample(wi, distance, load3(light, "emission") * slats(light, z * inverse), density, False)


@kernel
def emitted(light, wi):
    cosine = -dot(wi, load3(light, "n"))
    if light.two_sided != 0:
        cosine = abs(cosine)
    return load3(light, "emission") * slats(light, cosine) if cosine > 0.0 else BLACK


@kernel
def slats(light, cosine):
    """The part of the light that leaves at an angle, given by its cosine, between the slats."""
    if light.spread < LAMBERTIAN:
        tangent = math.sqrt(max(1.0 / (cosine * cosine) - 1.0, 0.0))
        return max(1.0 - tangent / light.spread, 0.0)
    return ONE


@kernel
def beam(light, view, is_inside):
    """The sample of a light that shines straight ahead, onto whoever stands in front of it."""
    if is_inside and view.lit.z > 0.0:
        return LightSample(view.axis_z, view.lit.z, load3(light, "emission"), ONE, True)
    return no_light()
