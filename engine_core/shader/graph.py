# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that vary over a surface, as a graph of operations: what an exporter builds, and `program` assembles.

    noise = node(Op.NOISE, position, 5.0, ...)          # a Node of several floats ...
    factor = part(noise, 0)                             # ... one of them
    height = node(Op.MATH, factor, 2.0, 0.0, mode=Math.MULTIPLY)

A value is a number, a tuple of three, a Node, or a Part of one. Where a number is needed and three are given, or the
other way round, it is the caller who says what that means: see `splat`, `mean` and `luminance`.
Graphs have no cycles, since a node's operands are there before it is.
"""

import math
from dataclasses import dataclass

import numpy as np

from .opcodes import DIRECTION_BITS, FOOTPRINT, MOST_STEPS, SIGNATURES, STEPS_PER_FOOTPRINT, Math, Op

LUMINANCE = (0.2126, 0.7152, 0.0722)  # of red, green and blue; see `vec3.luminance`


class GraphError(ValueError):
    """A graph that no program can be made of; the text says why."""


@dataclass(frozen=True, eq=False, repr=False)
class Node:
    op: Op
    operands: tuple  # values
    mode: int = 0
    data: object = None  # Image, Tiles, Curve or name of an attribute
    shift: int = 0  # not 0: a bit further along the surface, see `shifted`

    @property
    def width(self):
        return SIGNATURES[self.op].width


@dataclass(frozen=True)
class Part:
    """Some floats of a node's result."""

    node: Node
    offset: int
    width: int


@dataclass(frozen=True, eq=False)
class Curve:
    """A table of colours from 0 to 1, CURVE_SIZE rows of four."""

    values: np.ndarray


@dataclass(frozen=True, eq=False)
class Image:
    """Pixels, bottom row first: (height, width, 1 or 4), uint8, float16 or float32."""

    name: str
    pixels: np.ndarray
    is_srgb: bool = False  # of uint8 or float32: colours with the curve of sRGB


@dataclass(frozen=True, eq=False)
class Tiles:
    """Images side by side, each in a unit square of its own: rows of `columns`, the lowest first."""

    columns: int
    images: tuple


def node(op, *operands, mode=0, data=None):
    """A new Node; raises GraphError if operands do not fit."""
    signature = SIGNATURES[op]
    widths = tuple(width(operand) for operand in operands)
    if widths != signature.operands:
        raise GraphError(f"{op.name} takes operands of {signature.operands} floats, not {widths}")
    if not 0 <= mode < signature.modes:
        raise GraphError(f"{op.name} has no mode {mode}")
    return Node(op, operands, int(mode), data)


def is_constant(value):
    return not isinstance(value, (Node, Part))


def width(value):
    """Floats that a value is made of."""
    if isinstance(value, (Node, Part)):
        return value.width
    return 3 if hasattr(value, "__len__") else 1


def part(value, offset, size=1):
    """Some of the floats of a value: one as a number, three as a vector."""
    if isinstance(value, Part):
        return Part(value.node, value.offset + offset, size)
    if isinstance(value, Node):
        return value if size == value.width else Part(value, offset, size)
    return float(value[offset]) if size == 1 else tuple(float(v) for v in value[offset : offset + size])


def mean(vector):
    """Of the three numbers of a vector."""
    return math.fsum(vector) / 3.0 if is_constant(vector) else node(Op.AVERAGE, vector)


def splat(value):
    """A number as three equal ones."""
    return node(Op.COMBINE, value, value, value) if not is_constant(value) else (float(value),) * 3


def luminance(color):
    """A colour's as a number. What looks at images has it beside the colour."""
    if is_constant(color):
        return math.fsum(c * w for c, w in zip(color, LUMINANCE, strict=True))
    if isinstance(color, Part) and color.offset == 0 and color.node.op in (Op.IMAGE, Op.ENVIRONMENT):
        return Part(color.node, 4, 1)
    return node(Op.LUMINANCE, color)


def scaled(color, factor):
    """A colour times a number."""
    if is_constant(color) and is_constant(factor):
        return tuple(c * factor for c in color)
    if is_constant(factor) and factor == 1.0:
        return color
    if (is_constant(factor) and factor == 0.0) or (is_constant(color) and not any(color)):
        return (0.0, 0.0, 0.0)
    return node(Op.SCALE, color, factor)


def added(a, b):
    """Sum of two colours."""
    if is_constant(a) and is_constant(b):
        return tuple(x + y for x, y in zip(a, b, strict=True))
    if is_constant(a) and not any(a):
        return b
    if is_constant(b) and not any(b):
        return a
    return part(node(Op.VECTOR_MATH, a, b, (0.0, 0.0, 0.0), 0.0), 0, 3)


def sum_of(a, b):
    """Sum of two numbers."""
    if is_constant(a) and is_constant(b):
        return a + b
    for x, y in ((a, b), (b, a)):
        if is_constant(x) and x == 0.0:
            return y
    return node(Op.MATH, a, b, 0.0, mode=Math.ADD)


def product(a, b):
    """Product of two numbers."""
    if is_constant(a) and is_constant(b):
        return a * b
    for x, y in ((a, b), (b, a)):
        if is_constant(x) and x in (0.0, 1.0):
            return 0.0 if x == 0.0 else y
    return node(Op.MATH, a, b, 0.0, mode=Math.MULTIPLY)


def clamped(value):
    """A number, made to lie between 0 and 1."""
    if is_constant(value):
        return min(max(value, 0.0), 1.0)
    return node(Op.CLAMP, value, 0.0, 1.0)


def complement(value):
    """1 - a number."""
    return 1.0 - value if is_constant(value) else node(Op.MATH, 1.0, value, 0.0, mode=Math.SUBTRACT)


def nodes_below(values):
    """All nodes that `values` depend on, each after its operands. Without recursion: graphs may be deep."""
    order, state = [], {}
    stack = [(v.node if isinstance(v, Part) else v, False) for v in values if not is_constant(v)]
    while stack:
        at, operands_done = stack.pop()
        if operands_done:
            state[at] = 2
            order.append(at)
        elif at not in state:
            state[at] = 1
            stack.append((at, True))
            for operand in at.operands:
                below = operand.node if isinstance(operand, Part) else operand
                if not is_constant(operand):
                    if state.get(below) == 1:
                        raise GraphError("the graph bites its own tail")
                    stack.append((below, False))
    return order


def without_twins(values):
    """The same values, in which of nodes that do the same with the same there is but one."""
    kept, only = {}, {}
    for at in nodes_below(values):
        operands = tuple(_replace(operand, kept) for operand in at.operands)
        key = (at.op, tuple(map(_exact, operands)), at.mode, at.data, at.shift)
        if key not in only:
            same = all(a is b for a, b in zip(operands, at.operands, strict=True))
            only[key] = at if same else Node(at.op, operands, at.mode, at.data, at.shift)
        kept[at] = only[key]
    return [_replace(value, kept) for value in values]


def _exact(value):
    """What two values have in common that are the same: of constants the bits."""
    return np.asarray(value, np.float32).tobytes() if is_constant(value) else value


def shifted(value, direction, pixels=FOOTPRINT):
    """The same value a bit further along the surface: about so many pixels, in direction 1 or 2 of its tangents."""
    steps = max(1, round(pixels / FOOTPRINT * STEPS_PER_FOOTPRINT))
    shift = direction | min(steps, MOST_STEPS) << DIRECTION_BITS
    moved = {}
    for at in nodes_below([value]):
        operands = tuple(_replace(operand, moved) for operand in at.operands)
        is_input = at.op in (Op.INPUT_VECTOR, Op.INPUT_NUMBER, Op.ATTRIBUTE, Op.WIREFRAME)
        if is_input or any(a is not b for a, b in zip(operands, at.operands, strict=True)):
            moved[at] = Node(at.op, operands, at.mode, at.data, shift if is_input else 0)
    return _replace(value, moved)


def from_attribute(value, kind, name):
    """The same value with an input vector of that kind read from the attribute `name` instead."""
    changed = {}
    for at in nodes_below([value]):
        operands = tuple(_replace(operand, changed) for operand in at.operands)
        if at.op == Op.INPUT_VECTOR and at.mode == kind:
            changed[at] = part(Node(Op.ATTRIBUTE, (), 0, name, at.shift), 0, 3)
        elif any(a is not b for a, b in zip(operands, at.operands, strict=True)):
            changed[at] = Node(at.op, operands, at.mode, at.data, at.shift)
    return _replace(value, changed)


def _replace(value, moved):
    if isinstance(value, Part):
        return part(moved[value.node], value.offset, value.width) if value.node in moved else value
    return moved.get(value, value) if isinstance(value, Node) else value
