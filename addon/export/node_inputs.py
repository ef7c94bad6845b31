# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that tell where a ray hit what: coordinates, geometry, attributes, the object, the ray, and bent normals."""

import math

import bpy
import numpy as np

from ..core import graph, opcodes
from . import attributes, instance_values
from .graph import by_identifier

Op, InputVector, InputNumber = opcodes.Op, opcodes.InputVector, opcodes.InputNumber
ZERO3 = (0.0, 0.0, 0.0)


def vector_input(kind):
    return graph.node(Op.INPUT_VECTOR, mode=kind)


def number_input(kind):
    return graph.node(Op.INPUT_NUMBER, mode=kind)


def attribute(name, size=3, offset=0):
    return graph.part(graph.node(Op.ATTRIBUTE, data=name), offset, size)


def instance_value(values, name, size=3, offset=0):
    """What the whole instance has by that name."""
    values.context.value_names.add(name)
    return graph.part(graph.node(Op.INSTANCE_VALUE, data=name), offset, size)


COORDINATES = {
    "Generated": InputVector.GENERATED,
    "Normal": InputVector.OBJECT_NORMAL,
    "UV": InputVector.UV,
    "Object": InputVector.OBJECT,
    "Camera": InputVector.CAMERA,
    "Window": InputVector.WINDOW,
    "Reflection": InputVector.REFLECTION,
}
GEOMETRY = {
    "Position": InputVector.POSITION,
    "Normal": InputVector.NORMAL,
    "True Normal": InputVector.TRUE_NORMAL,
    "Incoming": InputVector.INCOMING,
    "Parametric": InputVector.PARAMETRIC,
    "Tangent": InputVector.RADIAL_TANGENT,
}
OBJECT = {
    "Location": InputVector.OBJECT_LOCATION,
    "Color": InputVector.OBJECT_COLOR,
    "Alpha": InputNumber.OBJECT_ALPHA,
    "Object Index": InputNumber.OBJECT_INDEX,
    "Material Index": InputNumber.MATERIAL_INDEX,
    "Random": InputNumber.RANDOM,
}
PARTICLES = {  # name of the value, first float
    "Index": (instance_values.PARTICLE, 0),
    "Age": (instance_values.PARTICLE, 1),
    "Lifetime": (instance_values.PARTICLE, 2),
    "Size": (instance_values.PARTICLE, 3),
    "Random": (instance_values.PARTICLE_LOCATION, 3),
    "Location": (instance_values.PARTICLE_LOCATION, 0),
    "Velocity": (instance_values.PARTICLE_VELOCITY, 0),
    "Angular Velocity": (instance_values.PARTICLE_SPIN, 0),
}
POINTS = {"Position": (0, 3), "Radius": (3, 1), "Random": (4, 1)}  # first float, floats
STRANDS = {
    "Is Strand": InputNumber.IS_STRAND,
    "Intercept": InputNumber.INTERCEPT,
    "Length": InputNumber.STRAND_LENGTH,
    "Thickness": InputNumber.THICKNESS,
    "Tangent Normal": InputVector.STRAND_NORMAL,
    "Random": InputNumber.STRAND_RANDOM,
}
RAYS = {
    "Is Camera Ray": InputNumber.IS_CAMERA,
    "Is Shadow Ray": InputNumber.IS_SHADOW,
    "Is Diffuse Ray": InputNumber.IS_DIFFUSE,
    "Is Glossy Ray": InputNumber.IS_GLOSSY,
    "Is Reflection Ray": InputNumber.IS_REFLECTION,
    "Is Transmission Ray": InputNumber.IS_TRANSMISSION,
    "Is Volume Scatter Ray": InputNumber.IS_VOLUME,
    "Ray Length": InputNumber.RAY_LENGTH,
    "Ray Depth": InputNumber.RAY_DEPTH,
    "Diffuse Depth": InputNumber.DIFFUSE_DEPTH,
    "Glossy Depth": InputNumber.GLOSSY_DEPTH,
    "Transparent Depth": InputNumber.TRANSPARENT_DEPTH,
    "Transmission Depth": InputNumber.TRANSMISSION_DEPTH,
}


def _input(kind):
    return number_input(kind) if isinstance(kind, InputNumber) else vector_input(kind)


def _texture_coordinate(values, node, output, groups):
    if output.identifier == "Object" and node.object is not None:
        b_object = node.object.evaluated_get(values.context.depsgraph)
        matrix = np.linalg.inv(np.array(b_object.matrix_world))
        rows = [tuple(float(x) for x in row[:3]) for row in matrix[:3]]
        return graph.node(Op.TRANSFORM, vector_input(InputVector.POSITION), *rows, tuple(matrix[:3, 3].tolist()))
    if node.from_instancer and output.identifier in ("Generated", "UV"):
        is_uv = output.identifier == "UV"
        return instance_value(values, instance_values.INSTANCER_UV if is_uv else instance_values.INSTANCER_GENERATED)
    return _input(COORDINATES[output.identifier])


def _geometry(values, node, output, groups):
    name = output.identifier
    if name == "Backfacing":
        return number_input(InputNumber.BACKFACING)
    if name == "Random Per Island":
        return attribute(attributes.ISLANDS, 1)
    if name == "Pointiness":
        return attribute(attributes.POINTINESS, 1)
    return _input(GEOMETRY[name])


def _object_info(values, node, output, groups):
    return _input(OBJECT[output.identifier])


def _particle_info(values, node, output, groups):
    name, offset = PARTICLES[output.identifier]
    return instance_value(values, name, 3 if output.type == "VECTOR" else 1, offset)


def _point_info(values, node, output, groups):
    return graph.part(graph.node(Op.POINT_VALUE), *POINTS[output.identifier])


def _curves_info(values, node, output, groups):
    return _input(STRANDS[output.identifier])


def _light_path(values, node, output, groups):
    kind = RAYS.get(output.identifier)
    if kind is None:
        values.warn(node, f"{output.name} is not rendered yet; using 0")
        return 0.0
    return _input(kind)


def _camera_data(values, node, output, groups):
    if output.identifier == "View Vector":
        camera = vector_input(InputVector.CAMERA)
        normalized = graph.node(Op.VECTOR_MATH, camera, ZERO3, ZERO3, 0.0, mode=opcodes.VectorMath.NORMALIZE)
        return graph.part(normalized, 0, 3)
    is_depth = output.identifier == "View Z Depth"
    return number_input(InputNumber.VIEW_DEPTH if is_depth else InputNumber.VIEW_DISTANCE)


# ---- Attributes ------------------------------------------------------------------------------------------------------


def _uv_map(values, node, output, groups):
    return attribute(node.uv_map) if node.uv_map else vector_input(InputVector.UV)


def _attribute(values, node, output, groups):
    kind, name = node.attribute_type, node.attribute_name
    if kind == "GEOMETRY":
        return _attribute_output(graph.node(Op.ATTRIBUTE, data=name), output)
    if kind == "VIEW_LAYER":
        return _attribute_output(instance_values.layer_value(values.context, name), output)
    owner = instance_values.OBJECT if kind == "OBJECT" else instance_values.INSTANCER
    return _attribute_output(instance_value(values, owner + name, 4), output)


def _color_attribute(values, node, output, groups):
    return _attribute_output(graph.node(Op.ATTRIBUTE, data=node.layer_name or attributes.ACTIVE_COLOR), output)


def _attribute_output(four, output):
    """An output of the Attribute node, of the four floats that it found."""
    if output.identifier == "Alpha":
        return graph.part(four, 3)
    color = graph.part(four, 0, 3)
    if output.identifier != "Fac":
        return color
    return graph.node(Op.AVERAGE, color) if not graph.is_constant(color) else math.fsum(color) / 3.0


# ---- Normals and angles ----------------------------------------------------------------------------------------------


def _normal_input(values, node, groups):
    return values.normal_or_none(node, groups) or ZERO3


def _bump(values, node, output, groups):
    strength, distance = values.number(node, groups, "Strength"), values.number(node, groups, "Distance")
    height = values.number(node, groups, "Height")
    normal = _normal_input(values, node, groups)
    if graph.is_constant(height):
        return normal if normal != ZERO3 else vector_input(InputVector.NORMAL)
    width = by_identifier(node.inputs, "Filter Width").default_value  # nothing can be linked to it
    nearby = (graph.shifted(height, 1, width), graph.shifted(height, 2, width))
    return graph.node(Op.BUMP, strength, distance, height, *nearby, normal, width, mode=int(node.invert))


def _normal_map(values, node, output, groups):
    space = node.space.removeprefix("BLENDER_")
    color, strength = values.color(node, groups, "Color"), values.number(node, groups, "Strength")
    if getattr(node, "convention", "OPENGL") == "DIRECTX":  # its green points down
        color = _inverted(color, (0.0, 1.0, 0.0))
    if node.space.startswith("BLENDER_"):
        color = _inverted(color, (0.0, 1.0, 1.0))
    tangent, sign = ZERO3, 1.0
    if space == "TANGENT":
        name = attributes.TANGENT + node.uv_map
        tangent, sign = attribute(name), attribute(name, 1, 3)
        space = "TANGENT_OF_4" if bpy.app.version < (5, 0) else space
    mapped = graph.node(Op.NORMAL_MAP, color, strength, tangent, sign, mode=opcodes.NormalSpace[space])
    if space != "TANGENT" or getattr(node, "base", "DISPLACED") != "ORIGINAL":
        return mapped
    original = attributes.ORIGINAL + node.uv_map
    color = _in_object_space(color, attribute(original), tangent, sign)
    on_original = graph.node(Op.NORMAL_MAP, color, strength, ZERO3, 1.0, mode=opcodes.NormalSpace.OBJECT)
    return graph.node(Op.MIX_VECTOR, graph.splat(attribute(original, 1, 3)), mapped, on_original)


def _in_object_space(color, normal, tangent, sign):
    """The colour of a normal map in object space that says what `color` says in the frame of normal and tangent."""

    def calculated(operation, a, b=ZERO3):
        return graph.part(graph.node(Op.VECTOR_MATH, a, b, ZERO3, 0.0, mode=opcodes.VectorMath[operation]), 0, 3)

    bitangent = graph.scaled(calculated("CROSS_PRODUCT", normal, tangent), sign)
    along = graph.added(graph.scaled(color, 2.0), (-1.0, -1.0, -1.0))
    x, y, z = (graph.scaled(axis, graph.part(along, i)) for i, axis in enumerate((tangent, bitangent, normal)))
    mapped = calculated("NORMALIZE", graph.added(graph.added(x, y), z))
    return graph.added(graph.scaled(mapped, 0.5), (0.5, 0.5, 0.5))


def _inverted(color, which):
    """A colour with 1 - c in the place of those components c for which `which` is 1."""
    signs = tuple(1.0 - 2.0 * w for w in which)
    return graph.added(_vectors(color, signs, opcodes.VectorMath.MULTIPLY), which)


def turned(vector, axis, turns):
    """A vector turned about an axis by a number of full turns."""
    angle = graph.product(turns, 2.0 * math.pi)
    return graph.node(Op.ROTATE, vector, ZERO3, axis, angle, ZERO3, mode=opcodes.Rotation.AXIS_ANGLE)


def _vectors(a, b, mode):
    return graph.part(graph.node(Op.VECTOR_MATH, a, b, ZERO3, 0.0, mode=mode), 0, 3)


def _tangent(values, node, output, groups):
    if node.direction_type == "UV_MAP":
        tangent = attribute(attributes.TANGENT + node.uv_map)
        mode = 27 + opcodes.Space.OBJECT * 3 + opcodes.Space.WORLD  # as Cycles has it: like a normal
        tangent, normal = graph.node(Op.CHANGE_SPACE, tangent, mode=mode), vector_input(InputVector.NORMAL)
        across = _vectors(
            _vectors(tangent, normal, opcodes.VectorMath.CROSS_PRODUCT), ZERO3, opcodes.VectorMath.NORMALIZE
        )
        return _vectors(normal, across, opcodes.VectorMath.CROSS_PRODUCT)
    return vector_input(InputVector["RADIAL_TANGENT" if node.axis == "Z" else f"RADIAL_TANGENT_{node.axis}"])


def _fresnel(values, node, output, groups):
    return graph.node(Op.FRESNEL, values.number(node, groups, "IOR"), _normal_input(values, node, groups))


def _layer_weight(values, node, output, groups):
    blend, normal = values.number(node, groups, "Blend"), _normal_input(values, node, groups)
    return graph.node(Op.LAYER_WEIGHT, blend, normal, mode=int(output.identifier == "Facing"))


FUNCTIONS = {
    "TEX_COORD": _texture_coordinate,
    "NEW_GEOMETRY": _geometry,
    "OBJECT_INFO": _object_info,
    "LIGHT_PATH": _light_path,
    "PARTICLE_INFO": _particle_info,
    "POINT_INFO": _point_info,
    "HAIR_INFO": _curves_info,
    "CAMERA": _camera_data,
    "UVMAP": _uv_map,
    "ATTRIBUTE": _attribute,
    "VERTEX_COLOR": _color_attribute,
    "TANGENT": _tangent,
    "BUMP": _bump,
    "NORMAL_MAP": _normal_map,
    "FRESNEL": _fresnel,
    "LAYER_WEIGHT": _layer_weight,
}
