# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur: where objects and the camera stand at times between the opening and the closing of the shutter.

Blender evaluates the scene at each of these times in place, so nothing of it may be kept from one to the next. Lamps
stand still, as in Cycles.
"""

import math
from contextlib import contextmanager

import numpy as np

from .camera import active_camera, placement

# Where the shutter opens, in parts of the time that it is open, beside the frame.
OPENS = {"START": 0.0, "CENTER": -0.5, "END": -1.0}
# Modifiers that move vertices as time goes by.
DEFORMING = {
    "ARMATURE",
    "CLOTH",
    "CURVE",
    "HOOK",
    "LATTICE",
    "MESH_CACHE",
    "MESH_DEFORM",
    "MESH_SEQUENCE_CACHE",
    "OCEAN",
    "SHRINKWRAP",
    "SOFT_BODY",
    "SURFACE_DEFORM",
    "WAVE",
}
SHUTTER_POINTS = 65  # at which the shutter's curve is read


def has_motion_blur(context):
    """Whether this render has it. Only an engine can move through time."""
    return context.engine is not None and context.scene.render.use_motion_blur


def is_blurred(b_object):
    """Whether the artist wants the object to be blurred where it moves."""
    return getattr(getattr(b_object, "lambent", None), "use_motion_blur", True)


def deforms(b_object):
    """Whether an object may change its shape, so far as its modifiers and shape keys tell."""
    keys = getattr(b_object.original.data, "shape_keys", None)
    moved = any(modifier.type in DEFORMING and modifier.show_render for modifier in b_object.modifiers)
    return moved or (keys is not None and keys.animation_data is not None)


def hair_deforms(b_object):
    """Whether the hair of its particle systems may change its shape."""
    return deforms(b_object) or any(b_system.use_hair_dynamics for b_system in b_object.particle_systems)


def note_placement(context, b_instance, b_source):
    """Remember what the next thing that is placed in the builder belongs to."""
    if context.placed is not None and is_blurred(b_source):
        context.placed.setdefault(key_of(b_instance), []).append(len(context.builder.placements))


@contextmanager
def middle_of_exposure(context):
    """Show the scene as it is when the shutter has been open for half of its time; afterwards as it is on the frame."""
    if not has_motion_blur(context):
        yield
        return
    frame = context.scene.frame_current + context.scene.frame_subframe
    if context.scene.render.motion_blur_position != "CENTER":
        _go_to(context, _time(context, frame, 0.5))
    context.placed = {}
    try:
        yield
        _export_motion(context, frame)
    finally:
        _go_to(context, frame)


def key_of(b_instance):
    """What names an instance at all times."""
    if not b_instance.is_instance:
        return b_instance.object.name_full
    b_source = b_instance.instance_object or b_instance.object
    return b_source.name_full, b_instance.parent.name_full, tuple(b_instance.persistent_id)


def _export_motion(context, frame):
    count = 2**context.scene.lambent.motion_steps + 1
    moments = []
    for number in range(count):
        _go_to(context, _time(context, frame, number / (count - 1)))
        moments.append((_camera_matrix(context), _object_matrices(context)))
    builder = context.builder
    if is_blurred(active_camera(context)):
        builder.camera_motion = np.array([camera for camera, _ in moments])
    for row, numbers in enumerate(context.placed.values()):
        for number in numbers:
            builder.placements[number].motion = np.array([matrices[row] for _, matrices in moments])
    _export_shutter(context)


def _camera_matrix(context):
    return placement(context, active_camera(context))[0]


def _object_matrices(context):
    """Where what was exported stands now, float64 (n, 4, 4); what is not there now, as it was exported."""
    keys = {key: row for row, key in enumerate(context.placed)}
    matrices = np.array([context.builder.placements[numbers[0]].to_world for numbers in context.placed.values()])
    for b_instance in context.depsgraph.object_instances:
        is_shown = b_instance.show_self or b_instance.show_particles
        row = keys.get(key_of(b_instance)) if is_shown else None
        if row is not None:
            matrices[row] = b_instance.matrix_world
    return matrices


def _export_shutter(context):
    """The curve by which the shutter opens and closes."""
    mapping = context.scene.render.motion_blur_shutter_curve
    mapping.initialize()
    times = np.linspace(0.0, 1.0, SHUTTER_POINTS)
    context.builder.shutter([mapping.evaluate(mapping.curves[0], time) for time in times])


def _time(context, frame, part):
    """The frame, with fractions, at which a part of the exposure is over."""
    render = context.scene.render
    return frame + (OPENS[render.motion_blur_position] + part) * render.motion_blur_shutter


def _go_to(context, time):
    frame = math.floor(time)
    context.engine.frame_set(frame, time - frame)
