# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of Blender made at random: all shader nodes, linked anyhow, set to anything. Where bpy is."""

import contextlib

import bpy
import numpy as np

from .exported import add, empty_scene, export, square
from .programs import faults_of_picture

RARELY = {"ShaderNodeVolumePrincipled", "ShaderNodeVolumeScatter", "ShaderNodeVolumeAbsorption"}
NEVER = {"ShaderNodeScript", "ShaderNodeGroup", "ShaderNodeCustomGroup", "ShaderNodeTree"}
MOST_DETAIL = 15.0
NUMBERS = [0.0, 1.0, -1.0, 0.3, 1e-20, 1e20, 7.7, -4.2]


def node_kinds():
    """Names of all shader nodes of this Blender."""
    kinds = (getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("ShaderNode"))
    return sorted({k.__name__ for k in kinds if issubclass(k, bpy.types.ShaderNode)} - NEVER - {"ShaderNode"})


def faults_of_tree(seed, size=30, volumes=True):
    """What is wrong with what is exported and rendered of random trees of a material, a lamp and the world."""
    rng, scene = np.random.default_rng(seed), empty_scene()
    scene.camera.location = (0.0, 0.0, 3.0)
    b_square, b_lamp = square(), bpy.data.lights.new("Lamp", str(rng.choice(["POINT", "SUN", "SPOT", "AREA"])))
    b_square.uv_layers.new(name="UVMap")
    b_square.materials.append(bpy.data.materials.new("Material"))
    add("Lamp", b_lamp, location=(1.0, 1.0, 2.0))
    add("Square", b_square)
    scene.world = bpy.data.worlds.new("World")
    image = bpy.data.images.new("Image", 4, 4)
    fills = [("Material", b_square.materials[0], size), ("World", scene.world, size // 3), ("Light", b_lamp, size // 3)]
    for output, owner, count in fills:
        if bpy.app.version < (5, 0) or owner.node_tree is None:
            owner.use_nodes = True
        fill(rng, owner.node_tree, output, count, image, volumes)
    builder, _ = export((8, 8))
    return faults_of_picture(builder.build())


def fill(rng, tree, output, size, image, volumes):
    tree.nodes.clear()
    kinds = node_kinds()
    for _ in range(size):
        kind = str(rng.choice(kinds))
        if kind in RARELY and not (volumes and rng.random() < 0.2):
            continue
        b_node = tree.nodes.new(kind)
        for p in b_node.bl_rna.properties:
            if not p.is_readonly and p.identifier not in bpy.types.Node.bl_rna.properties:
                choose(rng, b_node, p, image)
        for socket in b_node.inputs:
            if hasattr(socket, "default_value") and rng.random() < 0.5:
                choose(rng, socket, socket.bl_rna.properties["default_value"], image)
                if socket.name == "Detail":  # Blender, where it computes constants, and Cycles with it add all octaves
                    socket.default_value = min(socket.default_value, MOST_DETAIL)
    tree.nodes.new(f"ShaderNodeOutput{output}").is_active_output = rng.random() < 0.9  # some are of another kind
    wired = list(tree.nodes)  # each to some of the last ones before it; a few to any, which makes rings
    for number, b_node in enumerate(wired):
        before = wired if rng.random() < 0.1 else wired[max(0, number - 5) : number]
        ends = [s for n in before for s in n.outputs if s.enabled]
        for socket in b_node.inputs:
            of_its_kind = [s for s in ends if (s.type == "SHADER") == (socket.type == "SHADER")]
            is_wanted = socket.name != "Volume" or (volumes and rng.random() < 0.2)
            if of_its_kind and is_wanted and rng.random() < (0.9 if socket.type == "SHADER" else 0.8):
                tree.links.new(of_its_kind[rng.integers(len(of_its_kind))], socket)


def choose(rng, owner, p, image):
    """Set a property to anything that it may be."""
    if p.type == "ENUM" and not p.is_enum_flag:
        values = [item.identifier for item in p.enum_items]
    elif p.type == "BOOLEAN" and not p.is_array:
        values = [False, True]
    elif p.type == "INT" and not p.is_array:
        values = [p.hard_min, p.default, min(p.hard_max, 3)]
    elif p.type == "FLOAT":
        numbers = rng.choice(NUMBERS, max(p.array_length, 1))
        values = [numbers.tolist() if p.is_array else float(numbers[0])]
    elif p.type == "POINTER" and p.identifier == "image":
        values = [image, None]
    else:
        return
    if values:
        with contextlib.suppress(TypeError, AttributeError):  # items that depend on what else is set
            setattr(owner, p.identifier, values[rng.integers(len(values))])
