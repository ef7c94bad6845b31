# SPDX-License-Identifier: GPL-3.0-or-later
"""Less detail than the scene has. Blender's own panel for it would stand above Sampling."""

import bpy

from .panel import LambentPanel


class SimplifyPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_RENDER_PT_simplify"
    bl_label = "Simplify"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_simplify", text="")

    def draw(self, context):
        b_render = context.scene.render
        column = self.column(align=True)
        column.active = b_render.use_simplify
        column.prop(b_render, "simplify_subdivision", text="Max Subdivision Viewport")
        column.prop(b_render, "simplify_subdivision_render", text="Render")
        column.separator()
        column.prop(b_render, "simplify_child_particles", text="Child Particles Viewport")
        column.prop(b_render, "simplify_child_particles_render", text="Render")
        column.separator()
        column.prop(b_render, "use_simplify_normals", text="Viewport Normals")


CLASSES = (SimplifyPanel,)
