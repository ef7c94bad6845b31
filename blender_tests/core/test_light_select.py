# SPDX-License-Identifier: GPL-3.0-or-later
"""Choosing among suns, beams and the tree; and what is taken for a light's strength, which is the lamp's."""

import math

import numpy as np
import pytest

from blender_tests.helpers.lights import (
    EMISSION,
    irradiance,
    light,
    many_lights,
    pmf_of_all,
    select_often,
)
from engine_core.light.bounds import clusters, intensity
from engine_core.light.bounds import irradiance as far_irradiance
from engine_core.tables import LightKind as Kind

MEAN = np.mean(EMISSION)
UP, DOWN = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
ORIGIN = (0.0, 0.0, 0.0)


def probabilities(rows, p=ORIGIN, n=UP, both_sides=False):
    return pmf_of_all(many_lights(rows), [p], [n], both_sides)[0]


def lamp(intensity=1.0, **fields):
    """A point light one metre above the origin."""
    return light(Kind.POINT, is_delta=1, **{"emission": (intensity,) * 3, **fields})


def sun(irradiance=1.0, n=DOWN, **fields):
    return light(Kind.SUN, is_delta=1, emission=(irradiance,) * 3, n=n, **fields)


# ---- Who is chosen ---------------------------------------------------------------------------------------------------


def test_the_only_light_is_always_chosen_and_takes_no_random_number():
    """Even where it cannot be seen: the answer costs nothing."""
    for row in (lamp(), sun(), light(Kind.QUAD), light(Kind.TRIANGLE, two_sided=1)):
        scene = many_lights(np.concatenate([row, light(Kind.BACKGROUND), light(Kind.TRIANGLE, u=(0, 0, 0))]))
        u = np.array([0.0, 0.3, 0.99], np.float32)
        chosen, pmf, rest = select_often(scene, ORIGIN, DOWN, u)
        assert (chosen == 0).all()
        assert (pmf == 1.0).all()
        np.testing.assert_array_equal(rest, u)
        assert pmf_of_all(scene, [ORIGIN], [DOWN])[0].tolist() == [1.0, 0.0, 0.0]


def test_the_only_pair_is_chosen_by_area():
    """An emissive square is two triangles; where they are seen from makes no difference."""
    a = light(Kind.TRIANGLE, p=(0, 0, 1), u=(0, 2, 0), v=(2, 2, 0))
    b = light(Kind.TRIANGLE, p=(0, 0, 1), u=(2, 2, 0), v=(1, 0, 0), prim=1)
    scene = many_lights(np.concatenate([a, b]))
    np.testing.assert_allclose(pmf_of_all(scene, [ORIGIN], [DOWN]), [[2 / 3, 1 / 3]], rtol=1e-6)
    u = np.array([0.0, 0.6, 0.7, 0.999], np.float32)
    chosen, pmf, rest = select_often(scene, ORIGIN, DOWN, u)
    assert chosen.tolist() == [0, 0, 1, 1]
    np.testing.assert_allclose(pmf, [2 / 3, 2 / 3, 1 / 3, 1 / 3], rtol=1e-6)
    np.testing.assert_allclose(rest, [0.0, 0.9, 0.1, 0.997], atol=1e-5)


def test_nothing_is_chosen_if_there_is_nothing():
    """Constant background is left to scattering; a triangle without area has no light."""
    for rows in (light(Kind.BACKGROUND), np.repeat(light(Kind.TRIANGLE, u=(0, 0, 0)), 2)):
        scene = many_lights(rows)
        assert select_often(scene, ORIGIN, UP, np.array([0.0, 0.7], np.float32))[1].tolist() == [0.0, 0.0]
        assert pmf_of_all(scene, [ORIGIN], [UP]).max() == 0.0


def test_half_goes_by_irradiance_and_half_evenly():
    """A sun of 3 W/m2 beside a lamp that brings 1, and all others that bring nothing here."""
    np.testing.assert_allclose(probabilities(np.concatenate([sun(3.0), lamp()])), [0.625, 0.375], atol=1e-3)
    three = np.concatenate([sun(3.0), sun(2.0, n=(0, 0, 1)), lamp()])
    np.testing.assert_allclose(probabilities(three), [0.625, 0.0, 0.375], atol=1e-3)
    np.testing.assert_allclose(probabilities(three, n=DOWN), [0.0, 1.0, 0.0], atol=1e-3)
    np.testing.assert_allclose(probabilities(three, both_sides=True).sum(), 1.0, atol=1e-6)
    slanting = np.concatenate([sun(4.0, n=(0, 0.8, -0.6)), sun(1.0)])
    np.testing.assert_allclose(probabilities(slanting), [0.5 * (2.4 / 3.4 + 0.5), 0.5 * (1.0 / 3.4 + 0.5)], atol=1e-3)


def test_a_sun_that_dips_below_the_horizon_still_shines():
    """Its disk has a radius of 10 degrees, its centre stands 9 below the horizon; and at 11 all of it is gone."""
    for below, expected in ((9.0, True), (11.0, False)):
        a = math.radians(below)
        disk = light(Kind.SUN, height=1.0 - math.cos(math.radians(10.0)), n=(0, math.cos(a), math.sin(a)))
        assert (probabilities(np.concatenate([disk, lamp()]))[0] > 0.0) == expected


def test_beams_are_chosen_where_they_fall():
    """They do not fade with distance, and light nothing beside them or behind."""
    size = {"u": (0.4, 0, 0), "v": (0, -0.3, 0)}
    rows = np.concatenate([light(kind, **size, is_delta=1, spread=0.0) for kind in (Kind.QUAD, Kind.DISK)] + [lamp()])
    rows["p"] = (0, 0, 1), (2, 0, 1), (1, 0, 1)
    for x, expected in ((0.0, [True, False]), (0.39, [True, False]), (1.0, [False, False]), (2.0, [False, True])):
        for height in (0.5, 0.0, -1000.0):
            assert (probabilities(rows, (x, 0, height))[:2] > 0.0).tolist() == expected
        assert (probabilities(rows, (x, 0, 1.5))[:2] == 0.0).all()
    assert probabilities(rows, (0, 0, -1000.0))[0] > 0.7


def test_suns_do_not_outshine_lamps():
    """However strong the sun, and whatever shadow it may leave us in, a quarter of all samples go to the lamps."""
    assert probabilities(np.concatenate([sun(1e6), lamp()]))[1] == pytest.approx(0.25, abs=1e-3)


@pytest.mark.parametrize("both_sides", [False, True])
def test_lights_are_chosen_as_often_as_claimed(both_sides):
    """Not at random: all numbers that a sampler can give, here every 64th, fall where they must."""
    rows = np.concatenate([sun(0.5), sun(2.0, n=(0, 1, 0)), sun(0.1, n=(0.6, 0, -0.8)), *[lamp() for _ in range(5)]])
    rows["p"][3:] = np.random.default_rng(4).normal(size=(5, 3))
    scene = many_lights(rows)
    steps = np.arange(0, 2**24, 64)
    n = (0.48, 0.6, 0.64)
    chosen, pmf, rest = select_often(scene, ORIGIN, n, (steps / 2**24).astype(np.float32), both_sides)
    expected = pmf_of_all(scene, [ORIGIN], [n], both_sides)[0]
    found = pmf > 0.0
    counts = np.bincount(chosen[found], minlength=len(rows))
    np.testing.assert_allclose(counts / len(steps), expected, atol=2.5 * 64 / 2**24)
    np.testing.assert_allclose(pmf[found], expected[chosen[found]], rtol=1e-5)
    for row in np.flatnonzero(expected):  # what is left of the number is uniform again
        mine = np.sort(rest[found & (chosen == row)])
        np.testing.assert_allclose(mine, np.linspace(0.0, 1.0, len(mine)), atol=1e-3)
    assert rest.min() >= 0.0
    assert rest.max() < 1.0


# ---- How strong they are ---------------------------------------------------------------------------------------------

SIZE = {"u": (0.4, 0, 0), "v": (0, -0.3, 0)}
NARROW = math.tan(math.radians(35.0))
BOUNDED = {
    "point": light(Kind.POINT, is_delta=1),
    "soft point": light(Kind.POINT, radius=0.2, soft=1),
    "ball": light(Kind.POINT, radius=0.2),
    "spot": light(Kind.SPOT, is_delta=1, cos_angle=0.6, blend=4.0),
    "quad": light(Kind.QUAD, **SIZE),
    "narrow quad": light(Kind.QUAD, **SIZE, spread=NARROW),
    "disk": light(Kind.DISK, **SIZE),
    "narrow disk": light(Kind.DISK, **SIZE, spread=NARROW),
    "triangle": light(Kind.TRIANGLE, **SIZE),
    "two-sided triangle": light(Kind.TRIANGLE, **SIZE, two_sided=1),
    "sphere": light(Kind.SPHERE, radius=0.2),
    "two-sided quad": light(Kind.QUAD, **SIZE, two_sided=1),
}


@pytest.mark.parametrize("name", BOUNDED)
def test_intensity_is_what_arrives_straight_ahead(name):
    row = BOUNDED[name]
    received = irradiance(row, row["p"][0] + (0, 0, -400.0), UP).mean() * 400.0**2
    assert intensity(row)[0] == pytest.approx(received, rel=2e-3)


def test_intensity_of_a_box_is_what_arrives_where_most_of_it_is_seen():
    row = light(Kind.BOX, **SIZE, radius=0.2)
    directions = np.random.default_rng(3).normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    received = max(irradiance(row, row["p"][0] + 400.0 * d, -d, 5).mean() for d in directions) * 400.0**2
    assert intensity(row)[0] == pytest.approx(received, rel=5e-3)


@pytest.mark.parametrize("name", ["quad", "narrow quad", "disk", "narrow disk"])
def test_light_becomes_no_stronger_than_it_is_at_the_emitter(name):
    row = BOUNDED[name]
    received = irradiance(row, row["p"][0] + (0, 0, -0.02), UP).mean()
    (cluster,) = clusters(row, np.array([False]))
    assert cluster["intensity"] * cluster["closest"] ** 2 == pytest.approx(received, rel=0.03)


def test_irradiance_of_what_does_not_fade():
    disk = light(Kind.SUN, height=1.0 - math.cos(math.radians(20.0)))
    for row in (light(Kind.SUN, is_delta=1), disk, light(Kind.DISK, **SIZE, is_delta=1, spread=0.0)):
        assert far_irradiance(row)[0] == pytest.approx(irradiance(row, ORIGIN, UP).mean(), rel=1e-3)
