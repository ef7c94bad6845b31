# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames, transforms and ray origins: the geometry that everything else stands on."""

import numpy as np
import pytest

from engine_core.jit import kernel
from engine_core.linalg.frame import frame_from_normal, from_local, to_local
from engine_core.linalg.ray import offset_ray_origin
from engine_core.linalg.records import Tables
from engine_core.linalg.transform import transform_normal, transform_point, transform_vector
from engine_core.linalg.vec3 import Vec3
from engine_core.tables import INSTANCE

RANDOM = np.random.default_rng(3)
AXES = [tuple(sign * row) for row in np.eye(3) for sign in (1.0, -1.0)]
NEAR_POLES = [(1e-4, 0.0, -1.0), (0.0, -1e-4, -1.0), (1e-7, 1e-7, -1.0), (1.0, 0.0, -1e-9), (0.6, 0.8, -0.0)]
RANDOM_UNIT = [tuple(v / np.linalg.norm(v)) for v in RANDOM.normal(size=(50, 3))]


def array(v):
    return np.array([*v], np.float64)


def unit(v):
    return Vec3(*(np.asarray(v, np.float64) / np.linalg.norm(v)))


@pytest.mark.parametrize("n", AXES + NEAR_POLES + RANDOM_UNIT)
def test_frame_is_orthonormal_and_right_handed(n):
    n = unit(n)
    s, t = frame_from_normal(n)
    m = np.array([array(s), array(t), array(n)])
    np.testing.assert_allclose(m @ m.T, np.eye(3), atol=3e-7)
    assert np.linalg.det(m) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("n", AXES + RANDOM_UNIT[:10])
def test_local_and_world_are_inverse(n):
    n = unit(n)
    s, t = frame_from_normal(n)
    w = Vec3(0.3, -2.0, 0.7)
    np.testing.assert_allclose(array(from_local(s, t, n, to_local(s, t, n, w))), array(w), atol=1e-6)
    np.testing.assert_allclose(array(to_local(s, t, n, n)), [0, 0, 1], atol=3e-7)


# ---- Transforms ------------------------------------------------------------------------------------------------------


class Placed(Tables):
    instances = INSTANCE


@kernel
def through(placed, p, w, n):
    row = placed.instances[0]
    return (
        transform_point(row, "to_world", p),
        transform_vector(row, "to_world", w),
        transform_normal(row, "to_object", n),
        transform_point(row, "to_object", transform_point(row, "to_world", p)),
    )


@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_transforms_are_the_products_with_the_matrix(mirror):
    linear = RANDOM.normal(size=(3, 3)) + 2 * np.eye(3)
    linear[:, 0] *= mirror * np.sign(np.linalg.det(linear))
    row = np.zeros(1, INSTANCE)
    row["to_world"] = np.hstack([linear, [[3.0], [-1.0], [0.5]]])
    row["to_object"] = np.linalg.inv(np.vstack([row["to_world"][0], [0, 0, 0, 1]]))[:3]
    p, w, n = (RANDOM.normal(size=3).astype(np.float32) for _ in range(3))
    point, vector, normal, back = through(Placed(instances=row), Vec3(*p), Vec3(*w), Vec3(*n))
    np.testing.assert_allclose(array(point), linear @ p + [3.0, -1.0, 0.5], rtol=1e-5)
    np.testing.assert_allclose(array(vector), linear @ w, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(array(normal), np.linalg.inv(linear).T @ n, rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(array(back), p, atol=1e-5)


def test_a_normal_stays_perpendicular_to_its_surface():
    row = np.zeros(1, INSTANCE)
    row["to_world"] = [[2, 0.5, 0, 1], [0, 0.3, -0.2, 2], [0.1, 0, -1.5, 3]]
    row["to_object"] = np.linalg.inv(np.vstack([row["to_world"][0], [0, 0, 0, 1]]))[:3]
    n = np.array([0.3, -0.5, 0.8])
    for tangent in np.linalg.svd(n[None])[2][1:]:
        _, moved, normal, _ = through(Placed(instances=row), Vec3(0, 0, 0), Vec3(*tangent), Vec3(*n))
        assert abs(array(moved) @ array(normal)) < 1e-6


# ---- Leaving a surface -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [0.0, 1e-3, 1.0, 1e3, 1e6])
def test_offset_leaves_the_surface_by_a_little(size):
    """To the side of the normal, by more than the point's rounding, by less than anyone could see."""
    for p, n in zip(RANDOM.normal(size=(100, 3)) * size, RANDOM_UNIT + RANDOM_UNIT, strict=True):
        p, n = Vec3(*p), Vec3(*n)
        step = array(offset_ray_origin(p, n)) - array(p)
        rounding = np.spacing(np.float32(np.abs(array(p)).max()))
        along = step @ array(n)
        assert along > 4 * rounding
        assert 1e-6 < np.linalg.norm(step) < 1e-4 * max(1.0, size * 5)


def test_offset_goes_to_the_side_of_the_normal_in_every_component():
    for p in RANDOM.normal(size=(100, 3)) * 10.0 ** RANDOM.integers(-4, 5, (100, 1)):
        for n in RANDOM_UNIT[:10]:
            step = array(offset_ray_origin(Vec3(*p), Vec3(*n))) - array(Vec3(*p))
            assert (step * np.array(n) >= 0.0).all()
