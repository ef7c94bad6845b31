# SPDX-License-Identifier: GPL-3.0-or-later
"""Which rays see an object."""

import bpy

from .panel import LambentPanel

SEEN_TYPES = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD", "VOLUME", "LIGHT"}


class RayVisibilityPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_OBJECT_PT_ray_visibility"
    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object and context.object.type in SEEN_TYPES

    def draw(self, context):
        b_object = context.object
        column = self.column()
        column.prop(b_object, "visible_camera", text="Camera")
        column.prop(b_object, "visible_diffuse", text="Diffuse")
        column.prop(b_object, "visible_glossy", text="Glossy")
        column.prop(b_object, "visible_transmission", text="Transmission")
        if b_object.type != "LIGHT":
            column.prop(b_object, "visible_shadow", text="Shadow")


CLASSES = (RayVisibilityPanel,)
