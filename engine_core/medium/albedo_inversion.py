# SPDX-License-Identifier: GPL-3.0-or-later
"""The medium below a surface, from what an artist knows of it: its colour, and how far light gets.

A half space that scatters has a colour; which medium has the colour that is wanted? By fits, as Cycles has them:

d'Eon, "A Hitchhiker's Guide to Multiple Scattering" (2016), equation 53.7: after van de Hulst, for any anisotropy.
Chiang, Kutz and Burley, "Practical and Controllable Subsurface Scattering for Production Path Tracing" (2016), extended
to anisotropy by Wrenninge, Villemin and Hery, "Path Traced Subsurface Scattering using Anisotropic Phase Functions and
Non-Exponential Free Flights" (2017): the older fit.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import WHITE, Vec3
from ..tables import SubsurfaceKind

LEGACY_SCALE = np.float32(0.25 / np.pi)  # makes an artist's radius as wide as the profiles of older models
MOST_ALBEDO = np.float32(0.999999)
LEAST_ALBEDO = np.float32(0.2)  # below, guiding fails: light is scattered this much and dimmed instead
SMALLEST_RADIUS = np.float32(1e-16)


def _coefficients(*numbers):
    return tuple(np.float32(number) for number in numbers)


# In powers of g: a and d scale, b and e stretch, c and f bend two arc tangents of the colour (Wrenninge et al. 2017)
A = _coefficients(1.8260524, -1.2845106, -1.7990463, 9.1939329, -22.821559, 32.023487, -23.62648, 7.21067)
B = _coefficients(0.0, 31.149158, -201.84702, 841.57602, -2018.0929, 2731.7156, -1935.4142, 559.00905)
C = _coefficients(1.096861, -0.3947041, 1.0525812, -8.8396371, 28.864323, -46.880291, 38.540284, -12.718104)
D = _coefficients(0.49631021, 0.36014658, -2.1513931, 17.88969, -55.298401, 82.065982, -58.510601, 15.84783)
E = _coefficients(0.0, 76.731625, -594.35677, 2448.8834, -5576.6853, 7116.6017, -4763.5447, 1303.5318)
F = _coefficients(2.40603, -2.5181484, 9.1849491, -79.219171, 259.08287, -403.6138, 302.85712, -87.437047)


class Medium(NamedTuple):
    """Of each channel."""

    sigma_t: Vec3  # how often light is scattered or absorbed, 1 / m
    albedo: Vec3  # share of it that is scattered
    dimmed: Vec3  # by what to multiply all light: 1, but where the albedo was raised


@kernel
def medium_of(kind, color, radius, g, ior):
    """The Medium of a SubsurfaceKind: `radius` in metres, anisotropy `g`, index of refraction of the surface."""
    if kind == SubsurfaceKind.SKIN:
        scale = Vec3(skin_scale(color.x, ior), skin_scale(color.y, ior), skin_scale(color.z, ior))
    elif kind == SubsurfaceKind.LEGACY:
        scale = WHITE * LEGACY_SCALE
    else:
        scale = WHITE
    x = _channel(kind, color.x, radius.x * scale.x, g)
    y = _channel(kind, color.y, radius.y * scale.y, g)
    z = _channel(kind, color.z, radius.z * scale.z, g)
    return Medium(Vec3(x[0], y[0], z[0]), Vec3(x[1], y[1], z[1]), Vec3(x[2], y[2], z[2]))


@kernel
def _channel(kind, color, radius, g):
    """(sigma_t, albedo, dimmed)"""
    sigma_t = 1.0 / max(radius, SMALLEST_RADIUS)
    if kind == SubsurfaceKind.RANDOM_WALK or g < 0.0:
        albedo = albedo_of_color(color, g)
    else:
        albedo = older_albedo_of_color(color, g)
        sigma_t /= 1.0 - g
    albedo = min(max(albedo, 0.0), MOST_ALBEDO)
    if albedo < LEAST_ALBEDO:
        return sigma_t, LEAST_ALBEDO, albedo / LEAST_ALBEDO
    return sigma_t, albedo, np.float32(1.0)


@kernel
def albedo_of_color(color, g):
    """Albedo of single scattering in a half space of that colour (d'Eon 2016)."""
    s = 4.20863 * color - math.sqrt(9.59217 + color * (41.6808 + 17.7126 * color)) + 4.09712
    return (1.0 - s * s) / (1.0 - g * s * s)


@kernel
def older_albedo_of_color(color, g):
    """The same (Wrenninge et al. 2017), for g from 0 to 0.9."""
    b = 4.98511194 + 0.12735596 * math.exp(_polynomial(B, g))
    e = 4.231903 + 0.00310604 * math.exp(_polynomial(E, g))
    low = _polynomial(A, g) * math.atan(b * color) ** _polynomial(C, g)
    high = _polynomial(D, g) * math.atan(e * color) ** _polynomial(F, g)
    blend = math.sqrt(math.sqrt(color))
    return (1.0 - blend) * low + blend * high


@kernel
def _polynomial(coefficients, x):
    """Sum of coefficients[i] x^i."""
    total = np.float32(0.0)
    for i in range(len(coefficients) - 1, -1, -1):
        total = total * x + coefficients[i]
    return total


@kernel
def skin_scale(color, ior):
    """From the radius of diffusion, which the artist sets, to the mean free path: the dipole's (Jensen et al. 2001)."""
    inverse = 1.0 / ior
    reflected = inverse * (0.71 - 1.44 * inverse) + 0.668 + 0.0636 * ior  # of diffuse light, back into the medium
    boundary = 4.0 / 3.0 * (1.0 + reflected) / (1.0 - reflected)
    return math.sqrt(3.0 * (1.0 - dipole_albedo(color, boundary)))


@kernel
def dipole_albedo(color, boundary):
    """Reduced albedo of the medium whose diffuse reflectance by the dipole is `color`: by bisection."""
    if color < 1e-4:
        return np.float32(0.0)
    if color >= 0.995:
        return MOST_ALBEDO
    low, high, albedo = np.float32(0.0), np.float32(1.0), np.float32(0.5)
    for _ in range(12):
        albedo = 0.5 * (low + high)
        s = math.sqrt(3.0 * (1.0 - albedo))
        if 0.5 * albedo * (1.0 + math.exp(-boundary * s)) * math.exp(-s) < color:
            low = albedo
        else:
            high = albedo
    return albedo
