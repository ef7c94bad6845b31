# SPDX-License-Identifier: GPL-3.0-or-later
"""Spheres that shine equally from everywhere: emissive analytic spheres, and point lights that are not soft.

From outside, directions are uniform in the cone that the sphere fills (Shirley, Wang and Zimmerman 1996), from inside
uniform all around.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.frame import frame_from_normal, from_local
from ..linalg.vec3 import BLACK, dot, load3
from ..sampling.warp import INV_FOUR_PI, cap_height, square_to_cone, square_to_cone_pdf, square_to_sphere
from ..tables import LightKind
from .light_sample import ZERO, LightSample, no_light

# A point this close to the surface, in units of radius^2, lies on it: rounding puts it now in, now out.
ON_SURFACE = np.float32(12 * 2.0**-24)


@kernel
def sample(light, p, u0, u1):
    to_centre = load3(light, "p") - p
    d2 = dot(to_centre, to_centre)
    r2 = light.radius * light.radius
    if is_inside(d2, r2):
        if not emits_inwards(light):
            return no_light()
        wi = square_to_sphere(u0, u1)
        along = dot(to_centre, wi)
        distance = along + math.sqrt(r2 - d2 + along * along)
        return LightSample(wi, distance, load3(light, "emission"), INV_FOUR_PI, False)

    height = cap_height(r2 / d2)
    if height == 0.0:
        return no_light()
    d = math.sqrt(d2)
    axis = to_centre * (1.0 / d)
    local = square_to_cone(u0, u1, height)
    s, t = frame_from_normal(axis)
    wi = from_local(s, t, axis, local)
    # the line meets the sphere half a chord before and behind the point nearest to the centre
    half_chord = math.sqrt(max(r2 - d2 * (local.x * local.x + local.y * local.y), 0.0))
    is_on_surface = d2 - r2 <= ON_SURFACE * r2
    distance = d * local.z + (half_chord if is_on_surface else -half_chord)
    return LightSample(wi, distance, load3(light, "emission"), square_to_cone_pdf(height), False)


@kernel
def emitted(light, p, wi, t):
    """A ray passes through a lamp, and so meets it twice: from outside it counts where the ray enters."""
    to_centre = load3(light, "p") - p
    r2 = light.radius * light.radius
    is_outside = dot(to_centre, to_centre) - r2 > ON_SURFACE * r2
    if light.kind != LightKind.SPHERE and is_outside and t > dot(to_centre, wi):
        return BLACK
    if emits_inwards(light) or not is_inside(dot(to_centre, to_centre), light.radius * light.radius):
        return load3(light, "emission")
    return BLACK


@kernel
def pdf(light, p):
    """The same for each direction that meets the sphere."""
    to_centre = load3(light, "p") - p
    d2 = dot(to_centre, to_centre)
    r2 = light.radius * light.radius
    if is_inside(d2, r2):
        return INV_FOUR_PI if emits_inwards(light) else ZERO
    height = cap_height(r2 / d2)
    return square_to_cone_pdf(height) if height > 0.0 else ZERO


@kernel
def is_inside(d2, r2):
    """Whether a point at that distance squared from the centre is inside, and not just on the surface."""
    return r2 - d2 > ON_SURFACE * r2


@kernel
def emits_inwards(light):
    """Lamps shine on what stands in them, too."""
    return light.kind != LightKind.SPHERE or light.two_sided != 0
