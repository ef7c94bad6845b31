# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixel filters: samples are displaced as often as the filter is high there."""

import numpy as np
import pytest
from scipy import stats

from engine_core.film.filter import sample_filter
from engine_core.jit import kernel
from engine_core.settings import FilterKind, Settings

N = 200_000


@kernel
def _displace(settings, u, result):
    for i in range(len(u)):
        result[i, 0], result[i, 1] = sample_filter(settings, u[i, 0], u[i, 1])


def displacements(kind, width, u):
    result = np.zeros_like(u)
    _displace(Settings(filter_kind=kind, filter_width=width), u, result)
    return result.astype(float)


# Cycles' filters (intern/cycles/scene/film.cpp), by the offset in pixels for a width `w`.
FILTERS = {
    FilterKind.BOX: lambda x, w: np.where(np.abs(x) <= 0.5 * w, 1.0, 0.0),
    FilterKind.GAUSSIAN: lambda x, w: np.where(np.abs(x) <= 1.5 * w, np.exp(-2.0 * (2.0 * x / w) ** 2), 0.0),
    FilterKind.BLACKMAN_HARRIS: lambda x, w: np.where(np.abs(x) <= w, blackman_harris(x / (2.0 * w) + 0.5), 0.0),
}


def blackman_harris(t):
    a, turn = (0.35875, 0.48829, 0.14128, 0.01168), 2.0 * np.pi * t
    return a[0] - a[1] * np.cos(turn) + a[2] * np.cos(2.0 * turn) - a[3] * np.cos(3.0 * turn)


CASES = [(FilterKind.BOX, 1.0), (FilterKind.GAUSSIAN, 1.5), (FilterKind.BLACKMAN_HARRIS, 1.5)]
CASES += [(FilterKind.GAUSSIAN, 0.4), (FilterKind.BLACKMAN_HARRIS, 3.0)]


@pytest.mark.parametrize(("kind", "width"), CASES)
def test_displacements_follow_the_filter(kind, width):
    u = (np.random.default_rng(4).integers(0, 2**24, (N, 2)) * 2.0**-24).astype(np.float32)
    offsets = displacements(kind, width, u)
    x = np.linspace(-1.6 * width, 1.6 * width, 320_001)
    cdf = np.cumsum(FILTERS[kind](x, width))
    edges = np.interp(np.linspace(0.0, 1.0, 41), cdf / cdf[-1], x)  # cells of equal probability
    edges[[0, -1]] = -np.inf, np.inf
    counts, _, _ = np.histogram2d(*offsets.T, bins=[edges, edges])
    assert stats.chisquare(counts.ravel()).pvalue > 1e-4
    # the tails, which hold less than a cell
    for tail in (1e-2, 1e-3):
        start = np.interp(1.0 - tail, cdf / cdf[-1], x)
        expected = N * 2 * tail
        assert abs((offsets > start).sum() - expected) < 5.0 * np.sqrt(expected)


@pytest.mark.parametrize(("kind", "width"), CASES)
def test_the_filter_has_its_width(kind, width):
    """Its moments, from evenly spread numbers: the centre stays, and the variance is the filter's."""
    u = ((np.arange(N) + 0.5) / N).astype(np.float32)
    offsets = displacements(kind, width, np.stack([u, u[::-1]], axis=1))
    x = np.linspace(-1.6 * width, 1.6 * width, 320_001)
    weight = FILTERS[kind](x, width)
    for axis in (0, 1):
        assert abs(offsets[:, axis].mean()) < 1e-4 * width
        assert offsets[:, axis].var() == pytest.approx((weight * x**2).sum() / weight.sum(), rel=1e-3)


@pytest.mark.parametrize("kind", list(FilterKind))
def test_ends_of_the_numbers_stay_within_the_filter(kind):
    ends = np.array([0.0, 2.0**-24, 0.5 - 2.0**-25, 0.5, 0.5 + 2.0**-24, 1.0 - 2.0**-24], np.float32)
    offsets = displacements(kind, 2.0, np.stack([ends, ends], axis=1))[:, 0]
    reach = {FilterKind.BOX: 1.0, FilterKind.GAUSSIAN: 3.0, FilterKind.BLACKMAN_HARRIS: 2.0}[kind]
    assert offsets[0] == pytest.approx(-reach, abs=1e-6)
    assert offsets[-1] <= reach
    assert offsets[3] == 0.0
    assert (np.diff(offsets) >= 0.0).all()
