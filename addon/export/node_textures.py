# SPDX-License-Identifier: GPL-3.0-or-later
"""Texture nodes."""

import bpy

from ..core import graph, opcodes
from .images import export_image
from .node_inputs import vector_input
from .pixels import has_cover

Op, InputVector = opcodes.Op, opcodes.InputVector
ZERO3 = (0.0, 0.0, 0.0)
UNMOVED = (ZERO3, ZERO3, (1.0, 1.0, 1.0))


def _vector(values, node, groups, default):
    """The Vector input; where nothing is linked, what Blender takes for this texture. Old files and scripts may have
    moved it by a mapping of the node's own, which has no button any more."""
    if values.is_linked(node, groups, "Vector"):
        vector = values.vector(node, groups, "Vector")
    else:
        vector = vector_input(default)
    return _mapped(vector, node.texture_mapping)


def _mapped(vector, mapping):
    """A vector moved by a TexMapping: axes exchanged or left out, then as the Mapping node does it, then clamped."""
    axes = tuple(getattr(mapping, f"mapping_{axis}") for axis in "xyz")
    if axes != ("X", "Y", "Z"):
        parts = [0.0 if axis == "NONE" else graph.part(vector, "XYZ".index(axis)) for axis in axes]
        vector = graph.node(Op.COMBINE, *parts)
    own = (tuple(mapping.translation), tuple(mapping.rotation), tuple(mapping.scale))
    if own != UNMOVED:
        vector = graph.node(Op.MAPPING, vector, *own, mode=opcodes.Mapping[mapping.vector_type])
    for used, limit, operation in (
        (mapping.use_min, mapping.min, opcodes.VectorMath.MAXIMUM),
        (mapping.use_max, mapping.max, opcodes.VectorMath.MINIMUM),
    ):
        if used:
            vector = graph.part(graph.node(Op.VECTOR_MATH, vector, tuple(limit), ZERO3, 0.0, mode=operation), 0, 3)
    return vector


def _alpha_or_color(values, node, output, groups, result):
    return graph.part(result, 3) if output.identifier == "Alpha" else graph.part(result, 0, 3)


def _uses_alpha(node):
    """Whether colours are divided by alpha: as in Cycles, if somebody asks for alpha, and the image's is one."""
    return has_cover(node.image) and any(o.identifier == "Alpha" and o.is_linked for o in node.outputs)


def _image(values, node, output, groups):
    image = export_image(values, node, tiled=node.projection != "BOX")  # of tiles, box projection uses the first
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


# ---- Procedural textures ---------------------------------------------------------------------------------------------


def _dimensions(text):
    return int(text[0])


def _procedural(values, node, groups, op, vectors, numbers, mode):
    """A node of `op`: of its Vector, then of other vectors and numbers by identifier."""
    operands = [_vector(values, node, groups, InputVector.GENERATED)]
    operands += [values.color(node, groups, name) for name in vectors]
    operands += [values.number(node, groups, name) for name in numbers]
    return graph.node(op, *operands, mode=mode)


def _checker(values, node, output, groups):
    result = _procedural(values, node, groups, Op.CHECKER, ("Color1", "Color2"), ("Scale",), 0)
    return graph.part(result, 0, 3) if output.type == "RGBA" else graph.part(result, 3)


def _gradient(values, node, output, groups):
    return _procedural(values, node, groups, Op.GRADIENT, (), (), opcodes.Gradient[node.gradient_type])


def _magic(values, node, output, groups):
    numbers = ("Scale", "Distortion")
    result = _procedural(values, node, groups, Op.MAGIC, (), numbers, node.turbulence_depth)
    return result if output.type == "RGBA" else graph.node(Op.AVERAGE, result)


def _white_noise(values, node, output, groups):
    vector, w = values.vector(node, groups, "Vector"), values.number(node, groups, "W")
    result = graph.node(Op.WHITE_NOISE, vector, w, mode=_dimensions(node.noise_dimensions))
    return graph.part(result, 0, 3) if output.type == "RGBA" else graph.part(result, 3)


def _brick(values, node, output, groups):
    names = ("Scale", "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")
    vector = _vector(values, node, groups, InputVector.GENERATED)
    colors = [values.color(node, groups, name) for name in ("Color1", "Color2", "Mortar")]
    numbers = [values.number(node, groups, name) for name in names]
    every = (min(n, opcodes.MOST_EVERY - 1) for n in (node.offset_frequency, node.squash_frequency))
    mode = sum(n * factor for n, factor in zip(every, (1, opcodes.MOST_EVERY), strict=True))
    result = graph.node(Op.BRICK, vector, *colors, *numbers, float(node.offset), float(node.squash), mode=mode)
    return graph.part(result, 0, 3) if output.type == "RGBA" else graph.part(result, 3)


def _wave(values, node, output, groups):
    numbers = ("Scale", "Distortion", "Detail", "Detail Scale", "Detail Roughness", "Phase Offset")
    direction = node.bands_direction if node.wave_type == "BANDS" else node.rings_direction
    mode = opcodes.WaveKind[node.wave_type] + 2 * opcodes.WaveDirection[direction]
    mode += 8 * opcodes.WaveProfile[node.wave_profile]
    return _procedural(values, node, groups, Op.WAVE, (), numbers, mode)


def _noise(values, node, output, groups):
    numbers = ("W", "Scale", "Detail", "Roughness", "Lacunarity", "Offset", "Gain", "Distortion")
    mode = _dimensions(node.noise_dimensions) + 8 * opcodes.NoiseKind[node.noise_type] + 64 * int(node.normalize)
    is_color = output.type == "RGBA"
    result = _procedural(values, node, groups, Op.NOISE, (), numbers, mode + 128 * int(is_color))
    return graph.part(result, 0, 3) if is_color else graph.part(result, 3)


def _voronoi(values, node, output, groups):
    numbers = ("W", "Scale", "Detail", "Roughness", "Lacunarity", "Smoothness", "Exponent", "Randomness")
    mode = _dimensions(node.voronoi_dimensions) + 8 * opcodes.VoronoiFeature[node.feature]
    mode += 64 * opcodes.VoronoiMetric[node.distance] + 256 * int(node.normalize)
    op = Op.VORONOI_OF_4 if bpy.app.version < (5, 0) else Op.VORONOI
    result = _procedural(values, node, groups, op, (), numbers, mode)
    parts = {"Distance": (0, 1), "Color": (1, 3), "Position": (4, 3), "W": (7, 1), "Radius": (8, 1)}
    return graph.part(result, *parts[output.identifier])


def _gabor(values, node, output, groups):
    vector = _vector(values, node, groups, InputVector.GENERATED)
    names = ("Scale", "Frequency", "Anisotropy", "Orientation 2D")
    numbers = [values.number(node, groups, name) for name in names]
    orientation = values.vector(node, groups, "Orientation 3D")
    result = graph.node(Op.GABOR, vector, *numbers, orientation, mode=_dimensions(node.gabor_type))
    return graph.part(result, ("Value", "Phase", "Intensity").index(output.identifier))


FUNCTIONS = {
    "TEX_IMAGE": _image,
    "TEX_ENVIRONMENT": _environment,
    "TEX_CHECKER": _checker,
    "TEX_GRADIENT": _gradient,
    "TEX_MAGIC": _magic,
    "TEX_WHITE_NOISE": _white_noise,
    "TEX_BRICK": _brick,
    "TEX_WAVE": _wave,
    "TEX_NOISE": _noise,
    "TEX_VORONOI": _voronoi,
    "TEX_GABOR": _gabor,
}
