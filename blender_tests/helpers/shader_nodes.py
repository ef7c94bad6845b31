# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials made of shader nodes by hand, and what the export makes of them. For tests that run where bpy is."""

import bpy
import pytest

from addon.core import SceneBuilder
from addon.export import Report, nodes
from addon.export.context import Context

from .exported import empty_scene

COLOR, RGB = (0.1, 0.2, 0.4, 1.0), (0.1, 0.2, 0.4)


def material_tree():
    """The node tree of a material with nothing but an output, in an empty scene."""
    empty_scene()
    b_material = bpy.data.materials.new("Material")
    if bpy.app.version < (5, 0):
        b_material.use_nodes = True
    b_material.node_tree.nodes.clear()
    b_material.node_tree.nodes.new("ShaderNodeOutputMaterial")
    return b_material.node_tree


def node(tree, kind, **inputs):
    """A new node; values of its inputs by identifier, blanks as underscores."""
    new = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        socket(new, name.replace("_", " ")).default_value = value
    return new


def socket(b_node, identifier):
    return next(s for s in b_node.inputs if s.identifier == identifier)


def link(tree, source, target, identifier="Surface", output=0):
    tree.links.new(source.outputs[output], socket(target, identifier))


def output_node(tree):
    return next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")


def translated(b_material=None):
    """(closure, warnings) of a material, read from the evaluated scene as an export does."""
    b_material = b_material or bpy.data.materials["Material"]
    b_material.use_fake_user = True
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    report = Report()
    context = Context(depsgraph, report, SceneBuilder(), 64, 48)
    return nodes.material_surface(context, b_material), report.warnings


def surface(tree, b_node):
    """Closure of a node that is linked to the output, without any warning."""
    link(tree, b_node, output_node(tree))
    closure, warnings = translated()
    assert warnings == []
    return closure


def close(closure):
    """Numbers of a closure that can be compared."""
    return {k: pytest.approx(v) if not isinstance(v, bool) else v for k, v in numbers(closure).items()}


def numbers(closure):
    """Fields of a closure but its tangent, which is a node wherever there is anisotropy."""
    return {name: value for name, value in vars(closure).items() if name != "tangent"}
