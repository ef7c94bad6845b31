# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths that are guided bring the same light, with less noise."""

import numpy as np
import pytest

from blender_tests.helpers.scenes import box, builder, cube, picture, plane, settings, sphere
from engine_core.guiding import guide
from engine_core.integrator.tiles import Render
from engine_core.scene.materials import Diffuse, Emission, Metallic, Mix

WALL = Diffuse((0.75, 0.7, 0.6))


@pytest.fixture(autouse=True)
def learn_from_few(monkeypatch):
    """Pictures of tests are small."""
    monkeypatch.setattr("engine_core.integrator.tiles.FEWEST_PATHS", 1 << 10)
    monkeypatch.setattr(guide, "FEWEST_PATHS", 1 << 10)
    monkeypatch.setattr(guide, "FULL", 4000)
    monkeypatch.setattr(guide, "LEAST", 100)


def slab(b, low, high):
    low, high = np.array(low), np.array(high)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = np.diag((high - low) / 2), (low + high) / 2
    box(b, WALL, matrix)


def room_behind_a_window():
    """Sky and sun through a hole in the left wall; a ball of diffuse and gloss, and a matt one."""
    b = builder(eye=(0.8, -0.9, 0.2), target=(-0.3, 0.5, -0.4), field_of_view=80)
    for axis in range(3):
        for side in (-1, 1):
            low, high = [-1.1] * 3, [1.1] * 3
            low[axis], high[axis] = (1.0, 1.1) if side > 0 else (-1.1, -1.0)
            if (axis, side) != (0, -1):
                slab(b, low, high)
    for low, high in (
        ((-1.1, -1.1, -1.1), (-1, 1.1, -0.1)),
        ((-1.1, -1.1, 0.4), (-1, 1.1, 1.1)),
        ((-1.1, -1.1, -0.1), (-1, 0.0, 0.4)),
        ((-1.1, 0.5, -0.1), (-1, 1.1, 0.4)),
    ):
        slab(b, low, high)
    sphere(
        b,
        Mix(0.5, Diffuse((0.8, 0.3, 0.2)), Metallic((0.9, 0.9, 0.9), (1, 1, 1), roughness=0.5)),
        (-0.3, 0.4, -0.7),
        0.3,
    )
    sphere(b, Diffuse((0.3, 0.6, 0.3)), (0.4, 0.3, -0.75), 0.25)
    b.background((6.0, 8.0, 12.0))
    b.sun_light("Sun", (0.8, 0.1, -0.6), (10.0, 9.0, 7.0), angle=0.3)
    return b


def pictures(fill, seeds, **changes):
    """Means over blocks of 8 x 8 pixels of independent pictures: (seeds, 36, 3)."""
    values = {"size": 48, "samples": 64, "max_bounces": 6, "adaptive": 0, **changes}
    images = np.array([picture(fill(), seed=seed, **values) for seed in range(seeds)], float)[..., :3]
    return images.reshape(seeds, 6, 8, 6, 8, 3).mean(axis=(2, 4)).reshape(seeds, 36, 3)


def test_guided_paths_bring_the_same_light_with_less_noise():
    guided, plain = (pictures(room_behind_a_window, 12, guiding=guiding) for guiding in (1, 0))
    variance = [p.var(axis=0, ddof=1) for p in (guided, plain)]
    error = np.sqrt((variance[0] + variance[1]) / 12)
    assert np.abs((guided.mean(axis=0) - plain.mean(axis=0)) / error).max() < 5.5  # Student's t, of 108
    whole = [p.mean(axis=(1, 2)) for p in (guided, plain)]
    error = np.sqrt(sum(w.var(ddof=1) for w in whole) / 12)
    assert error < 0.01 * whole[1].mean()
    assert abs(whole[0].mean() - whole[1].mean()) < 4.5 * error
    assert variance[0].mean() < 0.8 * variance[1].mean()


@pytest.mark.parametrize("adaptive", [0, 1])
def test_threads_do_not_change_a_guided_picture(adaptive):
    b = room_behind_a_window()
    one, two, plain = (
        picture(b, threads, size=48, samples=32, max_bounces=6, adaptive=adaptive, guiding=guiding)
        for threads, guiding in ((1, 1), (2, 1), (2, 0))
    )
    assert (one != plain)[..., :3].mean() > 0.5
    np.testing.assert_array_equal(one, two)


def test_guided_paths_lose_nothing_in_a_furnace(monkeypatch):
    """Inside of a closed box that glows by 0.5 and reflects a half, all radiance is 1, however one is guided."""
    monkeypatch.setattr(guide, "WORTHWHILE", 0.0)
    monkeypatch.setattr(guide, "WORTH_ITS_TIME", 0.0)
    b = builder(eye=(0, -0.8, 0), target=(0, 1, 0.2))
    cube(b, Mix(0.5, Diffuse((1, 1, 1)), Emission((1, 1, 1), 1.0)))
    render = Render(b.build(), settings(32, samples=256, min_bounces=30, adaptive=0, guiding=1))
    render.run()
    assert render.guide.is_guiding
    image = render.image("Combined")[..., :3]
    assert image.mean() == pytest.approx(1.0, abs=0.002)


def test_nobody_is_guided_where_it_does_not_pay():
    """Under an even sky the cosine is as good as anything learned."""
    b = builder(eye=(0, -4, 2), target=(0, 0, 0))
    plane(b, WALL, half=3.0)
    b.background((1.0, 1.0, 1.0))
    render = Render(b.build(), settings(64, samples=32, guiding=1))
    render.run()
    assert not render.guide.is_guiding
    assert render.guide.scene.guide["on"][0] == 0
    np.testing.assert_array_equal(render.image("Combined"), picture(b, size=64, samples=32, guiding=0))
