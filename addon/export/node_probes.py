# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that look around a place: Ambient Occlusion, Bevel, Raycast; and Wireframe."""

from ..core import graph, opcodes
from .node_inputs import vector_input

Op, InputVector = opcodes.Op, opcodes.InputVector
ZERO3 = (0.0, 0.0, 0.0)
RAYCAST = {  # first float, floats
    "Is Hit": (0, 1),
    "Self Hit": (1, 1),
    "Hit Distance": (2, 1),
    "Hit Position": (3, 3),
    "Hit Normal": (6, 3),
}


def _ambient_occlusion(values, node, output, groups):
    distance = values.number(node, groups, "Distance")
    if graph.is_constant(distance) and distance == 0.0:
        world = values.context.scene.world
        distance = world.light_settings.distance if world else 10.0
    mode = (opcodes.ONLY_LOCAL if node.only_local else 0) + (opcodes.INSIDE if node.inside else 0)
    normal = values.normal_or_none(node, groups) or ZERO3
    share = graph.node(Op.OCCLUSION, distance, normal, float(node.samples), mode=mode)
    return share if output.identifier == "AO" else graph.scaled(values.color(node, groups, "Color"), share)


def _bevel(values, node, output, groups):
    normal = values.normal_or_none(node, groups) or ZERO3
    return graph.node(Op.BEVEL, values.number(node, groups, "Radius"), normal, float(node.samples))


def _raycast(values, node, output, groups):
    if output.identifier not in RAYCAST:
        values.warn(node, f"{output.name}: attributes of what is hit are not rendered yet; using 0")
        return 0.0 if output.type == "VALUE" else ZERO3
    position, direction = (
        values.vector(node, groups, name) if values.is_linked(node, groups, name) else vector_input(kind)
        for name, kind in (("Position", InputVector.POSITION), ("Direction", InputVector.NORMAL))
    )
    reach = values.number(node, groups, "Length")
    return graph.part(
        graph.node(Op.RAYCAST, position, direction, reach, mode=int(node.only_local)), *RAYCAST[output.identifier]
    )


def _wireframe(values, node, output, groups):
    return graph.node(Op.WIREFRAME, values.number(node, groups, "Size"), mode=int(node.use_pixel_size))


FUNCTIONS = {
    "AMBIENT_OCCLUSION": _ambient_occlusion,
    "BEVEL": _bevel,
    "MATERIAL_RAYCAST": _raycast,
    "WIREFRAME": _wireframe,
}
