# SPDX-License-Identifier: GPL-3.0-or-later
"""What becomes of light on the film."""

import bpy

from .panel import LambentPanel


class FilmPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_RENDER_PT_film"
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        ours = context.scene.lambent
        column = self.column()
        column.prop(ours, "exposure")
        column.prop(context.scene.render, "film_transparent")
        column.separator()
        column.prop(ours, "filter_type")
        if ours.filter_type != "BOX":
            column.prop(ours, "filter_width", text="Width")
            column.prop(ours, "use_shared_samples")


CLASSES = (FilmPanel,)
