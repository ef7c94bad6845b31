# SPDX-License-Identifier: GPL-3.0-or-later
"""How light is followed, how much work goes into a picture, and when it is enough."""

import bpy

from .copy_from_cycles import CopyFromCycles
from .panel import LambentPanel
from .visibility import SEEN_TYPES


class SamplingPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_RENDER_PT_sampling"
    bl_label = "Sampling"

    def draw(self, context):
        ours = context.scene.lambent
        column = self.column()
        column.prop(ours, "integrator")
        column.prop(ours, "samples")
        column.prop(ours, "viewport_samples")
        column.prop(ours, "noise_target")
        column.prop(ours, "time_limit")
        column.prop(ours, "use_adaptive")
        guiding = column.row()
        guiding.active = ours.integrator == "PATH"
        guiding.prop(ours, "use_guiding")
        column.prop(ours, "sampler")
        row = column.row(align=True)
        row.prop(ours, "seed")
        row.prop(ours, "use_animated_seed", text="", icon="TIME")
        if CopyFromCycles.poll(context):
            column.operator(CopyFromCycles.bl_idname)


class ObjectSamplingPanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_OBJECT_PT_sampling"
    bl_label = "Sampling"
    bl_context = "object"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object and context.object.type in SEEN_TYPES

    def draw(self, context):
        column = self.column()
        column.active = context.scene.lambent.integrator == "MIXTURE"  # the only one that it makes a difference to
        column.prop(context.object.lambent, "aim")


CLASSES = (SamplingPanel, ObjectSamplingPanel)
