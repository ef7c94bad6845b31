# SPDX-License-Identifier: GPL-3.0-or-later
"""What belongs to the machine, not to the scene."""

import bpy
from bpy.props import BoolProperty


class LambentPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    warm_up: BoolProperty(
        name="Compile in the Background",
        default=True,
        description="After an update, compile the kernels as soon as Blender has started, not with the first render",
    )

    def draw(self, context):
        self.layout.prop(self, "warm_up")


def preferences():
    """The add-on's preferences; their defaults where it runs from the sources, which Blender has no entry for."""
    addon = bpy.context.preferences.addons.get(__package__)
    return (addon and addon.preferences) or Defaults


class Defaults:
    warm_up = True


def register():
    bpy.utils.register_class(LambentPreferences)


def unregister():
    if LambentPreferences.is_registered:
        bpy.utils.unregister_class(LambentPreferences)
