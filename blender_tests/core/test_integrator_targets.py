# SPDX-License-Identifier: GPL-3.0-or-later
"""Aiming at targets: directions follow the density that is claimed for them, however targets overlap."""

import numpy as np
import pytest

from blender_tests.helpers.chi_square import compare_directions, significance_of_one_of
from blender_tests.helpers.scenes import CUBE_CORNERS, CUBE_TRIANGLES, builder, cube, plane, sphere
from engine_core.integrator import targets
from engine_core.jit import kernel
from engine_core.linalg.vec3 import Vec3
from engine_core.scene.materials import Diffuse, Emission, Glass
from engine_core.scene.targets import Aim
from engine_core.tables import LightKind

GREY, SHINING = Diffuse((0.5, 0.5, 0.5)), Emission((1, 1, 1), 2.0)
ALWAYS = {"aim": Aim.ALWAYS}


@kernel
def _sample_often(scene, p, u, result):
    for i in range(len(u)):
        s = targets.sample(scene, Vec3(p[0], p[1], p[2]), u[i, 0], u[i, 1], u[i, 2])
        result[i, 0], result[i, 1], result[i, 2], result[i, 3] = s.wi.x, s.wi.y, s.wi.z, s.pdf


@kernel
def _ask_often(scene, p, wi, result):
    for i in range(len(wi)):
        d = Vec3(wi[i, 0], wi[i, 1], wi[i, 2])
        result[i] = targets.pdf(scene, Vec3(p[0], p[1], p[2]), d, targets.NO_TARGET)


def sample(scene, p, n=100_000, seed=1):
    """(directions (n, 3), NaN where there is none; densities (n,))"""
    u = (np.random.default_rng(seed).integers(0, 2**24, (n, 3)) * 2.0**-24).astype(np.float32)
    result = np.zeros((n, 4), np.float32)
    _sample_often(scene, np.array(p, np.float32), u, result)
    result[result[:, 3] == 0.0, :3] = np.nan
    return result[:, :3].astype(float), result[:, 3]


def pdf(scene, p, wi):
    result = np.zeros(len(wi), np.float32)
    _ask_often(scene, np.array(p, np.float32), np.ascontiguousarray(wi, np.float32), result)
    return result


# ---- What is aimed at ------------------------------------------------------------------------------------------------


def two_balls(b):
    """One behind the other, and through it."""
    sphere(b, Glass(), (0, 3, 0), 1.0, **ALWAYS)
    sphere(b, GREY, (0.3, 4.2, 0.2), 1.5, **ALWAYS)


def mesh_of_two_cubes(b):
    """A mesh that is not convex: lines cross up to eight of its triangles."""
    corners = np.concatenate([CUBE_CORNERS, 0.7 * CUBE_CORNERS + (0.9, 0.4, 0.3)])
    mesh = b.mesh("cubes", corners, np.concatenate([CUBE_TRIANGLES, CUBE_TRIANGLES + 8]))
    matrix = np.array([[1.0, 0.2, 0, 0], [0, 0.8, 0.3, 3], [0, 0, -1.1, 0.4], [0, 0, 0, 1]])  # sheared and mirrored
    b.instance(mesh, matrix, [b.material("m", Glass())], aim=Aim.ALWAYS)


def instances(b):
    """One mesh, there twice; only one of both is aimed at."""
    mesh = b.mesh("cube", CUBE_CORNERS, CUBE_TRIANGLES)
    for x, aim in ((-1.5, Aim.ALWAYS), (1.5, Aim.NEVER)):
        matrix = np.eye(4)
        matrix[:3, 3] = x, 3, 0
        b.instance(mesh, matrix, [b.material("m", GREY)], aim=aim)


def ellipsoid(b):
    """It cannot be aimed at as such; the box around it can."""
    material = b.material("m", SHINING)
    b.instance(b.spheres("s", [(0, 0, 0)], [1.0]), np.diag([1.0, 0.5, 2.0, 1.0]), [material])


def box(b):
    b.instance(b.boxes("box", [(0, 3, 0)], [(1.0, 0.5, 0.7)]), materials=[b.material("m", GREY)], **ALWAYS)


def quad(b):
    b.instance(b.quads("q", [(0, 3, 0)], [(1, 0, 0)], [(0, 0.2, 0.6)]), materials=[b.material("m", GREY)], **ALWAYS)


def lamps(b):
    place = np.array([[1.0, 0, 0, 0.5], [0, 0.6, 0.8, 1], [0, -0.8, 0.6, 2], [0, 0, 0, 1]])
    b.area_light("Area", place, (10, 9, 8), 0.8, 0.6)
    b.area_light("Disk", np.diag([-1.0, 1.0, -1.0, 1.0]), (10, 9, 8), 1.8, 1.6, "ELLIPSE")
    b.area_light("Spread", place, (10, 9, 8), 0.8, 0.6, spread=1.0)
    b.point_light("Ball", (2, 3, 0), (10, 10, 10), radius=0.7, soft=False)
    b.point_light("Soft", (-2, 3, 0.3), (10, 10, 10), radius=0.7)
    b.spot_light("Spot", np.eye(4) + np.eye(4, k=3) * 1.5, (10, 10, 10), 0.4, 1.0, 0.5)
    b.sun_light("Sun", (1, 1, -1), (3, 3, 3), 1.0)


def all_sorts(b):
    two_balls(b)
    lamps(b)
    mesh_of_two_cubes(b)
    quad(b)
    b.sun_light("Parallel", (1, 1, -1), (3, 3, 3))  # a delta: nothing to aim at


CASES = {
    "ball behind a ball": (two_balls, (0, 0, 0)),
    "within two balls": (two_balls, (0.1, 3.5, 0.2)),
    "on a ball": (two_balls, (0, 2, 0)),
    "mesh": (mesh_of_two_cubes, (0.2, 0, 0.1)),
    "within the mesh": (mesh_of_two_cubes, (0.1, 3.1, 0.2)),
    "on the mesh": (mesh_of_two_cubes, (1.2, 3.1, 0.3)),
    "one instance of two": (instances, (0, 0, 0.3)),
    "ellipsoid": (ellipsoid, (0.3, -2, 0.5)),
    "within an ellipsoid": (ellipsoid, (0.3, 0.1, 0.5)),
    "box": (box, (0.7, 0, 1.0)),
    "within a box": (box, (0.7, 3.2, 0.1)),
    "on a box": (box, (0.3, 2.5, 0.1)),
    "front of a quad": (quad, (0.2, 2.0, 0.3)),
    "back of a quad": (quad, (0.2, 4.0, 0.3)),
    "lamps": (lamps, (0.1, 0.4, -0.5)),
    "all sorts": (all_sorts, (0.1, 0.4, -0.5)),
}


def scene_of(fill):
    b = builder()
    fill(b)
    return b.build()


@pytest.mark.parametrize("name", CASES)
def test_directions_follow_the_density(name):
    fill, p = CASES[name]
    scene = scene_of(fill)
    directions, _ = sample(scene, p)

    result = compare_directions(directions, lambda wi: pdf(scene, p, wi), tolerance=2e-6)

    assert result.p_value > significance_of_one_of(len(CASES)), result


@pytest.mark.parametrize("name", CASES)
def test_a_sample_knows_the_density_of_all_targets(name):
    """What a sample says is what a ray of another making would be told, but where rounding decides about an edge."""
    fill, p = CASES[name]
    scene = scene_of(fill)
    directions, densities = sample(scene, p, 20_000)
    found = np.isfinite(directions).all(axis=1)

    asked = pdf(scene, p, directions[found])

    differs = np.abs(asked - densities[found]) > 1e-2 * densities[found]
    assert found.mean() > 0.3
    assert differs.mean() < 2e-3


def test_a_point_in_the_plane_of_a_target_does_not_see_it():
    """Its own triangle, first of all, whatever side of it rounding has put the point on."""
    b = builder()
    plane(b, SHINING, half=2.0, z=1000.3)
    scene = b.build()
    p = np.float32((0.3, 0.2, np.nextafter(np.float32(1000.3), np.float32(np.inf))))

    assert np.isnan(sample(scene, p, 1000)[0]).all()
    assert (pdf(scene, p, np.array([(0, 0, -1.0), (0, 0, 1.0), (0.6, 0, -0.8)])) == 0.0).all()


# ---- Shares ----------------------------------------------------------------------------------------------------------


def shares(scene):
    """{(kind of light, whether it shines): probability}"""
    rows = scene.targets[: int(scene.world["target_count"][0])]
    lights = scene.lights[rows["light"]]
    result = {}
    for row, light in zip(rows, lights, strict=True):
        key = LightKind(light["kind"]).name, bool(light["emission"].any())
        result[key] = result.get(key, 0.0) + float(row["pmf"])
    return result


def test_probabilities_add_up_exactly():
    scene = scene_of(all_sorts)
    count = int(scene.world["target_count"][0])

    assert scene.targets["cdf"][count - 1] == 1.0
    np.testing.assert_array_equal(np.cumsum(scene.targets["pmf"][:count], dtype=float), scene.targets["cdf"][:count])
    assert int(scene.world["delta_count"][0]) == 1
    assert scene.targets["pmf"][count] == 1.0


def test_objects_that_do_not_shine_share_evenly():
    b = builder()
    sphere(b, Glass(), (0, 3, 0), 0.1, **ALWAYS)
    cube(b, GREY, **ALWAYS)
    plane(b, SHINING)

    result = shares(b.build())

    third = pytest.approx(1 / 3, rel=1e-5)
    assert result == {("SPHERE", False): third, ("TRIANGLE", False): third, ("TRIANGLE", True): third}


def test_lights_share_half_evenly_and_half_by_power():
    b = builder()
    sphere(b, Emission((1, 1, 1), 3.0), radius=1.0)
    plane(b, Emission((1, 1, 1), 1.0), half=1.0)  # pi 4 m2 on two sides, the ball 3 times pi 4 pi m2

    result = shares(b.build())

    power = {"SPHERE": 12 * np.pi, "TRIANGLE": 8.0}
    expected = {(k, True): pytest.approx(0.25 + 0.5 * v / sum(power.values()), rel=1e-5) for k, v in power.items()}
    assert result == expected


def test_an_object_may_be_left_out():
    b = builder()
    plane(b, SHINING)
    sphere(b, SHINING, aim=Aim.NEVER)
    b.point_light("Lamp", (0, 0, 3), (1, 1, 1), radius=0.1, aim=Aim.NEVER)
    b.background((1, 1, 1))

    assert shares(b.build()) == {("TRIANGLE", True): pytest.approx(1.0)}


def test_of_a_large_mesh_the_box_is_aimed_at(monkeypatch):
    monkeypatch.setattr("engine_core.scene.targets.LARGEST_MESH", 11)
    b = builder()
    cube(b, Diffuse((1, 1, 1)), **ALWAYS)

    scene = b.build()

    assert len(scene.targets) == 12
    assert scene.lights["area"].sum() == pytest.approx(24.0)


def test_of_very_many_targets_the_strongest_are_kept(monkeypatch):
    monkeypatch.setattr("engine_core.scene.targets.MOST_TARGETS", 3)
    b = builder()
    for i in range(5):
        sphere(b, Emission((1, 1, 1), 1.0 + i), (0, 3.0 * i, 0))

    scene = b.build()

    assert sorted(scene.lights["emission"][scene.targets["light"], 0]) == [3, 4, 5]
