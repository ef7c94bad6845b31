# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/nodes.md: what becomes of every shader node that Blender has.

    python -m blender_tests.against_cycles.node_states

with Python 3.13, which has Blender 5.2 as a module. Whether a node is translated is read from the exporter itself; what
is said of it beyond that stands here.
"""

from pathlib import Path

import bpy

from addon.export import volumes
from addon.export.nodes import Translation
from addon.export.values import FUNCTIONS

TARGET = Path(__file__).parents[2] / "docs" / "nodes.md"
HEAD = """# Shader nodes

What becomes of every shader node of Blender {version} that can be rendered by Cycles or stands in its menus. "full": as
in Cycles; "partly": all but what is said beside it, which is reported when a material uses it, but for what is told
below the table. Nodes that are not rendered have a stand-in, and a warning that names material and node.
Hair that emits light is found by chance only: few bright strands leave much noise.
Written by `python -m blender_tests.against_cycles.node_states`.

| node | state | what is different |
|---|---|---|
"""
TAIL = """
## Rough glass

By Multiscatter GGX, white glass of any roughness gives back all light. In Cycles it does so from outside; of light that
leaves it at roughness 0.4 and above some is lost at grazing angles, so a ball of roughness 1 is 1 % darker.

## Tangents of displaced meshes

Normal maps and the Tangent node use tangents from before the mesh was moved. In Cycles only normal maps whose Base is
Original do so. By Displaced, the default, normals differ a little: the light of a displaced ball by 0.008 (median).

## Blender 4.5

Nodes mean what Cycles of the same Blender makes of them. In 4.5 the Voronoi texture has other points; tangent space of
normal maps stands on normals as long as interpolation leaves them; and normals of smooth faces are not split from flat
ones beside them. Where Cycles 4.5 is in error and that of 5.2 no longer is, it is as in 5.2:

- a velvet Sheen BSDF whose normal is bent is black in light from below the smooth surface;
- colours of image files of bytes in other spaces than sRGB are converted in full (Cycles 4.5 rounds them before, and is
  off by up to 1.3 %);
- colours of IRIS, WebP and JPEG 2000 files that have an alpha channel are multiplied by it, as those of PNG files are.
"""
# What is left out of nodes that are translated
PARTLY = {
    "BSDF_HAIR_PRINCIPLED": "by the Huang model, cross-sections are round",
    "BSDF_RAY_PORTAL": "transparent instead",
    "EEVEE_SPECULAR": "a Principled BSDF instead; Cycles does not render it at all",
    "LIGHT_PATH": "portals: 0; what samples a lamp or a world sees a depth of 0",
    "MATERIAL_RAYCAST": "attributes of what is hit are 0",
    "TEX_IMAGE": "Cineon files, and alpha modes that do not fit the file: as Blender reads them",
    "PRINCIPLED_VOLUME": "attributes of volumes count as 1",
    "OUTPUT_MATERIAL": "the exporter reports what it leaves out of volume and displacement",
    "SHADERTORGB": "as in Cycles, which renders none: the value of the socket that it is linked to",
    "SQUEEZE": "as in Blender's own engines; Cycles does not render it at all",
    "NORMAL_MAP": "tangents of displaced meshes, see below",
    "OUTPUT_AOV": "no passes of one's own",
}
SEEN_THROUGH = {"GROUP", "GROUP_INPUT", "GROUP_OUTPUT", "REROUTE", "FRAME"}
OUTPUTS = {"OUTPUT_MATERIAL", "OUTPUT_WORLD", "OUTPUT_LIGHT"}
OF_BLENDER = {"Closure Input", "Closure Output", "Evaluate Closure"}  # resolved before the exporter looks


def text():
    """The page."""
    rows = sorted(f"| {label} | {state} | {note} |" for label, state, note in map(row, node_classes()))
    return HEAD.format(version=bpy.app.version_string) + "\n".join(rows) + "\n" + TAIL


def node_classes():
    """(type, label) of the nodes that a material can hold, and of those that worlds and lights have beside them."""
    return {node.type: (node.type, node.bl_rna.name) for node in all_nodes()}.values()


def giving_values():
    """Labels of the nodes that have an output for something else than a shader, groups aside."""
    giving = (node for node in all_nodes("ShaderNode") if any(output.type != "SHADER" for output in node.outputs))
    return {node.bl_rna.name for node in giving if node.type not in SEEN_THROUGH}


def all_nodes(*kinds):
    """A node of each class whose name begins so, one after the other."""
    kinds = kinds or ("ShaderNode", "NodeRepeat", "NodeClosure", "NodeMenuSwitch", "NodeEvaluate")
    tree = bpy.data.node_groups.new("All nodes", "ShaderNodeTree")
    try:
        for name in filter(lambda name: name.startswith(kinds), dir(bpy.types)):
            try:
                yield tree.nodes.new(name)
            except RuntimeError:  # a base class, or of another kind of tree
                continue
            tree.nodes.clear()
    finally:
        bpy.data.node_groups.remove(tree)


def row(told):
    """(label, state, note) of a node's type and label."""
    kind, label = told
    note = PARTLY.get(kind, "")
    if kind in SEEN_THROUGH or kind in OUTPUTS or label in OF_BLENDER:
        return label, "partly" if note else "full", note
    translators = [value for value in (Translation, *vars(volumes).values()) if isinstance(value, type)]
    if kind in FUNCTIONS or any(hasattr(translator, f"_{kind.lower()}") for translator in translators):
        if note.endswith("instead") or "instead;" in note:
            return label, "stand-in", note
        return label, "partly" if note else "full", note
    return label, "stand-in", note or "the value of the socket that it is linked to; a shader is black"


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")
