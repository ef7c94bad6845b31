# SPDX-License-Identifier: GPL-3.0-or-later
"""The error of a picture, told by how its pixels move; and samples given to pixels by it, without a bias."""

import numpy as np
import pytest

from engine_core.film import adaptive
from engine_core.film.noise import Noise, mean_of_neighbours
from engine_core.film.passes import make_film, pixels

SIZE = 96
MEAN = 1.0


class RareLight:
    """A picture whose samples are mostly dark: with a probability, other in each column, they bring 1 / probability."""

    def __init__(self, seed, rarest=1.0 / 200.0):
        self.film = make_film(SIZE, SIZE)
        self.chance = np.geomspace(0.5, rarest, SIZE)[None, :].repeat(SIZE, 0)
        self._random = np.random.default_rng(seed)

    def sample(self, targets):
        """Add samples until pixels have `targets`."""
        grid = pixels(self.film)
        bright = self._random.binomial(targets - grid["samples"], self.chance)
        grid["radiance"] += (MEAN * bright / self.chance)[..., None].astype(np.float32)
        grid["samples"] = targets

    def image(self):
        grid = pixels(self.film)
        return grid["radiance"][..., 0].astype(float) / grid["samples"]

    def deviation(self):
        """Of a single sample."""
        return MEAN * np.sqrt((1.0 - self.chance) / self.chance)


def render(picture, samples, importance_of=Noise.importance):
    """Render as `integrator.tiles` does: doubling, the first half evenly."""
    noise, goal, budget = Noise(picture.film), np.ones((SIZE, SIZE), np.int32), 1
    while True:
        done = pixels(picture.film)["samples"]
        picture.sample(np.minimum(goal, np.maximum(2 * done, 1)))
        noise.update()
        if (done >= goal).all():
            if budget == samples:
                return noise
            if importance_of and 4 * budget > samples:
                goal, budget = adaptive.distribute(importance_of(noise), done, samples, 4 * samples), samples
            else:
                budget = min(2 * budget, samples)
                goal = np.full((SIZE, SIZE), budget, np.int32)


@pytest.mark.parametrize("samples", [32, 64, 100, 512])
@pytest.mark.parametrize("importance_of", [None, Noise.importance], ids=["uniform", "adaptive"])
def test_error_of_independent_samples_is_known(samples, importance_of):
    ratios = []
    for seed in range(8):
        picture = RareLight(seed, rarest=1 / 50)
        estimate = render(picture, samples, importance_of).error_at(samples)
        true = np.sqrt(np.mean((picture.image() - MEAN) ** 2) / (MEAN**2 + 0.01))
        ratios.append(estimate / true)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.12)
    assert 0.75 < min(ratios) < max(ratios) < 1.35


def test_error_of_well_spread_samples_is_known():
    """Each pixel an integral over a line with one jump, by stratified points: the variance falls like n^-2, and the
    points of n samples are among those of 2 n."""
    film, random = make_film(SIZE, SIZE), np.random.default_rng(1)
    noise, jump = Noise(film), random.random((SIZE, SIZE))
    grid = pixels(film)
    n = 1
    points = random.random((SIZE, SIZE, 1))
    while True:
        image = 1.0 + (points < jump[..., None]).mean(axis=-1)
        grid["radiance"], grid["samples"] = (image * n)[..., None], n
        noise.update()
        if n >= 8:
            true = np.sqrt(np.mean((image - 1.0 - jump) ** 2 / ((1.0 + jump) ** 2 + 0.01)))
            assert noise.error_at(n) == pytest.approx(true, rel=0.2)
        if n == 64:
            break
        halves = np.floor(points * 2 * n).astype(int) ^ 1  # the other half of each stratum gets a point too
        points = np.concatenate([points, (halves + random.random(halves.shape)) / (2 * n)], axis=-1)
        n *= 2
    assert noise.decay > 1.5


def test_nothing_is_known_of_a_single_sample():
    picture = RareLight(0)
    assert np.isnan(Noise(picture.film).error_at(0.0))
    picture.sample(np.ones((SIZE, SIZE), np.int32))
    noise = Noise(picture.film)
    noise.update()
    assert np.isnan(noise.error_at(1.0))


def test_more_samples_mean_less_error():
    noise = render(RareLight(3), 64)
    assert noise.samples_for(noise.error_at(256)) == pytest.approx(256)
    assert noise.error_at(256) == pytest.approx(noise.error_at(64) / 2, rel=0.2)


def test_adaptive_pictures_have_no_bias():
    """Mean of the picture over seeds: within 0.1 %, although its samples are rare and count 200 times their share."""
    pictures = [RareLight(seed) for seed in range(100)]
    for picture in pictures:
        render(picture, 64)
    means = [picture.image().mean() for picture in pictures]
    error = np.std(means) / np.sqrt(len(means))
    assert error < 0.001
    assert abs(np.mean(means) - MEAN) < max(4.0 * error, 0.001)


def test_adaptive_pictures_have_less_error_than_uniform_ones():
    def squared_error(importance_of):
        errors = []
        for seed in range(20):
            picture = RareLight(seed)
            render(picture, 128, importance_of)
            errors.append(np.mean((picture.image() - MEAN) ** 2))
        return np.mean(errors)

    s = RareLight(0).deviation()
    best = np.mean(s**2) / np.mean(s) ** 2  # Neyman's
    assert best > 1.4
    assert squared_error(None) / squared_error(Noise.importance) > 1.0 + 0.4 * (best - 1.0)


@pytest.mark.parametrize("budget", [17, 32, 100])
def test_samples_are_distributed_in_proportion(budget):
    importance = np.random.default_rng(0).lognormal(0.0, 0.5, (64, 64)).astype(np.float32)
    targets = adaptive.distribute(importance, np.full((64, 64), 4, np.int32), budget, 1024)
    assert 0.999 * budget < targets.mean() <= budget
    assert (np.log2(targets) % 1.0 == 0.0).all()
    share = targets / importance**adaptive.TRUST
    inner = targets > 4
    assert share[inner].max() / share[inner].min() < 2.0 * 1.01


def test_samples_are_never_taken_away_and_never_more_than_allowed():
    importance = np.ones((32, 32), np.float32)
    importance[:4] = 1e6
    samples = np.full((32, 32), 16, np.int32)
    samples[-4:] = 64
    targets = adaptive.distribute(importance, samples, 48, 128)
    assert (targets >= samples).all()
    assert targets.max() == 128
    assert targets.mean() <= 48


def test_equal_pixels_share_an_uneven_budget():
    targets = adaptive.distribute(np.zeros((50, 50)), np.full((50, 50), 16, np.int32), 24, 256)
    assert sorted(np.unique(targets)) == [16, 32]
    assert targets.mean() == pytest.approx(24, abs=0.1)


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (3, 2), (12, 9)])
def test_neighbours_are_those_around_without_the_pixel(shape):
    a = np.random.default_rng(2).random(shape)
    result = mean_of_neighbours(a)
    for y, x in np.ndindex(shape):
        around = a[max(y - 2, 0) : y + 3, max(x - 2, 0) : x + 3]
        expected = (around.sum() - a[y, x]) / max(around.size - 1, 1)
        assert result[y, x] == pytest.approx(expected, rel=1e-5, abs=1e-6)
