# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine as Blender sees it. What it does is in `final` and `viewport`."""

import sys

import bpy

from . import messages, result


class LambentRenderEngine(bpy.types.RenderEngine):
    bl_idname = "LAMBENT"
    bl_label = "Lambent"
    bl_use_preview = False  # no previews of materials yet: Blender draws its own icons
    bl_use_shading_nodes_custom = False  # or the Shader Editor stays shut
    bl_use_eevee_viewport = True  # EEVEE draws the Material Preview
    bl_use_postprocess = True  # compositor and sequencer run on the result
    bl_use_image_save = True

    # Blender makes an engine for each 3D view and each render, and throws some away at once: nothing begins here.
    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.viewport = None

    def update_render_passes(self, scene=None, renderlayer=None):
        result.register_passes(self, scene, renderlayer)

    def render(self, depsgraph):
        expected = ()
        try:
            from . import core, final  # here, since it loads numba; and inside, since it may fail

            expected = (core.SceneError,)
            final.render_view_layer(self, depsgraph)
        except Exception as error:
            messages.fail(self, error, expected)

    def view_update(self, context, depsgraph):
        try:
            from .viewport import Viewport

            if self.viewport is None:
                self.viewport = Viewport(self)
            self.viewport.update(context, depsgraph)
        except Exception as error:
            messages.show(self, error)

    def view_draw(self, context, depsgraph):
        try:
            if self.viewport is not None:
                self.viewport.draw(context, depsgraph)
        except Exception as error:
            messages.show(self, error)


def register():
    bpy.utils.register_class(LambentRenderEngine)


def unregister():
    if viewport := sys.modules.get(f"{__package__}.viewport"):  # once there was one
        viewport.close_all()
    if LambentRenderEngine.is_registered:
        bpy.utils.unregister_class(LambentRenderEngine)
