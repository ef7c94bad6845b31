# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays find in a tree what brute force finds in float64; and no ray slips through a closed surface."""

import numpy as np
import pytest

from blender_tests.bench.leaks import measure as measure_leaks
from blender_tests.core.test_accel_build import TRIANGLES, soup
from blender_tests.helpers.rays import blocked, bumpy_sphere, closest, geometry_scene, lamps
from engine_core.tables import SHAPE, ShapeKind, TreeKind, Visibility

RANDOM = np.random.default_rng(11)
START = RANDOM.bit_generator.state
AXES = np.concatenate([np.eye(3), -np.eye(3)])


@pytest.fixture(autouse=True)
def _same_numbers_for_each_test():
    RANDOM.bit_generator.state = START


def directions(count):
    d = RANDOM.normal(size=(count, 3))
    return (d / np.linalg.norm(d, axis=1, keepdims=True)).astype(np.float32)


def brute_force(p, o, d):
    """First hits t (inf: none) of rays with triangles, one by one and in float64 (Moeller and Trumbore 1997)."""
    p, o, d = (np.asarray(x, np.float64) for x in (p, o, d))
    e1, e2 = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    h = np.cross(d[:, None], e2[None])
    with np.errstate(all="ignore"):
        scale = 1.0 / (h * e1).sum(-1)
        s = o[:, None] - p[None, :, 0]
        q = np.cross(s, e1[None])
        b1, b2 = (s * h).sum(-1) * scale, (q * d[:, None]).sum(-1) * scale
        t = (q * e2).sum(-1) * scale
        return np.where((b1 >= 0) & (b2 >= 0) & (b1 + b2 <= 1) & (t > 0), t, np.inf).min(axis=1)


def assert_agrees_with_brute_force(hits, p, hit_triangles=None):
    """What is hit lies on the ray, and nothing before it was overlooked.

    Rounding moves rays and edges by a hair's breadth. So only those triangles must not be overlooked that brute force
    finds at the same place by rays a hair's breadth aside as well. Returns which rays hit such a one.
    `hit_triangles`: what each hit names, (n, 3, 3); if not given, p[prim].
    """
    breadth = 2e-6 * np.abs(p).max()
    found = np.where(hits["prim"] >= 0, hits["t"], np.inf)
    corners = (p[hits["prim"]] if hit_triangles is None else hit_triangles)[hits["prim"] >= 0]
    hit = hits[hits["prim"] >= 0]
    weights = np.stack([1 - hit["b1"] - hit["b2"], hit["b1"], hit["b2"]], axis=1).astype(np.float64)
    assert (weights > -1e-6).all()
    at = (weights[:, :, None] * corners).sum(axis=1)
    error = np.linalg.norm(hit["o"] + hit["d"] * hit["t"][:, None].astype(np.float64) - at, axis=1)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).astype(np.float64)
    cosine = np.abs((normal * hit["d"]).sum(axis=1)) / (np.linalg.norm(normal, axis=1) + 1e-300)
    assert (error * cosine <= 2 * breadth).all()  # a triangle seen from its edge is hit anywhere along the ray

    o, d = hits["o"].astype(np.float64), hits["d"].astype(np.float64)
    t = brute_force(p, o, d)
    clear = np.isfinite(t)
    for _ in range(6):
        aside = brute_force(p, o + breadth * directions(len(o)), d + 2e-6 * directions(len(o)))
        with np.errstate(invalid="ignore"):
            clear &= np.abs(aside - t) < 1e-3 * t
    assert (found[clear] <= t[clear] * (1 + 1e-3) + breadth).all()
    return clear


def rays_of(kind, p, count=400):
    """Rays that meet the triangles `p`: aimed at their insides from around, along axes, or lying in their planes."""
    corners = p[RANDOM.integers(len(p), size=count)].astype(np.float64)
    weights = RANDOM.dirichlet((1, 1, 1), size=count)
    target = (corners * weights[:, :, None]).sum(axis=1)
    size = np.ptp(p.reshape(-1, 3).astype(np.float64), axis=0).max() + 1e-30
    if kind == "axis":
        d = AXES[RANDOM.integers(6, size=count)]
    elif kind == "in plane":
        d = corners[:, 1] - corners[:, 0]
        d /= np.linalg.norm(d, axis=1, keepdims=True) + 1e-300
        d[~(np.linalg.norm(d, axis=1) > 0.5)] = AXES[0]
    else:
        d = directions(count)
    with np.errstate(over="ignore"):
        return (target - d * size * 2).astype(np.float32), d.astype(np.float32)


@pytest.mark.parametrize("kind", ["random", "axis", "in plane"])
@pytest.mark.parametrize("name", [n for n in TRIANGLES if n not in ("largest", "huge", "tiny")])
def test_first_hit_agrees_with_brute_force(name, kind):
    p = TRIANGLES[name]
    hits = closest(geometry_scene(p), *rays_of(kind, p))
    clear = assert_agrees_with_brute_force(hits, p)
    if kind == "random" and name in ("one", "nine", "thousand", "identical", "in a plane"):
        assert clear.mean() > 0.8


@pytest.mark.parametrize("size", [1e-9, 1e9])
def test_triangles_of_any_size_are_hit(size):
    p = soup(200) * np.float32(size)
    hits = closest(geometry_scene(p), *rays_of("random", p))
    assert assert_agrees_with_brute_force(hits, p).mean() > 0.9


@pytest.mark.parametrize("name", TRIANGLES)
def test_no_input_brings_not_a_number(name):
    o, d = rays_of("random", TRIANGLES[name])
    hits = closest(geometry_scene(TRIANGLES[name]), np.nan_to_num(o), d)
    hits = hits[hits["prim"] >= 0]
    assert (hits["t"] > 0).all()
    assert np.isfinite([hits["t"], hits["b1"], hits["b2"]]).all()


def grid(cells):
    """The square 0 to `cells` at z = 0, in triangles between whole numbers."""
    x, y = np.meshgrid(np.arange(cells), np.arange(cells))
    q = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 1, 3)
    lower, upper = [[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]
    return np.concatenate([q + lower, q + upper]).astype(np.float32)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_ray_along_an_axis_hits_the_corners_and_edges_of_a_flat_grid(axis):
    """Boxes are flat, the ray runs along sides of boxes, and meets nothing but edges."""
    p = np.roll(grid(16), axis, axis=2)
    places = np.array([(x, y, 3) for x in np.arange(0, 16.5, 0.5) for y in np.arange(0, 16.5, 0.5)], np.float32)
    for height in (3.0, -3.0):
        o = np.roll(places * np.float32([1, 1, height / 3]), axis, axis=1)
        d = np.roll(np.float32([0, 0, -np.sign(height)]), axis)
        hits = closest(geometry_scene(p), o, d)
        assert (hits["prim"] >= 0).all()
        assert (hits["t"] == 3.0).all()


def test_a_ray_within_a_plane_passes_it_by_and_hits_what_stands_on_it():
    floor = grid(8)
    wall = np.array([[[4, -1, -1], [4, 9, -1], [4, 9, 1]], [[4, -1, -1], [4, 9, 1], [4, -1, 1]]], np.float32)
    y = np.arange(0.0, 8.25, 0.25)
    o = np.stack([0 * y - 2, y, 0 * y], axis=1)
    hits = closest(geometry_scene(np.concatenate([floor, wall])), o, [1, 0, 0])
    assert (hits["t"] == 6.0).all()
    assert (hits["prim"] >= len(floor)).all()


def test_no_ray_escapes_from_a_closed_surface():
    """Aimed at corners and along edges, where rounding would open gaps."""
    vertices, faces = bumpy_sphere(60)
    vertices = vertices * np.float32(0.37) + np.float32([3.1, -2.3, 1.7])
    p = vertices[faces]
    scene = geometry_scene(p)
    along = RANDOM.random((len(p), 8, 1)).astype(np.float32)
    targets = np.concatenate([vertices, (p[:, :1] * along + p[:, 1:2] * (1 - along)).reshape(-1, 3)])
    for o in np.float32([[3.1, -2.3, 1.7], [3.15, -2.2, 1.65]]):
        d = targets - o
        assert (closest(scene, o, d)["prim"] >= 0).all()
        assert blocked(scene, o, d).all()


def test_of_a_million_rays_none_escapes_from_a_closed_surface():
    """At edges and at random; the bench part `leaks` sends a hundred million into a million triangles."""
    result = measure_leaks(rings=90, rays=1_000_000)
    assert result["triangles"] > 30_000
    assert result["escaped"] == result["not_occluded"] == 0


# ---- Instances and shapes --------------------------------------------------------------------------------------------


def matrices(count, spread=5.0):
    """Random transforms (3, 4): turned, scaled unevenly along slanted axes, every other one mirrored."""
    turn, slant = (np.linalg.qr(RANDOM.normal(size=(count, 3, 3)))[0] for _ in range(2))
    m = turn * RANDOM.uniform(0.4, 2.5, (count, 1, 3)) @ slant
    m *= (np.sign(np.linalg.det(m)) * np.where(np.arange(count) % 2, 1, -1))[:, None, None]
    return np.concatenate([m, spread * RANDOM.normal(size=(count, 3, 1))], axis=2).astype(np.float32)


def moved(p, matrix):
    return (p @ matrix[:, :3].T.astype(np.float64) + matrix[:, 3]).astype(np.float32)


def test_instances_are_hit_as_their_triangles_in_the_world_are():
    first, second, own = soup(40, 0.8), soup(30, 0.8), soup(50, 2.0)
    placed = matrices(6), matrices(7)
    scene = geometry_scene(own, instances=[(first, placed[0]), (second, placed[1])])
    everything = [own, *(moved(p, m) for p, ms in zip((first, second), placed, strict=True) for m in ms)]
    everything = np.concatenate(everything)
    hits = closest(scene, *rays_of("random", everything, 1500))
    objects = np.concatenate([own, first, second])[hits["prim"]]
    matrix = np.where(hits["instance"] >= 0, hits["instance"], 0)
    matrix = np.where(hits["instance"][:, None, None] >= 0, scene.instances["to_world"][matrix], np.eye(4)[:3])
    hit_triangles = objects @ matrix[:, :, :3].transpose(0, 2, 1) + matrix[:, None, :, 3]
    assert assert_agrees_with_brute_force(hits, everything, hit_triangles).sum() > 1000
    assert (hits["kind"] == TreeKind.TRIANGLES).all()
    hits = hits[hits["prim"] >= 0]
    np.testing.assert_array_equal(hits["prim"] < len(own), hits["instance"] < 0)


def test_rays_see_only_instances_that_their_visibility_allows():
    p = soup(1, 1.0) * np.float32([1, 1, 0])
    near, far = np.eye(4)[:3].astype(np.float32), np.eye(4)[:3].astype(np.float32)
    far[2, 3] = -1.0
    scene = geometry_scene(instances=[(p, [(near, Visibility.CAMERA), (far, Visibility.ALL - Visibility.CAMERA)])])
    o = p[0].mean(axis=0) + np.float32([0, 0, 2])
    for visibility, t in ((Visibility.CAMERA, 2.0), (Visibility.DIFFUSE, 3.0), (Visibility.SHADOW, 3.0)):
        assert closest(scene, o[None], [0, 0, -1], visibility=visibility)["t"] == pytest.approx(t)
    assert not blocked(scene, o[None], [0, 0, -1], 2.5)
    assert blocked(scene, o[None], [0, 0, -1], 3.5)


def spheres(centres, radii):
    rows = np.zeros(len(radii), SHAPE)
    rows["kind"], rows["p"], rows["radius"] = ShapeKind.SPHERE, centres, radii
    return rows


def first_sphere(centres, radii, o, d):
    """t of the first sphere on the rays, in float64; inf: none."""
    f = o[:, None].astype(np.float64) - centres[None]
    a, b, c = (d**2).sum(-1)[:, None], (f * d[:, None]).sum(-1), (f**2).sum(-1) - np.asarray(radii, float) ** 2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - a * c)
        t = np.stack([(-b - root) / a, (-b + root) / a])
    return np.where(t > 0, t, np.inf).min(axis=(0, 2)), np.abs(b * b - a * c).min(axis=1)


def test_many_spheres_are_hit_as_each_alone_is():
    centres, radii = RANDOM.normal(size=(300, 3)) * 3, RANDOM.random(300) * 0.5
    scene = geometry_scene(shapes=spheres(centres, radii))
    o, d = (RANDOM.normal(size=(3000, 3)) * 3).astype(np.float32), directions(3000)
    t, clarity = first_sphere(np.float32(centres), np.float32(radii), o, d)
    hits = closest(scene, o, d)
    clear = clarity > 1e-4
    np.testing.assert_allclose(np.where(hits["prim"] >= 0, hits["t"], np.inf)[clear], t[clear], rtol=1e-3)
    assert 500 < np.isfinite(t).sum() < 2500
    some = hits[hits["prim"] >= 0]
    assert (some["kind"] == TreeKind.SHAPES).all()
    on_surface = np.linalg.norm(some["o"] + some["d"] * some["t"][:, None] - scene.shapes["p"][some["prim"]], axis=1)
    np.testing.assert_allclose(on_surface, scene.shapes["radius"][some["prim"]], atol=1e-5)


def test_an_instance_makes_an_ellipsoid_of_a_sphere():
    """x = M y + c with |y| = 1 has |M^-1 (x - c)| = 1."""
    placed = matrices(20)
    scene = geometry_scene(instances=[(spheres([[0, 0, 0]], [1]), placed)])
    o, d = (RANDOM.normal(size=(3000, 3)) * 6).astype(np.float32), directions(3000)
    hits = closest(scene, o, d)
    hits = hits[hits["prim"] >= 0]
    assert len(hits) > 300
    m = scene.instances["to_world"][hits["instance"]].astype(np.float64)
    x = hits["o"] + hits["d"].astype(np.float64) * hits["t"][:, None]
    y = np.linalg.solve(m[:, :, :3], (x - m[:, :, 3])[..., None])[..., 0]
    np.testing.assert_allclose(np.linalg.norm(y, axis=1), 1.0, atol=1e-3)


def mixed_scene():
    return geometry_scene(
        soup(60, 0.5),
        spheres(RANDOM.normal(size=(20, 3)) * 2, RANDOM.random(20) * 0.4),
        spheres(RANDOM.normal(size=(9, 3)), np.full(9, 1.0)),  # lamps, which block nothing
        [(soup(50, 0.5), matrices(4, 2.0)), (spheres([[0, 0, 0]], [0.5]), matrices(4, 2.0))],
    )


def test_a_ray_is_occluded_if_and_only_if_it_hits_something():
    scene = mixed_scene()
    o, d = (RANDOM.normal(size=(4000, 3)) * 2).astype(np.float32), directions(4000) * np.float32(1.7)
    t_max = (RANDOM.random(4000) * 4).astype(np.float32)
    hits = closest(scene, o, d, t_max)
    found = hits["prim"] >= 0
    np.testing.assert_array_equal(blocked(scene, o, d, t_max), found)
    assert (hits["t"] == t_max)[~found].all()
    kinds = {(k, i >= 0) for k, i in zip(hits["kind"][found], hits["instance"][found], strict=True)}
    assert len(kinds) == 4


def test_t_max_ends_a_ray():
    scene = mixed_scene()
    o, d = (RANDOM.normal(size=(1000, 3)) * 2).astype(np.float32), directions(1000)
    free = closest(scene, o, d)
    hit = free["prim"] >= 0
    before = closest(scene, o, d, free["t"] * np.float32(0.999))
    after = closest(scene, o, d, free["t"] * np.float32(1.001))
    assert (before["prim"] < 0).all()
    np.testing.assert_array_equal(after["prim"][hit], free["prim"][hit])


def test_from_hit_to_hit_a_ray_meets_all_that_it_crosses():
    """Each query begins where the last one hit: nothing is met twice, nor left out, and t only grows."""
    scene = mixed_scene()
    o, d = (RANDOM.normal(size=(1000, 3)) * 2).astype(np.float32), directions(1000)
    forth = list_hits(scene, o, d)
    assert sum(map(len, forth)) > 150
    assert max(map(len, forth)) > 2
    back = list_hits(scene, o + d * np.float32(16), -d)
    agreeing = [[k for _, k in a] == [k for t, k in reversed(b) if t < 16] for a, b in zip(forth, back, strict=True)]
    assert np.mean(agreeing) > 0.98  # rounding: edges, and what lies within a hair's breadth of the origin


def list_hits(scene, o, d):
    """For each ray (t, (kind, prim, instance)) of all that it crosses, one behind the other."""
    met, t = [[] for _ in o], np.zeros(len(o), np.float32)
    for _ in range(64):
        hits = closest(scene, o, d, t_min=t)
        for i in np.flatnonzero(hits["prim"] >= 0):
            assert hits["t"][i] > t[i]
            met[i].append((hits["t"][i], tuple(hits[["kind", "prim", "instance"]][i])))
        if not (hits["prim"] >= 0).any():
            return met
        t = np.where(hits["prim"] >= 0, hits["t"], np.inf).astype(np.float32)
    raise AssertionError("there is always something more")


def test_lamps_are_met_one_behind_the_other():
    scene = geometry_scene(soup(5), lamps=spheres([[0, 0, z] for z in range(5)], [0.25] * 5))
    t, met = 0.0, []
    while True:
        (hit,) = lamps(scene, np.float32([[0, 0, 10]]), [0, 0, -2], t)
        if hit["prim"] < 0:
            break
        t = hit["t"]
        assert hit["kind"] == TreeKind.SHAPES
        met.append((scene.shapes[hit["prim"]]["p"][2], 10 - 2 * t))
    expected = [(z, z + side) for z in (4, 3, 2, 1, 0) for side in (0.25, -0.25)]
    np.testing.assert_allclose(met, expected, atol=1e-6)


def test_a_ray_that_is_not_a_number_hits_nothing_and_ends():
    scene = mixed_scene()
    for o, d in (
        ([0, 0, 0], [np.nan, 0, 1]),
        ([np.nan] * 3, [0, 0, 1]),
        ([0, 0, 0], [np.nan] * 3),
        ([0, 0, 0], [0, 0, 0]),
    ):
        assert closest(scene, np.float32([o]), np.float32(d))["prim"] == -1
        assert not blocked(scene, np.float32([o]), np.float32(d))


def test_a_scene_of_nothing_is_never_hit():
    scene = geometry_scene()
    assert (closest(scene, directions(10), directions(10))["prim"] == -1).all()
    assert not blocked(scene, directions(10), directions(10)).any()
    assert (lamps(scene, directions(10), directions(10))["prim"] == -1).all()
