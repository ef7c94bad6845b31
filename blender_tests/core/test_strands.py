# SPDX-License-Identifier: GPL-3.0-or-later
"""Hairs: smooth curves of pieces that fit together, hit from outside, and gone through by what has entered them."""

import numpy as np
import pytest

from engine_core.jit import kernel
from engine_core.linalg.ray import offset_ray_origin
from engine_core.linalg.records import Tables
from engine_core.linalg.vec3 import load3
from engine_core.scene.checks import SceneError
from engine_core.scene.strands import strands
from engine_core.shape import dispatch
from engine_core.tables import SHAPE

RANDOM = np.random.default_rng(5)
RAY = np.dtype(
    [("o", "f4", (3,)), ("d", "f4", (3,)), ("t", "f4"), ("p", "f4", (3,)), ("n", "f4", (3,)), ("s", "f4", (3,))]
)


class HairRays(Tables):
    shapes = SHAPE
    rays = RAY


@kernel
def trace_all(tables, pieces, count, from_surface):
    """The nearest hit of each ray among all pieces; rays may begin on a surface."""
    for i in range(count):
        ray = tables.rays[i]
        o, d = load3(ray, "o"), load3(ray, "d")
        if from_surface:
            o = offset_ray_origin(o, load3(ray, "n"))
        ray.t = np.inf
        for k in range(pieces):
            shape = tables.shapes[k]
            hit = dispatch.intersect(shape, o, d, np.float32(0.0), ray.t)
            if hit.t < ray.t:
                ray.t = hit.t
                p = dispatch.snap(shape, o + d * hit.t)
                n, s = dispatch.geometric_normal(shape, o, p), dispatch.tangent(shape, p)
                ray.p[0], ray.p[1], ray.p[2] = p.x, p.y, p.z
                ray.n[0], ray.n[1], ray.n[2] = n.x, n.y, n.z
                ray.s[0], ray.s[1], ray.s[2] = s.x, s.y, s.z


def trace(rows, o, d, n=None):
    rays = np.zeros(len(d), RAY)
    rays["o"], rays["d"] = o, d
    if n is not None:
        rays["n"] = n
    trace_all(HairRays(shapes=rows, rays=rays), len(rows), len(rays), n is not None)
    return rays


def lock(radius=0.02, keys=7):
    """A hair that turns and gets thinner; the points of its axis."""
    t = np.linspace(0.0, 1.0, keys)
    p = np.stack([np.cos(4.0 * t), np.sin(4.0 * t), t], axis=1)
    return strands("Lock", p, radius * (1.2 - t), [keys])


def axis(hair, count):
    """Points on the axis, and how thick the hair is there; not near its open ends."""
    rows = hair.rows[RANDOM.integers(2, len(hair.rows) - 2, count)]
    y = RANDOM.random((count, 1)).astype(np.float32)
    return rows["p"] + y * rows["u"], (rows["radius"] + y[:, 0] * (rows["radius_end"] - rows["radius"]))


def across(d):
    """Random unit vectors at right angles to each of `d`."""
    side = np.cross(d, RANDOM.normal(size=d.shape))
    return side / np.linalg.norm(side, axis=1, keepdims=True)


@pytest.mark.parametrize(("radius", "distance"), [(0.02, 3.0), (0.001, 30.0), (0.3, 10.0)])
def test_a_straight_hair_is_a_cylinder(radius, distance):
    """Rays that pass its axis at less than the radius hit it, where the quadratic equation says; others miss."""
    hair = strands("Straight", [(0, 0, -1), (0, 0, 0), (0, 0, 1)], [radius] * 3, [3])
    target = np.concatenate(
        [radius * RANDOM.uniform(-1.5, 1.5, (3000, 2)), RANDOM.uniform(-0.9, 0.9, (3000, 1))], axis=1
    )
    d = RANDOM.normal(size=(3000, 3))
    d[:, 2] *= 0.5
    d = np.float32(d / np.linalg.norm(d, axis=1, keepdims=True))
    o = np.float32(target - distance * d)
    rays = trace(hair.rows, o, d)
    o, d = o.astype(float), d.astype(float)
    a, b = (d[:, :2] ** 2).sum(axis=1), (o[:, :2] * d[:, :2]).sum(axis=1)
    miss = np.abs(o[:, 0] * d[:, 1] - o[:, 1] * d[:, 0]) / np.sqrt(a)
    near = (-b - np.sqrt(np.maximum(b * b - a * ((o[:, :2] ** 2).sum(axis=1) - radius**2), 0.0))) / a
    z = o[:, 2] + near * d[:, 2]
    clear = (np.abs(miss / radius - 1.0) > 0.01) & (np.abs(np.abs(z) - 1.0) > 1e-3) & (a > 0.01)
    expected = (miss < radius) & (np.abs(z) < 1.0)
    assert 0.2 < expected[clear].mean() < 0.9
    np.testing.assert_array_equal(np.isfinite(rays["t"])[clear], expected[clear])
    hit = clear & expected
    np.testing.assert_allclose(rays["t"][hit], near[hit], atol=0.02 * radius + 2e-6 * distance)
    np.testing.assert_allclose(np.linalg.norm(rays["p"][hit, :2], axis=1), radius, rtol=1e-3)
    np.testing.assert_allclose(rays["s"][hit], [(0, 0, 1)] * hit.sum(), atol=1e-6)
    assert ((rays["n"] * d).sum(axis=1)[hit] < 0.0).all()


def test_pieces_of_a_hair_leave_no_gap():
    """Whoever looks at its axis sees it, at the joints of its pieces, too."""
    hair = lock()
    assert len(hair.rows) > 12
    points, radius = axis(hair, 20_000)
    d = np.float32(RANDOM.normal(size=points.shape))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    inner = points + (0.8 * radius * RANDOM.random(len(radius)))[:, None] * across(d)
    rays = trace(hair.rows, np.float32(inner - 5.0 * d), d)
    assert np.isfinite(rays["t"]).mean() > 0.9995


def test_a_ray_that_enters_a_hair_does_not_hit_it_and_one_that_leaves_neither():
    hair = lock(0.02)
    points, _ = axis(hair, 5000)
    d = np.float32(RANDOM.normal(size=points.shape))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    rays = trace(hair.rows, np.float32(points - 0.2 * d), d)
    rays = rays[np.isfinite(rays["t"]) & (np.abs((rays["d"] * rays["s"]).sum(axis=1)) < 0.7)]
    assert len(rays) > 2000
    through = trace(hair.rows, rays["p"], rays["d"], -rays["n"])
    assert (through["t"] < 0.1).mean() < 1e-3
    out = across(rays["s"]) * 0.5 + rays["n"]
    outwards = np.float32(out / np.linalg.norm(out, axis=1, keepdims=True))
    outwards[(outwards * rays["n"]).sum(axis=1) <= 0.05] = [0, 0, 0]
    leaves = (outwards != 0).any(axis=1)
    assert (trace(hair.rows, rays["p"][leaves], outwards[leaves], rays["n"][leaves])["t"] < 0.1).mean() < 1e-3


def test_bounds_contain_every_hit():
    hair = lock(0.1)
    low, high = dispatch.bounds(hair.rows)
    points, _ = axis(hair, 3000)
    d = np.float32(RANDOM.normal(size=points.shape))
    for row in range(len(hair.rows)):
        p = trace(hair.rows[row : row + 1], np.float32(points - 3.0 * d), d)
        p = p["p"][np.isfinite(p["t"])]
        assert (p >= low[row] - 1e-6).all()
        assert (p <= high[row] + 1e-6).all()


def test_hairs_tell_how_far_along_they_are():
    hair = strands(
        "Two", [(0, 0, 0), (0, 0, 3), (5, 0, 0), (6, 0, 0), (8, 0, 0)], [0.1] * 5, [2, 3], [0.25, 0.5], [(0, 1), (2, 3)]
    )
    told = hair.strands[hair.rows["strand"]]
    second = hair.rows["p"][:, 0] > 4.0
    np.testing.assert_allclose(told["length"][~second], 3.0)
    np.testing.assert_allclose(told["length"][second], 3.0)
    np.testing.assert_allclose(told["random"], np.where(second, 0.5, 0.25))
    np.testing.assert_allclose(told["uv"][second][0], (2, 3))
    assert told["start"][second].min() == 0.0
    assert told["end"][second].max() == pytest.approx(1.0)
    at = told["start"][np.isclose(hair.rows["p"][:, 0], 6.0)]
    np.testing.assert_allclose(at, 1.0 / 3.0, rtol=1e-6)


def test_attributes_vary_along_a_hair():
    """Linearly from key to key, however many pieces there are between two."""
    t = np.linspace(0.0, 1.0, 4)
    keys = np.stack([np.cos(4.0 * t), np.sin(4.0 * t), t], axis=1)
    values = np.array([(1.0, 2.0), (3.0, 5.0), (2.0, 2.0), (4.0, 0.0)])
    hair = strands("Lock", keys, np.full(4, 0.01), [4], attributes={"Heat": values})
    given = hair.attributes["Heat"]
    assert len(given) == len(hair.rows) > 12
    np.testing.assert_allclose(given[1:, 0], given[:-1, 1])  # one after the other
    for number, key in enumerate(keys):
        ends = np.isclose(hair.rows["p"] + hair.rows["u"], key, atol=1e-6).all(axis=1)
        starts = np.isclose(hair.rows["p"], key, atol=1e-6).all(axis=1)
        assert ends.sum() == (number > 0)
        assert starts.sum() == (number < 3)
        for found in (given[ends, 1], given[starts, 0]):
            np.testing.assert_allclose(found, np.tile((*values[number], 0.0, 1.0), (len(found), 1)), atol=1e-6)


def test_straight_hairs_bend_at_their_keys_only():
    keys = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0)])
    hair = strands("Bent", keys, [0.1, 0.2, 0.1], [3], is_smooth=False)
    np.testing.assert_allclose(hair.rows["u"], keys[1:] - keys[:-1])
    np.testing.assert_allclose(hair.rows["radius_end"], (0.2, 0.1))
    diagonal = np.sqrt(0.5)
    np.testing.assert_allclose(hair.rows["w"], [(diagonal, diagonal, 0.0), (0.0, 1.0, 0.0)], atol=1e-7)
    np.testing.assert_allclose(hair.rows["v"], [(1.0, 0.0, 0.0), (diagonal, diagonal, 0.0)], atol=1e-7)


def test_a_hair_of_one_key_or_no_length_is_nothing():
    assert len(strands("None", np.zeros((0, 3)), [], []).rows) == 0
    assert len(strands("Dots", [(0, 0, 0), (1, 1, 1), (1, 1, 1)], [1, 1, 1], [1, 2]).rows) == 0
    with pytest.raises(SceneError, match="Hair"):
        strands("Hair", [(0, 0, 0)], [1], [2])
