# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixel filters, sampled: each sample counts for one pixel only, with weight 1, and is displaced at random instead.

The displacement has the filter's shape as its density (Shirley 1991; Ernst et al. 2006), which leaves the samples of a
pixel independent of its neighbours'. Filters, and what their width means, are those of Cycles (scene/film.cpp).
"""

import math

import numpy as np

from ..jit import kernel
from ..settings import FilterKind

# How far a filter reaches to each side, in units of its width.
REACH = {FilterKind.BOX: 0.5, FilterKind.GAUSSIAN: 1.5, FilterKind.BLACKMAN_HARRIS: 1.0}
CELLS = 512


def gaussian(x):
    """Over a reach of -1 to 1, which is six standard deviations to each side."""
    return np.exp(-0.5 * (6.0 * x) ** 2)


def blackman_harris(x):
    """The four-term window over -1 to 1 (Harris 1978)."""
    t = np.pi * (x + 1.0)
    return 0.35875 - 0.48829 * np.cos(t) + 0.14128 * np.cos(2.0 * t) - 0.01168 * np.cos(3.0 * t)


def inverse_table(shape, cells=CELLS, points=1 << 14):
    """float32 (cells + 1,): entry i is where a tail of `shape`, symmetric on -1 to 1, begins with (i / cells)^2 of it.

    That is of both tails together. The square makes the table fine where the shape is flat and its inverse is steep.
    """
    x = np.linspace(0.0, 1.0, points + 1)
    inner = np.concatenate([[0.0], np.cumsum(shape(0.5 * (x[1:] + x[:-1])))])
    tail = np.linspace(0.0, 1.0, cells + 1) ** 2
    return np.interp(1.0 - tail, inner / inner[-1], x).astype(np.float32)


GAUSSIAN_TABLE, BLACKMAN_HARRIS_TABLE = inverse_table(gaussian), inverse_table(blackman_harris)
GAUSSIAN_REACH = np.float32(REACH[FilterKind.GAUSSIAN])


@kernel
def sample_filter(settings, u0, u1):
    """(dx, dy): where to look, from the centre of the pixel, in pixels. `u0`, `u1`: uniform in [0, 1)."""
    width = np.float32(settings.filter_width)
    if settings.filter_kind == FilterKind.BLACKMAN_HARRIS:
        return width * look_up(BLACKMAN_HARRIS_TABLE, u0), width * look_up(BLACKMAN_HARRIS_TABLE, u1)
    if settings.filter_kind == FilterKind.GAUSSIAN:
        reach = width * GAUSSIAN_REACH
        return reach * look_up(GAUSSIAN_TABLE, u0), reach * look_up(GAUSSIAN_TABLE, u1)
    return width * (u0 - 0.5), width * (u1 - 0.5)


@kernel
def look_up(table, u):
    """The place from -1 to 1 that has the part `u` of the table's shape to its left."""
    side = 2.0 * u - 1.0
    position = math.sqrt(1.0 - abs(side)) * np.float32(CELLS)
    cell = min(np.int32(position), np.int32(CELLS - 1))
    rest = position - np.float32(cell)
    return math.copysign(table[cell] + rest * (table[cell + 1] - table[cell]), side)
