# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of Blender's own panels stay visible while Lambent is the engine.

A panel lists the engines that it is for in `COMPAT_ENGINES`; other engines may add themselves.
"""

import bpy

from .panel import ENGINE

# Panels for any engine that we have another one for, or that would be empty or promise what there is not.
REPLACED = {
    "DATA_PT_falloff_curve",
    "DATA_PT_light",
    "DATA_PT_preview",
    "MATERIAL_PT_preview",
    "NODE_DATA_PT_light",
    "NODE_DATA_PT_spot",
    "OBJECT_PT_shading",
    "RENDER_PT_simplify",
    "RENDER_PT_simplify_greasepencil",
    "RENDER_PT_simplify_render",
    "RENDER_PT_simplify_viewport",
    "VIEWLAYER_PT_filter",
    "VIEWLAYER_PT_layer_passes",
}
# Panels for EEVEE and Workbench that show exactly what Lambent reads too.
BORROWED = {
    "DATA_PT_camera_dof",
    "DATA_PT_camera_dof_aperture",
    "DATA_PT_EEVEE_light",
    "DATA_PT_spot",
    "EEVEE_MATERIAL_PT_context_material",
}


def kept_panels():
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", ())
        if panel.__name__ in BORROWED or ("BLENDER_RENDER" in engines and panel.__name__ not in REPLACED):
            yield panel


def register():
    for panel in kept_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister():
    for panel in bpy.types.Panel.__subclasses__():
        if not panel.__module__.startswith(__package__):  # ours keep it, to come back with it
            getattr(panel, "COMPAT_ENGINES", set()).discard(ENGINE)
