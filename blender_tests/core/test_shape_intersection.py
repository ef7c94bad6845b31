# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes are hit where analysis says, from far and from near, and never by a ray that leaves them."""

import numpy as np
import pytest

from engine_core.jit import kernel
from engine_core.linalg.ray import offset_ray_origin
from engine_core.linalg.records import Tables
from engine_core.linalg.vec3 import Vec3, load3
from engine_core.shape import dispatch, triangle
from engine_core.tables import SHAPE, TRIANGLE, ShapeKind

RANDOM = np.random.default_rng(17)
FAR = np.float32(np.inf)
RAY = np.dtype(
    [
        ("o", "f4", (3,)),
        ("d", "f4", (3,)),
        ("t_min", "f4"),
        ("t_max", "f4"),
        ("t", "f4"),
        ("b", "f4", (2,)),
        ("p", "f4", (3,)),
        ("n", "f4", (3,)),
        ("uv", "f4", (2,)),
    ]
)


class ShapeRays(Tables):
    shapes = SHAPE
    triangles = TRIANGLE
    rays = RAY


@kernel
def intersect_all(tables, count):
    shape = tables.shapes[0]
    for i in range(count):
        ray = tables.rays[i]
        o, d = load3(ray, "o"), load3(ray, "d")
        hit = dispatch.intersect(shape, o, d, ray.t_min, ray.t_max)
        ray.t, ray.b[0], ray.b[1] = hit
        p = dispatch.snap(shape, o + d * hit.t)
        n = dispatch.geometric_normal(shape, o, p)
        ray.p[0], ray.p[1], ray.p[2] = p.x, p.y, p.z
        ray.n[0], ray.n[1], ray.n[2] = n.x, n.y, n.z
        ray.uv[0], ray.uv[1] = dispatch.uv(shape, p)


@kernel
def intersect_triangle_all(tables, count):
    row = tables.triangles[0]
    n = triangle.normal(row, Vec3(0.0, 0.0, 0.0))
    for i in range(count):
        ray = tables.rays[i]
        ray.t, ray.b[0], ray.b[1] = triangle.intersect(row, load3(ray, "o"), load3(ray, "d"), ray.t_min, ray.t_max)
        ray.n[0], ray.n[1], ray.n[2] = n.x, n.y, n.z


def shape(kind, p=(0, 0, 0), u=(1, 0, 0), v=(0, 1, 0), radius=1.0):
    row = np.zeros(1, SHAPE)
    row["kind"], row["p"], row["u"], row["v"], row["radius"] = kind, p, u, v, radius
    return row


def trace(row, o, d, t_min=0.0, t_max=FAR):
    """Rows of RAY for rays on one shape or triangle."""
    count = np.broadcast_shapes(np.shape(o), np.shape(d), (1, 3))[0]
    rays = np.zeros(count, RAY)
    rays["o"], rays["d"], rays["t_min"], rays["t_max"] = o, d, t_min, t_max
    is_shape = row.dtype == SHAPE
    tables = ShapeRays(
        shapes=row if is_shape else np.zeros(0, SHAPE), triangles=np.zeros(0, TRIANGLE) if is_shape else row, rays=rays
    )
    (intersect_all if is_shape else intersect_triangle_all)(tables, count)
    return rays


def directions(count):
    d = RANDOM.normal(size=(count, 3))
    return (d / np.linalg.norm(d, axis=1, keepdims=True)).astype(np.float32)


def dots(a, b):
    return (np.asarray(a, np.float64) * b).sum(axis=-1)


# ---- Spheres ---------------------------------------------------------------------------------------------------------


def sphere_t(centre, radius, o, d):
    """Both roots, in float64."""
    f = np.asarray(o, np.float64) - np.float32(centre)
    a, b, c = dots(d, d), dots(f, d), dots(f, f) - np.float64(np.float32(radius)) ** 2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - a * c)
    return (-b - root) / a, (-b + root) / a


@pytest.mark.parametrize(("distance", "radius"), [(3, 1), (1000, 1), (1e5, 1), (30, 1e-3), (1e4, 3e3)])
def test_sphere_keeps_its_outline_at_any_distance(distance, radius):
    """Rays that pass the centre at less than the radius hit, others miss, but for a rim as wide as rays are rounded."""
    centre = np.array([0.3, -0.2, 0.1])
    offset = RANDOM.uniform(-1.3, 1.3, (2000, 2)) * radius
    target = centre + np.concatenate([offset, np.zeros((2000, 1))], axis=1)
    o = np.float32(centre + distance * np.array([0, 0, 1]))
    d = np.float32(target - o)
    hits = trace(shape(ShapeKind.SPHERE, centre, radius=radius), o, d)
    near, _ = sphere_t(centre, radius, o, d)
    miss = np.linalg.norm(np.cross(o - np.float32(centre), d.astype(np.float64)), axis=1) / np.linalg.norm(d, axis=1)
    clear = np.abs(miss / radius - 1) > max(1e-5, 1e-6 * distance / radius)
    np.testing.assert_array_equal(np.isfinite(hits["t"])[clear], (miss < radius)[clear])
    inside = clear & (miss < 0.99 * radius)
    np.testing.assert_allclose(hits["t"][inside], near[inside], rtol=2e-6 * max(1, distance / radius * 0.01))
    assert 0.3 < inside.mean() < 0.7
    np.testing.assert_allclose(dots(hits["n"], hits["n"])[inside], 1.0, atol=1e-6)
    assert (dots(hits["n"], d)[inside] < 0).all()
    height = np.linalg.norm(hits["p"].astype(np.float64) - np.float32(centre), axis=1)
    np.testing.assert_allclose(height[inside], radius, rtol=1e-6 + 1e-7 / radius)


def test_sphere_from_inside_is_hit_once_in_every_direction():
    d = directions(500) * np.float32(2.5)
    o = (RANDOM.random((500, 3)) - 0.5).astype(np.float32)
    hits = trace(shape(ShapeKind.SPHERE, radius=1.0), o, d)
    np.testing.assert_allclose(hits["t"], sphere_t((0, 0, 0), 1.0, o, d)[1], rtol=1e-5)
    assert (dots(hits["n"], d) > 0).all()


def test_sphere_beyond_t_min_is_its_far_side():
    row = shape(ShapeKind.SPHERE, (0, 0, 5), radius=2.0)
    for t_min, t_max, t in ((0, FAR, 3), (3.5, FAR, 7), (0, 2.9, np.inf), (3.5, 6.9, np.inf), (7.5, FAR, np.inf)):
        assert trace(row, [0, 0, 0], [0, 0, 1], t_min, t_max)["t"][0] == pytest.approx(t)


SPHERES = [((0, 0, 0), 1.0), ((0.1, 2, -3), 0.01), ((0, 0, -1000), 1000.0), ((0, 0, -1e5), 1e5), ((50, 60, 70), 5.0)]


@pytest.mark.parametrize(("centre", "radius"), SPHERES)
def test_a_ray_that_leaves_a_sphere_does_not_hit_it(centre, radius):
    """The ground of many scenes is a sphere with a radius of 1000, touched near the origin."""
    n, d = directions(3000), directions(3000)
    n[:1000] = (0, 0, 1) + 1e-3 * n[:1000]
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    d *= np.sign(dots(n, d))[:, None].astype(np.float32)
    p = (np.float32(centre) + np.float32(radius) * n).astype(np.float32)
    o = np.array([[*offset_ray_origin(Vec3(*a), Vec3(*b))] for a, b in zip(p, n, strict=True)], np.float32)
    grazing = dots(n, d) < 2e-3  # the surface as rounding has it is not that flat
    hits = trace(shape(ShapeKind.SPHERE, centre, radius=radius), o, d)
    assert np.isinf(hits["t"][~grazing]).all()


@pytest.mark.parametrize(("centre", "radius"), SPHERES[:2] + SPHERES[4:])
def test_a_ray_that_enters_a_sphere_comes_to_its_other_side(centre, radius):
    n, d = directions(3000), directions(3000)
    cosine = np.abs(dots(n, d))
    d *= -np.sign(dots(n, d))[:, None].astype(np.float32)
    p = (np.float32(centre) + np.float32(radius) * n).astype(np.float32)
    o = np.array([[*offset_ray_origin(Vec3(*a), Vec3(*-b))] for a, b in zip(p, n, strict=True)], np.float32)
    t = trace(shape(ShapeKind.SPHERE, centre, radius=radius), o, d)["t"]
    deep = cosine > 0.05
    np.testing.assert_allclose(t[deep], sphere_t(centre, radius, o, d)[1][deep], rtol=1e-3)
    assert (t[deep] > radius * cosine[deep]).all()


@pytest.mark.parametrize(
    ("p", "u", "v"),
    [
        ((0, -1, 0), 0.0, 0.5),
        ((1, 0, 0), 0.25, 0.5),
        ((0, 1, 0), 0.5, 0.5),
        ((-1, 0, 0), 0.75, 0.5),
        ((0, 1e-6, 1), 0.5, 1),
    ],
)
def test_sphere_is_mapped_as_blender_maps_it(p, u, v):
    """u = 0.5 - atan2(x, y) / 2 pi, v = 1 - acos(z) / pi."""
    row = shape(ShapeKind.SPHERE, (3, 4, 5), radius=2.0)
    (hit,) = trace(row, np.float32([3, 4, 5]), np.float32(p))
    assert hit["uv"][0] % 1 == pytest.approx(u % 1, abs=1e-5)
    assert hit["uv"][1] == pytest.approx(v, abs=1e-3)


# ---- Flat shapes -----------------------------------------------------------------------------------------------------

SLANTED = {"p": (1.0, 2.0, 3.0), "u": (0.5, 0.2, 0.0), "v": (0.1, -0.3, 0.8)}  # not at right angles


@pytest.mark.parametrize("kind", [ShapeKind.QUAD, ShapeKind.DISK])
def test_flat_shapes_are_hit_within_their_outline(kind):
    c, u, v = (np.float32(SLANTED[k]).astype(np.float64) for k in "puv")
    x, y = RANDOM.uniform(-1.5, 1.5, (2, 2000))
    p = c + x[:, None] * u + y[:, None] * v
    o = c + 3 * directions(2000)
    hits = trace(shape(kind, **SLANTED), o.astype(np.float32), (0.5 * (p - o)).astype(np.float32))
    outline = np.maximum(np.abs(x), np.abs(y)) if kind == ShapeKind.QUAD else np.hypot(x, y)
    steep = np.abs(dots(np.cross(u, v), p - o)) > 0.01
    clear = (np.abs(outline - 1) > 1e-4) & steep
    np.testing.assert_array_equal(np.isfinite(hits["t"])[clear], (outline < 1)[clear])
    inside = clear & (outline < 1)
    assert inside.sum() > 500
    np.testing.assert_allclose(hits["t"][inside], 2.0, rtol=1e-4)
    np.testing.assert_allclose(hits["b"][inside], np.stack([x, y], 1)[inside] / 2 + 0.5, atol=1e-3)
    np.testing.assert_allclose(hits["uv"][inside], np.stack([x, y], 1)[inside] / 2 + 0.5, atol=1e-3)
    np.testing.assert_allclose(hits["p"][inside], p[inside], atol=1e-3)
    normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
    np.testing.assert_allclose(hits["n"][inside], np.broadcast_to(normal, (inside.sum(), 3)), atol=1e-6)


@pytest.mark.parametrize("kind", [ShapeKind.QUAD, ShapeKind.DISK])
def test_flat_shapes_heed_both_ends_of_the_ray_and_the_plane(kind):
    row = shape(kind, (0, 0, 4))
    for t_min, t_max, t in ((0, FAR, 2), (2.5, FAR, np.inf), (0, 1.5, np.inf)):
        assert trace(row, [0.1, 0.2, 0], [0, 0, 2], t_min, t_max)["t"][0] == t
    assert trace(row, [0, 0, 0], [0, 0, -1])["t"][0] == np.inf
    assert trace(row, [-3, 0, 4], [1, 0, 0])["t"][0] == np.inf  # within the plane
    assert trace(row, [-3, 0, 3], [1, 0, 0])["t"][0] == np.inf  # along it


@pytest.mark.parametrize("kind", [ShapeKind.QUAD, ShapeKind.DISK])
def test_a_ray_that_leaves_a_large_slanted_plane_does_not_hit_it(kind):
    """Its centre is far away, and the point near the origin, where the offset is as small as it gets."""
    u, v = np.array([600.0, 100.0, -300.0]), np.array([-50.0, 700.0, 200.0])
    n = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
    x, y = RANDOM.uniform(-0.5, 0.5, (2, 2000))
    centre = -0.4 * u + 0.3 * v
    p = np.float32(centre + (0.4 + 0.01 * x)[:, None] * u + (-0.3 + 0.01 * y)[:, None] * v)
    d = directions(2000)
    d *= np.sign(dots(n, d))[:, None].astype(np.float32)
    o = np.array([[*offset_ray_origin(Vec3(*a), Vec3(*n))] for a in p], np.float32)
    assert np.isinf(trace(shape(kind, centre, u, v), o, d)["t"]).all()


def test_a_facing_disk_turns_to_its_viewer():
    centre, radius = np.array([1.0, -2.0, 0.5]), 0.7
    o = centre + RANDOM.uniform(1, 5, (2000, 1)) * directions(2000)
    axis = (centre - o) / np.linalg.norm(centre - o, axis=1, keepdims=True)
    across = np.cross(axis, directions(2000))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    r = RANDOM.uniform(0, 1.5, 2000) * radius
    d = (centre + r[:, None] * across - o) / 3
    hits = trace(shape(ShapeKind.FACING_DISK, centre, radius=radius), o, d)
    clear = np.abs(r / radius - 1) > 1e-4
    np.testing.assert_array_equal(np.isfinite(hits["t"])[clear], (r < radius)[clear])
    inside = clear & (r < radius)
    np.testing.assert_allclose(hits["t"][inside], 3.0, rtol=1e-5)
    np.testing.assert_allclose(hits["n"][inside], -axis[inside], atol=1e-5)
    near = centre + 0.1 * (o - centre) / np.linalg.norm(o - centre, axis=1, keepdims=True)
    assert np.isinf(trace(shape(ShapeKind.FACING_DISK, centre, radius=radius), near, near - centre)["t"]).all()


# ---- Boxes -----------------------------------------------------------------------------------------------------------

TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
BOXES = [((0.3, -0.2, 0.1), (1.0, 0.5, 2.0)), ((5.0, 60.0, 70.0), (0.01, 3.0, 1.0)), ((0, 0, -500), (500, 500, 500))]


def box(centre, half, axes=TURN):
    return shape(ShapeKind.BOX, centre, half[0] * axes[0], half[1] * axes[1], half[2])


def box_t(centre, half, o, d, axes=TURN):
    """Distances to entering and leaving, in float64; NaN: never."""
    at, along = (np.asarray(o, np.float64) - np.float32(centre)) @ axes.T, np.asarray(d, np.float64) @ axes.T
    first, second = (-np.float64(half) - at) / along, (half - at) / along
    near, far = np.minimum(first, second).max(axis=1), np.maximum(first, second).min(axis=1)
    return np.where(near <= far, [near, far], np.nan)


@pytest.mark.parametrize(("centre", "half"), BOXES)
@pytest.mark.parametrize("where", ["outside", "inside"])
def test_boxes_are_hit_where_their_slabs_say(centre, half, where):
    half, size = np.array(half), max(half)
    spread = 3.0 * size if where == "outside" else 0.99 * half
    at = RANDOM.uniform(-1, 1, (4000, 3)) * spread
    at = at[(np.abs(at) > 1.01 * half).any(axis=1) == (where == "outside")]
    target = RANDOM.uniform(-1.1, 1.1, at.shape) * half
    o = np.float32(np.float32(centre) + at @ TURN)
    d = np.float32((np.float32(centre) + target @ TURN - o) * 0.4)
    hits = trace(box(centre, half), o, d)
    near, far = box_t(centre, half, o, d)
    expected = np.where(near > 0, near, far)
    rough = 1e-6 * (np.abs(centre).max() + size)  # where float32 puts points, against the edges that rays might miss
    aside = [box_t(centre, half * (1 + s * rough / half), o, d)[0] for s in (-1, 1)]
    clear = np.isfinite(aside[0]) == np.isfinite(aside[1])
    clear &= ~(expected < 0)
    np.testing.assert_array_equal(np.isfinite(hits["t"])[clear], np.isfinite(expected)[clear])
    met = clear & np.isfinite(expected)
    assert met.sum() > 500
    error = np.abs(hits["t"] - expected)[met] * np.linalg.norm(d[met], axis=1)
    p = (hits["p"].astype(np.float64) - np.float32(centre)) @ TURN.T
    steep = np.abs(dots(hits["n"], d))[met] / np.linalg.norm(d[met], axis=1) > 0.1
    assert (error[steep] < 30 * rough).all()
    on_face = np.abs(np.abs(p) - half).min(axis=1)
    assert (on_face[met] < 3 * rough).all()
    local_n = hits["n"] @ TURN.T
    axis = np.argmax(np.abs(local_n), axis=1)
    rows = np.arange(len(hits))
    np.testing.assert_allclose(np.abs(local_n[rows, axis]), 1.0, atol=1e-5)
    assert (np.abs(p[rows, axis] - np.sign(local_n[rows, axis]) * half[axis])[met] < 3 * rough).all()
    outwards = dots(hits["n"], d) > 0
    np.testing.assert_array_equal(outwards[met][steep], (near <= 0)[met][steep])


@pytest.mark.parametrize(("centre", "half"), BOXES)
@pytest.mark.parametrize("leaves", [True, False])
def test_a_ray_from_the_surface_of_a_box_does_not_hit_it_there(centre, half, leaves):
    """Outwards it meets nothing, inwards the other side: 256 steps of floats away from the surface, as paths go."""
    half = np.array(half)
    axis, sign = RANDOM.integers(3, size=3000), RANDOM.choice([-1.0, 1.0], 3000)
    at = RANDOM.uniform(-0.999, 0.999, (3000, 3)) * half
    rows = np.arange(3000)
    at[rows, axis] = sign * half[axis]
    n = sign[:, None] * TURN[axis]
    p = np.float32(np.float32(centre) + at @ TURN)
    d = directions(3000)
    d *= (np.sign(dots(n, d)) * (1 if leaves else -1))[:, None].astype(np.float32)
    o = np.array([[*offset_ray_origin(Vec3(*a), Vec3(*b))] for a, b in zip(p, n if leaves else -n, strict=True)])
    o = o.astype(np.float32)
    t = trace(box(centre, half), o, d)["t"]
    if leaves:
        assert np.isinf(t).all()
    else:
        near, far = box_t(centre, half, o, d)
        deep = (np.abs(dots(n, d)) > 0.05) & (far > 1e-3 * half.max()) & (near < 0)  # some start beside an edge
        assert deep.mean() > 0.8
        np.testing.assert_allclose(t[deep], far[deep], rtol=1e-2)


def test_boxes_heed_both_ends_of_the_ray_and_their_planes():
    row = box((0, 0, 5), (1, 1, 2), np.eye(3))
    for t_min, t_max, t in ((0, FAR, 3), (3.5, FAR, 7), (0, 2.9, np.inf), (3.5, 6.9, np.inf), (7.5, FAR, np.inf)):
        assert trace(row, [0, 0, 0], [0, 0, 1], t_min, t_max)["t"][0] == pytest.approx(t)
    assert trace(row, [0.5, 0, 0], [0, 0, 2])["t"][0] == pytest.approx(1.5)
    assert np.isinf(trace(row, [1, 0, 0], [0, 0, 1])["t"][0])  # within the plane of a side
    assert np.isinf(trace(row, [2, 0, 0], [0, 0, 1])["t"][0])
    assert np.isinf(trace(row, [0, 0, 0], [0, 0, -1])["t"][0])


def test_each_face_of_a_box_is_mapped_upright_and_not_mirrored():
    """Seen from outside, u runs to the right where v runs upwards."""
    row = box((0, 0, 0), (1, 2, 3), np.eye(3))
    for axis in range(3):
        for side in (-1.0, 1.0):
            n = side * np.eye(3)[axis]
            up = np.eye(3)[1 if axis == 2 else 2]
            right = np.cross(up, n)
            for x, y in ((0.5, 0.5), (-0.5, 0.25)):
                p = (n + x * right + y * up) * (1, 2, 3)
                (hit,) = trace(row, np.float32([p + n]), np.float32(-n))
                np.testing.assert_allclose(hit["uv"], [0.5 + x / 2, 0.5 + y / 2], atol=1e-6)


# ---- Triangles -------------------------------------------------------------------------------------------------------


def test_triangle_is_hit_within_its_corners():
    p = RANDOM.normal(size=(3, 3))
    b = RANDOM.uniform(-0.5, 1.5, (2000, 2))
    target = p[0] + b[:, :1] * (p[1] - p[0]) + b[:, 1:] * (p[2] - p[0])
    o = target + 2 * directions(2000)
    row = np.zeros(1, TRIANGLE)
    row["p"] = p
    hits = trace(row, o, (target - o) * 0.25)
    normal = np.cross(p[1] - p[0], p[2] - p[0])
    inside = np.minimum(b.min(axis=1), 1 - b.sum(axis=1))
    clear = (np.abs(inside) > 1e-3) & (np.abs(dots(normal, target - o)) > 0.1)
    np.testing.assert_array_equal(np.isfinite(hits["t"])[clear], (inside > 0)[clear])
    met = clear & (inside > 0)
    assert met.sum() > 100
    np.testing.assert_allclose(hits["t"][met], 4.0, rtol=1e-4)
    np.testing.assert_allclose(hits["b"][met], b[met], atol=1e-3)
    np.testing.assert_allclose(hits["n"][0], normal / np.linalg.norm(normal), atol=1e-6)


# ---- Bounds ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", sorted(set(ShapeKind) - {ShapeKind.STRAND}))  # a strand has tests of its own
def test_bounds_contain_every_hit_and_are_tight(kind):
    c = np.array([10.0, -3.0, 2.0])
    v = (-0.16, 0.4, 0.2) if kind == ShapeKind.BOX else SLANTED["v"]  # boxes have right angles
    row = shape(kind, c, SLANTED["u"], v, radius=0.6)
    lo, hi = dispatch.bounds(row)
    o = c + 3 * directions(100_000)
    d = c + RANDOM.uniform(-1.1, 1.1, (100_000, 3)) - o
    hits = trace(row, o, d)
    hits = hits[np.isfinite(hits["t"])]
    p = hits["o"] + hits["d"] * hits["t"][:, None]
    assert len(p) > 3000
    assert (p >= lo).all()
    assert (p <= hi).all()
    np.testing.assert_allclose([p.min(axis=0), p.max(axis=0)], [lo[0], hi[0]], atol=0.04)
