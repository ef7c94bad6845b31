# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples that count for several pixels: each pixel is still the picture seen through its filter, with less noise."""

import numpy as np
import pytest

from blender_tests.helpers.scenes import builder, plane, quad, settings, sphere
from engine_core.film import sharing
from engine_core.film.filter import REACH, blackman_harris, gaussian
from engine_core.film.passes import image, make_film, pixels
from engine_core.integrator.tiles import SHARING_IS_JUDGED, Render
from engine_core.jit import kernel
from engine_core.linalg.vec3 import Vec3
from engine_core.scene.materials import Diffuse, Emission
from engine_core.settings import FilterKind, Settings

WIDTH, HEIGHT = 6, 5
SHAPES = {FilterKind.BLACKMAN_HARRIS: blackman_harris, FilterKind.GAUSSIAN: gaussian}
CASES = [(FilterKind.BLACKMAN_HARRIS, 1.5), (FilterKind.BLACKMAN_HARRIS, 1.25), (FilterKind.GAUSSIAN, 1.5)]


def light(x, y):
    """What is to be seen at (x, y) of the frame, in pixels: slopes, and an edge that no pixel's border is on."""
    return 1.0 + 0.1 * x * y + np.where(x + 0.3 * y > 3.7, 2.0, 0.0)


@kernel
def _give(film, settings, numbers, u, values):
    for i in range(len(numbers)):
        number = numbers[i]
        area = sharing.area_of(settings, number % settings.crop_width, number // settings.crop_width)
        dx, dy = area.x + u[i, 0] * area.width - 0.5, area.y + u[i, 1] * area.height - 0.5
        L = np.float32(values[i])
        sharing.give(film, settings, number, area, dx, dy, Vec3(L, 2.0 * L, 0.0), np.float32(0.5))
        film.pixels[number].samples += 1


def exposed(case, sides, value):
    """A film with sides[pixel]^2 jittered samples of `value(x, y)` in each pixel, and their Settings."""
    kind, width = case
    asked = Settings(WIDTH, HEIGHT, crop_width=WIDTH, crop_height=HEIGHT, filter_kind=kind, filter_width=width)
    assert sharing.can_share(asked)
    film, random = make_film(WIDTH, HEIGHT, shares_samples=True), np.random.default_rng(3)
    for number, side in enumerate(sides):
        u = (np.indices((side, side)).reshape(2, -1).T + random.random((side * side, 2))) / side
        u = u.astype(np.float32)
        x, y = number % WIDTH, number // WIDTH
        low, high = (x == 0, y == 0), (x == WIDTH - 1, y == HEIGHT - 1)
        place = [
            at - lo + u[:, a] * (1 + lo + hi) for a, (at, lo, hi) in enumerate(zip((x, y), low, high, strict=True))
        ]
        values = np.broadcast_to(value(*place), len(u)).astype(np.float32)
        _give(film, asked.row(), np.full(len(u), number), u, values)
    return film


def through_filter(case):
    """(height, width): `light` as each pixel's filter sees it, by quadrature."""
    kind, width = case
    fine = 64
    t = (np.arange(3 * fine) + 0.5) / fine - 1.5
    w = np.where(np.abs(t) < REACH[kind] * width, SHAPES[kind](np.minimum(np.abs(t) / (REACH[kind] * width), 1.0)), 0.0)
    w /= w.sum()
    picture = np.empty((HEIGHT, WIDTH))
    for y, x in np.ndindex(HEIGHT, WIDTH):
        picture[y, x] = w @ light(x + 0.5 + t[None, :], y + 0.5 + t[:, None]) @ w
    return picture


@pytest.mark.parametrize("case", CASES)
def test_pixels_show_the_picture_through_their_filter(case):
    """Those at the border, too, and whatever numbers of samples their neighbours have."""
    sides = np.random.default_rng(5).choice([48, 96], WIDTH * HEIGHT)
    picture = image(exposed(case, sides, light), "Combined")
    np.testing.assert_allclose(picture[..., 0], through_filter(case), atol=0.02)
    np.testing.assert_allclose(picture[..., 1], 2.0 * picture[..., 0], rtol=1e-5)
    np.testing.assert_allclose(picture[..., 3], 0.5, rtol=1e-5)


@pytest.mark.parametrize("case", CASES)
def test_flat_pictures_are_flat(case):
    """Even by a single sample; pixels without any take what their neighbours give."""
    sides = np.random.default_rng(6).choice([0, 1, 2], WIDTH * HEIGHT)
    picture = image(exposed(case, sides, lambda x, y: 3.0), "Combined")
    np.testing.assert_allclose(picture[..., 0], 3.0, rtol=1e-5)


def test_tiles_are_parts_of_the_picture():
    film = exposed(CASES[0], np.full(WIDTH * HEIGHT, 3), light)
    tile = image(film, "Combined", (2, 1, 3, 4))
    np.testing.assert_array_equal(tile, image(film, "Combined")[1:5, 2:5])


def test_a_film_without_samples_is_black():
    assert not image(make_film(WIDTH, HEIGHT, shares_samples=True), "Combined").any()


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, True),
        ({"filter_width": 1.6}, False),
        ({"filter_width": 1.0}, False),
        ({"filter_kind": FilterKind.BOX}, False),
        ({"filter_kind": FilterKind.GAUSSIAN}, True),
        ({"crop_width": 2}, False),
    ],
)
def test_filters_that_allow_it(changes, expected):
    assert sharing.can_share(Settings()._replace(**changes)) == expected


# ---- Whole pictures --------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def scene():
    b = builder(eye=(0, -4, 2), target=(0, 0, 0.3))
    plane(b, Diffuse((0.7, 0.6, 0.5)), half=4, z=-1)
    sphere(b, Diffuse((0.3, 0.6, 0.7)))
    sphere(b, Emission((20, 20, 20)), centre=(2, -1, 3), radius=0.5)
    b.background((0.4, 0.5, 0.6))
    return b.build()


def rendered(scene, **changes):
    render = Render(scene, settings(32, max_bounces=3, **{"share_samples": 1, **changes}))
    render.run()
    return render


@pytest.mark.parametrize("adaptive", [0, 1])
def test_samples_that_count_for_several_pixels_leave_half_the_error(scene, adaptive):
    """And the same picture."""
    references = [
        rendered(scene, samples=4096, adaptive=0, seed=9, share_samples=share).image("Combined")[..., :3]
        for share in (0, 1)
    ]
    np.testing.assert_allclose(references[1], references[0], rtol=0.03, atol=0.01)
    reference = np.mean(references, axis=0)
    errors = [
        np.mean(
            [
                (rendered(scene, samples=32, seed=seed, **kind).image("Combined")[..., :3] - reference) ** 2
                for seed in range(4)
            ]
        )
        for kind in ({"adaptive": adaptive, "share_samples": share} for share in (0, 1))
    ]
    assert errors[1] < 0.6 * errors[0]


def test_samples_beyond_the_border_count(scene):
    """A part of the frame is the same as in the whole."""
    whole = rendered(scene, samples=1024, adaptive=0).image("Combined")[8:24, 4:28, :3]
    part = Render(scene, settings(32, max_bounces=3, samples=1024, adaptive=0, share_samples=1)._replace(
        crop_x=4, crop_y=8, crop_width=24, crop_height=16))  # fmt: skip
    part.run()
    np.testing.assert_allclose(part.image("Combined")[..., :3], whole, rtol=0.05, atol=0.01)


def test_pixels_keep_their_own_samples(scene):
    """The means that tell noise are those of a pixel's own samples."""
    render = rendered(scene, samples=16)
    own = pixels(render.film)["radiance"] / 16.0
    assert own.mean() == pytest.approx(render.image("Combined")[..., :3].mean(), rel=0.01)


def floor_below_a_lamp():
    b = builder(eye=(0, -3, 3), target=(0, 0, 0))
    plane(b, Diffuse((0.8, 0.8, 0.8)), half=30.0)
    quad(b, Emission((20, 20, 20)), np.diag([1.0, -1.0, -1.0, 1.0]) + np.outer([0, 0, 4, 0], [0, 0, 0, 1]))
    return b.build()


def test_where_light_is_even_samples_count_for_one_pixel_each():
    """Well spread samples leave next to no noise there, which is lost where the filter's weights vary with them, too.

    After eight samples the picture is begun anew.
    """
    scene = floor_below_a_lamp()
    shared, apart = (rendered(scene, samples=64, share_samples=share) for share in (1, 0))
    assert shared.settings.share_samples == 0
    np.testing.assert_array_equal(shared.image("Combined"), apart.image("Combined"))
    assert (shared.samples_done, shared.progress) == (64, 1.0)
    assert shared.error_estimate == apart.error_estimate
    few = rendered(scene, samples=8)
    assert few.settings.share_samples == 1


class Watched(Render):
    """Keeps what is shown after each pass."""

    def _next_pass(self):
        super()._next_pass()
        self.shown = [*getattr(self, "shown", []), self.image("Combined")]


def test_what_is_begun_anew_shows_the_earlier_picture_until_there_is_one_as_good():
    """Passes end at 1, 2, 4 and 8 samples, and at the same again."""
    shared, apart = (
        Watched(floor_below_a_lamp(), settings(32, max_bounces=3, samples=64, share_samples=share), threads=1)
        for share in (1, 0)
    )
    shared.run()
    apart.run()
    earlier = shared.shown[3]
    assert (earlier != shared.shown[2]).any()
    assert (earlier != apart.shown[3]).any()
    for samples in range(3):
        np.testing.assert_array_equal(shared.shown[4 + samples], earlier)
    for later in range(3, len(apart.shown)):
        np.testing.assert_array_equal(shared.shown[4 + later], apart.shown[later])


def test_what_is_cancelled_while_it_begins_anew_ends():
    """By a user who presses Esc in that very moment."""

    class Cancelled(Render):
        def _expected_end(self):
            if self._done == SHARING_IS_JUDGED:
                self.cancel()
            return super()._expected_end()

    render = Cancelled(floor_below_a_lamp(), settings(32, max_bounces=3, samples=64, share_samples=1))
    render.run()
    assert render.settings.share_samples == 0
    assert render.is_cancelled
    assert render.samples_done == 0
    assert (render.image("Combined")[..., 3] == 1.0).all()


def test_where_light_is_noisy_samples_are_shared_to_the_end(scene):
    assert rendered(scene, samples=64).settings.share_samples == 1
