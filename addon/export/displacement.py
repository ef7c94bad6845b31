# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement: how far a surface is moved, as a vector in the world's space; and what a bump makes of it."""

from ..core import graph, opcodes
from .attributes import TANGENT
from .node_inputs import attribute, vector_input

Op, InputVector, Space = opcodes.Op, opcodes.InputVector, opcodes.Space
ZERO3 = (0.0, 0.0, 0.0)
VECTOR_TO_WORLD = 9 + 3 * Space.OBJECT + Space.WORLD
NORMAL_TO_OBJECT = 18 + 3 * Space.WORLD + Space.OBJECT


def _displacement(values, node, output, groups):
    """Along the normal, by how much the height is above the midlevel."""
    height, middle = values.number(node, groups, "Height"), values.number(node, groups, "Midlevel")
    above = graph.node(Op.MATH, height, middle, 0.0, mode=opcodes.Math.SUBTRACT)
    amount = graph.product(above, values.number(node, groups, "Scale"))
    normal = values.normal_or_none(node, groups)
    if node.space == "WORLD":
        return graph.scaled(normal or vector_input(InputVector.NORMAL), amount)
    if normal is None:
        normal = vector_input(InputVector.OBJECT_NORMAL)
    else:
        normal = graph.node(Op.CHANGE_SPACE, normal, mode=NORMAL_TO_OBJECT)
    return graph.node(Op.CHANGE_SPACE, graph.scaled(normal, amount), mode=VECTOR_TO_WORLD)


def _vector_displacement(values, node, output, groups):
    """By a colour: in object space, or along tangent, normal and bitangent."""
    middle = graph.splat(values.number(node, groups, "Midlevel"))
    above = _vector_math("SUBTRACT", values.color(node, groups, "Vector"), middle)
    moved = graph.scaled(above, values.number(node, groups, "Scale"))
    if node.space == "WORLD":
        return moved
    if node.space == "TANGENT":
        normal = vector_input(InputVector.OBJECT_NORMAL)
        tangent, sign = attribute(TANGENT), attribute(TANGENT, 1, 3)
        bitangent = graph.scaled(_vector_math("NORMALIZE", _vector_math("CROSS_PRODUCT", normal, tangent)), sign)
        axes = (tangent, normal, bitangent)
        along = [graph.scaled(axis, graph.part(moved, i)) for i, axis in enumerate(axes)]
        moved = graph.added(graph.added(*along[:2]), along[2])
    return graph.node(Op.CHANGE_SPACE, moved, mode=VECTOR_TO_WORLD)


FUNCTIONS = {"DISPLACEMENT": _displacement, "VECTOR_DISPLACEMENT": _vector_displacement}


def _vector_math(operation, a, b=ZERO3):
    return graph.part(graph.node(Op.VECTOR_MATH, a, b, ZERO3, 0.0, mode=opcodes.VectorMath[operation]), 0, 3)


def bumped_normal(moved):
    """The normal of a surface that looks as if it were moved by the vector `moved`: by its height along the normal."""
    product = graph.node(
        Op.VECTOR_MATH, moved, vector_input(InputVector.NORMAL), ZERO3, 0.0, mode=opcodes.VectorMath.DOT_PRODUCT
    )
    height = graph.part(product, 3)
    return graph.node(
        Op.BUMP, 1.0, 1.0, height, graph.shifted(height, 1), graph.shifted(height, 2), ZERO3, opcodes.FOOTPRINT, mode=0
    )
