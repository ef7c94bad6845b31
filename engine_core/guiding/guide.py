# SPDX-License-Identifier: GPL-3.0-or-later
"""The guide of one render: cells that are divided where paths come by often, and what they have learned so far.

Learning happens between two passes: what paths of one pass have taught is used by those of later ones only, and so each
sample is an unbiased estimate, whatever was learned. (Mueller et al. 2017, "Practical path guiding for efficient
light-transport simulation"; but with an octree for each side, bins of one size, and no sample thrown away.)

Whether it pays is looked at first. A histogram tells what variance directions have that are drawn by the cosine alone,
and what they have if guided. Where both are much the same nobody is guided; nor anywhere, if that is so where most of
the light is.
"""

import numpy as np

from ..guide_tables import GUIDE, GUIDE_BINS, GUIDE_BRANCH, GUIDE_CELL, GUIDE_GRID, GUIDE_LEVELS, GUIDE_SIDE, LESSON
from ..tables import Scene

MOST_CELLS = 8192
FULL = 16000  # vertices in a cell beyond which it is divided
INHERITANCE = 0.25  # part of what a cell has learned that each of its eight parts begins with: four hold any surface
LEAST = 500  # vertices in a cell from which on its histogram means something, and it may guide
SMOOTH = 0.1  # part of what a bin has learned that it shares with its three neighbours
GUIDED = 0.5  # share of the directions that come from the guide, of those that a matt surface scatters
FEWEST_PATHS, FEWEST_SAMPLES = 1 << 16, 4  # of the picture and of a pixel, before paths are guided ...
MOST_PATHS = 1 << 20  # ... and until they have taught enough
WORTHWHILE = 1.35  # how many times less variance there has to be in a cell; guiding costs up to a third of the time
WORTH_ITS_TIME = 1.5  # ... and in the picture
SIDES = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])  # as cells.side_of has them


class Guide:
    """What paths in `scene` learn. Its own `scene` is the same one, with tables that kernels find it in."""

    def __init__(self, scene):
        grid = 6 * GUIDE_GRID**3
        self._cell_count = self._branch_count = grid
        self._branches = np.zeros(grid + 8 * MOST_CELLS, GUIDE_BRANCH)
        self._side = np.zeros(MOST_CELLS, np.int64)
        self._side[:grid] = np.repeat(np.arange(6), grid // 6)
        self._owner = np.zeros(MOST_CELLS, np.int64)  # row of GUIDE_BRANCH that leads to a cell
        self._branches["target"][:grid] = self._owner[:grid] = np.arange(grid)
        self._sums, self._vertices = np.zeros((MOST_CELLS, GUIDE_BINS), np.float32), np.zeros(MOST_CELLS)
        self._cells, self.lessons = np.zeros(MOST_CELLS, GUIDE_CELL), np.zeros(MOST_CELLS, LESSON)
        self._guide = np.zeros(1, GUIDE)
        self._guide["on"] = self._guide["learns"] = 1
        centre, radius = scene.world["centre"][0], max(scene.world["radius"][0], 1e-6)
        self._guide["corner"], self._guide["grid_per_m"] = centre - radius, GUIDE_GRID / (2.0 * radius)
        self._is_guiding = False
        self._by_cosine = cosine_histograms()
        tables = {name: np.asarray(table) for name, table in scene.tables().items()}
        tables |= {"guide": self._guide, "guide_branches": self._branches, "guide_cells": self._cells}
        self.scene = Scene(**tables)

    @property
    def is_guiding(self):
        """Whether paths are guided."""
        return self._is_guiding and self._guide["on"][0] != 0

    def after_pass(self, pixels, noise):
        """All threads have finished a pass. `pixels`: of the film, (height, width); `noise`: film.noise.Noise of it."""
        if self._guide["on"][0] == 0 or self._guide["learns"][0] == 0:
            return
        self.learn()
        paths = int(pixels["samples"].sum())
        if not self._is_guiding and paths >= FEWEST_PATHS and pixels["samples"].min() >= FEWEST_SAMPLES:
            self._is_guiding = self.expected_gain(pixels, noise) >= WORTH_ITS_TIME
            self._guide["on"] = int(self._is_guiding)
        if self._is_guiding:
            self._guide["learns"] = int(paths < MOST_PATHS)
            self.publish()

    def expected_gain(self, pixels, noise):
        """By what factor guiding would lessen the noise of the picture.

        It lessens what comes from light that was scattered, not from light that is sampled at the first place.
        """
        count = np.maximum(pixels["samples"], 2)
        variance = np.maximum(pixels["scattered_square"] - pixels["scattered"] ** 2 / count, 0.0) / (count - 1)
        light = self._sums[: self._cell_count].sum(axis=1)
        left = (light / self.worth()).sum() / max(light.sum(), 1e-30)
        return 1.0 / (1.0 - noise.share_of(variance) * (1.0 - left))

    def learn(self):
        """Take in the lessons that paths have left, and divide cells that many vertices fall into."""
        count = self._cell_count
        self._sums[:count] += self.lessons["sums"][:count]
        self._vertices[:count] += self.lessons["count"][:count]
        self.lessons[:count] = 0
        cell = 0
        while cell < self._cell_count and self._cell_count + 7 <= MOST_CELLS:
            if self._vertices[cell] > FULL:
                self._divide(cell)
            else:
                cell += 1

    def _divide(self, cell):
        """Eight parts, of which the first takes the cell's row, begin with what the whole has learned."""
        first, parts = self._branch_count, np.r_[cell, self._cell_count : self._cell_count + 7]
        self._branches["target"][self._owner[cell]] = ~first
        self._branches["target"][first : first + 8] = parts
        self._side[parts] = self._side[cell]
        self._owner[parts] = np.arange(first, first + 8)
        self._sums[parts] = INHERITANCE * self._sums[cell]
        self._vertices[parts] = INHERITANCE * self._vertices[cell]
        self._branch_count += 8
        self._cell_count += 7

    def worth(self):
        """By what factor guiding lessens the variance of directions in each cell, as far as bins tell; 1: too little.

        Of a cell that few vertices fell into nobody knows.
        """
        count = self._cell_count
        share, cosine = self._shares(), self._by_cosine[self._side[:count]]
        value = share**2
        plain, guided = value / cosine, value / ((1.0 - GUIDED) * cosine + GUIDED * share)
        worth = plain.sum(axis=1) / np.maximum(guided.sum(axis=1), 1e-30)
        return np.where((worth >= WORTHWHILE) & (self._vertices[:count] >= LEAST), worth, 1.0)

    def _shares(self):
        """Of each bin in what its cell has learned, float32 (cells, GUIDE_BINS)."""
        sums = self._sums[: self._cell_count]
        share = (sums / np.maximum(sums.sum(axis=1, keepdims=True), 1e-30)).reshape(len(sums), -1, 4)
        return ((1.0 - SMOOTH) * share + SMOOTH * share.mean(axis=2, keepdims=True)).reshape(len(sums), -1)

    def publish(self):
        """Let kernels be guided by what is known now."""
        count = self._cell_count
        level, end = self._shares(), self._cells["sums"].shape[1]
        for _ in range(GUIDE_LEVELS):
            self._cells["sums"][:count, end - level.shape[1] : end] = level
            end -= level.shape[1]
            level = level.reshape(count, -1, 4).sum(axis=2)
        self._cells["guided"][:count] = np.where(self.worth() > 1.0, GUIDED, 0.0)


def cosine_histograms(steps=4):
    """Of the directions from a face into each of the SIDES, by the cosine to it: float32 (6, GUIDE_BINS).

    The sphere is unfolded as in `histogram`. A thousandth of the directions lies evenly in all bins, since faces do not
    look exactly into one of the SIDES.
    """
    size = GUIDE_SIDE * steps
    x = ((np.arange(size) + 0.5) / size * 2.0 - 1.0)[None, :] + np.zeros((size, 1))
    y, z = x.T, 1.0 - np.abs(x) - np.abs(x.T)
    x, y = (np.where(z < 0.0, np.copysign(1.0 - np.abs(b), a), a) for a, b in ((x, y), (y, x)))
    places = np.stack([x, y, z], axis=-1)
    # the cosine times r is the product with the unfolded place, and a solid angle is area / r^3
    r = np.linalg.norm(places, axis=-1)
    light = np.maximum(places @ SIDES.T, 0.0) / r[..., None] ** 4
    bins = light.reshape(GUIDE_SIDE, steps, GUIDE_SIDE, steps, 6).sum(axis=(1, 3)).reshape(GUIDE_BINS, 6).T
    number = np.arange(GUIDE_BINS)
    column, row = (sum(((number >> (2 * bit + odd)) & 1) << bit for bit in range(GUIDE_LEVELS)) for odd in (0, 1))
    result = bins[:, row * GUIDE_SIDE + column]
    return (0.999 * result / result.sum(axis=1, keepdims=True) + 0.001 / GUIDE_BINS).astype(np.float32)
