# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an object is rendered as its mesh or as a perfect shape, and how its shadow sets in if it is smooth."""

import bpy

from .panel import LambentPanel


class ShapePanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_OBJECT_PT_shape"
    bl_label = "Shape"
    bl_context = "object"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object and context.object.type == "MESH"

    def draw(self, context):
        self.column().prop(context.object.lambent, "shape")


class TerminatorPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_OBJECT_PT_terminator"
    bl_label = "Shadow Terminator"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object and context.object.type != "LIGHT"

    def draw(self, context):
        column = self.column()
        column.prop(context.object, "shadow_terminator_geometry_offset", text="Geometry Offset")
        column.prop(context.object, "shadow_terminator_shading_offset", text="Shading Offset")


CLASSES = (ShapePanel, TerminatorPanel)
