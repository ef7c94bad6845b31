# SPDX-License-Identifier: GPL-3.0-or-later
"""Textured emitters in parts: a hit finds the very part that sampling would have taken, and bright parts are chosen."""

import numpy as np
import pytest

from blender_tests.helpers.lights import random_numbers
from blender_tests.helpers.scenes import builder
from engine_core.accel.traverse import NO_FACE, intersect_closest
from engine_core.jit import kernel
from engine_core.light import dispatch
from engine_core.light.triangle import row_at
from engine_core.linalg.vec3 import Vec3, load3
from engine_core.scene.emitters import FLOOR, MOST_PARTS
from engine_core.scene.materials import Emission
from engine_core.shader.graph import Image, node, part
from engine_core.shader.opcodes import InputVector, Interpolation, Op
from engine_core.shape.interaction import make_interaction, new_interaction
from engine_core.tables import MAX_PART_LEVEL, Visibility

SQUARE = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32)
HALVES = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
UP = (0.2, -0.3, 3.0)
MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])


def spot(size=2**MAX_PART_LEVEL):
    """A dim picture with one bright pixel, on the edge between both triangles; parts are half as large as pixels."""
    pixels = np.full((size, size, 4), 0.01, np.float32)
    pixels[9, 9, :3] = (20, 10, 5)
    return pixels


def shining(pixels, *placements, grid=1):
    """A square of `grid`^2 quadrilaterals, all with the whole picture, at each of the placements."""
    uv = node(Op.INPUT_VECTOR, mode=InputVector.UV)
    closest = int(Interpolation.Closest)
    picture = part(node(Op.IMAGE, uv, 0.0, mode=closest, data=Image("lamp", pixels)), 0, 3)
    b = builder()
    places = [np.array((2 * i + 1 - grid, 2 * j + 1 - grid, 0)) for i in range(grid) for j in range(grid)]
    cells = [(SQUARE + place) / grid for place in places]
    triangles = np.concatenate([HALVES + 4 * i for i in range(grid * grid)])
    uvs = np.tile((SQUARE[HALVES][..., :2] + 1) / 2, (grid * grid, 1, 1))
    mesh = b.mesh("screen", np.concatenate(cells), triangles, uvs=uvs)
    material = b.material("screen", Emission(picture))
    for to_world in placements or (np.eye(4),):
        b.instance(mesh, to_world, [material])
    return b.build()


@kernel
def _hit_rows(scene, p, rows, u, result):
    """For samples of rows of LIGHT, the row that the ray there finds."""
    origin, it = Vec3(p[0], p[1], p[2]), new_interaction()
    for i in range(len(rows)):
        s = dispatch.sample(scene, scene.lights[rows[i]], origin, u[i, 0], u[i, 1])
        hit = intersect_closest(
            scene, origin, s.wi, np.float32(0.0), np.float32(np.inf), Visibility.ALL.value, np.float32(0.0), NO_FACE
        )
        result[i] = -1
        if hit.prim >= 0:
            make_interaction(scene, it, hit, origin, s.wi, np.float32(0.0))
            result[i] = row_at(scene, it.light, load3(it, "p"))


TWO_SIDES = np.array([[1, 0, 0, 1.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
TURNED = np.array([[0, -0.5, 0, -1.5], [1, 0.2, 0, 0], [0, 0, 1, 0.3], [0, 0, 0, 1.0]])


@pytest.mark.parametrize("placements", [(np.eye(4),), (MIRROR,), (TWO_SIDES, TURNED), (TWO_SIDES, TURNED @ MIRROR)])
def test_a_sampled_point_is_found_in_the_part_it_was_sampled_from(placements):
    """All parts, of what stands in the world and of instances, mirrored as well. Edges may be rounded away."""
    scene = shining(spot(), *placements)
    rows = np.flatnonzero(scene.lights["share"] > 0.0)
    assert len(rows) == len(placements) * 2 * 4**MAX_PART_LEVEL
    many = np.repeat(rows, 8)
    found = np.zeros(len(many), np.int64)
    _hit_rows(scene, np.array(UP, np.float32), many, random_numbers(len(many)), found)
    assert (found == many).mean() > 0.995
    assert (found >= 0).mean() > 0.999


def test_parts_fill_their_triangle_and_keep_its_mean():
    scene = shining(spot())
    whole, parts = scene.lights[:2], scene.lights[2:].reshape(2, -1)
    np.testing.assert_allclose(parts["area"].sum(axis=1), whole["area"], rtol=1e-5)
    centre = parts["p"] + (parts["u"] + parts["v"]) / 3.0
    np.testing.assert_allclose(centre.mean(axis=1), whole["p"] + (whole["u"] + whole["v"]) / 3.0, atol=1e-6)
    np.testing.assert_allclose(np.cross(parts["u"], parts["v"])[..., 2], 2.0 * parts["area"], rtol=1e-5)
    assert not whole["emission"].any()
    assert not whole["share"].any()
    mean = parts["emission"].mean(axis=(0, 1))
    np.testing.assert_allclose(mean, spot()[..., :3].mean(axis=(0, 1)), rtol=0.1)
    assert (parts["emission"].min(axis=1) >= 0.9 * FLOOR * parts["emission"].mean(axis=1)).all()


def test_what_does_not_vary_stays_whole():
    for pixels in (np.ones((4, 4, 4), np.float32), np.zeros((4, 4, 4), np.float32)):
        scene = shining(pixels)
        assert len(scene.lights) == 2
        assert not scene.lights["level"].any()
        assert (scene.lights["share"].sum() > 0.0) == pixels.any()


def test_parts_are_as_fine_as_the_picture():
    """Four pixels a side: parts of a quarter of the side resolve what halves do not."""
    pixels = np.ones((4, 4, 4), np.float32)
    pixels[:2, 2:, :3] = 5.0  # half of the first triangle's square, and nothing of the second
    level = shining(pixels).lights["level"][:2]
    assert 1 <= level.max() <= 2
    assert level.min() == 0


def test_the_number_of_parts_is_bounded():
    grid = 40
    scene = shining(spot(), grid=grid)
    assert 2 * grid * grid < len(scene.lights) <= 2 * grid * grid + MOST_PARTS
