# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame shows what Blender's own frame shows, to a fraction of a pixel."""

import math

import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

from blender_tests.helpers.exported import add, empty_scene, export, export_as_a_render
from engine_core.scene.checks import SceneError
from engine_core.tables import CameraKind

WIDE, TALL = (1920, 1080), (700, 1500)


@pytest.fixture(autouse=True)
def scene():
    return empty_scene()


def set_up(scene, size=WIDE, aspect=(1, 1), **properties):
    """Place the camera at random, and set its properties."""
    camera, render = scene.camera, scene.render
    render.resolution_x, render.resolution_y = size
    render.pixel_aspect_x, render.pixel_aspect_y = aspect
    camera.location, camera.rotation_euler = (1, -4, 2), (1.1, 0.2, 0.4)
    for name, value in properties.items():
        setattr(camera.data, name, value)
    bpy.context.view_layer.update()
    return camera


def pixels(row, points, size):
    """Where the exported camera sees points of the world, (n, 2) in pixels from the lower left."""
    to_world = np.vstack([row["to_world"].astype(float), [0, 0, 0, 1]])
    local = (np.linalg.inv(to_world) @ np.c_[points, np.ones(len(points))].T).T
    xy = local[:, :2] if row["kind"] == CameraKind.ORTHOGRAPHIC else local[:, :2] / -local[:, 2:3]
    left, right, bottom, top = row["screen"]
    return (xy - [left, bottom]) / [right - left, top - bottom] * size


def blenders_pixels(scene, camera, points, size):
    return np.array([world_to_camera_view(scene, camera, Vector(p))[:2] for p in points]) * size


def points_in_view(camera, count=50):
    local = np.random.default_rng(1).uniform([-3, -3, -9], [3, 3, -4], (count, 3))
    matrix = np.array(camera.matrix_world.normalized())
    return local @ matrix[:3, :3].T + matrix[:3, 3]


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("shift", [(0, 0), (0.3, -0.2)])
@pytest.mark.parametrize("size", [WIDE, TALL])
@pytest.mark.parametrize("sensor_fit", ["AUTO", "HORIZONTAL", "VERTICAL"])
@pytest.mark.parametrize("aspect", [(1, 1), (2, 1), (1, 1.7)])
def test_points_land_where_blender_has_them(scene, kind, shift, size, sensor_fit, aspect):
    camera = set_up(
        scene, size, aspect, type=kind, sensor_fit=sensor_fit, shift_x=shift[0], shift_y=shift[1], lens=35,
        sensor_width=30, sensor_height=20, ortho_scale=7,
    )  # fmt: skip
    points = points_in_view(camera)
    row = export(size)[0].camera_row[0]
    assert pixels(row, points, size) == pytest.approx(blenders_pixels(scene, camera, points, size), abs=0.02)


@pytest.mark.parametrize("scale", [(1, 1, 1), (3, 0.5, 2), (-1, 1, 1), (2, -2, 2)])
def test_scale_is_of_no_matter_but_mirroring_is(scene, scale):
    camera = set_up(scene, lens=35)
    camera.scale = scale
    bpy.context.view_layer.update()
    points = points_in_view(camera)
    row = export(WIDE)[0].camera_row[0]
    assert pixels(row, points, WIDE) == pytest.approx(blenders_pixels(scene, camera, points, WIDE), abs=0.02)


def test_the_engine_gives_the_same_camera(scene):
    set_up(scene, size=(64, 48), shift_x=0.1)
    alone, by_engine = export((64, 48))[0].camera_row, export_as_a_render()[0].camera_row
    for name in alone.dtype.names:
        assert by_engine[name] == pytest.approx(alone[name]), name


def test_each_eye_of_a_stereo_view_has_its_place(scene):
    camera = set_up(scene, size=(64, 48))
    scene.render.use_multiview = True
    camera.data.stereo.convergence_mode, camera.data.stereo.pivot = "PARALLEL", "CENTER"
    right_eye = export_as_a_render()[0].camera_row[0]
    offset = right_eye["to_world"][:, 3] - np.array(camera.matrix_world.translation)
    assert np.linalg.norm(offset) == pytest.approx(camera.data.stereo.interocular_distance / 2, rel=1e-4)
    assert offset @ right_eye["to_world"][:, 0] > 0


def test_without_depth_of_field_the_lens_is_a_point(scene):
    scene.camera.data.dof.aperture_fstop = 0.1
    assert export()[0].camera_row[0]["lens_radius"] == 0


def test_the_aperture_is_focal_length_over_f_number(scene):
    dof = set_up(scene, lens=80).data.dof
    dof.use_dof, dof.aperture_fstop, dof.focus_distance = True, 2.0, 3.5
    dof.aperture_blades, dof.aperture_rotation, dof.aperture_ratio = 6, 0.3, 1.5
    row = export()[0].camera_row[0]
    assert row["lens_radius"] == pytest.approx(0.080 / 2.0 / 2)  # a radius: half the diameter
    assert row["focus_distance"] == pytest.approx(3.5)
    assert (row["blades"], row["blade_rotation"], row["aperture_ratio"]) == (6, pytest.approx(0.3), pytest.approx(1.5))


def test_focus_on_an_object_is_measured_along_the_axis(scene):
    camera = set_up(scene)
    axes = np.array(camera.matrix_world.normalized())
    target = add("Target", None, location=axes[:3, 3] - 5 * axes[:3, 2] + 2 * axes[:3, 0])
    camera.data.dof.use_dof, camera.data.dof.focus_object = True, target
    assert export()[0].camera_row[0]["focus_distance"] == pytest.approx(5)


def test_focus_on_a_bone_is_on_the_bone(scene):
    camera = scene.camera
    camera.location = (0, 0, 10)  # looks down
    bpy.ops.object.armature_add()
    armature = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.data.edit_bones.new("Focus")
    bone.head, bone.tail = (0, 0, 4), (0, 0, 5)
    bpy.ops.object.mode_set(mode="OBJECT")
    dof = camera.data.dof
    dof.use_dof, dof.focus_object, dof.focus_subtarget = True, armature, "Focus"
    assert export()[0].camera_row[0]["focus_distance"] == pytest.approx(6)


def test_clipping_is_in(scene):
    set_up(scene, clip_start=0.25, clip_end=75)
    row = export()[0].camera_row[0]
    assert (row["clip_start"], row["clip_end"]) == (0.25, 75)


# ---- What is no camera -----------------------------------------------------------------------------------------------


def test_a_panorama_is_named_as_missing(scene):
    scene.camera.data.type = "PANO"
    builder, warnings = export()
    assert warnings == ["Camera: pano cameras are not rendered yet; using a perspective one"]
    assert builder.camera_row[0]["kind"] == CameraKind.PERSPECTIVE


def test_a_scene_without_a_camera_is_refused(scene):
    scene.camera = None
    with pytest.raises(SceneError, match="no camera"):
        export()


def test_a_lamp_as_a_camera_is_refused_by_name(scene):
    scene.camera = add("Lamp", bpy.data.lights.new("Lamp", "SPOT"))
    with pytest.raises(SceneError, match="Lamp"):
        export()


def test_a_camera_scaled_to_nothing_is_refused_by_name(scene):
    scene.camera.scale = (1, 0, 1)
    with pytest.raises(SceneError, match=r"Camera: .*scaled to 0"):
        export()


def test_field_of_view_is_that_of_the_lens(scene):
    """An anchor apart from Blender's own formulas: 36 mm of sensor behind 18 mm see 90 degrees."""
    set_up(scene, lens=18, sensor_width=36)
    left, right, _, _ = export(WIDE)[0].camera_row[0]["screen"]
    assert math.degrees(math.atan(right) - math.atan(left)) == pytest.approx(90, abs=1e-3)
