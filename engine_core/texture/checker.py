# SPDX-License-Identifier: GPL-3.0-or-later
"""The Checker texture: cubes of two colours, and what the seed of this project did with sines."""

import math

import numpy as np

from ..jit import kernel

STRETCH, SHIFT = np.float32(0.999999), np.float32(0.000001)  # so that faces on whole coordinates are not torn


@kernel
def checker(p):
    """1 in the cubes of the first colour, 0 in those of the second; `p` is scaled already."""
    x, y, z = _cell(p.x), _cell(p.y), _cell(p.z)
    return np.float32((x + y + z) & 1)


@kernel
def _cell(x):
    return int(np.floor((x + SHIFT) * STRETCH))


@kernel
def sine_checker(p):
    """sin x sin y sin z: its sign is a checker with cubes of side pi, the size of it fades towards their faces.

    By nodes: Vector Math (Sine), Separate XYZ, two Math (Multiply); or, for the sign alone, Checker of scale 1 / pi.
    """
    return math.sin(p.x) * math.sin(p.y) * math.sin(p.z)
