# SPDX-License-Identifier: GPL-3.0-or-later
"""How far light is followed, and what of it is left out."""

import bpy

from .panel import LambentPanel


class LightPathsPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_RENDER_PT_light_paths"
    bl_label = "Light Paths"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        pass


class BouncesPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_RENDER_PT_light_paths_bounces"
    bl_label = "Max Bounces"
    bl_parent_id = "LAMBENT_RENDER_PT_light_paths"

    def draw(self, context):
        ours = context.scene.lambent
        column = self.column(align=True)
        column.prop(ours, "max_bounces")
        for name in ("diffuse", "glossy", "transmission", "volume", "transparent_max"):
            column.prop(ours, f"{name}_bounces")
        column.separator()
        column.prop(ours, "min_bounces")


class ClampingPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_RENDER_PT_light_paths_clamping"
    bl_label = "Clamping"
    bl_parent_id = "LAMBENT_RENDER_PT_light_paths"

    def draw(self, context):
        column = self.column(align=True)
        column.prop(context.scene.lambent, "clamp_direct")
        column.prop(context.scene.lambent, "clamp_indirect")


class CausticsPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_RENDER_PT_light_paths_caustics"
    bl_label = "Caustics"
    bl_parent_id = "LAMBENT_RENDER_PT_light_paths"

    def draw(self, context):
        column = self.column(heading="Caustics")
        column.prop(context.scene.lambent, "caustics_reflective")
        column.prop(context.scene.lambent, "caustics_refractive")


CLASSES = (
    LightPathsPanel,
    BouncesPanel,
    ClampingPanel,
    CausticsPanel,
)
