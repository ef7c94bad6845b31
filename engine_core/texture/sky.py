# SPDX-License-Identifier: GPL-3.0-or-later
"""The sky: from tables of `atmosphere` and the sun's disk, or by the formulas of `daylight`.

Directions are unit, z up; azimuths go from +y towards +x. Colours too saturated for Rec.709 are clamped last, as in
Blender.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.color import not_negative, xyz_to_rgb
from ..linalg.vec3 import BLACK, Vec3, length
from .image import EXTEND, INV_TWO_PI, LINEAR, lookup

PI, HALF_PI, TWO_OVER_PI = np.float32(math.pi), np.float32(math.pi / 2.0), np.float32(2.0 / math.pi)
LIMB_DARKENING = np.float32(0.6)
TO_RADIANCE = np.float32(2.0 * math.pi / 683.0)  # Blender's factor for the numbers of Hosek and Wilkie


class Sun(NamedTuple):
    """The disk in the sky: where it is, and its radiance."""

    elevation: float
    azimuth: float
    size: float  # full angle; negative: there is none
    intensity: float
    horizon: float  # elevation below which the Earth hides it
    bottom: Vec3
    top: Vec3


@kernel
def direction_of(elevation, azimuth):
    flat = math.cos(elevation)
    return Vec3(flat * math.sin(azimuth), flat * math.cos(azimuth), math.sin(elevation))


@kernel
def disk(sun, d):
    """Radiance of the sun's disk in the direction `d`, darker towards its limb."""
    if sun.size < 0.0:
        return BLACK
    axis = direction_of(sun.elevation, sun.azimuth)
    from_centre = 2.0 * math.atan2(length(d - axis), length(d + axis)) / (0.5 * sun.size)
    elevation = HALF_PI - math.acos(min(max(d.z, -1.0), 1.0))
    if from_centre >= 1.0 or elevation <= sun.horizon:
        return BLACK
    t = (elevation - sun.elevation) / sun.size + 0.5
    darkening = 1.0 - LIMB_DARKENING * (1.0 - math.sqrt(1.0 - from_centre * from_centre))
    return (sun.bottom + (sun.top - sun.bottom) * t) * (sun.intensity * darkening)


@kernel
def from_table(scene, image, sun, d):
    """Radiance of sky and sun; `image` is a table of `atmosphere.table`."""
    elevation = HALF_PI - math.acos(min(max(d.z, -1.0), 1.0))
    v = 0.5 + math.copysign(0.5 * math.sqrt(abs(elevation) * TWO_OVER_PI), elevation)
    sky = lookup(scene, image, column(sun, d), v, LINEAR, EXTEND).color
    return not_negative(sky + disk(sun, d))


@kernel
def from_old_table(scene, image, sun, d):
    """Blender 4's: the disk is in front of the sky, and below the horizon the sky fades to black."""
    if d.z >= 0.0:
        in_front = disk(sun, d)
        if in_front.y > 0.0:
            return not_negative(in_front)
        v, fade = math.sqrt(max(HALF_PI - math.acos(min(d.z, 1.0)), 0.0) * TWO_OVER_PI), np.float32(1.0)
    else:
        v, fade = np.float32(-0.5), max(1.0 + 2.5 * d.z, 0.0)
    return not_negative(lookup(scene, image, column(sun, d), v, LINEAR, EXTEND).color * (fade * fade * fade))


@kernel
def column(sun, d):
    u = (math.atan2(d.x, d.y) - sun.azimuth) * INV_TWO_PI - 0.5
    return u - np.floor(u)


# ---- By formulas -----------------------------------------------------------------------------------------------------


@kernel
def angles(d, sun_angle, sun_azimuth):
    """(angle to the vertical, at most that of the horizon; angle to the sun)"""
    theta, phi = math.acos(min(max(d.z, -1.0), 1.0)), math.atan2(d.x, d.y)
    cosine = math.sin(theta) * math.sin(sun_angle) * math.cos(sun_azimuth - phi) + math.cos(theta) * math.cos(sun_angle)
    return min(theta, HALF_PI - 0.001), math.acos(min(max(cosine, -1.0), 1.0))


@kernel
def perez(a, b, c, d, e, cosine, gamma):
    """One channel's shape of the sky (Perez et al. 1993)."""
    cos_gamma = math.cos(gamma)
    return (1.0 + a * math.exp(b / cosine)) * (1.0 + c * math.exp(d * gamma) + e * cos_gamma * cos_gamma)


@kernel
def preetham(a, b, c, d, e, radiance, theta, gamma):
    """`a` to `e`: shapes of the channels Y, x and y; `radiance`: these at the zenith."""
    cosine = math.cos(theta)
    Y = radiance.x * perez(a.x, b.x, c.x, d.x, e.x, cosine, gamma)
    x = radiance.y * perez(a.y, b.y, c.y, d.y, e.y, cosine, gamma)
    y = radiance.z * perez(a.z, b.z, c.z, d.z, e.z, cosine, gamma)
    scale = Y / y if y != 0.0 else np.float32(0.0)
    return not_negative(xyz_to_rgb(Vec3(x * scale, Y, (1.0 - x - y) * scale)))


@kernel
def wilkie(a, b, c, d, e, f, g, h, i, cosine, gamma):
    """One channel's shape of the sky (Hosek and Wilkie 2012, equation 8)."""
    cos_gamma = math.cos(gamma)
    squared = cos_gamma * cos_gamma
    mie = (1.0 + squared) / (1.0 + i * i - 2.0 * i * cos_gamma) ** np.float32(1.5)
    glow = c + d * math.exp(e * gamma) + f * squared + g * mie + h * math.sqrt(cosine)
    return (1.0 + a * math.exp(b / (cosine + 0.01))) * glow


@kernel
def hosek_wilkie(a, b, c, d, e, f, g, h, i, radiance, theta, gamma):
    """`a` to `i`: shapes of the channels X, Y and Z; `radiance`: their factors."""
    z = math.cos(theta)
    xyz = Vec3(
        radiance.x * wilkie(a.x, b.x, c.x, d.x, e.x, f.x, g.x, h.x, i.x, z, gamma),
        radiance.y * wilkie(a.y, b.y, c.y, d.y, e.y, f.y, g.y, h.y, i.y, z, gamma),
        radiance.z * wilkie(a.z, b.z, c.z, d.z, e.z, f.z, g.z, h.z, i.z, z, gamma),
    )
    return not_negative(xyz_to_rgb(xyz)) * TO_RADIANCE
