# SPDX-License-Identifier: GPL-3.0-or-later
"""Texture nodes."""

from ..core import graph, opcodes
from .images import export_image
from .node_inputs import vector_input

Op, InputVector = opcodes.Op, opcodes.InputVector


def _vector(values, node, groups, default):
    """The Vector input; where nothing is linked, what Blender takes for this texture."""
    if values.is_linked(node, groups, "Vector"):
        return values.vector(node, groups, "Vector")
    return vector_input(default)


def _alpha_or_color(values, node, output, groups, result):
    return graph.part(result, 3) if output.identifier == "Alpha" else graph.part(result, 0, 3)


def _uses_alpha(node):
    """Whether colours are divided by alpha: as in Cycles, if somebody asks for alpha, and the image's is one."""
    image = node.image
    has_cover = image.alpha_mode not in ("CHANNEL_PACKED", "NONE") and not image.colorspace_settings.is_data
    return has_cover and any(o.identifier == "Alpha" and o.is_linked for o in node.outputs)


def _image(values, node, output, groups):
    image = export_image(values, node)
    mode = opcodes.Interpolation[node.interpolation] + 4 * opcodes.Extension[node.extension]
    mode += 16 * opcodes.Projection[node.projection]
    if node.image is not None and _uses_alpha(node):
        mode += opcodes.UNASSOCIATE
    vector = _vector(values, node, groups, InputVector.UV)
    result = graph.node(Op.IMAGE, vector, float(node.projection_blend), mode=mode, data=image)
    return _alpha_or_color(values, node, output, groups, result)


def _environment(values, node, output, groups):
    image = export_image(values, node)
    mode = opcodes.Interpolation[node.interpolation] + 16 * opcodes.Panorama[node.projection]
    vector = _vector(values, node, groups, InputVector.POSITION)
    result = graph.node(Op.ENVIRONMENT, vector, mode=mode, data=image)
    return _alpha_or_color(values, node, output, groups, result)


FUNCTIONS = {
    "TEX_IMAGE": _image,
    "TEX_ENVIRONMENT": _environment,
}
