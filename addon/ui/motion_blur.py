# SPDX-License-Identifier: GPL-3.0-or-later
"""How long the shutter is open, and what is blurred by it."""

import bpy

from .panel import LambentPanel
from .visibility import SEEN_TYPES


class MotionBlurPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_RENDER_PT_motion_blur"
    bl_label = "Motion Blur"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context):
        b_render = context.scene.render
        column = self.column()
        column.active = b_render.use_motion_blur
        column.prop(b_render, "motion_blur_position", text="Position")
        column.prop(b_render, "motion_blur_shutter")
        column.prop(context.scene.lambent, "motion_steps")


class ShutterCurvePanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_RENDER_PT_shutter_curve"
    bl_label = "Shutter Curve"
    bl_parent_id = MotionBlurPanel.bl_idname
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        b_render = context.scene.render
        self.layout.active = b_render.use_motion_blur
        self.layout.template_curve_mapping(b_render, "motion_blur_shutter_curve")


class ObjectMotionBlurPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_OBJECT_PT_motion_blur"
    bl_label = "Motion Blur"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object and context.object.type in SEEN_TYPES | {"CAMERA"}

    def draw(self, context):
        column = self.column()
        column.active = context.scene.render.use_motion_blur
        column.prop(context.object.lambent, "use_motion_blur")


CLASSES = (MotionBlurPanel, ShutterCurvePanel, ObjectMotionBlurPanel)
