# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera: where it stands, what its frame shows, and its lens."""

from dataclasses import dataclass

import numpy as np

from ..core import SceneError

MM = 1e-3  # lenses and sensors are in millimetres
SMALLEST_FSTOP = 1e-5  # as in Cycles
SMALLEST_FOCUS = 1e-5  # metres; a lens cannot focus on itself


@dataclass
class Frame:
    """The whole picture: its size in pixels and the shape of a pixel."""

    width: int
    height: int
    aspect_x: float = 1.0
    aspect_y: float = 1.0


def export_camera(context):
    b_object = active_camera(context)
    b_camera, render = b_object.data, context.scene.render
    if b_camera.type not in ("PERSP", "ORTHO"):
        context.warn(b_object.name, f"{b_camera.type.lower()} cameras are not rendered yet; using a perspective one")
    to_world, shift_x = placement(context, b_object)
    frame = Frame(context.width, context.height, render.pixel_aspect_x, render.pixel_aspect_y)
    context.builder.camera(
        to_world,
        screen(b_camera, frame, shift_x),
        kind="ORTHOGRAPHIC" if b_camera.type == "ORTHO" else "PERSPECTIVE",
        clip_start=b_camera.clip_start,
        clip_end=b_camera.clip_end,
        **lens(b_camera, to_world),
    )


def active_camera(context):
    b_object = context.engine.camera_override if context.engine else None
    b_object = b_object or context.scene.camera
    if b_object is None:
        raise SceneError("The scene has no camera")
    if b_object.type != "CAMERA":
        raise SceneError(f"{b_object.name}: is the scene's camera, but it is a {b_object.type.lower()}")
    return b_object.evaluated_get(context.depsgraph)


def placement(context, b_object):
    """Camera to world without scale, float64 (4, 4), and the horizontal shift; by the engine, which knows the eye of
    a stereo view."""
    if context.engine:
        to_world, shift_x = context.engine.camera_model_matrix(b_object), context.engine.camera_shift_x(b_object)
    else:
        to_world, shift_x = b_object.matrix_world, b_object.data.shift_x
    to_world = np.array(to_world, np.float64)
    lengths = np.linalg.norm(to_world[:3, :3], axis=0)
    if not lengths.all():
        raise SceneError(f"{b_object.name}: the camera, or a parent of it, is scaled to 0")
    to_world[:3, :3] /= lengths
    return to_world, shift_x


def screen(b_camera, frame, shift_x):
    """Left, right, bottom, top of the frame: at distance 1 of a perspective camera, in metres of an orthographic one.

    The sensor is fitted to one side of the frame, to the longer one if left to itself; the other side follows from the
    frame's proportions. Shifts are in units of the fitted side. (With AUTO the sensor's width counts even where it is
    fitted to the frame's height: that is how Blender has it.)
    """
    width, height = frame.width * frame.aspect_x, frame.height * frame.aspect_y
    horizontal = width >= height if b_camera.sensor_fit == "AUTO" else b_camera.sensor_fit == "HORIZONTAL"
    if b_camera.type == "ORTHO":
        fitted = b_camera.ortho_scale
    else:
        sensor = b_camera.sensor_height if b_camera.sensor_fit == "VERTICAL" else b_camera.sensor_width
        fitted = sensor / b_camera.lens
    half = fitted / 2.0 / (width if horizontal else height)  # of one unit of the frame
    x, y = shift_x * fitted, b_camera.shift_y * fitted
    return (x - half * width, x + half * width, y - half * height, y + half * height)


def lens(b_camera, to_world):
    """Depth of field: radius of the aperture in metres, its shape, and the distance in focus along the axis."""
    dof = b_camera.dof
    if not dof.use_dof:
        return {}
    fstop = max(dof.aperture_fstop, SMALLEST_FSTOP)
    # an orthographic camera has no focal length; Cycles takes one metre
    focal_length = 1.0 if b_camera.type == "ORTHO" else b_camera.lens * MM
    return {
        "lens_radius": focal_length / (2.0 * fstop),
        "focus_distance": max(_focus_distance(dof, to_world), SMALLEST_FOCUS),
        "blades": dof.aperture_blades,
        "blade_rotation": dof.aperture_rotation,
        "aperture_ratio": dof.aperture_ratio,
    }


def _focus_distance(dof, to_world):
    if dof.focus_object is None:
        return dof.focus_distance
    target = dof.focus_object.matrix_world
    bone = dof.focus_object.pose.bones.get(dof.focus_subtarget) if dof.focus_object.pose else None
    if bone:
        target = target @ bone.matrix
    away = to_world[:3, 3] - np.array(target.translation)
    return abs(float(away @ to_world[:3, 2]))
