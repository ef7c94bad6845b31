# SPDX-License-Identifier: GPL-3.0-or-later
"""How the machine is used."""

import bpy

from .. import compile_cache
from .panel import LambentPanel


class PerformancePanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_RENDER_PT_performance"
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        b_render = context.scene.render
        column = self.column()
        column.prop(b_render, "threads_mode")
        threads = column.column()
        threads.enabled = b_render.threads_mode == "FIXED"
        threads.prop(b_render, "threads")
        column.prop(b_render, "use_lock_interface")
        if text := compile_cache.status():
            column.label(text=text, icon="SORTTIME" if compile_cache.is_busy() else "CHECKMARK")


CLASSES = (PerformancePanel,)
