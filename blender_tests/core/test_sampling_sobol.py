# SPDX-License-Identifier: GPL-3.0-or-later
"""Random numbers: Owen-scrambled Sobol points fill the square evenly, and are independent wherever they have to be."""

import numba
import numpy as np
import pytest
from scipy import stats

from engine_core.jit import kernel
from engine_core.sampling.mis import power_heuristic
from engine_core.sampling.rng import hash_float, hash_u32, to_unit_float
from engine_core.sampling.sobol import half_of, make_sampler, make_sequence, sample_1d, sample_2d
from engine_core.sampling.sobol8 import sample_vertex
from engine_core.settings import SamplerKind, Settings

SIGNIFICANCE = 1e-4  # of each test; the points are fixed, so a test that passes once passes always


@kernel
def fill_points(settings, points, dimension):
    """Samples 0, 1, 2 ... of the pixels 0, 1, 2 ... of a row: points (pixels, samples, 2)."""
    for x in range(points.shape[0]):
        sequence = make_sequence(settings, x, 7)
        for index in range(points.shape[1]):
            u0, u1 = sample_2d(make_sampler(sequence, index), dimension)
            points[x, index, 0], points[x, index, 1] = u0, u1


@kernel
def fill_numbers(settings, numbers, dimension):
    for x in range(numbers.shape[0]):
        sequence = make_sequence(settings, x, 7)
        for index in range(numbers.shape[1]):
            numbers[x, index] = sample_1d(make_sampler(sequence, index), dimension)


def points_of(pixels, samples, dimension=0, **changes):
    """float32 (pixels, samples, 2); `changes` of the settings."""
    points = np.empty((pixels, samples, 2), np.float32)
    fill_points(Settings(**{"samples": samples, **changes}), points, dimension)
    return points


def uniformity(*coordinates, cells=16):
    """p-value for points with these coordinates being uniform in the unit square or cube."""
    counts, _ = np.histogramdd(np.stack(coordinates, axis=-1), bins=cells, range=[(0, 1)] * len(coordinates))
    return stats.chisquare(counts.ravel()).pvalue


@pytest.mark.parametrize("log2_samples", range(1, 13))
def test_every_elementary_interval_holds_one_point(log2_samples):
    n = 1 << log2_samples
    for points in points_of(pixels=4, samples=n, dimension=3):
        for log2_columns in range(log2_samples + 1):
            columns, rows = 1 << log2_columns, n >> log2_columns
            cell = (points[:, 0] * columns).astype(int) * rows + (points[:, 1] * rows).astype(int)
            assert len(np.unique(cell)) == n


@kernel
def fill_vertices(settings, drawn, numbers):
    """For samples 0, 1 ... of a pixel what `sample_vertex` draws, and the same dimension by dimension."""
    sequence = make_sequence(settings, 5, 7)
    for i in range(len(drawn)):
        sampler, first = make_sampler(sequence, i), 3 + 4 * i
        u = sample_vertex(sampler, first)
        drawn[i, 0], drawn[i, 1], drawn[i, 2], drawn[i, 3] = u.light, u.lobe, u.light_u0, u.light_u1
        drawn[i, 4], drawn[i, 5], drawn[i, 6] = u.u0, u.u1, u.roulette
        for k in range(3):
            numbers[i, 2 * k], numbers[i, 2 * k + 1] = sample_2d(sampler, first + k)
        numbers[i, 6] = sample_1d(sampler, first + 3)


@pytest.mark.parametrize("sampler", SamplerKind)
def test_a_vertex_draws_from_its_four_dimensions(sampler):
    drawn, numbers = np.empty((2, 1000, 7), np.float32)
    fill_vertices(Settings(samples=1024, seed=9, sampler=sampler).row(), drawn, numbers)
    np.testing.assert_array_equal(drawn, numbers)


@kernel
def fill_halves(settings, points, dimension):
    """As `fill_points`, two points for each sample."""
    for x in range(points.shape[0]):
        sequence = make_sequence(settings, x, 7)
        for i in range(points.shape[1]):
            u0, u1 = sample_2d(half_of(make_sampler(sequence, i // 2), i % 2), dimension)
            points[x, i, 0], points[x, i, 1] = u0, u1


def test_halves_of_samples_are_a_net_of_twice_as_many_points():
    n = 256
    points = np.empty((4, n, 2), np.float32)
    fill_halves(Settings(samples=n // 2), points, 3)
    for pixel in points:
        for columns in (1, 2, 4, 8, 16, 32, 64, 128, 256):
            cell = (pixel[:, 0] * columns).astype(int) * (n // columns) + (pixel[:, 1] * (n // columns)).astype(int)
            assert len(np.unique(cell)) == n


def test_each_block_of_samples_is_a_net_of_its_own():
    """What makes passes of 1, 1, 2, 4, 8 samples refine each other."""
    points = points_of(pixels=1, samples=256)[0]
    for block in points.reshape(16, 16, 2):
        assert len(np.unique((block * 4).astype(int) @ [4, 1])) == 16


@pytest.mark.parametrize("index", [0, 1, 2, 77])
def test_each_sample_alone_is_uniform_over_pixels(index):
    points = points_of(pixels=100_000, samples=index + 1)[:, index]
    assert uniformity(*points.T) > SIGNIFICANCE


def test_dimensions_and_seeds_are_independent():
    a = points_of(20_000, 4, dimension=0)
    for b in (points_of(20_000, 4, dimension=1), points_of(20_000, 4, seed=1)):
        for i in (0, 1):
            for j in (0, 1):
                assert uniformity(a[..., i].ravel(), b[..., j].ravel()) > SIGNIFICANCE


# ---- Blue noise: how pixels share a sequence -------------------------------------------------------------------------


@kernel
def fill_square(settings, points, dimension):
    """All samples of a square of pixels: points (height, width, samples, 2)."""
    for y in range(points.shape[0]):
        for x in range(points.shape[1]):
            sequence = make_sequence(settings, x, y)
            for index in range(points.shape[2]):
                u0, u1 = sample_2d(make_sampler(sequence, index), dimension)
                points[y, x, index, 0], points[y, x, index, 1] = u0, u1


def square_of(side, samples, **changes):
    points = np.empty((side, side, samples, 2), np.float32)
    fill_square(Settings(**{"samples": samples, "adaptive": 0, **changes}), points, 2)
    return points


def integral_errors(points):
    """Error of each pixel's estimate of a smooth integral."""
    values = np.exp(-4.0 * ((points - 0.3) ** 2).sum(axis=-1)).mean(axis=-1).astype(float)
    return values - values.mean()


def low_frequencies(errors):
    """Power at wavelengths above 8 pixels, in relation to that of white noise of the same variance."""
    power = np.abs(np.fft.fft2(errors)) ** 2 / (errors.var() * errors.size)
    frequency = np.fft.fftfreq(len(errors))
    radius = np.hypot(*np.meshgrid(frequency, frequency))
    return power[(radius > 0) & (radius < 1 / 8)].mean()


@pytest.mark.parametrize("samples", [1, 4, 16])
@pytest.mark.parametrize("pixels", [2, 4, 16])
def test_samples_of_a_square_of_pixels_are_a_net(samples, pixels):
    points = square_of(16, samples)[:pixels, :pixels].reshape(-1, 2)
    n = len(points)
    for columns in 2 ** np.arange(int(np.log2(n)) + 1):
        cell = (points[:, 0] * columns).astype(int) * (n // columns) + (points[:, 1] * (n // columns)).astype(int)
        assert len(np.unique(cell)) == n


@pytest.mark.parametrize("samples", [1, 16])
def test_errors_of_pixels_are_blue_noise(samples):
    blue = [low_frequencies(integral_errors(square_of(128, samples, seed=seed))) for seed in range(4)]
    assert np.mean(blue) < 0.25


def test_blue_noise_leaves_the_error_of_a_pixel_as_it_was():
    """In relation to pixels far apart in their sequence, as those that adaptive sampling keeps room for."""
    shared = np.mean([integral_errors(square_of(64, 64, seed=s)).var() for s in range(4)])
    apart = np.mean([integral_errors(square_of(64, 64, seed=s, adaptive=1)).var() for s in range(4)])
    assert shared == pytest.approx(apart, rel=0.1)


def test_no_two_pixels_of_a_large_frame_have_the_same_samples():
    """Sequences have 2^32 points, so a frame of 4096 x 4096 pixels with 2^12 samples takes several."""
    settings = Settings(samples=1 << 12, adaptive=0)
    seen = {
        (s.seed, s.first) for x in (0, 1, 1023, 1024, 4095) for y in (0, 511, 1024) for s in [sequence(settings, x, y)]
    }
    assert len(seen) == 15


@kernel
def sequence(settings, x, y):
    return make_sequence(settings, x, y)


# ---- Plain random numbers --------------------------------------------------------------------------------------------


def test_random_numbers_are_independent():
    a = points_of(5000, 16, sampler=int(SamplerKind.RANDOM))
    assert uniformity(a[..., 0].ravel(), a[..., 1].ravel()) > SIGNIFICANCE
    others = [np.roll(a, 1, axis=0), np.roll(a, 1, axis=1), points_of(5000, 16, 1, sampler=int(SamplerKind.RANDOM))]
    for b in others:
        for i in (0, 1):
            for j in (0, 1):
                assert uniformity(a[..., i].ravel(), b[..., j].ravel()) > SIGNIFICANCE


def test_random_numbers_have_the_variance_of_random_numbers():
    values = np.exp(-4.0 * ((points_of(4000, 64, sampler=int(SamplerKind.RANDOM)) - 0.3) ** 2).sum(axis=-1))
    assert values.mean(axis=1).var() == pytest.approx(values.var() / 64, rel=0.1)


# ---- Within a pixel --------------------------------------------------------------------------------------------------


def test_dimensions_are_decorrelated_within_a_pixel():
    """Two dimensions that kept the order of their samples would lie on diagonals."""
    a, b = points_of(4000, 64, dimension=0), points_of(4000, 64, dimension=1)
    correlation = ((a[..., 0] - 0.5) * (b[..., 0] - 0.5)).mean(axis=1) * 12.0
    assert abs(correlation.mean()) < 4.0 * correlation.std() / np.sqrt(4000)
    assert correlation.std() < 2.0 / np.sqrt(64)  # that of random numbers: 1 / 8


@pytest.mark.parametrize(("samples", "least_gain"), [(16, 20.0), (256, 1000.0)])
def test_smooth_integrands_have_far_less_variance_than_with_random_numbers(samples, least_gain):
    values = np.exp(-4.0 * ((points_of(4000, samples) - 0.3) ** 2).sum(axis=-1))
    random_variance = values.var() / samples
    assert values.mean(axis=1).var() < random_variance / least_gain


def test_estimates_have_no_bias():
    values = np.exp(-4.0 * ((points_of(200_000, 1)[:, 0] - 0.3) ** 2).sum(axis=-1))
    x = (np.arange(2000) + 0.5) / 2000
    truth = np.exp(-4.0 * (x - 0.3) ** 2).mean() ** 2
    assert abs(values.mean() - truth) < 4.0 * values.std() / np.sqrt(len(values))


def test_one_number_is_the_first_of_two():
    numbers = np.empty((8, 64), np.float32)
    fill_numbers(Settings(samples=64, seed=1), numbers, 5)
    np.testing.assert_array_equal(numbers, points_of(8, 64, dimension=5, seed=1)[..., 0])


def test_numbers_stay_below_one():
    assert to_unit_float(np.uint32(0xFFFFFFFF)) == 1.0 - 2.0**-24
    assert to_unit_float(np.uint32(0)) == 0.0
    points = points_of(1000, 1024)
    assert points.min() >= 0.0
    assert points.max() < 1.0


@pytest.mark.parametrize(
    ("function", "result"), [(sample_1d, numba.float32), (sample_2d, numba.types.UniTuple(numba.float32, 2))]
)
def test_numbers_are_float32(function, result):
    @numba.njit  # without a cache: what comes from one has not looked at the types of what it calls
    def call(settings):
        return function(make_sampler(make_sequence(settings, 0, 7), 0), 0)

    call(Settings())
    assert function.inner.nopython_signatures
    assert all(signature.return_type == result for signature in function.inner.nopython_signatures)


def test_hash_is_a_bijection_that_changes_half_of_all_bits():
    x = np.arange(1 << 16, dtype=np.uint32)
    hashed = np.array([hash_u32(v) for v in x], np.uint32)
    assert len(np.unique(hashed)) == len(x)
    for bit in (0, 7, 16, 31):
        flipped = np.array([hash_u32(v) for v in x ^ np.uint32(1 << bit)], np.uint32)
        rate = np.unpackbits((hashed ^ flipped).view(np.uint8)).mean()
        assert abs(rate - 0.5) < 0.01


def test_hashed_numbers_are_uniform_and_independent_of_neighbours():
    numbers = np.array([[hash_float(seed, index, 3) for index in range(300)] for seed in range(300)])
    assert uniformity(numbers[:, :-1].ravel(), numbers[:, 1:].ravel()) > SIGNIFICANCE
    assert uniformity(numbers[:-1].ravel(), numbers[1:].ravel()) > SIGNIFICANCE


@pytest.mark.parametrize(("a", "b"), [(1.0, 2.0), (1e30, 1e30), (1e-30, 1e-25), (3.0, 0.0), (0.0, 1.0)])
def test_weights_of_both_techniques_add_up_to_one(a, b):
    a, b = np.float32(a), np.float32(b)
    assert power_heuristic(a, b) + power_heuristic(b, a) == pytest.approx(1.0, abs=1e-6)
    assert power_heuristic(a, b) == pytest.approx(float(a) ** 2 / (float(a) ** 2 + float(b) ** 2), abs=1e-6)
