# SPDX-License-Identifier: GPL-3.0-or-later
"""Choosing a light: with exactly the probability that is claimed, in proportion to a power that is the lamp's."""

import math

import numba
import numpy as np
import pytest

from blender_tests.helpers.lights import EMISSION, OneLight, even_numbers, light, sample_light
from engine_core.light.select import QUANTA, apportion, light_power, select, set_probabilities
from engine_core.tables import SHAPE, WORLD
from engine_core.tables import LightKind as Kind

MEAN = np.mean(EMISSION)


def scene_of(lights):
    world = np.zeros(1, WORLD)
    world["light_count"] = len(lights)
    return OneLight(lights=lights, shapes=np.zeros(1, SHAPE), world=world)


def lamps(*powers):
    """Points with intensities in proportion to `powers`."""
    rows = np.concatenate([light(Kind.POINT, is_delta=1) for _ in powers])
    rows["emission"] *= np.array(powers)[:, None]
    set_probabilities(rows, 1.0)
    return rows


@numba.njit
def select_often(scene, u):
    result = np.empty((len(u), 3), np.float32)
    for i in range(len(u)):
        result[i, 0], result[i, 1], result[i, 2] = select(scene, u[i])
    return result


# ---- Selection -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("powers", [(1,), (1, 2, 3), (0, 1, 0, 0, 2, 0), (1e-9, 1, 1e-9), tuple(range(100))])
def test_lights_are_chosen_as_often_as_claimed(powers):
    """Not at random: all numbers that a sampler can give, here every 16th, fall where they must."""
    rows = lamps(*powers)
    u = (np.arange(0, QUANTA, 16) / QUANTA).astype(np.float32)
    row, pmf, _ = select_often(scene_of(rows), u).T
    counts = np.bincount(row.astype(int), minlength=len(rows))
    np.testing.assert_allclose(counts / len(u), rows["pmf"], atol=2.0 * 16 / QUANTA)
    np.testing.assert_array_equal(pmf, rows["pmf"][row.astype(int)])
    assert rows["pmf"].astype(float).sum() == 1.0
    np.testing.assert_allclose(rows["pmf"], np.array(powers) / sum(powers), atol=1.1 * len(rows) / QUANTA)


def test_edges_of_intervals_belong_to_one_light():
    rows = lamps(*range(1, 50))
    edges = (rows["cdf"].astype(float) * QUANTA).astype(int)[:-1]
    for offset, expected in ((-1, np.arange(48)), (0, np.arange(1, 49))):
        u = ((edges + offset) / QUANTA).astype(np.float32)
        np.testing.assert_array_equal(select_often(scene_of(rows), u)[:, 0], expected)


def test_what_is_left_of_the_number_is_uniform():
    rows = lamps(1, 5, 2)
    u = ((np.arange(100_000) + 0.5) / 100_000).astype(np.float32)
    row, _, rest = select_often(scene_of(rows), u).T
    for number in range(3):
        mine = np.sort(rest[row == number])
        np.testing.assert_allclose(mine, np.linspace(0.0, 1.0, len(mine)), atol=1e-4)
    assert rest.min() >= 0.0
    assert rest.max() < 1.0


def test_faint_lights_keep_a_chance():
    """A light that were never chosen would be missing from the picture."""
    rows = lamps(1e-12, 1.0, 1e-12, 0.0)
    assert (rows["pmf"] > 0).tolist() == [True, True, True, False]


def test_no_light_at_all_is_chosen_with_probability_zero():
    rows = lamps(0.0, 0.0)
    assert (select_often(scene_of(rows), np.array([0.0, 0.7], np.float32))[:, 1] == 0.0).all()


def test_a_million_lights_have_exact_probabilities():
    powers = np.random.default_rng(3).random(1_000_000) ** 4
    counts = apportion(powers, QUANTA)
    assert counts.sum() == QUANTA
    assert counts.min() >= 1
    wanted = np.maximum(powers / powers.sum() * QUANTA, 1.0)
    typical = np.abs(counts - wanted) <= 1.0
    assert typical.mean() > 0.99


def test_suns_do_not_outshine_lamps():
    """In a large scene a sun's power is all there is; what the camera sees may still be lit by the lamp."""
    rows = np.concatenate([light(Kind.POINT, is_delta=1), light(Kind.SUN, is_delta=1), light(Kind.BACKGROUND)])
    set_probabilities(rows, 1e4)
    np.testing.assert_allclose(rows["pmf"], [0.25, 0.75, 0.0], atol=1e-3)


# ---- Power -----------------------------------------------------------------------------------------------------------


def fibonacci_sphere(n):
    """Points spread evenly on the unit sphere: (n, 3)."""
    i = np.arange(n) + 0.5
    z, phi = 1.0 - 2.0 * i / n, np.pi * (1.0 + math.sqrt(5.0)) * i
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1)


SIZE = {"u": (0.4, 0, 0), "v": (0, -0.3, 0)}
NARROW = math.tan(math.radians(35.0))
POWERS = {
    "point": light(Kind.POINT, is_delta=1),
    "soft point": light(Kind.POINT, radius=0.2, soft=1),
    "ball": light(Kind.POINT, radius=0.2),
    "spot": light(Kind.SPOT, is_delta=1, cos_angle=0.6, blend=4.0),
    "sharp spot": light(Kind.SPOT, is_delta=1, cos_angle=0.2),
    "quad": light(Kind.QUAD, **SIZE),
    "narrow quad": light(Kind.QUAD, **SIZE, spread=NARROW),
    "disk": light(Kind.DISK, **SIZE),
    "narrow disk": light(Kind.DISK, **SIZE, spread=NARROW),
    "triangle": light(Kind.TRIANGLE, **SIZE),
    "two-sided triangle": light(Kind.TRIANGLE, **SIZE, two_sided=1),
    "sphere": light(Kind.SPHERE, radius=0.2),
}


@pytest.mark.parametrize("name", POWERS)
def test_power_is_the_flux_through_a_sphere_around(name):
    row = POWERS[name]
    radius, n = 50.0, 40_000
    directions = fibonacci_sphere(n)
    p = row["p"][0] + radius * directions
    s = sample_light(row, p, np.tile(even_numbers(10), (n // 100, 1)))
    cosine = -(s.wi * directions).sum(axis=1)
    irradiance = s.radiance.mean(axis=1) * cosine / np.where(s.pdf > 0, s.pdf, np.inf)
    flux = irradiance.astype(float).mean() * 4.0 * math.pi * radius**2
    assert light_power(row, 1.0)[0] == pytest.approx(flux, rel=5e-3)


def test_power_of_what_is_infinitely_far_is_what_enters_the_scene():
    half = math.radians(10.0)
    disk = light(Kind.SUN, height=1.0 - math.cos(half))
    assert light_power(light(Kind.SUN, is_delta=1), 3.0)[0] == pytest.approx(MEAN * math.pi * 9.0)
    assert light_power(disk, 3.0)[0] == pytest.approx(MEAN * math.pi * math.sin(half) ** 2 * math.pi * 9.0, rel=1e-5)
    # radiance L from all around: irradiance pi L on each side of each part of the ball's surface
    assert light_power(light(Kind.BACKGROUND), 3.0)[0] == pytest.approx(MEAN * math.pi * 4.0 * math.pi * 9.0)


def test_power_of_a_beam_is_its_irradiance_times_its_area():
    row = light(Kind.DISK, **SIZE, is_delta=1, spread=0.0)
    assert light_power(row, 1.0)[0] == pytest.approx(MEAN * math.pi * 0.12)


def test_power_of_an_elliptic_spot_is_about_that_of_its_cone():
    """Axes of 2 and 1: twice the solid angle, for a cone that is not too wide."""
    round_one = light(Kind.SPOT, is_delta=1, cos_angle=0.98)
    elliptic = light(Kind.SPOT, is_delta=1, cos_angle=0.98, u=(0.5, 0, 0))
    assert light_power(elliptic, 1.0)[0] == pytest.approx(2.0 * light_power(round_one, 1.0)[0], rel=1e-6)
