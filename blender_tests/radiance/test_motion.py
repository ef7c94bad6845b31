# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur against what it stands for: the mean over moments, each of them with everything standing still."""

import numpy as np
import pytest

from blender_tests.helpers.scenes import builder, settings
from engine_core.integrator.tiles import Render
from engine_core.motion import pose_at
from engine_core.scene.builder import look_at
from engine_core.scene.checks import SceneError
from engine_core.scene.materials import Diffuse, Emission
from engine_core.scene.motion import decomposed, pose_rows, rotation_matrix, swept

MOMENTS = 64


def turned(axis, angle):
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis) * np.sin(angle / 2)
    return rotation_matrix((np.cos(angle / 2), x, y, z))


def placed(place, linear=None):
    matrix = np.eye(4)
    matrix[:3, 3] = place
    matrix[:3, :3] = np.eye(3) if linear is None else linear
    return matrix


# Name: where it stands at a time between 0 and 1. All of it is what poses can follow exactly.
MOTIONS = {
    "flies": lambda time: placed((-0.5 + time, 4.0, 0.2 * time)),
    "turns": lambda time: placed((0.2, 4.0, 0.0), turned((1, 2, 3), 2.4 * time) @ np.diag((1.5, 0.5, 0.7))),
    "grows": lambda time: placed((0.0, 4.0, 0.0), np.diag((0.3 + 2.0 * time, 1.0, 1.0 + time))),
    "turns inside out": lambda time: placed((-0.3, 4.0 - time, 0.0), -turned((0, 1, 1), time)),
}


def scene(shape="mesh"):
    """A builder with a floor, a light, a thing of that shape to place, and a material for it."""
    b = builder()
    matt, bright = b.material("Matt", Diffuse((0.7, 0.5, 0.3))), b.material("Bright", Emission((2.0, 2.0, 2.0)))
    if shape == "mesh":
        thing = b.mesh("Thing", [(-0.5, 0, -0.5), (0.7, 0, -0.4), (0, 0.8, 0.6)], [(0, 1, 2), (2, 1, 0)])
    else:
        thing = b.spheres("Thing", [(0.0, 0.0, 0.0)], [0.4])
    floor = b.mesh("Floor", [(-9, -9, -1), (9, -9, -1), (9, 9, -1), (-9, 9, -1)], [(0, 1, 2), (0, 2, 3)])
    lamp = b.mesh("Lamp", [(-2, 2, 3), (2, 2, 3), (2, 6, 3), (-2, 6, 3)], [(0, 2, 1), (0, 3, 2)])
    b.instance(floor, materials=[matt])
    b.instance(lamp, materials=[bright])
    return b, thing, matt


def mean_over_moments(place, of_camera, shape):
    total = 0.0
    for moment in range(MOMENTS):
        time = (moment + 0.5) / MOMENTS
        b, thing, matt = scene(shape)
        b.instance(thing, place(time), [matt])
        aim(b, of_camera(time))
        total = total + picture(b, samples=16, seed=moment)
    return total / MOMENTS


def blurred(place, of_camera, shape, poses=3, seed=99):
    b, thing, matt = scene(shape)
    times = np.linspace(0.0, 1.0, poses)
    b.instance(thing, place(0.5), [matt], motion=[place(time) for time in times])
    aim(b, of_camera(0.5), [of_camera(time) for time in times])
    return picture(b, samples=16 * MOMENTS, seed=seed)


def aim(b, to_world, motion=None):
    b.camera(to_world, (-0.5, 0.5, -0.5, 0.5), motion=motion)


def picture(b, samples, seed):
    render = Render(b.build(), settings(size=16, samples=samples, seed=seed, max_bounces=2, adaptive=0))
    render.run()
    return render.image("Combined")[..., :3].astype(float)


def blocks(picture):
    """Means over 4 x 4 pixels."""
    return picture.reshape(4, 4, 4, 4, 3).mean(axis=(1, 3))


def still(time):
    return look_at((0, 0, 0), (0, 1, 0))


def swinging(time):
    return placed((0.5 * time, 0.0, 0.0), turned((0, 0, 1), 0.3 * time)) @ look_at((0, 0, 0), (0, 1, 0))


@pytest.mark.parametrize(
    ("name", "of_camera", "shape"),
    [(name, still, "mesh") for name in MOTIONS] + [("flies", swinging, "mesh"), ("turns", still, "sphere")],
)
def test_blur_is_the_mean_over_moments(name, of_camera, shape):
    """Moments are a sum where blur is an integral; with 64 that is a hundredth of an edge's contrast.

    Noise is left out by blocks of pixels, which tell whether something moves a tenth too short.
    """
    place = MOTIONS[name]
    expected, found = mean_over_moments(place, of_camera, shape), blurred(place, of_camera, shape)
    assert np.abs(found.mean(axis=(0, 1)) / expected.mean(axis=(0, 1)) - 1.0).max() < 0.005
    assert np.abs(found - expected).mean() < 0.02 * expected.mean()
    assert np.abs(found - expected).max() < 0.2 * expected.max()
    coarse = np.abs(blocks(found) - blocks(expected))
    assert coarse.mean() < 0.008 * expected.mean()
    assert coarse.max() < 0.012 * expected.max()
    unmoved = blurred(lambda time: place(0.5), of_camera, shape)
    assert np.abs(unmoved - expected).mean() > 2.0 * np.abs(found - expected).mean()  # else this proves nothing


def test_a_still_motion_costs_nothing_and_changes_nothing():
    b, thing, matt = scene()
    b.instance(thing, placed((0, 4, 0)), [matt], motion=[placed((0, 4, 0))] * 3)
    aim(b, still(0), [still(0)] * 3)
    built = b.build()
    assert built.world[0].moving_root == -1
    assert built.world[0].pose_count == 0


def test_what_moves_never_leaves_its_box():
    """Corners of a box, at a thousand times between poses, against the bounds at a few dozen."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        motion = np.array([placed(rng.normal(size=3), rng.normal(size=(3, 3))) for _ in range(3)])
        rows = pose_rows([motion])[1:]
        corners = rng.uniform(-1, 1, (50, 3))
        matrices, margin = swept(rows, np.linalg.norm(corners, axis=1).max())
        swept_points = corners @ np.swapaxes(matrices[:, :, :3], 1, 2) + matrices[:, None, :, 3]
        low, high = swept_points.min(axis=(0, 1)) - margin, swept_points.max(axis=(0, 1)) + margin
        for time in np.linspace(0.0, 1.0, 1001):
            linear, place = between(rows, time)
            points = corners @ linear.T + place
            assert (points >= low - 1e-5).all()
            assert (points <= high + 1e-5).all()


@pytest.mark.parametrize("name", MOTIONS)
def test_kernels_let_things_stand_where_their_poses_say(name):
    b, thing, matt = scene()
    b.instance(thing, MOTIONS[name](0.5), [matt], motion=[MOTIONS[name](time) for time in (0.0, 0.5, 1.0)])
    aim(b, still(0))
    built = b.build()
    first = built.instances["motion"].max()
    for time in np.linspace(0.0, 1.0, 21, dtype=np.float32):
        found = pose_at(built, first, time)
        linear, place = between(built.poses[first : first + 3], time)
        columns = np.array([(v.x, v.y, v.z) for v in found]).T
        np.testing.assert_allclose(columns, np.column_stack([linear, place]), atol=3e-6)


def between(rows, time):
    """As `pose_at`, in float64."""
    i = min(int(time * (len(rows) - 1)), len(rows) - 2)
    f = time * (len(rows) - 1) - i
    a, b = rows[i], rows[i + 1]
    q, r = a["rotation"].astype(float), b["rotation"].astype(float)
    angle = np.arccos(min(q @ r, 1.0))
    weights = (np.sin((1 - f) * angle), np.sin(f * angle)) if angle > 1e-6 else (1 - f, f)
    turn = rotation_matrix(weights[0] * q + weights[1] * r)
    return turn @ (a["stretch"] * (1 - f) + b["stretch"] * f), a["location"] * (1 - f) + b["location"] * f


def test_a_matrix_is_its_stretch_and_its_rotation():
    linear = np.random.default_rng(2).normal(size=(40, 3, 3))
    quaternions, stretches = decomposed(linear)
    rotations = np.array([rotation_matrix(q) for q in quaternions])
    np.testing.assert_allclose(rotations @ stretches, linear, atol=1e-12)
    np.testing.assert_allclose(stretches, np.swapaxes(stretches, 1, 2), atol=1e-12)
    assert (np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1]) >= 0.0).all()


def test_faulty_motions_are_refused_by_name():
    b, thing, _ = scene()
    b.instance(thing, motion=[placed((0, 4, 0)), placed((0, 5, 0), np.zeros((3, 3)))])
    aim(b, still(0))
    with pytest.raises(SceneError, match="Thing: is scaled to 0"):
        b.build()
    b.placements[-1].motion = [placed((0, 4, 0)), placed((0, 5, 0))]
    b.camera_motion = [still(0), swinging(0.5), swinging(1)]
    with pytest.raises(SceneError, match="different numbers of poses"):
        b.build()
    with pytest.raises(SceneError, match="never opens"):
        b.shutter([0.0, 0.0])
