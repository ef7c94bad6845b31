# SPDX-License-Identifier: GPL-3.0-or-later
"""The Wave texture: bands or rings, bent by noise."""

import math
from enum import IntEnum

import numpy as np

from ..jit import kernel
from ..linalg.scalar_math import TAU
from ..linalg.vec3 import Vec3, length
from .noise import NoiseKind, fractal

STRETCH, SHIFT = np.float32(0.999999), np.float32(0.000001)  # so that faces on whole coordinates are not torn
HALF_PI = np.float32(0.5 * np.pi)
ZERO, TWO = np.float32(0.0), np.float32(2.0)
FBM = np.int64(NoiseKind.FBM)


class WaveKind(IntEnum):
    """Names and numbers are Blender's, here and below."""

    BANDS = 0
    RINGS = 1


class WaveDirection(IntEnum):
    """Bands follow each other along it, rings lie around it."""

    X = 0
    Y = 1
    Z = 2
    DIAGONAL = 3  # of bands: all three alike
    SPHERICAL = 3  # of rings: around the origin


class WaveProfile(IntEnum):
    SIN = 0
    SAW = 1
    TRI = 2


@kernel
def wave(p, kind, direction, profile, distortion, detail, detail_scale, detail_roughness, phase):
    """0 to 1, at a point that is scaled already; `phase` is in radians. The node's colour is this as a grey."""
    p = (p + Vec3(SHIFT, SHIFT, SHIFT)) * STRETCH
    n = _distance(p, kind, direction) + phase
    detail = min(max(detail, 0.0), 15.0)  # as noise has it: a linked socket may hold anything
    if distortion != 0.0:
        noise = fractal(p * detail_scale, ZERO, 3, FBM, detail, detail_roughness, TWO, ZERO, ZERO, True)
        n += distortion * (noise * 2.0 - 1.0)
    if profile == WaveProfile.SIN:
        return 0.5 + 0.5 * math.sin(n - HALF_PI)
    n /= TAU
    if profile == WaveProfile.SAW:
        return n - np.floor(n)
    return abs(n - np.floor(n + 0.5)) * 2.0


@kernel
def _distance(p, kind, direction):
    if kind == WaveKind.RINGS:
        x = ZERO if direction == WaveDirection.X else p.x
        y = ZERO if direction == WaveDirection.Y else p.y
        z = ZERO if direction == WaveDirection.Z else p.z
        return 20.0 * length(Vec3(x, y, z))
    if direction == WaveDirection.X:
        return 20.0 * p.x
    if direction == WaveDirection.Y:
        return 20.0 * p.y
    if direction == WaveDirection.Z:
        return 20.0 * p.z
    return 10.0 * (p.x + p.y + p.z)
