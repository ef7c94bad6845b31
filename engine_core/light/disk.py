# SPDX-License-Identifier: GPL-3.0-or-later
"""Elliptic area lights, sampled uniformly by area; where spread leaves but a small part of one lit, by the rectangle
around that part, whose points outside of the ellipse are dark.
"""

import math

from ..jit import kernel
from ..linalg.vec3 import BLACK, dot
from ..sampling.spherical import sample_rectangle
from ..sampling.warp import PI, square_to_disk
from . import area
from .light_sample import ZERO, LightSample, area_pdf, no_light
from .quad import pdf_of_rectangle


@kernel
def sample(light, p, u0, u1):
    view = area.view_from(light, p)
    if light.is_delta != 0:
        return area.beam(light, view, is_inside(view, 0.0, 0.0))
    if not area.is_lit(view):
        return no_light()
    if uses_rectangle(light, view):
        x, y, density = sample_rectangle(u0, u1, view.lit)
        s = area.sample_towards(light, view, x, y, density)
        return s if is_inside(view, x, y) else LightSample(s.wi, s.distance, BLACK, s.pdf, False)
    x, y = square_to_disk(u0, u1)
    x, y, z = view.x + x * view.half_x, view.y + y * view.half_y, view.lit.z
    distance = math.sqrt(x * x + y * y + z * z)
    return area.sample_towards(light, view, x, y, area_pdf(light.area, distance, z / distance))


@kernel
def emitted(light, wi):
    return area.emitted(light, wi)


@kernel
def pdf(light, p, wi, t):
    view = area.view_from(light, p)
    if light.is_delta != 0 or not area.is_lit(view):
        return ZERO
    if uses_rectangle(light, view):
        return pdf_of_rectangle(light, view, dot(wi, view.axis_x) * t, dot(wi, view.axis_y) * t)
    cosine = dot(wi, view.axis_z)
    return area_pdf(light.area, t, cosine) if cosine > 0.0 else ZERO


@kernel
def is_inside(view, x, y):
    """Whether the point (x, y) of the plane lies on the ellipse."""
    a, b = (x - view.x) / view.half_x, (y - view.y) / view.half_y
    return a * a + b * b <= 1.0


@kernel
def uses_rectangle(light, view):
    """Whether the rectangle around the part that is lit is smaller than the ellipse."""
    lit = view.lit
    return light.spread < area.LAMBERTIAN and (lit.x1 - lit.x0) * (lit.y1 - lit.y0) < PI * view.half_x * view.half_y
