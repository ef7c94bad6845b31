# SPDX-License-Identifier: GPL-3.0-or-later
"""Both engines see the same thing in the same pixel, in focus and out of it."""

from functools import partial

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with

WIDE, TALL, SAMPLES = (96, 64), (48, 80), 1024
POSE = Matrix.LocRotScale((1, -2, 3), Matrix.Rotation(0.9, 3, (0.6, 0.2, -0.77)), (1, 1, 1))

CAMERAS = {
    "wide": (WIDE, {}),
    "tall": (TALL, {}),
    "shifted": (WIDE, {"shift_x": 0.2, "shift_y": -0.15}),
    "shifted and tall": (TALL, {"shift_x": 0.2, "shift_y": -0.15}),
    "horizontal fit": (TALL, {"sensor_fit": "HORIZONTAL", "sensor_width": 24}),
    "vertical fit": (WIDE, {"sensor_fit": "VERTICAL", "sensor_height": 30}),
    "vertical fit, shifted": (WIDE, {"sensor_fit": "VERTICAL", "sensor_height": 30, "shift_x": 0.2}),
    "broad pixels": (WIDE, {"pixel_aspect": (1.8, 1.0), "shift_y": 0.1}),
    "high pixels": (WIDE, {"pixel_aspect": (1.0, 1.8), "shift_x": 0.1}),
    "orthographic": (WIDE, {"type": "ORTHO", "ortho_scale": 6.0, "shift_x": 0.1}),
    "orthographic, tall": (TALL, {"type": "ORTHO", "ortho_scale": 6.0, "shift_y": 0.1}),
    "scaled": (WIDE, {"scale": (2, 3, 0.5), "shift_x": 0.1}),
    "mirrored": (WIDE, {"scale": (-1, 1, 1), "shift_x": 0.1}),
}
OUT_OF_FOCUS = {
    "round": {},
    "five blades": {"aperture_blades": 5},
    "three turned blades": {"aperture_blades": 3, "aperture_rotation": 0.6},
    "anamorphic": {"aperture_ratio": 2.0},
    "squeezed, turned blades": {"aperture_blades": 4, "aperture_rotation": 0.3, "aperture_ratio": 0.5},
    "focus object": {"focus_at": -3.0},
    "orthographic": {"type": "ORTHO", "ortho_scale": 4.0, "aperture_fstop": 1.3},
}


def add_camera(size, pixel_aspect=(1.0, 1.0), scale=(1, 1, 1), **properties):
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = pixel_aspect
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.matrix_world = POSE @ Matrix.LocRotScale(None, None, scale)
    for name, value in properties.items():
        setattr(camera.data, name, value)
    return camera


def add_ball(x, y, z, radius, strength):
    """A ball that shines, at a place relative to the camera."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=POSE @ Matrix.Translation((x, y, z)).translation)
    material = bpy.data.materials.new("Light")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    tree = material.node_tree
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Strength"].default_value = strength
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    bpy.context.object.data.materials.append(material)


def balls_in_view(name):
    size, properties = CAMERAS[name]
    add_camera(size, **properties)
    for x, y, z in ((0, 0, -6), (0.9, 0.5, -5), (-0.6, 0.9, -7), (-0.4, -0.5, -4), (1.1, -0.9, -8)):
        add_ball(x, y, z, radius=-0.02 * z, strength=1.0)


def one_ball_out_of_focus(name):
    properties = {"lens": 50, **OUT_OF_FOCUS[name]}
    aperture = {key: properties.pop(key) for key in list(properties) if key.startswith("aperture")}
    focus_at = properties.pop("focus_at", None)
    camera = add_camera(WIDE, **properties)
    dof = camera.data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 2.0, 0.05
    for key, value in aperture.items():
        setattr(dof, key, value)
    if focus_at:
        dof.focus_object = bpy.data.objects.new("Focus", None)
        bpy.context.scene.collection.objects.link(dof.focus_object)
        dof.focus_object.location = POSE @ Matrix.Translation((1, 1, focus_at)).translation
    add_ball(0.2, -0.1, -4, radius=0.1, strength=4.0)


def pictures(build):
    """(Lambent's, Cycles') grey picture of a scene, (height, width) each."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    build()
    size = bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y
    theirs = cycles_picture(build, SAMPLES, size)
    ours, _ = render_with("LAMBENT", open_for_both(build, size), SAMPLES)
    return ours[..., :3].mean(axis=-1, dtype=float), theirs[..., :3].mean(axis=-1, dtype=float)


def centroids(picture, places, reach=4):
    """Centres of brightness near `places`, (n, 2) as x, y in pixels."""
    result = []
    for x, y in places:
        ys = slice(max(int(y) - reach, 0), int(y) + reach + 1)
        xs = slice(max(int(x) - reach, 0), int(x) + reach + 1)
        light = picture[ys, xs]
        row, column = np.mgrid[ys, xs][:, : light.shape[0], : light.shape[1]]
        result.append(((light * column).sum() / light.sum(), (light * row).sum() / light.sum()))
    return np.array(result)


def blobs(picture):
    """Bright places that stand alone and away from the border, (n, 2) as x, y."""
    left, found = picture.copy(), []
    while left.max() > 0.3:
        y, x = np.unravel_index(left.argmax(), left.shape)
        left[max(y - 7, 0) : y + 8, max(x - 7, 0) : x + 8] = 0.0
        if 5 < x < picture.shape[1] - 6 and 5 < y < picture.shape[0] - 6:
            found.append((x, y))
    return found


@pytest.mark.parametrize("name", CAMERAS)
def test_every_ball_is_where_cycles_has_it(name):
    ours, theirs = pictures(partial(balls_in_view, name))
    places = blobs(theirs)
    assert len(places) >= 3
    assert centroids(ours, places) == pytest.approx(centroids(theirs, places), abs=0.1)


def moments(picture):
    """Mean x, y and spread xx, yy, xy of the light, in pixels."""
    y, x = np.mgrid[: picture.shape[0], : picture.shape[1]]
    weight = picture / picture.sum()
    mx, my = (weight * x).sum(), (weight * y).sum()
    dx, dy = x - mx, y - my
    return np.array([mx, my, (weight * dx * dx).sum(), (weight * dy * dy).sum(), (weight * dx * dy).sum()])


@pytest.mark.parametrize("name", OUT_OF_FOCUS)
def test_a_ball_out_of_focus_has_the_shape_of_the_aperture(name):
    ours, theirs = pictures(partial(one_ball_out_of_focus, name))
    assert ours.sum() == pytest.approx(theirs.sum(), rel=0.02)
    mean, spread = moments(ours)[:2], moments(ours)[2:]
    assert mean == pytest.approx(moments(theirs)[:2], abs=0.15)
    assert spread == pytest.approx(moments(theirs)[2:], abs=0.03 * moments(theirs)[2:4].max())
    assert moments(theirs)[2:4].max() > 9  # it is blurred, and by pixels

    def smooth(picture):
        return picture[: WIDE[1] // 4 * 4].reshape(WIDE[1] // 4, 4, WIDE[0] // 4, 4).mean(axis=(1, 3))

    assert abs(smooth(ours) - smooth(theirs)).sum() < 0.06 * smooth(theirs).sum()
