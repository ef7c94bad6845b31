# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view layer keeps of a render, beside the picture."""

import bpy

from .panel import LambentPanel


class PassesPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_VIEWLAYER_PT_passes"
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        layer = context.view_layer
        column = self.column(heading="Include")
        column.prop(layer, "use_pass_z", text="Depth")
        column.prop(layer, "use_pass_position")
        column.prop(layer, "use_pass_normal")
        column.prop(layer.lambent, "use_pass_denoising_data")
        column.prop(layer.lambent, "use_pass_sample_count")


CLASSES = (PassesPanel,)
