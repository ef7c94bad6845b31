# SPDX-License-Identifier: GPL-3.0-or-later
"""Take over what a scene says to Cycles, once: nothing else here depends on Cycles."""

import bpy

from ..properties import FILTERS

# scene.cycles: scene.lambent
SAME_MEANING = {
    "samples": "samples",
    "preview_samples": "viewport_samples",
    "time_limit": "time_limit",
    "seed": "seed",
    "use_animated_seed": "use_animated_seed",
    "max_bounces": "max_bounces",
    "diffuse_bounces": "diffuse_bounces",
    "glossy_bounces": "glossy_bounces",
    "transmission_bounces": "transmission_bounces",
    "volume_bounces": "volume_bounces",
    "transparent_max_bounces": "transparent_max_bounces",
    "sample_clamp_direct": "clamp_direct",
    "sample_clamp_indirect": "clamp_indirect",
    "caustics_reflective": "caustics_reflective",
    "caustics_refractive": "caustics_refractive",
    "film_exposure": "exposure",
    "filter_width": "filter_width",
}


def copy_settings(b_scene):
    """Copy from `b_scene.cycles` to `b_scene.lambent`."""
    theirs, ours = b_scene.cycles, b_scene.lambent
    for their_name, our_name in SAME_MEANING.items():
        if hasattr(theirs, their_name):
            setattr(ours, our_name, getattr(theirs, their_name))
    if theirs.pixel_filter_type in {identifier for identifier, *_ in FILTERS}:
        ours.filter_type = theirs.pixel_filter_type
    for b_object in b_scene.objects:
        b_object.lambent.use_motion_blur = b_object.cycles.use_motion_blur
    ours.motion_steps = max((b_object.cycles.motion_steps for b_object in b_scene.objects), default=1)


class CopyFromCycles(bpy.types.Operator):
    bl_idname = "lambent.copy_from_cycles"
    bl_label = "Copy Settings from Cycles"
    bl_description = (
        "Take samples, bounces, clamping, seed, exposure, pixel filter and motion blur from the settings of Cycles"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return hasattr(context.scene, "cycles")  # only while the add-on Cycles is enabled

    def execute(self, context):
        copy_settings(context.scene)
        return {"FINISHED"}


CLASSES = (CopyFromCycles,)
