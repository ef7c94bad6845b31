# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that their materials move."""

import numpy as np
import pytest

from blender_tests.helpers.scenes import CUBE_CORNERS, CUBE_TRIANGLES, builder
from engine_core.scene.materials import Diffuse
from engine_core.shader import graph
from engine_core.shader.opcodes import InputVector, Math, Op

NORMAL = graph.node(Op.INPUT_VECTOR, mode=InputVector.NORMAL)
GENERATED = graph.node(Op.INPUT_VECTOR, mode=InputVector.GENERATED)
SPHERE_NORMALS = (CUBE_CORNERS / np.sqrt(3.0))[CUBE_TRIANGLES].astype(np.float32)


def triangles(b):
    """Rows of TRIANGLE of what is built, as the mesh has them."""
    return b.build().triangles


def test_smooth_vertices_move_along_their_normals_and_stay_together():
    """A cube whose corners have the normals of a ball grows; faces moved apart would tear it."""
    b = builder()
    grows = b.material("grows", Diffuse(), displacement=graph.scaled(NORMAL, 0.5))
    b.instance(b.mesh("cube", CUBE_CORNERS, CUBE_TRIANGLES, normals=SPHERE_NORMALS), materials=[grows])
    p = triangles(b)["p"]
    scale = 1.0 + 0.5 / np.sqrt(3.0)
    np.testing.assert_allclose(p, CUBE_CORNERS[CUBE_TRIANGLES] * scale, atol=1e-6)


def test_displacement_is_in_the_worlds_space_and_by_coordinates_from_before():
    """Twice as large in the world, the same vector moves the mesh by half of it; an instance that shares it, too."""
    b = builder()
    mesh = b.mesh("cube", CUBE_CORNERS, CUBE_TRIANGLES)
    moves = b.material("moves", Diffuse(), displacement=GENERATED)
    for x in (0.0, 5.0):
        b.instance(mesh, np.array([[2, 0, 0, x], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1.0]]), [moves])
    p = triangles(b)["p"]
    before = CUBE_CORNERS[CUBE_TRIANGLES]
    assert len(p) == 12
    np.testing.assert_allclose(p, before + (before + 1.0) / 4.0, atol=1e-6)


def test_a_builder_can_be_built_twice():
    """What is displaced is a copy."""
    b = builder()
    grows = b.material("grows", Diffuse(), displacement=graph.scaled(NORMAL, 0.5))
    b.instance(b.mesh("cube", CUBE_CORNERS, CUBE_TRIANGLES, normals=SPHERE_NORMALS), materials=[grows])
    np.testing.assert_array_equal(triangles(b)["p"], triangles(b)["p"])


def bent(keeps_normals=False, flat=False):
    """A strip of two squares in the plane z = 0, of which the far edge is lifted by 1: rows of TRIANGLE."""
    corners = np.array([(x, y, 0.0) for x in (0.0, 1.0, 2.0) for y in (0.0, 1.0)], np.float32)
    faces = np.array([(0, 2, 3), (0, 3, 1), (2, 4, 5), (2, 5, 3)], np.int32)
    x = graph.part(graph.node(Op.INPUT_VECTOR, mode=InputVector.POSITION), 0)
    beyond = graph.node(Op.MATH, x, 1.0, 0.0, mode=Math.SUBTRACT)
    lift = graph.node(Op.MATH, beyond, 0.0, 0.0, mode=Math.MAXIMUM)
    b = builder()
    normals = None if flat else np.broadcast_to(np.array((0, 0, 1), np.float32), (4, 3, 3)).copy()
    up = graph.node(Op.COMBINE, 0.0, 0.0, lift)
    bends = b.material("bends", Diffuse(), displacement=up, keeps_normals=keeps_normals)
    b.instance(b.mesh("strip", corners, faces, normals=normals), materials=[bends])
    return triangles(b)


def test_flat_faces_stay_flat():
    rows = bent(flat=True)
    slope = np.array((-1, 0, 1)) / np.sqrt(2.0)
    is_lifted = rows["p"][:, :, 2].max(axis=1) > 0.5
    assert is_lifted.sum() == 2
    unit = rows["n"] / np.linalg.norm(rows["n"], axis=-1, keepdims=True)
    np.testing.assert_allclose(unit[is_lifted], np.broadcast_to(slope, (2, 3, 3)), atol=1e-6)
    np.testing.assert_allclose(unit[~is_lifted], np.broadcast_to((0, 0, 1), (2, 3, 3)), atol=1e-6)


def test_smooth_normals_are_means_of_the_faces_around_a_vertex():
    rows = bent()
    up, slope = np.array((0, 0, 1.0)), np.array((-1, 0, 1)) / np.sqrt(2.0)
    unit = rows["n"] / np.linalg.norm(rows["n"], axis=-1, keepdims=True)
    x = rows["p"][..., 0]
    np.testing.assert_allclose(unit[x == 0.0], np.broadcast_to(up, (3, 3)), atol=1e-6)
    np.testing.assert_allclose(unit[x == 2.0], np.broadcast_to(slope, (3, 3)), atol=1e-6)
    assert ((unit[x == 1.0] @ up) < 0.999).all()
    assert ((unit[x == 1.0] @ slope) < 0.999).all()


def test_normals_stay_where_bumps_have_the_displacement_in_them():
    rows = bent(keeps_normals=True)
    assert rows["p"][:, :, 2].max() == pytest.approx(1.0)
    np.testing.assert_array_equal(rows["n"], np.broadcast_to(np.array((0, 0, 1), np.float32), (4, 3, 3)))
