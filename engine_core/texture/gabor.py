# SPDX-License-Identifier: GPL-3.0-or-later
"""The Gabor texture: waves of one frequency in patches, scattered at random (Lagae et al. 2009).

Real and imaginary waves together make phasor noise (Tricard et al. 2019), which has a phase and an intensity.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.scalar_math import TAU
from ..linalg.simd import bits, lowest_bit, splat8, without_lowest_bit
from ..linalg.simd_int import bits_of_floats, lane_numbers, splat_int8, to_floats
from ..linalg.vec3 import Vec3, dot
from ..linalg.vector_math import safe_normalize
from .hash import random_of_3, random_of_4
from .hash8 import lookup3, lookup3_of_4, unit_floats

PI = np.float32(np.pi)
ZERO, ONE = np.float32(0.0), np.float32(1.0)
# Eight impulses a cell, each of mean square 1/2 times the integral of a squared patch, which is 1/4 in two dimensions
# and 1 / (4 sqrt 2) in three. Six standard deviations were found to hold nearly all values.
HEIGHT_2D = np.float32(6.0 * np.sqrt(8.0 * 0.5 * 0.25))
HEIGHT_3D = np.float32(6.0 * np.sqrt(8.0 * 0.5 * 0.25 / np.sqrt(2.0)))


class GaborSample(NamedTuple):
    value: np.float32  # the imaginary part, about 0 to 1
    phase: np.float32  # 0 to 1
    intensity: np.float32  # about 0 to 1


@kernel
def gabor(p, dimensions, frequency, anisotropy, orientation_2d, orientation_3d):
    """At a point that is scaled already; `dimensions` is 2 or 3, `orientation_2d` in radians."""
    isotropy = 1.0 - min(max(anisotropy, 0.0), 1.0)
    frequency = max(frequency, 0.001)
    flat = dimensions == 2
    if flat:
        p = Vec3(p.x, p.y, ZERO)
        axis = Vec3(orientation_2d, ZERO, ZERO)
    else:
        axis = safe_normalize(orientation_3d)
    cell = Vec3(np.floor(p.x), np.floor(p.y), np.floor(p.z))
    real, imaginary = ZERO, ZERO
    for k in range(0 if flat else -1, 1 if flat else 2):
        for j in range(-1, 2):
            for i in range(-1, 2):
                offset = Vec3(i, j, k)
                wave = _cell(cell + offset, p - cell - offset, flat, frequency, isotropy, axis)
                real += wave.real
                imaginary += wave.imaginary
    height = HEIGHT_2D if flat else HEIGHT_3D
    return GaborSample(
        imaginary / height * 0.5 + 0.5,
        (math.atan2(imaginary, real) + PI) / TAU,
        math.sqrt(real * real + imaginary * imaginary) / height,
    )


class Phasor(NamedTuple):
    real: np.float32
    imaginary: np.float32


@kernel
def _cell(cell, p, flat, frequency, isotropy, axis):
    """The sum of the impulses of one cell at a point given from its corner."""
    near = bits(_distances(cell, p, flat) < splat8(ONE))
    real, imaginary = ZERO, ZERO
    while near != 0:
        i = np.float32(lowest_bit(near)) * 3.0
        near = without_lowest_bit(near)
        if flat:
            x, y = random_of_3(cell.x, cell.y, i + 1.0), random_of_3(i + 1.0, cell.x, cell.y)
            d = p - Vec3(x, y, ZERO)
            angle = axis.x + (random_of_3(cell.x, cell.y, i) - 0.5) * PI * isotropy
            direction = Vec3(math.cos(angle), math.sin(angle), ZERO)
            sign = -ONE if random_of_3(cell.x, cell.y, i + 2.0) < 0.5 else ONE
        else:
            d = p - Vec3(
                random_of_4(cell.x, cell.y, cell.z, i + 1.0),
                random_of_4(cell.z, cell.x, i + 1.0, cell.y),
                random_of_4(i + 1.0, cell.z, cell.y, cell.x),
            )
            direction = _turned(axis, isotropy, cell, i)
            sign = -ONE if random_of_4(cell.x, cell.y, cell.z, i + 2.0) < 0.5 else ONE
        d2 = dot(d, d)
        size = sign * math.exp(-PI * d2) * (0.5 + 0.5 * math.cos(PI * d2))
        angle = TAU * frequency * dot(d, direction)
        real += size * math.cos(angle)
        imaginary += size * math.sin(angle)
    return Phasor(real, imaginary)


@kernel
def _distances(cell, p, flat):
    """Squared, from the point to each of the eight impulses of a cell."""
    x, y, z = (
        bits_of_floats(splat8(cell.x)),
        bits_of_floats(splat8(cell.y)),
        bits_of_floats(splat8(cell.z)),
    )
    seed = lane_numbers()
    seed = bits_of_floats(to_floats(seed + seed + seed + splat_int8(np.int32(1))))
    if flat:
        dx = splat8(p.x) - unit_floats(lookup3(x, y, seed, 3))
        dy = splat8(p.y) - unit_floats(lookup3(seed, x, y, 3))
        return dx * dx + dy * dy
    dx = splat8(p.x) - unit_floats(lookup3_of_4(x, y, z, seed))
    dy = splat8(p.y) - unit_floats(lookup3_of_4(z, x, seed, y))
    dz = splat8(p.z) - unit_floats(lookup3_of_4(seed, z, y, x))
    return dx * dx + dy * dy + dz * dz


@kernel
def _turned(axis, isotropy, cell, seed):
    """The direction of an impulse in three dimensions: the axis, turned at random by up to pi in either angle."""
    if isotropy == 0.0:
        return axis
    inclination = math.acos(min(max(axis.z, -1.0), 1.0))
    around = math.sqrt(axis.x * axis.x + axis.y * axis.y)
    azimuth = math.acos(min(max(axis.x / around, -1.0), 1.0)) if around > 0.0 else ZERO
    inclination += random_of_4(cell.x, cell.y, cell.z, seed) * PI * isotropy
    azimuth = (-azimuth if axis.y < 0.0 else azimuth) + random_of_4(cell.z, cell.x, seed, cell.y) * PI * isotropy
    return Vec3(
        math.sin(inclination) * math.cos(azimuth), math.sin(inclination) * math.sin(azimuth), math.cos(inclination)
    )
