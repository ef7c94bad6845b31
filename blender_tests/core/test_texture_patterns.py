# SPDX-License-Identifier: GPL-3.0-or-later
"""Voronoi cells are what they claim to be, and simple patterns stay in their range and repeat."""

import itertools
import math

import numpy as np
import pytest

from engine_core.linalg.vec3 import Vec3
from engine_core.texture.brick import brick
from engine_core.texture.cells import Lattice, Point4, VoronoiMetric, point_of
from engine_core.texture.checker import checker, sine_checker
from engine_core.texture.gabor import gabor
from engine_core.texture.gradient import GradientKind, gradient
from engine_core.texture.magic import magic
from engine_core.texture.voronoi import VoronoiFeature, voronoi
from engine_core.texture.wave import WaveKind, WaveProfile, wave

f = np.float32
RANDOM = np.random.default_rng(3)
POINTS = RANDOM.uniform(-20, 20, (40, 4)).astype(np.float32)


def look(
    point,
    dimensions,
    feature,
    metric=VoronoiMetric.EUCLIDEAN,
    smoothness=1.0,
    detail=0.0,
    normalize=False,
    only=False,
    randomness=1.0,
):
    """A Voronoi sample at scale 1; in one dimension at the first coordinate."""
    x, y, z, w = (float(c) for c in point)
    p, w = Vec3(x, y, z), f(x if dimensions == 1 else w)
    numbers = [f(n) for n in (1, detail, 0.5, 2, smoothness, 1.5, randomness)]
    return voronoi(p, w, dimensions, int(feature), int(metric), *numbers, normalize, only)


def neighbours(point, dimensions, reach=1, randomness=1.0):
    """[point of a cell] around the one of `point`, in the whole space, by the scalar function."""
    lattice = Lattice(dimensions, 0, f(1), f(randomness))
    cell = np.zeros(4, np.float32)
    cell[:dimensions] = np.floor(point[:dimensions])
    steps = itertools.product(range(-reach, reach + 1), repeat=dimensions)
    offsets = [np.float32((*step, *[0] * (4 - dimensions))) for step in steps]
    found = [point_of(lattice, Point4(*cell), Point4(*offset)) for offset in offsets]
    return np.array(found)[:, :dimensions] + cell[:dimensions]


def distances(points, point, metric):
    d = abs(points - point[: points.shape[1]]).astype(float)
    if metric == VoronoiMetric.MANHATTAN:
        return d.sum(axis=1)
    if metric == VoronoiMetric.CHEBYCHEV:
        return d.max(axis=1)
    e = 1.5 if metric == VoronoiMetric.MINKOWSKI else 2
    return (d**e).sum(axis=1) ** (1 / e)


@pytest.mark.parametrize("metric", VoronoiMetric)
@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_the_nearest_points_are_the_nearest_of_all(dimensions, metric):
    metric = VoronoiMetric.EUCLIDEAN if dimensions == 1 else metric
    for point in POINTS:
        points = neighbours(point, dimensions)
        d = distances(points, point, metric)
        order = np.argsort(d)
        for feature, rank in ((VoronoiFeature.F1, 0), (VoronoiFeature.F2, 1)):
            sample = look(point, dimensions, feature, metric)
            position = np.array([sample.w] if dimensions == 1 else [*sample.position, sample.w][:dimensions])
            assert sample.distance == pytest.approx(d[order[rank]], abs=1e-5)
            alone = look(point, dimensions, feature, metric, only=True)
            assert alone.distance == pytest.approx(sample.distance, abs=1e-6)  # another order of sums
            np.testing.assert_allclose(position, points[order[rank]], atol=1e-5)
            assert min(sample.color) >= 0
            assert max(sample.color) <= 1


@pytest.mark.parametrize("randomness", [0.0, 0.3, 0.8])
@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_less_randomness_moves_the_points_and_leaves_the_nearest_nearest(dimensions, randomness):
    for point in POINTS:
        d = distances(neighbours(point, dimensions, randomness=randomness), point, VoronoiMetric.EUCLIDEAN)
        sample = look(point, dimensions, VoronoiFeature.F1, randomness=randomness)
        assert sample.distance == pytest.approx(d.min(), abs=1e-5)


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_distances_to_edges_and_radii_are_those_of_the_points(dimensions):
    for point in POINTS:
        points = neighbours(point, dimensions).astype(float)
        here = point[:dimensions].astype(float)
        nearest = points[np.argmin(distances(points, point, VoronoiMetric.EUCLIDEAN))]
        across = points - nearest
        size = np.linalg.norm(across, axis=1)
        other = size > 0.01
        to_planes = ((0.5 * (points + nearest) - here) * across).sum(axis=1)[other] / size[other]
        if dimensions > 1:
            assert look(point, dimensions, VoronoiFeature.DISTANCE_TO_EDGE).distance == pytest.approx(
                to_planes.min(), abs=1e-4
            )
        around = neighbours(point, dimensions, reach=2).astype(float)
        cells = np.round(np.floor(around) - np.floor(nearest))
        apart = np.linalg.norm(around - nearest, axis=1)
        near = apart[(abs(cells).max(axis=1) <= 1) & (apart > 1e-4)].min()
        assert look(point, dimensions, VoronoiFeature.N_SPHERE_RADIUS).radius == pytest.approx(near / 2, abs=1e-5)


@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_a_smooth_minimum_becomes_the_minimum(dimensions):
    for point in POINTS:
        sharp = look(point, dimensions, VoronoiFeature.F1)
        nearly = look(point, dimensions, VoronoiFeature.SMOOTH_F1, smoothness=1e-4)
        smooth = look(point, dimensions, VoronoiFeature.SMOOTH_F1, smoothness=1.0)
        assert nearly.distance == pytest.approx(sharp.distance, abs=1e-3)
        assert smooth.distance <= sharp.distance + 1e-5


@pytest.mark.parametrize("feature", [VoronoiFeature.F1, VoronoiFeature.F2, VoronoiFeature.DISTANCE_TO_EDGE])
@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_normalized_distances_stay_in_zero_to_one(feature, dimensions):
    values = [look(p, dimensions, feature, detail=2.5, normalize=True).distance for p in POINTS]

    assert min(values) >= 0
    assert max(values) <= 1


# ---- Simple patterns -------------------------------------------------------------------------------------------------


def test_checkers_alternate_along_each_axis():
    for point in POINTS[:, :3]:
        here = checker(Vec3(*point))
        for axis in range(3):
            step = np.eye(3)[axis]
            assert checker(Vec3(*(point + step))) == 1 - here
            assert checker(Vec3(*(point + 2 * step))) == here


def test_the_sign_of_three_sines_is_a_checker():
    for point in POINTS[:, :3]:
        value = sine_checker(Vec3(*point))
        assert value == pytest.approx(np.sin(point.astype(float)).prod(), abs=1e-5)
        assert (value < 0) == (checker(Vec3(*(point / math.pi))) == 1)


@pytest.mark.parametrize("kind", GradientKind)
def test_gradients_stay_in_zero_to_one_and_reach_both(kind):
    line = [
        gradient(Vec3(x, x if kind == GradientKind.DIAGONAL else 1e-4, 0), int(kind)) for x in np.linspace(-2, 2, 401)
    ]

    assert min(line) == pytest.approx(0, abs=0.01) or kind == GradientKind.RADIAL
    assert max(line) == pytest.approx(1, abs=0.01)
    assert gradient(Vec3(0.6, 0.8, 0), int(GradientKind.SPHERICAL)) == 0


@pytest.mark.parametrize("kind", WaveKind)
@pytest.mark.parametrize("profile", WaveProfile)
def test_waves_repeat(kind, profile):
    """Twenty radians to a unit."""
    along = lambda x: wave(Vec3(x, 0, 0), int(kind), 0 if kind == 0 else 3, int(profile), *[f(0)] * 5)  # noqa: E731
    xs = np.linspace(0.01, 3, 500)
    values = np.array([along(x) for x in xs])

    assert values.min() >= 0
    assert values.max() <= 1
    assert values.max() - values.min() > 0.95
    smooth = profile != WaveProfile.SAW
    for x, value in zip(xs, values, strict=True):
        d = abs(along(x + 2 * math.pi / 20) - value)
        assert (d if smooth else min(d, 1 - d)) < 1e-3


def test_magic_stays_around_one_half():
    colors = np.array([tuple(magic(Vec3(*p), depth, f(1.5))) for depth in range(11) for p in POINTS[:, :3]])

    assert abs(colors - 0.5).max() <= 0.5 + 1e-5
    assert colors.std() > 0.2


def test_a_wall_is_made_of_bricks_of_one_colour_each():
    one, two, mortar = Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)
    look_at = lambda x, y: brick(Vec3(x, y, 0), one, two, mortar, f(0.1), f(0), f(0), f(1), f(0.5), f(0.5), 2, f(1), 2)  # noqa: E731

    for row, number in itertools.product(range(-3, 4), range(-3, 4)):
        left = number - (0.5 if row % 2 == 0 else 0.0)
        inside = [look_at(left + x, 0.5 * row + y) for x, y in ((0.11, 0.11), (0.89, 0.39), (0.5, 0.25))]
        assert [s.mortar for s in inside] == [0, 0, 0]
        assert len({tuple(s.color) for s in inside}) == 1
        assert sum(inside[0].color) == pytest.approx(1)
        assert tuple(look_at(left + 0.05, 0.5 * row + 0.25).color) == (0, 0, 1)
        assert look_at(left + 0.5, 0.5 * row + 0.45).mortar == 1


@pytest.mark.parametrize("dimensions", [2, 3])
def test_gabor_noise_is_continuous_and_goes_up_and_down_with_its_frequency(dimensions):
    def along(x, frequency):
        return gabor(Vec3(x, 0.3, 0.2), dimensions, f(frequency), f(1), f(0), Vec3(1, 0, 0))

    xs = np.arange(0, 40, 0.02)
    for frequency in (1.0, 3.0):
        samples = [along(x, frequency) for x in xs]
        values = np.array([s.value for s in samples]) - 0.5
        assert abs(np.diff(values)).max() < 0.02 * frequency * 2 * math.pi
        spectrum = abs(np.fft.rfft(values * np.hanning(len(values))))
        assert np.fft.rfftfreq(len(xs), 0.02)[spectrum.argmax()] == pytest.approx(frequency, abs=0.5)
        for s in samples:
            assert s.value - 0.5 == pytest.approx(-0.5 * s.intensity * math.sin(2 * math.pi * s.phase), abs=1e-4)
