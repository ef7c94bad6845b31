# SPDX-License-Identifier: GPL-3.0-or-later
"""Suns: a disk of directions, uniformly bright, infinitely far away."""

from ..jit import kernel
from ..linalg.frame import frame_from_normal, from_local
from ..linalg.vec3 import BLACK, dot, load3
from ..sampling.warp import square_to_cone, square_to_cone_pdf
from .light_sample import INFINITY, ONE, ZERO, LightSample


@kernel
def sample(light, u0, u1):
    axis = -load3(light, "n")
    if light.is_delta != 0:
        return LightSample(axis, INFINITY, load3(light, "emission"), ONE, True)
    s, t = frame_from_normal(axis)
    wi = from_local(s, t, axis, square_to_cone(u0, u1, light.height))
    return LightSample(wi, INFINITY, load3(light, "emission"), square_to_cone_pdf(light.height), False)


@kernel
def emitted(light, wi):
    return load3(light, "emission") if is_inside(light, wi) else BLACK


@kernel
def pdf(light, wi):
    return square_to_cone_pdf(light.height) if is_inside(light, wi) else ZERO


@kernel
def is_inside(light, wi):
    """Whether `wi` points into the disk: by the chord to its centre, |wi - axis|^2 = 2 (1 - cos)."""
    chord = wi + load3(light, "n")
    return light.is_delta == 0 and dot(chord, chord) <= 2.0 * light.height
