# SPDX-License-Identifier: GPL-3.0-or-later
"""Rectangular area lights and emissive analytic rectangles, sampled by solid angle (Urena et al. 2013)."""

from ..jit import kernel
from ..linalg.vec3 import dot
from ..sampling.spherical import sample_rectangle, sample_rectangle_pdf
from . import area
from .light_sample import ZERO, no_light


@kernel
def sample(light, p, u0, u1):
    view = area.view_from(light, p)
    if light.is_delta != 0:
        return area.beam(light, view, abs(view.x) <= view.half_x and abs(view.y) <= view.half_y)
    if not area.is_lit(view):
        return no_light()
    x, y, density = sample_rectangle(u0, u1, view.lit)
    return area.sample_towards(light, view, x, y, density)


@kernel
def emitted(light, wi):
    return area.emitted(light, wi)


@kernel
def pdf(light, p, wi, t):
    view = area.view_from(light, p)
    if light.is_delta != 0 or not area.is_lit(view):
        return ZERO
    return pdf_of_rectangle(light, view, dot(wi, view.axis_x) * t, dot(wi, view.axis_y) * t)


@kernel
def pdf_of_rectangle(light, view, x, y):
    """Density of the point (x, y) if the lit rectangle is sampled; 0 outside of it."""
    lit = view.lit
    if light.spread < area.LAMBERTIAN and not (lit.x0 <= x <= lit.x1 and lit.y0 <= y <= lit.y1):
        return ZERO
    return sample_rectangle_pdf(lit, x, y)
