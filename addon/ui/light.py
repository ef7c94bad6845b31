# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's own light panels lack."""

import bpy

from .panel import LambentPanel


class SpreadPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_LIGHT_PT_spread"
    bl_label = "Beam Shape"
    bl_context = "data"
    bl_parent_id = "DATA_PT_EEVEE_light"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.light and context.light.type == "AREA"

    def draw(self, context):
        self.column().prop(context.light, "spread")


CLASSES = (SpreadPanel,)
