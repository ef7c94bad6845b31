# SPDX-License-Identifier: GPL-3.0-or-later
"""How a luminaire shines in which direction, measured: an image of numbers.

Its first row (from the second number on) holds vertical angles, 0 straight down, its first column horizontal ones, both
in radians and rising; the rest are intensities, a row for each horizontal angle. `addon/export/ies.py` reads files.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import dot
from .image import component

PI, TWO_PI = np.float32(math.pi), np.float32(2.0 * math.pi)
SMALL = np.float32(1e-5)  # radians
ZERO = np.float32(0.0)


@kernel
def intensity(scene, image, d):
    """In the direction `d`, by cubic interpolation as in Cycles; 0 beyond the angles that were measured."""
    rows, columns = image.height - 1, image.width - 1
    size = math.sqrt(dot(d, d))
    if size == 0.0 or rows < 2 or columns < 2:
        return ZERO
    vertical = math.acos(min(max(-d.z / size, -1.0), 1.0))
    horizontal = math.atan2(d.x, d.y) + PI
    first, last = angle_of_row(scene, image, 0), angle_of_row(scene, image, rows - 1)
    if not first <= horizontal < last:
        return ZERO
    if not angle_of_column(scene, image, 0) <= vertical < angle_of_column(scene, image, columns - 1):
        return ZERO
    row = 0
    while row < rows - 2 and angle_of_row(scene, image, row + 1) < horizontal:
        row += 1
    column = 0
    while column < columns - 2 and angle_of_column(scene, image, column + 1) < vertical:
        column += 1
    a, b = angle_of_row(scene, image, row), angle_of_row(scene, image, row + 1)
    t = (horizontal - a) / (b - a)
    a, b = angle_of_column(scene, image, column), angle_of_column(scene, image, column + 1)
    s = (vertical - a) / (b - a)
    goes_around = first < SMALL and last > TWO_PI - SMALL
    before = row - 1 if row > 0 else (rows - 1 if goes_around else -1)  # not the one before: so it is in Cycles
    after = row + 2 if row + 2 < rows else (1 if goes_around else -1)
    value = cubic(
        along_row(scene, image, before, column, s),
        along_row(scene, image, row, column, s),
        along_row(scene, image, row + 1, column, s),
        along_row(scene, image, after, column, s),
        t,
    )
    return max(value, 0.0)


@kernel
def along_row(scene, image, row, column, s):
    """Beyond the poles the light is taken for symmetrical; 0 in a row that is not there."""
    if row < 0:
        return ZERO
    columns = image.width - 1
    before = column - 1
    if column == 0:
        before = 1 if angle_of_column(scene, image, 0) < SMALL else -1
    after = column + 2
    if after >= columns:
        after = columns - 2 if angle_of_column(scene, image, columns - 1) > PI - SMALL else -1
    return cubic(
        measured(scene, image, row, before),
        measured(scene, image, row, column),
        measured(scene, image, row, column + 1),
        measured(scene, image, row, after),
        s,
    )


@kernel
def measured(scene, image, row, column):
    if column < 0:
        return ZERO
    return component(scene, image, np.int64(row + 1) * image.width + column + 1)


@kernel
def angle_of_row(scene, image, row):
    return component(scene, image, np.int64(row + 1) * image.width)


@kernel
def angle_of_column(scene, image, column):
    return component(scene, image, np.int64(column + 1))


@kernel
def cubic(a, b, c, d, t):
    """Between `b` and `c` (Catmull and Rom)."""
    return b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
