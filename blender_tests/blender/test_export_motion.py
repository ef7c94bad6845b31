# SPDX-License-Identifier: GPL-3.0-or-later
"""With motion blur, the export looks at the scene between the opening and the closing of the shutter."""

import bpy
import numpy as np
import pytest

from blender_tests.helpers.exported import add, empty_scene, export_as_a_render, placement, square

pytestmark = pytest.mark.usefixtures("registered")
FRAME = 5
EXPOSURES = {"START": (5.0, 5.5), "CENTER": (4.75, 5.25), "END": (4.5, 5.0)}


def moving_scene(position="CENTER"):
    """A square whose x is the number of the frame, and a camera that rises as much."""
    scene = empty_scene()
    moving = add("Moving", square())
    add("Still", square())
    for b_object, axis in ((moving, 0), (scene.camera, 2)):
        for frame in (0, 10):
            b_object.location[axis] = frame
            b_object.keyframe_insert("location", frame=frame)
        for curve in b_object.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
    scene.frame_set(FRAME)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.5
    scene.render.motion_blur_position = position
    return scene


@pytest.mark.parametrize("position", EXPOSURES)
def test_poses_are_those_while_the_shutter_is_open(position):
    scene = moving_scene(position)
    scene.lambent.motion_steps = 2
    builder, warnings, _ = export_as_a_render()
    expected = np.linspace(*EXPOSURES[position], 5)
    moving, _ = placement(builder, "Moving")
    np.testing.assert_allclose(moving.motion[:, 0, 3], expected, atol=1e-5)
    np.testing.assert_allclose(builder.camera_motion[:, 2, 3], expected, atol=1e-5)
    assert np.asarray(moving.to_world)[0, 3] == pytest.approx(expected.mean(), abs=1e-5)
    world = builder.build().world[0]
    assert world.pose_count == 5
    assert world.moving_root >= 0
    assert scene.frame_current == FRAME
    assert warnings == []


def test_without_motion_blur_everything_stands_on_the_frame():
    scene = moving_scene("START")
    scene.render.use_motion_blur = False
    builder, *_ = export_as_a_render()
    moving, _ = placement(builder, "Moving")
    assert moving.motion is None
    assert np.asarray(moving.to_world)[0, 3] == pytest.approx(FRAME)
    assert builder.build().world[0].pose_count == 0


def test_what_shall_not_be_blurred_stands_in_the_middle():
    scene = moving_scene("START")
    bpy.data.objects["Moving"].lambent.use_motion_blur = False
    scene.camera.lambent.use_motion_blur = False
    builder, *_ = export_as_a_render()
    assert builder.build().world[0].pose_count == 0
    moving, _ = placement(builder, "Moving")
    assert np.asarray(moving.to_world)[0, 3] == pytest.approx(5.25, abs=1e-5)


def test_instances_move_each_on_its_own():
    scene = moving_scene()
    inside = bpy.data.collections.new("Inside")
    inside.objects.link(bpy.data.objects["Moving"])
    for y in (0.0, 3.0):
        carrier = add("Carrier", None, location=(0.0, y, 0.0))
        carrier.instance_type, carrier.instance_collection = "COLLECTION", inside
    scene.collection.objects.unlink(bpy.data.objects["Moving"])
    builder, *_ = export_as_a_render()
    motions = [p.motion for p in builder.placements if p.name == "Moving"]
    assert len(motions) == 2
    for motion, y in zip(motions, (0.0, 3.0), strict=True):
        np.testing.assert_allclose(motion[:, 0, 3], (4.75, 5.0, 5.25), atol=1e-5)
        np.testing.assert_allclose(motion[:, 1, 3], y, atol=1e-6)


def test_the_shutter_opens_by_its_curve():
    scene = moving_scene()
    points = scene.render.motion_blur_shutter_curve.curves[0].points
    for point, place in zip(points, ((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)), strict=True):
        point.location, point.handle_type = place, "VECTOR"
    scene.render.motion_blur_shutter_curve.update()
    builder, *_ = export_as_a_render()
    times = builder.build().camera[0].shutter
    share = np.linspace(0.0, 1.0, len(times))
    expected = np.where(share < 0.5, np.sqrt(share / 2.0), 1.0 - np.sqrt((1.0 - share) / 2.0))  # of a triangle
    np.testing.assert_allclose(times, expected, atol=2e-3)


def test_deformation_is_told_to_be_missing():
    moving_scene()
    lattice = add("Lattice", bpy.data.lattices.new("Lattice"))
    bpy.data.objects["Moving"].modifiers.new("Lattice", "LATTICE").object = lattice
    bpy.data.objects["Still"].modifiers.new("Rigid", "BEVEL")
    _, warnings, _ = export_as_a_render()
    assert [line.split(":")[0] for line in warnings if "deformation" in line] == ["Moving"]


def test_hair_moves_with_what_it_grows_on():
    moving_scene("CENTER")
    moving = bpy.data.objects["Moving"]
    moving.modifiers.new("Hair", "PARTICLE_SYSTEM")
    moving.particle_systems[0].settings.type = "HAIR"
    moving.particle_systems[0].settings.count = 3
    builder, warnings, _ = export_as_a_render()
    hair, square_itself = (p for p in builder.placements if p.name == "Moving")
    assert hasattr(builder.geometries[hair.geometry], "strands")
    np.testing.assert_allclose(hair.motion[:, 0, 3], (4.75, 5.0, 5.25), atol=1e-5)
    np.testing.assert_array_equal(hair.motion, square_itself.motion)
    assert warnings == []
    moving.particle_systems[0].use_hair_dynamics = True
    _, warnings, _ = export_as_a_render()
    assert [line.split(":")[0] for line in warnings] == ["Moving"]
