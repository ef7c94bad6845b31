# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves while the shutter is open is as blurred in Lambent as in Cycles."""

from functools import partial
from math import radians

import bpy
import numpy as np
import pytest
from mathutils import Vector

from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with

SIZE, SAMPLES = (96, 64), 512
FRAME = 5

EXPOSURES = {
    "centred": {},
    "from the frame on": {"motion_blur_position": "START", "motion_blur_shutter": 0.8},
    "up to the frame": {"motion_blur_position": "END", "motion_blur_shutter": 1.5},
    "a shutter that opens slowly": {"curve": ((0.0, 0.0), (0.6, 1.0), (1.0, 0.0))},
}


def build(camera_moves=False, curve=None, **exposure):
    """Shining things that fly, turn, grow, and fly as parts of an instance, before a camera that may move, too."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 10
    scene.frame_set(FRAME)
    render = scene.render
    render.resolution_x, render.resolution_y = SIZE
    render.use_motion_blur, render.motion_blur_shutter = True, 1.0
    for name, value in exposure.items():
        setattr(render, name, value)
    if curve:
        points = render.motion_blur_shutter_curve.curves[0].points
        for point, place in zip(points, curve, strict=True):
            point.location, point.handle_type = place, "VECTOR"
        render.motion_blur_shutter_curve.update()

    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera, camera.location = camera, (0, 0, 12)
    if camera_moves:
        animate(camera, location=((-1, 0, 12), (1, 0.5, 11)), rotation_euler=((0, 0, -0.4), (0, 0.1, 0.4)))

    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.0)
    animate(shining((1.0, 0.2, 0.1)), location=((-4, 2, 0), (-2, 2.5, 0)))
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(0, 2, 0))
    animate(shining((0.1, 1.0, 0.2)), rotation_euler=((0, 0, 0), (0, 0, radians(80))))
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(3.5, 2, 0))
    animate(shining((0.2, 0.1, 1.0)), scale=((0.5, 1.0, 1.0), (3.0, 0.3, 1.0)))
    bpy.ops.mesh.primitive_cone_add(radius1=0.8, depth=1.0)
    cone = shining((0.7, 0.7, 0.1))
    inside = bpy.data.collections.new("Inside")
    inside.objects.link(cone)
    scene.collection.objects.unlink(cone)
    for x in (-4, -1, 2):
        instance = bpy.data.objects.new("Instance", None)
        instance.instance_type, instance.instance_collection = "COLLECTION", inside
        scene.collection.objects.link(instance)
        animate(instance, location=((x, -2, 0), (x + 1.5, -1.5, 0)), rotation_euler=((0, 0, 0), (1, 1, 0)))
    bpy.ops.mesh.primitive_cube_add(size=1.5, location=(4, -1.5, 0))
    shining((0.4, 0.4, 0.4))


def shining(color):
    """Let the active object shine."""
    b_object = bpy.context.object
    material = bpy.data.materials.new("Shine")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    emission.inputs["Color"].default_value = (*color, 1.0)
    links.new(emission.outputs[0], output.inputs["Surface"])
    b_object.data.materials.append(material)
    return b_object


def animate(b_object, **paths):
    """From one value a frame before to the other a frame after, at constant speed before, between and after."""
    for path, (first, last) in paths.items():
        first, last = Vector(first), Vector(last)
        for frame, value in (
            (FRAME - 3, first * 2 - last),
            (FRAME - 1, first),
            (FRAME + 1, last),
            (FRAME + 3, last * 2 - first),
        ):
            setattr(b_object, path, value)
            b_object.keyframe_insert(path, frame=frame)
    action = b_object.animation_data.action
    curves = action.layers[0].strips[0].channelbags[0].fcurves
    for curve in curves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


@pytest.mark.parametrize("camera_moves", [False, True], ids=["still camera", "moving camera"])
@pytest.mark.parametrize("exposure", EXPOSURES)
def test_movement_is_blurred_alike(exposure, camera_moves):
    source = partial(build, camera_moves, **EXPOSURES[exposure])
    theirs = cycles_picture(source, SAMPLES, SIZE)[..., :3]
    scene = open_for_both(source, SIZE)
    ours = render_with("LAMBENT", scene, SAMPLES)[0][..., :3]
    assert scene.frame_current == FRAME
    difference = (ours - theirs).astype(float)
    assert difference.std() < 0.01  # that of one pixel covered half of the time is 0.03, were samples independent
    assert np.abs(blocks(difference)).max() < 0.02  # five times that of a block of such pixels
    assert np.abs(difference.mean(axis=(0, 1))).max() < 5e-4


def blocks(picture, size=8):
    height, width, channels = picture.shape
    return picture.reshape(height // size, size, width // size, size, channels).mean(axis=(1, 3))
