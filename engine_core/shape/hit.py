# SPDX-License-Identifier: GPL-3.0-or-later
"""What intersecting a shape returns."""

from typing import NamedTuple

import numpy as np


class ShapeHit(NamedTuple):
    t: float  # distance in units of the ray's direction; infinite when the ray misses
    b1: float  # coordinates within the shape, see each shape
    b2: float


INFINITY = np.float32(np.inf)
ZERO = np.float32(0.0)
MISS = ShapeHit(INFINITY, ZERO, ZERO)
