# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader of a material and of the world, as a tree of nodes in the properties editor."""

import bpy
from bpy_extras.node_utils import find_node_input

from .panel import LambentPanel


def draw_surface(layout, node_tree):
    """The tree behind the Surface socket of the output that Cycles would take: nodes mean what they mean there."""
    output = node_tree.get_output_node("CYCLES") if node_tree else None
    if output is None:
        layout.label(text="No output node")
        return
    layout.use_property_split = True
    layout.template_node_view(node_tree, output, find_node_input(output, "Surface"))


class MaterialSurfacePanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_MATERIAL_PT_surface"
    bl_label = "Surface"
    bl_context = "material"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.material and not context.material.grease_pencil

    def draw(self, context):
        draw_surface(self.layout, context.material.node_tree)


class WorldSurfacePanel(LambentPanel, bpy.types.Panel):
    bl_idname = "LAMBENT_WORLD_PT_surface"
    bl_label = "Surface"
    bl_context = "world"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.world

    def draw(self, context):
        draw_surface(self.layout, context.world.node_tree)


CLASSES = (MaterialSurfacePanel, WorldSurfacePanel)
