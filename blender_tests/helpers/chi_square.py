# SPDX-License-Identifier: GPL-3.0-or-later
"""Pearson's chi-square test: do sampled directions follow the density that is claimed for them?

    result = compare_directions(directions, pdf)            # (n, 3) with rows of NaN for "no direction"
    assert result.p_value > significance_of_one_of(12), result

The sphere is cut into cells of equal solid angle, cos(theta) times phi. Samples are counted in each cell, the density
is integrated over each cell, and what no direction gets is a cell of its own, so that the total is tested too.
"""

from typing import NamedTuple

import numpy as np
from scipy import stats

SPHERE = (-1.0, 1.0, 0.0, 2.0 * np.pi)  # a window: cos(theta) from, to; phi from, to
MIN_EXPECTED = 5.0  # cells that expect fewer samples are pooled: below it the statistic is not chi-square distributed
SIGNIFICANCE = 0.01  # of a whole family of tests
GAUSS_POINTS = 5
MAX_SPLITS = 14


class ChiSquare(NamedTuple):
    """Outcome of a test. `p_value`: how likely so large a deviation is if the samples do follow the density."""

    p_value: float
    statistic: float
    degrees: int
    total: float  # integral of the density
    worst: str  # the cell that deviates most

    def __str__(self):
        return (
            f"p = {self.p_value:.2e}: chi-square {self.statistic:.1f} at {self.degrees} degrees of freedom, "
            f"the density integrates to {self.total:.5f}; {self.worst}"
        )


def significance_of_one_of(tests, significance=SIGNIFICANCE):
    """Level for each of so many independent tests, so that all pass with probability 1 - significance (Sidak 1967)."""
    return 1.0 - (1.0 - significance) ** (1.0 / tests)


def compare_directions(directions, pdf, window=None, cos_cells=20, phi_cells=40, tolerance=1e-5):
    """Test directions, (n, 3), unit or NaN, against `pdf`: function of (m, 3) unit directions, per solid angle, (m,).

    `window`: the part of the sphere that is cut into cells, by `window_around` for a density that is narrower than a
    cell of the whole sphere; the rest is then one cell.
    """
    window = window or SPHERE
    observed = tabulate_directions(directions, cos_cells, phi_cells, window)
    expected = integrate_over_cells(pdf, cos_cells, phi_cells, window, tolerance)
    return compare_counts(observed, expected, len(directions))


def window_around(directions, share=0.99):
    """The window that holds `share` of the directions in each coordinate: what `compare_directions` zooms into."""
    directions = directions[np.isfinite(directions).all(axis=1)]
    x, y, z = directions.T
    z0, z1 = np.quantile(z, [(1.0 - share) / 2.0, (1.0 + share) / 2.0])
    middle = np.arctan2(y.mean(), x.mean())
    phi = np.mod(np.arctan2(y, x) - middle + np.pi, 2.0 * np.pi) - np.pi
    phi0, phi1 = middle + np.quantile(phi, [(1.0 - share) / 2.0, (1.0 + share) / 2.0])
    return float(z0), float(z1), float(phi0), float(phi1)


def compare_counts(observed, expected, n):
    """Test counts in cells against the cells' probabilities; what is missing from `n` and from 1 is one more cell.

    `observed` and `expected` have the same shape, whatever that is.
    """
    total = expected.sum()
    observed = np.append(observed.ravel(), n - observed.sum()).astype(float)
    expected = np.append(expected.ravel(), max(1.0 - total, 0.0)) * n
    order = np.argsort(expected)
    observed, expected = observed[order], expected[order]
    # the smallest cells together, with as many more as it takes to make the pool large enough
    pooled = np.searchsorted(expected, MIN_EXPECTED)
    while 0 < pooled < len(expected) and expected[:pooled].sum() < MIN_EXPECTED:
        pooled += 1
    cells = [(observed[:pooled].sum(), expected[:pooled].sum(), -1)] if pooled else []
    cells += list(zip(observed[pooled:], expected[pooled:], order[pooled:], strict=True))
    seen, awaited, names = (np.array(column) for column in zip(*cells, strict=True))
    with np.errstate(divide="ignore", invalid="ignore"):
        terms = np.where(seen == awaited, 0.0, (seen - awaited) ** 2 / awaited)
    statistic, degrees = terms.sum(), max(len(terms) - 1, 1)
    w = int(np.argmax(terms))
    name = {-1: "the pool of small cells", len(order) - 1: "what no cell gets"}.get(names[w], f"cell {names[w]}")
    worst = f"{name}: {seen[w]:.0f} samples where {awaited[w]:.1f} are expected"
    return ChiSquare(float(stats.chi2.sf(statistic, degrees)), float(statistic), degrees, float(total), worst)


def tabulate_directions(directions, cos_cells, phi_cells, window=SPHERE):
    """Count unit directions, (n, 3), in cells: (cos_cells, phi_cells). NaN, and what lies outside, counts nowhere."""
    z0, z1, phi0, phi1 = window
    x, y, z = np.asarray(directions, float)[np.isfinite(directions).all(axis=1)].T
    phi = np.mod(np.arctan2(y, x) - phi0, 2.0 * np.pi)
    inside = (z >= z0) & (z <= z1) & (phi <= phi1 - phi0)
    row = np.clip((z[inside] - z0) / (z1 - z0) * cos_cells, 0, cos_cells - 1).astype(int)
    column = np.clip(phi[inside] / (phi1 - phi0) * phi_cells, 0, phi_cells - 1).astype(int)
    return np.bincount(row * phi_cells + column, minlength=cos_cells * phi_cells).reshape(cos_cells, phi_cells)


def integrate_over_cells(pdf, cos_cells, phi_cells, window=SPHERE, tolerance=1e-5):
    """Probability of each cell, (cos_cells, phi_cells): Gauss quadrature, cells cut in four until it no longer changes.

    `tolerance`: absolute error that a whole cell may have, roughly.
    """
    z, phi = np.linspace(*window[:2], cos_cells + 1), np.linspace(*window[2:], phi_cells + 1)
    i, j = np.divmod(np.arange(cos_cells * phi_cells), phi_cells)
    boxes, owner = np.stack([z[i], z[i + 1], phi[j], phi[j + 1]], axis=1), np.arange(cos_cells * phi_cells)
    sums = np.zeros(cos_cells * phi_cells)
    coarse = _gauss(pdf, boxes)
    for _ in range(MAX_SPLITS):
        quarters = _split(boxes)
        fine = _gauss(pdf, quarters)
        better = fine.reshape(-1, 4).sum(axis=1)
        unsure = np.abs(better - coarse) > tolerance
        np.add.at(sums, owner[~unsure], better[~unsure])
        again = np.repeat(unsure, 4)
        boxes, owner, coarse = quarters[again], np.repeat(owner[unsure], 4), fine[again]
        if not len(boxes):
            break
        tolerance *= 0.5
    np.add.at(sums, owner, coarse)
    return sums.reshape(cos_cells, phi_cells)


def _split(boxes):
    """The four quarters of each box (z0, z1, phi0, phi1): (n, 4) to (4 n, 4)."""
    z0, z1, p0, p1 = boxes.T
    z, p = (z0 + z1) / 2, (p0 + p1) / 2
    quarters = [(z0, z, p0, p), (z0, z, p, p1), (z, z1, p0, p), (z, z1, p, p1)]
    return np.array(quarters).transpose(2, 0, 1).reshape(-1, 4)


def _gauss(pdf, boxes):
    """Integral of `pdf` over each box, (n,): Gauss-Legendre points in cos(theta) and phi, where d omega = dz dphi."""
    x, w = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    z = boxes[:, 0, None] + (boxes[:, 1] - boxes[:, 0])[:, None] * (x + 1.0) / 2.0
    phi = boxes[:, 2, None] + (boxes[:, 3] - boxes[:, 2])[:, None] * (x + 1.0) / 2.0
    z, phi = np.broadcast_arrays(z[:, :, None], phi[:, None, :])
    r = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    directions = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1).reshape(-1, 3)
    values = np.asarray(pdf(directions), float).reshape(len(boxes), GAUSS_POINTS, GAUSS_POINTS)
    area = (boxes[:, 1] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 2])
    return np.einsum("nij,i,j->n", values, w / 2.0, w / 2.0) * area
