# SPDX-License-Identifier: GPL-3.0-or-later
"""Guides: directions follow the density that is claimed for them, and cells are where places are looked up."""

import numpy as np
import pytest

from blender_tests.helpers.chi_square import compare_counts, significance_of_one_of, tabulate_directions
from blender_tests.helpers.scenes import builder, plane
from engine_core.guide_tables import GUIDE_BINS
from engine_core.guiding import histogram
from engine_core.guiding.cells import cell_at
from engine_core.guiding.guide import FULL, SIDES, Guide, cosine_histograms
from engine_core.jit import kernel
from engine_core.linalg.vec3 import Vec3, load3, store3
from engine_core.sampling.rng import hash_float
from engine_core.scene.materials import Diffuse

CELLS, POINTS = (6, 12), (900, 1800)  # cos(theta) times phi
DIRECTION = np.dtype([("w", "f4", (3,)), ("pdf", "f4"), ("bin", "i4")])


@kernel
def draw(scene, directions):
    for i in range(len(directions)):
        w, pdf = histogram.sample(scene.guide_cells[0], hash_float(i, 1, 7), hash_float(i, 2, 7))
        store3(directions[i], "w", w)
        directions[i].pdf, directions[i].bin = pdf, histogram.bin_of(w)


@kernel
def densities(scene, directions):
    for i in range(len(directions)):
        directions[i].pdf = histogram.pdf(scene.guide_cells[0], load3(directions[i], "w"))


def guide_of(lesson):
    """A Guide whose first cell has learned the histogram `lesson`."""
    b = builder()
    plane(b, Diffuse((0.5, 0.5, 0.5)))
    guide = Guide(b.build())
    guide.lessons["sums"][0], guide.lessons["count"][0] = lesson, FULL
    guide.learn()
    guide.publish()
    return guide


def spiky():
    random = np.random.default_rng(4)
    return (random.uniform(0, 1, GUIDE_BINS) ** 4 * 1e6 * (random.uniform(0, 1, GUIDE_BINS) > 0.5)).astype(np.int64)


LESSONS = {"even": np.full(GUIDE_BINS, 1000), "spiky": spiky(), "one bin": np.eye(GUIDE_BINS, dtype=np.int64)[77] * 10}


@pytest.mark.parametrize("lesson", LESSONS.values(), ids=LESSONS)
def test_directions_follow_their_density(lesson):
    scene = guide_of(lesson).scene
    found = np.zeros(200_000, DIRECTION)
    draw(scene, found)

    def pdf(directions):
        asked = np.zeros(len(directions), DIRECTION)
        asked["w"] = directions
        densities(scene, asked)
        return asked["pdf"]

    np.testing.assert_allclose(np.linalg.norm(found["w"], axis=1), 1.0, atol=1e-6)
    np.testing.assert_allclose(np.median(pdf(found["w"]) / found["pdf"]), 1.0, rtol=1e-5)
    assert (np.abs(pdf(found["w"]) / found["pdf"] - 1.0) > 1e-3).mean() < 1e-4  # rounding crosses borders of bins
    # the density jumps from bin to bin, where quadrature by polynomials is of no use: many points, evenly on the sphere
    expected = pdf(even_directions()).reshape(CELLS[0], -1, CELLS[1], POINTS[1] // CELLS[1]).mean(axis=(1, 3))
    expected *= 4.0 * np.pi / expected.size
    assert expected.sum() == pytest.approx(1.0, abs=2e-3)
    result = compare_counts(tabulate_directions(found["w"], *CELLS), expected / expected.sum(), len(found))
    assert result.p_value > significance_of_one_of(len(LESSONS)), result


def even_directions():
    """Unit directions evenly in the cosine and the azimuth, (n, 3)."""
    z, phi = ((np.arange(n) + 0.5) / n for n in POINTS)
    z, phi = np.meshgrid(2.0 * z - 1.0, 2.0 * np.pi * phi, indexing="ij")
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1).reshape(-1, 3)


def test_a_bin_gets_what_it_has_learned():
    lesson = LESSONS["spiky"]
    found = np.zeros(200_000, DIRECTION)
    draw(guide_of(lesson).scene, found)
    counts = np.bincount(found["bin"], minlength=GUIDE_BINS) / len(found)
    share = lesson / lesson.sum()
    shared = 0.9 * share + 0.1 * np.repeat(share.reshape(-1, 4).mean(axis=1), 4)
    assert np.abs(counts - shared).max() < 5.0 * np.sqrt(shared.max() / len(found))


def test_histograms_of_the_cosine_are_those_of_directions():
    random = np.random.default_rng(1)
    w = random.normal(size=(100_000, 3))
    w /= np.linalg.norm(w, axis=1)[:, None]
    bins = np.array([histogram.bin_of(Vec3(*x)) for x in w])
    for side, expected in zip(SIDES, cosine_histograms(), strict=True):
        weight = np.maximum(w @ side, 0.0) / np.maximum(w @ side, 0.0).sum()
        found, error = np.bincount(bins, weight, GUIDE_BINS), np.sqrt(np.bincount(bins, weight**2, GUIDE_BINS))
        assert (np.abs(found - expected) < 5.0 * error + 2e-5).all()


def test_a_cell_is_divided_where_many_come_by_and_its_parts_inherit():
    guide = guide_of(LESSONS["spiky"])
    up = Vec3(0.0, 0.0, 1.0)
    places = np.random.default_rng(2).uniform(-1, 1, (2000, 3)) * [1, 1, 0]
    before = [cell_at(guide.scene, Vec3(*p), up) for p in places]
    crowded = before[0]
    guide.lessons["sums"][crowded], guide.lessons["count"][crowded] = LESSONS["spiky"], 3 * FULL
    guide.learn()
    guide.publish()
    after = [cell_at(guide.scene, Vec3(*p), up) for p in places]
    inside = [a for a, b in zip(after, before, strict=True) if b == crowded]
    assert len(set(inside)) > 1
    assert all(a == b for a, b in zip(after, before, strict=True) if b != crowded)
    sums = guide.scene.guide_cells["sums"]
    np.testing.assert_array_equal(sums[inside], np.broadcast_to(sums[0], sums[inside].shape))
    assert cell_at(guide.scene, Vec3(0.1, 0.1, 0.0), up) != cell_at(guide.scene, Vec3(0.1, 0.1, 0.0), -up)
