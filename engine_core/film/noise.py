# SPDX-License-Identifier: GPL-3.0-or-later
"""What error is left in a picture, and where samples would lessen it most: both known from how pixels move.

The mean of a pixel moves by D when its samples grow from n to r n. Of nested sets of points that is uncorrelated with
what is still missing: E[D^2] = v(n) - v(r n), with v the variance of the mean. Where v falls like n^-p this tells
v(r n) = D^2 / (r^p - 1), of one pixel very roughly, of thousands together well. Independent samples have p = 1, well
spread ones more; the picture as a whole tells, by how D^2 falls from one doubling to the next.

What belongs to a pixel is never judged by the pixel itself, but by its neighbours. Or the picture would become too
dark: a pixel that has not met its rare bright path yet would seem to need no more samples, one that has would get them
(0.7 % too dark among ten thousand glossy instances, 0.2 % in caustics). For the same reason samples are distributed
once: neighbours that were given more samples by a bright one of mine would give me more in the next round (0.2 % too
dark in caustics). And an outlier would be compared with its own brightness, and count for nothing: the error would seem
up to ten times smaller than it is.
"""

import math

import numpy as np

from . import passes

RADIUS = 2  # of the square of neighbours, in pixels: 5 x 5
DARK = 0.01  # radiance^2: errors count in relation to the radiance, but not where there is next to none
LEAST_GROWTH = 1.4  # of a pixel's samples, before its movement is measured again
OUTLIERS = 0.02  # part of the pixels, those with the largest error, which is taken to fall like 1 / n
EXPONENT = 0.75  # of variances, when neighbours are averaged: with 1 outliers rule, with 1/2 edges are lost


class Noise:
    """The error of a film, as of the last `update`."""

    def __init__(self, film):
        shape = film.height, film.width
        self._film, self._shape = film, shape
        self._mean, self._count = np.zeros(shape, np.float32), np.zeros(shape, np.float32)  # when last measured
        self._moved, self._growth = np.zeros(shape, np.float32), np.ones(shape, np.float32)  # D^2 and r
        self._spread = np.zeros(shape, np.float32)  # sum of D^2 n (r n): n times the variance of one sample
        self._weight = None  # 1 / (radiance^2 + DARK) of the neighbours
        self._decay = None  # p
        self._picture = None  # when last measured
        self.kept = 1.0  # part of the noise of pixels' own samples that is in the picture, if they share them
        self._error, self._samples = math.nan, 0.0  # of the picture, and samples of a pixel on average

    def update(self, is_steady=True):
        """Measure how pixels moved. Takes about 0.3 s for a million pixels.

        `is_steady`: the last samples vary as those before, so that D^2 falls for no other reason than their number.
        """
        pixels = self._film.pixels.reshape(self._shape)
        count = pixels["samples"].astype(np.float32)
        mean = pixels["radiance"].mean(axis=-1) / np.maximum(count, 1.0)
        self._weight = 1.0 / (mean_of_neighbours(mean) ** 2 + DARK)

        measured = count >= LEAST_GROWTH * self._count
        has_moved = measured & (self._count > 0.0)
        moved = np.where(has_moved, (mean - self._mean) ** 2, self._moved)
        growth = np.where(has_moved, count / np.maximum(self._count, 1.0), self._growth)
        self._spread += np.where(has_moved, moved * count * self._count, 0.0)
        if is_steady:
            self._learn_decay(has_moved & (growth == 2.0) & (self._growth == 2.0), moved)
        if len(self._film.shares) > 0 and measured.all():
            self._learn_sharing(moved)
        self._moved, self._growth = moved, growth
        self._mean, self._count = np.where(measured, mean, self._mean), np.where(measured, count, self._count)

        self._samples = float(count.mean(dtype=np.float64))
        if growth.min() > 1.0:
            movement = self._weight * moved
            decay = np.where(movement > threshold(movement), 1.0, self.decay)
            variance = movement / (growth**decay - 1.0) * (self._count / count) ** decay
            self._error = math.sqrt(self.kept * variance.mean(dtype=np.float64))

    def _learn_sharing(self, moved):
        """What pixels show where samples count for several moves less than the mean of their own samples: how much?"""
        picture = passes.image(self._film, "Combined")[..., :3].mean(axis=-1)
        if self._picture is not None and moved.any():
            shown = self._weight * (picture - self._picture) ** 2
            self.kept = float(shown.sum(dtype=np.float64) / (self._weight * moved).sum(dtype=np.float64))
        self._picture = picture

    def _learn_decay(self, doubled_twice, moved):
        if doubled_twice.mean() < 0.1:
            return
        weight = self._weight[doubled_twice]
        before, now = (weight * movement[doubled_twice] for movement in (self._moved, moved))
        before, now = (np.sum(m[m <= threshold(m)], dtype=np.float64) for m in (before, now))
        if before > 0.0 and now > 0.0:
            decay = min(max(math.log2(before / now), 1.0), 2.0)
            self._decay = decay if self._decay is None else 0.5 * (self._decay + decay)

    @property
    def decay(self):
        """With which power of the number of samples the variance falls, but for outliers."""
        return self._decay or 1.0

    def share_of(self, variance):
        """Share of the noise that would be left if samples varied by `variance` alone, (height, width); no outliers."""
        whole = self._weight * self._spread / np.maximum(self._count - 1.0, 1.0)
        part = self._weight * variance
        usual = whole + part <= threshold(whole + part)
        return float(min(part[usual].sum() / max(whole[usual].sum(), 1e-30), 1.0))

    def error_at(self, samples):
        """Relative error of the picture with so many samples in a pixel on average; NaN while nothing is known.

        It is the root of the mean, over pixels, of error^2 / (radiance^2 + DARK).
        """
        return self._error * (self._samples / samples) ** (0.5 * self.decay) if samples else math.nan

    def samples_for(self, error):
        """How many samples a pixel needs on average to come down to this relative error of the picture."""
        return self._samples * (self._error / error) ** (2.0 / self.decay)

    def importance(self):
        """float32 (height, width): what one sample of each pixel varies by, in relation to the radiance there."""
        variance = mean_of_neighbours((self._spread / self._count) ** EXPONENT) ** (1.0 / EXPONENT)
        return np.sqrt(variance * self._weight)


def threshold(values):
    """What the part OUTLIERS of the values exceeds."""
    rank = int((1.0 - OUTLIERS) * (values.size - 1))
    return np.partition(values, rank, axis=None)[rank]


def mean_of_neighbours(a, radius=RADIUS):
    """Mean over the square around each pixel, cut off at the border, without the pixel itself."""
    ones = [np.ones(size) for size in a.shape]
    number = np.outer(*(_box_sum(one, radius, 0) for one in ones)) - 1.0
    sums = _box_sum(_box_sum(a.astype(np.float64), radius, 0), radius, 1) - a
    return (np.maximum(sums, 0.0) / np.maximum(number, 1.0)).astype(np.float32)


def _box_sum(a, radius, axis):
    """Sums over 2 radius + 1 entries along an axis."""
    size = a.shape[axis]
    padded = np.concatenate([np.zeros_like(np.take(a, [0], axis)), np.cumsum(a, axis)], axis)
    entries = np.arange(size)
    high, low = np.minimum(entries + radius + 1, size), np.maximum(entries - radius, 0)
    return np.take(padded, high, axis) - np.take(padded, low, axis)
