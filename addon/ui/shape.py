# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an object is rendered as its mesh or as a perfect shape."""

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


CLASSES = (ShapePanel,)
