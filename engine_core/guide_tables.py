# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of what paths learn about where light comes from, see `guiding/`: a part of the contract of `tables`."""

import numpy as np

GUIDE_GRID = 4  # edge of the grid that the octrees of cells begin with
GUIDE_LEVELS = 4  # of a histogram, each of four times as many bins as the one above
GUIDE_SIDE = 1 << GUIDE_LEVELS
GUIDE_BINS = GUIDE_SIDE**2
GUIDE_SUMS = sum(4 ** (level + 1) for level in range(GUIDE_LEVELS))

GUIDE = np.dtype(
    [
        ("on", "i4"),  # 1: paths are guided; 0: there are no cells
        ("learns", "i4"),  # 1: they leave lessons
        ("corner", "f4", (3,)),  # lower corner of the octrees; they cover a cube around the scene
        ("grid_per_m", "f4"),  # edges of the grid that they begin with
    ]
)
GUIDE_BRANCH = np.dtype([("target", "i4")])  # of an octree; >= 0: row of GUIDE_CELL; < 0: ~row of the first of eight
GUIDE_CELL = np.dtype(
    [  # a histogram of directions, see guiding/histogram.py
        ("guided", "f4"),  # share of the directions that shall come from here
        ("sums", "f4", (GUIDE_SUMS,)),  # 4 shares of the whole, 16, 64, and at last those of the bins
    ]
)
LESSON = np.dtype(
    [  # on the film, for each cell
        ("sums", "i8", (GUIDE_BINS,)),
        ("count", "i8"),  # vertices of paths
    ]
)


def no_guide():
    """{table name: rows} of a scene in which nobody is guided."""
    return {
        "guide": np.zeros(1, GUIDE),
        "guide_branches": np.zeros(0, GUIDE_BRANCH),
        "guide_cells": np.zeros(0, GUIDE_CELL),
    }
