# SPDX-License-Identifier: GPL-3.0-or-later
"""Render: the same picture whoever renders it, in whatever order; and it stops when told."""

import time

import numpy as np
import pytest

from blender_tests.helpers.scenes import builder, cube, picture, plane, settings, sphere
from engine_core.integrator.tiles import RENDER_TILE, RENDER_TILE_IN_MEDIA, TILE_SIZE, Render, make_tiles
from engine_core.scene.materials import Diffuse, Emission, Glass
from engine_core.settings import UNIFORM_SAMPLES, IntegratorKind


@pytest.fixture(scope="module")
def room():
    b = builder(eye=(0, -4, 2), target=(0, 0, 0))
    plane(b, Diffuse((0.5, 0.6, 0.7)), half=3, z=-1)
    sphere(b, Glass(roughness=0.1))
    cube(b, Diffuse((0.8, 0.2, 0.2)), np.diag([0.3, 0.3, 0.3, 1.0]))
    b.background((0.4, 0.5, 0.6))
    b.point_light("Lamp", (2, -2, 3), (300, 300, 300), radius=0.2)
    return b


@pytest.mark.parametrize("adaptive", [0, 1])
def test_threads_do_not_change_the_picture(room, adaptive):
    changes = {"size": 100, "samples": 20, "adaptive": adaptive, "share_samples": 1}
    pictures = [picture(room, threads, **changes) for threads in (1, 2, 7)]
    assert pictures[0].std() > 0.01
    np.testing.assert_array_equal(pictures[0], pictures[1])
    np.testing.assert_array_equal(pictures[0], pictures[2])


@pytest.mark.parametrize("share", [0, 1])
def test_a_crop_is_a_part_of_the_whole(room, share):
    """Where pixels share samples, those at its border and next to it have other ones."""
    whole = picture(room, size=100, samples=4, share_samples=share)
    part = picture(room, size=100, samples=4, share_samples=share, crop_x=30, crop_y=10, crop_width=50, crop_height=77)
    inner = slice(2 * share, -2 * share or None)
    np.testing.assert_array_equal(part[inner, inner], whole[10:87, 30:80][inner, inner])


def test_seeds_give_other_noise(room):
    """Light of the lamp through the glass is rare and bright: a mean of 4 samples is off by 3 %, of 256 by 0.2 %."""
    a, b = (picture(room, size=32, samples=256, seed=seed) for seed in (0, 1))
    assert (a != b)[..., :3].mean() > 0.5
    assert a.mean() == pytest.approx(b.mean(), rel=0.05)


@pytest.mark.parametrize("seed", [-1, 2**31, 2**40 + 5])
def test_a_seed_may_be_any_integer(room, seed):
    np.testing.assert_array_equal(
        picture(room, size=16, samples=2, seed=seed), picture(room, size=16, samples=2, seed=seed % 2**32)
    )


def test_cancel_stops_within_a_row_and_keeps_what_is_there(room):
    render = Render(room.build(), settings(256, samples=100_000))
    render.start()
    while not render.finished_tiles(timeout_s=60.0):
        pass
    render.cancel()
    render.wait()
    assert not render.is_running
    assert render.progress < 0.5
    assert np.isfinite(render.image("Combined")).all()
    assert render.film.pixels["samples"].sum() > 0


def test_time_limit_finishes_the_first_pass(room):
    render = Render(room.build(), settings(128, samples=1_000_000), time_limit=0.01)
    render.run()
    assert render.samples_done >= 1
    assert render.film.pixels["samples"].min() >= 1
    assert render.film.pixels["samples"].max() < 1_000_000


def test_an_error_in_a_thread_reaches_the_caller(room, monkeypatch):
    def fails(*arguments):
        raise RuntimeError("planted")

    monkeypatch.setitem(RENDER_TILE, IntegratorKind.PATH, fails)
    render = Render(room.build(), settings(32), threads=2)
    render.start()
    with pytest.raises(RuntimeError, match="planted"):
        render.wait()


def test_every_integrator_knows_scenes_with_and_without_media():
    assert set(RENDER_TILE) == set(RENDER_TILE_IN_MEDIA) == set(IntegratorKind)


def test_tiles_are_told_once_each_pass(room):
    render = Render(room.build(), settings(130, samples=2))
    render.start()
    told = []
    while render.is_running:
        told += render.finished_tiles(timeout_s=0.1)
        time.sleep(0.01)
    told += render.finished_tiles(timeout_s=0.0)
    assert set(told) == set(render.tiles)
    assert render.samples_done == 2
    assert render.progress == 1.0


@pytest.mark.parametrize(("width", "height"), [(1, 1), (64, 64), (65, 63), (1000, 3)])
def test_tiles_cover_each_pixel_once(width, height):
    seen = np.zeros((height, width), int)
    for x, y, w, h in make_tiles(width, height):
        assert max(w, h) <= TILE_SIZE
        seen[y : y + h, x : x + w] += 1
    assert (seen == 1).all()


@pytest.mark.parametrize("adaptive", [0, 1])
@pytest.mark.parametrize("samples", [1, 2, 3, 17, 100])
def test_samples_add_up(room, samples, adaptive):
    render = Render(room.build(), settings(40, samples=samples, adaptive=adaptive))
    render.run()
    given = render.film.pixels["samples"]
    assert render.samples_done == samples
    assert render.progress == 1.0
    assert 0.98 * samples < given.mean() <= samples
    if samples <= UNIFORM_SAMPLES or not adaptive:
        assert (given == samples).all()
    else:
        assert given.min() > samples / 4


@pytest.mark.parametrize("adaptive", [0, 1])
def test_noise_target_ends_a_render(room, adaptive):
    """As soon as its own estimate says so, and no sooner."""
    render = Render(room.build(), settings(48, samples=100_000, noise_target=0.1, adaptive=adaptive))
    render.run()
    assert 0.03 < render.error_estimate <= 0.1
    assert UNIFORM_SAMPLES < render.samples_done < 10_000


def test_error_is_known_after_a_time_limit(room):
    picture(room, size=8, samples=1)  # compiling the kernels shall not use the time up
    render = Render(room.build(), settings(32, samples=1_000_000), time_limit=0.5)
    render.run()
    assert render.error_estimate > 0.0


@pytest.mark.parametrize("adaptive", [0, 1])
@pytest.mark.parametrize("samples", [8, 64, 256])
def test_error_estimate_is_right(box_reference, samples, adaptive):
    """Within a fifth, against a reference of many more samples."""
    scene, reference = box_reference
    ratios = []
    for seed in (1, 2, 3):
        render = Render(
            scene, settings(48, samples=samples, seed=seed, adaptive=adaptive, max_bounces=4, share_samples=1)
        )
        render.run()
        x = render.image("Combined")[..., :3].mean(axis=-1)
        true = np.sqrt(np.mean((x - reference) ** 2 / (reference**2 + 0.01)))
        ratios.append(render.error_estimate / true)
    assert 0.8 < np.mean(ratios) < 1.2


@pytest.fixture(scope="module")
def box_reference():
    b = builder(eye=(0, -0.9, 0.3), target=(0, 0, -0.3), field_of_view=70)
    cube(b, Diffuse((0.7, 0.7, 0.7)))
    b.point_light("Lamp", (0.3, 0.2, 0.6), (30, 30, 30), radius=0.2)
    scene = b.build()
    reference = Render(scene, settings(48, samples=3000, seed=77, max_bounces=4))
    reference.run()
    return scene, reference.image("Combined")[..., :3].mean(axis=-1)


def test_adaptive_and_uniform_pictures_agree():
    """Light through a glass ball: a few samples bring nearly all of it. Mean over seeds, of the whole picture."""
    b = builder(eye=(0, -4, 2), target=(0, 0, -0.5))
    plane(b, Diffuse((0.6, 0.6, 0.6)), half=3, z=-1)
    sphere(b, Glass())
    sphere(b, Emission((60, 60, 60)), centre=(2, 1, 3), radius=0.3)
    scene = b.build()

    def means(count, **changes):
        values = []
        for seed in range(count):
            render = Render(scene, settings(32, seed=seed, share_samples=1, **changes))
            render.run()
            values.append(render.image("Combined")[..., :3].mean(dtype=float))
        return np.mean(values), np.std(values) / np.sqrt(count)

    (adaptive, error), (uniform, other) = means(120, samples=64, adaptive=1), means(6, samples=1024, adaptive=0)
    assert np.hypot(error, other) < 0.006 * uniform
    assert abs(adaptive - uniform) < 3.5 * np.hypot(error, other)
