# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from pictures: a world and a mesh whose radiance programs make, in scenes whose answer is known on paper."""

import numpy as np
import pytest

from engine_core.integrator.tiles import Render
from engine_core.scene.builder import SceneBuilder, look_at, perspective_screen
from engine_core.scene.materials import Diffuse, Emission
from engine_core.settings import IntegratorKind, Settings
from engine_core.shader.graph import Image, node, part
from engine_core.shader.opcodes import InputVector, Interpolation, Op

CLOSEST = int(Interpolation.Closest)
ALBEDO = 0.5


def mean_of(builder, integrator=IntegratorKind.PATH, samples=64, size=16):
    settings = Settings(
        width=size, height=size, crop_width=size, crop_height=size, samples=samples, integrator=int(integrator)
    )
    render = Render(builder.build(), settings, threads=1)
    render.run()
    return render.image("Combined")[..., :3].mean(axis=(0, 1))


def plane(b, half, z, surface, name, front_up=True):
    corners = [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)]
    triangles = [(0, 1, 2), (0, 2, 3)] if front_up else [(0, 2, 1), (0, 3, 2)]
    uvs = np.array([[(corners[i][0] / half / 2 + 0.5, corners[i][1] / half / 2 + 0.5) for i in t] for t in triangles])
    b.instance(b.mesh(name, corners, triangles, uvs=uvs), materials=[b.material(name, surface)])


def sky(rows):
    """The radiance of a lat-long picture of these rows, from below to above, each of one colour."""
    pixels = np.ones((len(rows), 4, 4), np.float32)
    pixels[..., :3] = np.array(rows, np.float32)[:, None]
    direction = node(Op.INPUT_VECTOR, mode=InputVector.POSITION)
    return part(node(Op.ENVIRONMENT, direction, mode=CLOSEST, data=Image("sky", pixels)), 0, 3)


@pytest.mark.parametrize("rows", [[(1, 1, 1), (1, 1, 1)], [(9, 9, 9), (1, 2, 3)], [(0, 0, 0), (4, 4, 4)]])
def test_a_plane_under_a_picture_of_the_sky_gets_its_upper_half(rows):
    """Irradiance under radiance L from the upper half is pi L, whatever is below: the plane shines with albedo L."""
    b = SceneBuilder()
    plane(b, 1000.0, 0.0, Diffuse((ALBEDO,) * 3), "Ground")
    b.background(sky(rows))
    b.camera(look_at((0, -1, 3), (0, 0, 0)), perspective_screen(40))
    np.testing.assert_allclose(mean_of(b), ALBEDO * np.array(rows[1]), rtol=0.02)


def test_a_small_sun_in_a_picture_is_found_by_its_map():
    """One bright cell in a picture of 64 x 32: irradiance is radiance x solid angle x cosine, with little noise."""
    pixels = np.zeros((32, 64, 4), np.float32)
    pixels[24, 10, :3] = 1000.0
    direction = node(Op.INPUT_VECTOR, mode=InputVector.POSITION)
    b = SceneBuilder()
    plane(b, 1000.0, 0.0, Diffuse((ALBEDO,) * 3), "Ground")
    b.background(part(node(Op.ENVIRONMENT, direction, mode=CLOSEST, data=Image("sun", pixels)), 0, 3))
    b.camera(look_at((0, -1, 3), (0, 0, 0)), perspective_screen(40))
    low, high = np.pi * (24 / 32 - 0.5), np.pi * (25 / 32 - 0.5)
    irradiance = 1000.0 * (2.0 * np.pi / 64) * (np.sin(high) ** 2 - np.sin(low) ** 2) / 2.0
    np.testing.assert_allclose(mean_of(b, samples=16), ALBEDO * irradiance / np.pi, rtol=0.02)


def test_a_picture_that_shines_lights_the_same_by_sampling_and_by_chance():
    """A lamp of 2 x 2 different cells above a plane: next-event estimation against brute force."""

    def scene():
        pixels = np.zeros((2, 2, 4), np.float32)
        pixels[..., :3] = [[(8, 0, 0), (0, 4, 0)], [(0, 0, 2), (0, 0, 0)]]
        uv = node(Op.INPUT_VECTOR, mode=InputVector.UV)
        picture = part(node(Op.IMAGE, uv, 0.0, mode=CLOSEST, data=Image("lamp", pixels)), 0, 3)
        b = SceneBuilder()
        plane(b, 4.0, 0.0, Diffuse((ALBEDO,) * 3), "Ground")
        plane(b, 1.5, 2.0, Emission(picture), "Lamp", front_up=False)
        b.camera(look_at((0, -6, 1.5), (0, 0, 0.3)), perspective_screen(50))
        return b

    sampled, by_chance = mean_of(scene(), samples=512), mean_of(scene(), IntegratorKind.BRUTE_FORCE, samples=512)
    np.testing.assert_allclose(sampled, by_chance, rtol=0.04)


def test_a_bright_spot_in_a_picture_is_found_by_its_parts():
    """One bright pixel of 64: all integrators see the same, and the path tracer with little noise."""
    pixels = np.full((8, 8, 4), 0.05, np.float32)
    pixels[2, 5, :3] = (60, 40, 20)
    uv = node(Op.INPUT_VECTOR, mode=InputVector.UV)
    picture = part(node(Op.IMAGE, uv, 0.0, mode=CLOSEST, data=Image("lamp", pixels)), 0, 3)
    b = SceneBuilder()
    plane(b, 4.0, 0.0, Diffuse((ALBEDO,) * 3), "Ground")
    plane(b, 1.5, 1.0, Emission(picture), "Lamp", front_up=False)
    b.camera(look_at((0, -3, 0.9), (0, 0, 0)), perspective_screen(30))
    scene = b.build()

    def blocks(kind, samples):
        options = {"width": 24, "height": 24, "crop_width": 24, "crop_height": 24, "clamp_indirect": 0.0}
        runs = []
        for seed in range(8):
            render = Render(scene, Settings(samples=samples, integrator=int(kind), seed=seed, **options), threads=1)
            render.run()
            runs.append(render.image("Combined")[..., :3].reshape(2, 12, 2, 12, 3).mean(axis=(1, 3)))
        runs = np.array(runs, np.float64)
        return runs.mean(axis=0), runs.std(axis=0, ddof=1) / np.sqrt(len(runs))

    path, path_error = blocks(IntegratorKind.PATH, 32)
    assert path_error.max() < 0.01 * path.mean()
    for kind, samples in ((IntegratorKind.MIXTURE, 64), (IntegratorKind.BRUTE_FORCE, 512)):
        other, error = blocks(kind, samples)
        assert (np.abs(path - other) < 5.0 * np.hypot(path_error, error)).all(), kind
        assert error.max() < 0.1 * other.mean()
