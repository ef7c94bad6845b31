# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions are densities that their samples follow; flights have the means of what they stand for."""

import numpy as np
import pytest

from engine_core.jit import kernel
from engine_core.linalg.vec3 import Vec3
from engine_core.medium import equiangular
from engine_core.medium.dispatch import phase_value, sample_cosine
from engine_core.medium.homogeneous import fly
from engine_core.medium_tables import PHASE
from engine_core.scene.volumes import Draine, FournierForand, HenyeyGreenstein, Mie, Rayleigh, _phase_rows

CASES = [
    *(HenyeyGreenstein(g) for g in (0.0, 0.002, 0.7, -0.9)),
    Rayleigh(),
    *(Draine(g, alpha) for g, alpha in ((0.0, 1.0), (0.002, 1.5), (0.5, 0.5), (-0.3, 2.0), (0.6, 250.0))),
    *(FournierForand(ior, share) for ior, share in ((1.33, 0.1), (1.5, 0.3))),
    *(Mie(diameter) for diameter in (0.05, 0.5, 3.0, 20.0)),
]


@kernel
def _values(rows, cosines, values):
    for i in range(len(cosines)):
        values[i] = phase_value(rows[0], cosines[i])


@kernel
def _cosines(rows, u, cosines):
    for i in range(len(u)):
        cosines[i] = sample_cosine(rows[0], u[i])


@pytest.mark.parametrize("phase", CASES, ids=str)
def test_samples_follow_the_density(phase):
    """Evenly spread numbers fill the cumulative distribution evenly (Kolmogorov's statistic)."""
    shares = [share for share, _ in _phase_rows(phase)]
    assert sum(shares) == pytest.approx(1.0)
    for _, row in _phase_rows(phase):
        rows = np.array([row], PHASE).view(np.recarray)
        theta = np.linspace(0.0, np.pi, 100_001)[1:]
        values, u = np.zeros(len(theta), np.float32), ((np.arange(50_000) + 0.5) / 50_000).astype(np.float32)
        cosines = np.zeros(len(u), np.float32)
        _values(rows, np.cos(theta).astype(np.float32), values)
        _cosines(rows, u, cosines)
        density = values * 2.0 * np.pi * np.sin(theta)
        assert np.trapezoid(density, theta) == pytest.approx(1.0, abs=5e-3)
        below = np.cumsum(density) * (theta[1] - theta[0])
        found = np.interp(np.sort(np.arccos(np.clip(cosines.astype(float), -1.0, 1.0))), theta, below)
        assert np.abs(found - u).max() < 6e-3


LIGHTS = {"none": (0.0, 0.0, 1e9), "beside": (0.1, 0.3, 0.0), "behind": (0.0, -0.2, -0.4), "far": (1.0, 6.0, 0.0)}


@kernel
def _aim(place, t_max, sigma_t):
    """At a light, of a ray from the origin along y."""
    return equiangular.aim_at(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), t_max, place, np.float32(0.01), sigma_t)


@kernel
def _fly(sigma_t, sigma_s, beta, t_max, light, nothing, n, within, sums):
    aim = _aim(light, t_max, sigma_t)
    for i in range(10 * n):
        for j in range(n):
            u0, u1 = (np.float32(i) + 0.5) / np.float32(10 * n), (np.float32(j) + 0.5) / np.float32(n)
            flight = fly(sigma_t, sigma_s, beta, t_max, aim, nothing, u0, u1)
            row = 0 if not flight.scatters else (1 if flight.t < within else 2)
            sums[row, 0] += flight.weight.x
            sums[row, 1] += flight.weight.y
            sums[row, 2] += flight.weight.z
            after = beta * flight.weight
            sums[3, 0] = max(sums[3, 0], after.x + after.y + after.z)


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("nothing", [False, True])
@pytest.mark.parametrize("sigma_s", [(0.5, 1.0, 2.0), (0.0, 0.3, 4.0), (0.05, 0.1, 0.0)])
def test_flights_stand_for_all_that_is_scattered_and_gets_through(sigma_s, nothing, light):
    sigma_s, n, t_max, within = np.array(sigma_s), 400, 1.5, 0.4
    sigma_t = sigma_s + np.array([0.2, 0.0, 0.1])
    sums, place, t_max = np.zeros((4, 3)), Vec3(*LIGHTS[light]), np.float32(t_max)
    share = _aim(place, t_max, Vec3(*sigma_t)).share
    if light == "none":
        assert share == 0.0
    elif light == "beside":
        assert share > 0.1
    beta = Vec3(1.0, 0.5, 0.8)
    _fly(Vec3(*sigma_t), Vec3(*sigma_s), beta, t_max, place, nothing, n, np.float32(within), sums)
    through, near, far = sums[:3] / (10 * n**2)
    albedo = sigma_s / sigma_t
    expected = albedo * -np.expm1(-sigma_t * within), albedo * (np.exp(-sigma_t * within) - np.exp(-sigma_t * t_max))
    assert near == pytest.approx(expected[0], rel=0.02, abs=1e-6)
    assert far == pytest.approx(expected[1], rel=0.02, abs=1e-6)
    assert through == pytest.approx(0.0 if nothing else np.exp(-sigma_t * t_max), rel=0.02)
    assert sums[3, 0] <= 2.3001 / (1.0 - share)  # none brings more than it had, by as much as aimed flights take


@kernel
def _places(light, t_max, u, t, density):
    aim = _aim(light, t_max, Vec3(0.1, 0.1, 0.1))
    for i in range(len(u)):
        t[i] = equiangular.sample(aim, u[i])
        density[i] = equiangular.pdf(aim, t[i])


@pytest.mark.parametrize("t_max", [1.5, np.inf])
@pytest.mark.parametrize("light", ["beside", "behind"])
def test_places_near_a_light_follow_their_density(light, t_max):
    """Between evenly spread numbers lies an equal part of the density's integral."""
    u = ((np.arange(20_000) + 0.5) / 20_000).astype(np.float32)
    t, density = np.zeros(len(u), np.float32), np.zeros(len(u), np.float32)
    _places(Vec3(*LIGHTS[light]), np.float32(t_max), u, t, density)
    t, density = t.astype(float), density.astype(float)
    below = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(t))])
    assert t.min() > -1e-5
    assert t.max() < t_max
    assert (np.diff(t) > -1e-5 * (1.0 + t[1:])).all()
    middle = u < 0.99  # beyond it lies half of an endless ray
    assert below[middle] == pytest.approx(u[middle] - u[0], abs=2e-3)
