# SPDX-License-Identifier: GPL-3.0-or-later
"""Exporting the open scene in one line, and making things to export. For tests that run where bpy is."""

import bpy
import numpy as np

from addon.export import Report, export_scene

SIZE = (64, 48)


def empty_scene():
    """An empty file with nothing but a camera."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    return scene


def add(name, data, **properties):
    """A new object in the scene."""
    b_object = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(b_object)
    for key, value in properties.items():
        setattr(b_object, key, value)
    return b_object


def mesh(name, positions, faces, smooth=False):
    """A new mesh data-block."""
    b_mesh = bpy.data.meshes.new(name)
    b_mesh.from_pydata(positions, [], faces, shade_flat=not smooth)
    return b_mesh


def square(name="Square", smooth=False):
    """A mesh: a square of side 2 in the xy plane, front up."""
    return mesh(name, [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)], smooth)


def export(size=SIZE):
    """(builder, warnings) of the open scene as the viewport sees it."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    report = Report()
    builder, _ = export_scene(depsgraph, report, *size)
    return builder, report.warnings


class ExportingEngine(bpy.types.RenderEngine):
    """Exports where it should render."""

    bl_idname, bl_label = "LAMBENT_TEST_EXPORT", "Export"
    result = None

    def render(self, depsgraph):
        if depsgraph.scene.render.use_multiview:
            self.active_view_set("right")
        report = Report()
        builder, overrides = export_scene(depsgraph, report, self.resolution_x, self.resolution_y, self)
        ExportingEngine.result = builder, report.warnings, overrides


def export_as_a_render():
    """(builder, warnings, overrides) of the open scene as a final render sees it."""
    bpy.utils.register_class(ExportingEngine)
    try:
        bpy.context.scene.render.engine = ExportingEngine.bl_idname
        ExportingEngine.result = None
        bpy.ops.render.render()
    finally:
        bpy.utils.unregister_class(ExportingEngine)
    return ExportingEngine.result


def placement(builder, name):
    """The one thing of that name in the builder, and its geometry."""
    (found,) = [p for p in builder.placements if p.name == name]
    return found, builder.geometries[found.geometry]


def world_triangles(builder, name):
    """Corners in the world, (n, 3, 3)."""
    found, geometry = placement(builder, name)
    matrix = np.asarray(found.to_world)
    return geometry.positions[geometry.triangles] @ matrix[:3, :3].T + matrix[:3, 3]
