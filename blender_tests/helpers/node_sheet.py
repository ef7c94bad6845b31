# SPDX-License-Identifier: GPL-3.0-or-later
"""Many shader nodes in one picture: a sheet of tilted squares, each of which shines with what one node gives out.

Rendered by Lambent and by Cycles, with every sample in the middle of its pixel, the two are equal number by number.
"""

import math
import tempfile
from pathlib import Path

import bpy
import numpy as np

import addon

from .cycles import set_up_cycles
from .exported import empty_scene
from .small_blend import enable_cycles, render

CELL = 12  # pixels of a square's cell
MARGIN = 2  # pixels at the border of a cell that are not compared
FILTER_CELLS = 1024  # of Cycles' table, over a pixel: its first sample is half a cell beside the middle
TILT = (0.5, -0.35, 0.1)  # of the squares, so that no coordinate is the same all over one


def sheet(cases):
    """Make a scene with a square for each of `cases`, {name: function(tree) that gives an output socket}."""
    scene = empty_scene()
    columns = math.ceil(math.sqrt(len(cases)))
    rows = math.ceil(len(cases) / columns)
    scene.render.resolution_x, scene.render.resolution_y = columns * CELL, rows * CELL
    camera = scene.camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", max(columns, rows)
    camera.location = (columns / 2, rows / 2, 10)
    scene.view_settings.view_transform = "Standard"
    b_mesh = square_with_attributes()
    for number, (name, build) in enumerate(cases.items()):
        b_object = bpy.data.objects.new(name, b_mesh)
        scene.collection.objects.link(b_object)
        b_object.location = (number % columns + 0.5, number // columns + 0.5, 0.1 * (number % 7))
        b_object.rotation_euler, b_object.scale = TILT, (0.48, 0.48, 0.48)
        b_object.color, b_object.pass_index = (0.2, 0.4, 0.8, 0.5), number % 5
        material = bpy.data.materials.new(name)
        if bpy.app.version < (5, 0):
            material.use_nodes = True
        material.pass_index = 3
        b_object.material_slots[0].link = "OBJECT"
        b_object.material_slots[0].material = material
        tree = material.node_tree
        tree.nodes.clear()
        output, emission = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeEmission")
        tree.links.new(emission.outputs[0], output.inputs["Surface"])
        tree.links.new(build(tree), emission.inputs["Color"])
    return scene


def square_with_attributes():
    """A square of two triangles, with two UV maps, colours and a number, none of them linear in the others."""
    b_mesh = bpy.data.meshes.new("Square")
    b_mesh.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0.3), (-1, 1, 0)], [], [(0, 1, 2), (0, 2, 3)])
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)], np.float32)
    b_mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", corners.ravel())
    b_mesh.uv_layers.new(name="Second").uv.foreach_set("vector", (corners * (2.0, -0.7) + 0.1).astype("f4").ravel())
    colors = b_mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    colors.data.foreach_set("color", np.array([(1, 0, 0, 1), (0, 1, 0, 0.5), (0, 0, 1, 1), (1, 1, 0, 0)], "f4").ravel())
    b_mesh.attributes.new("Heat", "FLOAT", "POINT").data.foreach_set("value", [0.1, 0.9, 0.4, 2.0])
    b_mesh.materials.append(None)
    return b_mesh


def compared(cases, frame=1):
    """{name: (Lambent's pixels, Cycles' pixels)} of the middle of each square, float32 (n, n, 3)."""
    if not hasattr(bpy.types.Scene, "lambent"):
        addon.register()
    scene = sheet(cases)
    scene.frame_set(frame)
    with tempfile.TemporaryDirectory() as folder:
        scene.render.engine = "LAMBENT"
        scene.lambent.samples, scene.lambent.filter_type, scene.lambent.filter_width = 64, "BOX", 0.01
        ours = render(Path(folder, "lambent.exr"), scene)
        enable_cycles()
        set_up_cycles(scene, samples=1)
        scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
        aside = 0.5 / FILTER_CELLS / max(scene.render.resolution_x, scene.render.resolution_y)
        scene.camera.data.shift_x = scene.camera.data.shift_y = -aside
        theirs = render(Path(folder, "cycles.exr"), scene)
    columns = math.ceil(math.sqrt(len(cases)))
    cells = {}
    for number, name in enumerate(cases):
        x, y = (number % columns) * CELL, (number // columns) * CELL
        window = np.s_[y + MARGIN : y + CELL - MARGIN, x + MARGIN : x + CELL - MARGIN, :3]
        cells[name] = ours[window], theirs[window]
    return cells


def difference(ours, theirs):
    """Of a node's pixels, in relation to numbers above 1; of all but a twentieth of them: where a function jumps, a
    picture has what is on either side."""
    return np.quantile(np.abs(ours - theirs) / np.maximum(np.abs(theirs), 1.0), 0.95)


# ---- Making trees ----


def add(tree, kind, inputs=(), **properties):
    """A new node. `inputs`: {name or number: a value, or a socket to link}."""
    node = tree.nodes.new(f"ShaderNode{kind}")
    for key, value in properties.items():
        setattr(node, key, value)
    for key, value in dict(inputs).items():
        socket = node.inputs[key] if isinstance(key, int) else named(node.inputs, key)
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket)
        else:
            socket.default_value = value
    return node


def named(sockets, identifier):
    return next(s for s in sockets if s.identifier == identifier)


def position(tree, scale=2.0, offset=(0.3, -0.2, 0.1)):
    """Coordinates of the object, stretched: negative and positive, beyond -1 and 1."""
    coordinates = tree.nodes.new("ShaderNodeTexCoord").outputs["Object"]
    moved = add(tree, "VectorMath", {0: coordinates, 1: (scale,) * 3, 2: offset}, operation="MULTIPLY_ADD")
    return moved.outputs[0]


def shine(output, kind, scale=1.0, offset=0.0, inputs=(), **properties):
    """A material that shines with what an output of a node gives, times `scale`, plus `offset`."""
    b_material = bpy.data.materials.new(kind)
    if bpy.app.version < (5, 0):
        b_material.use_nodes = True
    tree = b_material.node_tree
    tree.nodes.clear()
    value = add(tree, kind, inputs, **properties).outputs[output]
    operands = {0: value, 1: (scale,) * 3, 2: (offset,) * 3}
    color = add(tree, "VectorMath", operands, operation="MULTIPLY_ADD").outputs[0]
    emission = add(tree, "Emission", {0: color})
    tree.links.new(emission.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return b_material
