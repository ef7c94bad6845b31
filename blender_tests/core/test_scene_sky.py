# SPDX-License-Identifier: GPL-3.0-or-later
"""A sun in the sky is sampled as a light of its own, and lights what paper says."""

import math

import numpy as np
import pytest

from engine_core.integrator.tiles import Render
from engine_core.light import dispatch
from engine_core.light.background import is_in_disk
from engine_core.linalg.vec3 import Vec3
from engine_core.scene.builder import SceneBuilder, look_at, perspective_screen
from engine_core.scene.materials import Diffuse
from engine_core.settings import Settings
from engine_core.shader import graph
from engine_core.shader.opcodes import InputVector, Op
from engine_core.texture import atmosphere

SIZE, ELEVATION, ALBEDO = 0.02, 0.7, 0.5
RADIANCE = (3e4, 2e4, 1e4)


def sky(level, disk=RADIANCE, size=SIZE):
    """A sky of one grey level with a sun in it."""
    pixels = np.full((4, 8, 4), level, np.float32)
    d = graph.node(Op.INPUT_VECTOR, mode=InputVector.GENERATED)
    numbers = (ELEVATION, 0.3, size, 1.0, -math.pi)
    return graph.node(Op.SKY, d, *numbers, disk, disk, data=graph.Image("sky", pixels))


def scene_under(radiance):
    builder = SceneBuilder()
    floor = builder.mesh("Floor", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2), (0, 2, 3)])
    builder.instance(floor, materials=[builder.material("White", Diffuse((ALBEDO,) * 3))])
    builder.background(radiance)
    builder.camera(look_at((0, -0.001, 4), (0, 0, 0)), perspective_screen(15))
    return builder.build()


def test_the_suns_disk_lights_a_floor_as_bright_as_paper_says_with_hardly_any_noise():
    render = Render(scene_under(sky(0.0)), Settings(width=8, height=8, crop_width=8, crop_height=8, samples=64))
    render.run()
    picture = render.image("Combined")[..., :3].astype(float)

    # over a disk darkened at its limb by 0.6 (1 - cosine) the mean is 0.8 of the centre
    expected = ALBEDO * 0.8 * math.sin(SIZE / 2.0) ** 2 * math.sin(ELEVATION) * np.array(RADIANCE)
    assert picture.mean(axis=(0, 1)) == pytest.approx(expected, rel=0.01)
    assert picture[..., 0].std() < 0.05 * picture[..., 0].mean()


def test_sky_and_sun_add_up_to_what_each_of_them_brings():
    def floor(radiance):
        render = Render(
            scene_under(radiance), Settings(width=8, height=8, crop_width=8, crop_height=8, samples=256, seed=3)
        )
        render.run()
        return render.image("Combined")[..., :3].astype(float).mean(axis=(0, 1))

    alone = floor(sky(0.0))
    assert floor(sky(2.0)) - alone == pytest.approx(ALBEDO * 2.0, rel=0.02)


def test_each_direction_belongs_to_the_sun_or_to_the_sky():
    scene = scene_under(sky(1.0))
    world = scene.world[0]
    rng = np.random.default_rng(5)
    background, disk = scene.lights[world.background_light], scene.lights[world.disk_light]

    for u0, u1 in rng.random((200, 2)).astype(np.float32):
        s = dispatch.sample(scene, disk, Vec3(0, 0, 0), u0, u1)
        assert is_in_disk(scene, s.wi)
        s = dispatch.sample(scene, background, Vec3(0, 0, 0), u0, u1)
        assert s.pdf == 0.0 or not is_in_disk(scene, s.wi)


def test_there_is_no_row_for_a_sky_without_a_sun():
    assert scene_under(sky(1.0, size=-1.0)).world["disk_light"][0] == -1


def test_the_map_of_the_sky_leaves_the_sun_out():
    """Else a few cells of it would take nearly all samples, and light from the rest of the sky would be noise."""
    plain, sunny = scene_under(sky(1.0, size=-1.0)), scene_under(sky(1.0))

    assert sunny.world["background"][0] == pytest.approx(plain.world["background"][0], rel=1e-3)


@pytest.mark.parametrize("multiple", [False, True])
def test_a_sky_is_bluest_overhead_and_brightest_at_the_sun(multiple):
    table = atmosphere.table(0.4, atmosphere.Air(), multiple)[..., :3]
    zenith = table[-1].mean(axis=0)
    row, column = np.unravel_index(table.sum(axis=-1).argmax(), table.shape[:2])

    assert zenith[2] > 1.5 * zenith[0] > 0.0
    elevation = (row / (atmosphere.HEIGHT / 2) - 1.0) ** 2 * math.pi / 2.0
    assert column == pytest.approx(atmosphere.WIDTH / 2, abs=2)
    assert 0.0 < elevation < 0.5


def test_a_higher_sun_is_brighter_and_whiter():
    low, high = (atmosphere.disk(e, 0.01, atmosphere.Air(), True).top for e in (0.05, 1.2))

    assert (high > low).all()
    assert high[2] / high[0] > 2.0 * low[2] / low[0]
