# SPDX-License-Identifier: GPL-3.0-or-later
"""Hashes and gradient noise have the properties that textures are built on."""

import numpy as np
import pytest

from engine_core.jit import kernel
from engine_core.linalg.records import Tables
from engine_core.linalg.simd import load8, store8
from engine_core.linalg.simd_int import bits_of_floats
from engine_core.linalg.vec3 import Vec3
from engine_core.texture import hash as scalar
from engine_core.texture import hash8
from engine_core.texture.noise import OFFSETS, OFFSETS_1D, NoiseKind, fractal, noise, turbulence
from engine_core.texture.perlin import perlin

f = np.float32
RANDOM = np.random.default_rng(11)
ROW = np.dtype([("words", "f4", (4, 8)), ("out", "f4", (13, 8))])


class Rows(Tables):
    rows = ROW


@kernel
def all_hashes(rows):
    r = rows.rows[0]
    x, y = bits_of_floats(load8(r, "words", 0)), bits_of_floats(load8(r, "words", 1))
    z, w = bits_of_floats(load8(r, "words", 2)), bits_of_floats(load8(r, "words", 3))
    none = x - x
    store8(r, "out", 0, hash8.unit_floats(hash8.lookup3(x, none, none, 1)))
    store8(r, "out", 1, hash8.unit_floats(hash8.lookup3(x, y, none, 2)))
    store8(r, "out", 2, hash8.unit_floats(hash8.lookup3(x, y, z, 3)))
    store8(r, "out", 3, hash8.unit_floats(hash8.lookup3_of_4(x, y, z, w)))
    two, three, four = hash8.pcg2(x, y), hash8.pcg3(x, y, z), hash8.pcg4(x, y, z, w)
    store8(r, "out", 4, two.x)
    store8(r, "out", 5, two.y)
    store8(r, "out", 6, three.x)
    store8(r, "out", 7, three.y)
    store8(r, "out", 8, three.z)
    store8(r, "out", 9, four.x)
    store8(r, "out", 10, four.y)
    store8(r, "out", 11, four.z)
    store8(r, "out", 12, four.w)


def test_hashes_in_lanes_are_those_of_single_numbers():
    words = RANDOM.integers(-(2**31), 2**31, (4, 8)).astype(np.int32)
    words[:, 0] = 0
    row = np.zeros(1, ROW)
    row["words"] = words.view(np.float32)  # carried as bits
    rows = Rows(rows=row)

    all_hashes(rows)

    for i, signed in enumerate(words.T):
        x, y, z, w = signed.view(np.uint32)
        expected = [scalar.hash1(x), scalar.hash2(x, y), scalar.hash3(x, y, z), scalar.hash4(x, y, z, w)]
        expected = [scalar.to_unit_float(np.uint32(h)) for h in expected]
        expected += [*scalar.pcg2(*signed[:2])[:2], *scalar.pcg3(*signed[:3])[:3], *scalar.pcg4(*signed)]
        np.testing.assert_allclose(rows.rows[0].out[:, i], expected, rtol=1e-6)


def test_numbers_of_points_are_spread_evenly():
    points = RANDOM.standard_normal((4000, 4)).astype(np.float32)
    for dimensions in (1, 2, 3, 4):
        colors = np.array([tuple(scalar.random_color(*p, dimensions)) for p in points])

        assert colors.min() >= 0
        assert colors.max() <= 1
        counts = np.array([np.histogram(c, 10, (0, 1))[0] for c in colors.T])
        expected = len(points) / 10
        # chi-square with 9 degrees of freedom: p = 6e-5
        assert (((counts - expected) ** 2).sum(axis=1) / expected).max() < 35
        assert abs(np.corrcoef(colors.T) - np.eye(3)).max() < 0.08


def test_far_points_for_colours_and_distortion_are_hashes_of_their_numbers():
    for seed, row in enumerate(OFFSETS):
        expected = [100 + 100 * scalar.random_of_2(f(seed), f(axis)) for axis in range(4)]
        np.testing.assert_allclose(row, expected, rtol=1e-6)
    expected = [100 + 100 * scalar.random_of_1(f(seed)) for seed in range(3)]
    np.testing.assert_allclose(OFFSETS_1D, expected, rtol=1e-6)


# ---- Gradient noise --------------------------------------------------------------------------------------------------


def at(point, dimensions):
    """Noise at the first coordinates of a point."""
    x, y, z, w = (*np.float32(point)[:dimensions], *[f(0)] * (4 - dimensions))
    return perlin(Vec3(x, y, z), f(w), dimensions)


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_noise_is_zero_at_corners_and_smooth_and_within_one(dimensions):
    corners = RANDOM.integers(-50, 50, (50, 4))
    assert [at(c, dimensions) for c in corners] == [0] * len(corners)

    points = RANDOM.uniform(-50, 50, (3000, 4)).astype(np.float32)
    values = np.array([at(p, dimensions) for p in points])
    step = np.float32(2.0**-12)
    moved = np.array([at(p + step, dimensions) for p in points])
    assert abs(values).max() <= 1
    assert abs(values).max() > 0.6
    assert abs(moved - values).max() < 16 * step
    assert abs(values.mean()) < 0.05

    # across faces of cells too
    below, above = np.nextafter(np.float32(corners), np.float32(-1000)), np.float32(corners)
    below[:, 1:], above[:, 1:] = points[:50, 1:], points[:50, 1:]
    np.testing.assert_allclose([at(p, dimensions) for p in below], [at(p, dimensions) for p in above], atol=1e-4)


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_the_lattice_repeats(dimensions):
    """Every 100,000; and where floats have no fractions left, noise still is not 0 everywhere."""
    point = np.array([3.25, -7.5, 11.125, 0.5])
    for axis in range(dimensions):
        far = point.copy()
        far[axis] += 100000 * np.sign(far[axis])
        assert at(far, dimensions) == pytest.approx(at(point, dimensions), abs=1e-3)
    assert at(point.round() + 3e7, dimensions) != 0


def test_a_plane_through_noise_of_more_dimensions_is_noise_too():
    """Distinct ones: dimensions are no mere cuts of each other."""
    point = (0.3, 0.4, 0.0, 0.0)
    assert len({float(at(point, n)) for n in (1, 2, 3, 4)}) == 4


# ---- Fractals --------------------------------------------------------------------------------------------------------


def octaves(kind, detail, roughness=0.5, normalize=False, p=(1.3, -0.4, 2.2)):
    return fractal(Vec3(*p), f(0), 3, int(kind), f(detail), f(roughness), f(2), f(0.7), f(1.5), normalize)


@pytest.mark.parametrize("kind", NoiseKind)
def test_a_fraction_of_an_octave_fades_in(kind):
    """From nothing to a whole one without a jump; a ridged fractal has whole octaves only."""
    whole = [octaves(kind, n) for n in (2, 3)]
    assert whole[0] != whole[1]
    if kind == NoiseKind.RIDGED_MULTIFRACTAL:
        assert octaves(kind, 2.5) == whole[0]
        return
    assert octaves(kind, 2.0001) == pytest.approx(whole[0], abs=1e-3)
    assert octaves(kind, 2.9999) == pytest.approx(whole[1], abs=1e-3)


def test_fbm_is_the_sum_of_its_octaves():
    p = np.array([1.3, -0.4, 2.2])
    expected = sum(0.5**i * at((*p * 2**i, 0), 3) for i in range(4))

    assert octaves(NoiseKind.FBM, 3) == pytest.approx(expected, abs=1e-6)
    assert octaves(NoiseKind.FBM, 3, normalize=True) == pytest.approx(0.5 + 0.5 * expected / 1.875, abs=1e-6)


def test_colour_channels_are_alike_and_independent():
    numbers = (1, 2, 0.5, 2, 0, 1, 0, True, True)
    samples = [
        noise(Vec3(*p), f(0), 3, numbers[0], *[f(x) for x in numbers[1:7]], *numbers[7:])
        for p in RANDOM.uniform(-40, 40, (2000, 3))
    ]
    colors = np.array([tuple(s.color) for s in samples])

    assert [s.value for s in samples] == colors[:, 0].tolist()
    assert abs(colors.mean(axis=0) - 0.5).max() < 0.02
    assert abs(np.corrcoef(colors.T) - np.eye(3)).max() < 0.08


def test_turbulence_adds_the_sizes_of_octaves():
    p = np.array([0.7, 1.9, -3.4])
    expected = sum(0.5**i * abs(at((*p * 2**i, 0), 3)) for i in range(7))

    assert turbulence(Vec3(*p), 7) == pytest.approx(expected, abs=1e-6)
