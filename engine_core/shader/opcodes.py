# SPDX-License-Identifier: GPL-3.0-or-later
"""What the machine can do: families of operations, and for each operation its operands and its result.

Members of the modes have the names that Blender gives to them, in the order of Blender's menus.
"""

from enum import IntEnum
from typing import NamedTuple


class Entry(IntEnum):
    """Rows of KERNEL: the entry points of the machine, and the families of its operations."""

    SURFACE = 0  # run a material's program: lobes and emission
    VALUE = 1  # run a program that gives a colour
    LIGHT = 2  # radiance of a textured light at a sampled point
    INPUT = 3
    MATHS = 4
    COLOR = 5
    VECTOR = 6
    IMAGE = 7
    PATTERN = 8
    NOISE = 9
    VORONOI = 10


class Op(IntEnum):
    INPUT_VECTOR = 0
    INPUT_NUMBER = 1
    ATTRIBUTE = 2
    MATH = 10
    VECTOR_MATH = 11
    CLAMP = 12
    MAP_RANGE = 13
    MAP_RANGE_VECTOR = 14
    MIX_NUMBER = 15
    MIX_VECTOR = 16
    COMBINE = 17
    AVERAGE = 18
    LUMINANCE = 19
    SCALE = 20
    BLEND = 30
    HUE_SATURATION = 31
    INVERT = 32
    GAMMA = 33
    BRIGHT_CONTRAST = 34
    RAMP = 35
    CURVES = 36
    CURVE = 37
    SEPARATE_COLOR = 38
    COMBINE_COLOR = 39
    BLACKBODY = 40
    MAPPING = 50
    TRANSFORM = 51
    ROTATE = 52
    CHANGE_SPACE = 53
    BUMP = 54
    NORMAL_MAP = 55
    FRESNEL = 56
    LAYER_WEIGHT = 57
    IMAGE = 70
    ENVIRONMENT = 71
    CHECKER = 80
    GRADIENT = 81
    NOISE = 90
    VORONOI = 100


class InputVector(IntEnum):
    POSITION = 0
    NORMAL = 1
    TRUE_NORMAL = 2
    INCOMING = 3
    UV = 4
    GENERATED = 5
    OBJECT = 6
    OBJECT_NORMAL = 7
    CAMERA = 8
    WINDOW = 9
    REFLECTION = 10
    PARAMETRIC = 11
    OBJECT_LOCATION = 12
    OBJECT_COLOR = 13
    RADIAL_TANGENT = 14


class InputNumber(IntEnum):
    BACKFACING = 0
    RANDOM = 1
    OBJECT_INDEX = 2
    MATERIAL_INDEX = 3
    OBJECT_ALPHA = 4
    IS_CAMERA = 5
    IS_SHADOW = 6
    IS_DIFFUSE = 7
    IS_GLOSSY = 8
    IS_TRANSMISSION = 9
    IS_REFLECTION = 10
    IS_VOLUME = 11
    RAY_LENGTH = 12
    RAY_DEPTH = 13
    DIFFUSE_DEPTH = 14
    GLOSSY_DEPTH = 15
    TRANSPARENT_DEPTH = 16
    TRANSMISSION_DEPTH = 17
    VIEW_DEPTH = 18
    VIEW_DISTANCE = 19


class Math(IntEnum):
    ADD = 0
    SUBTRACT = 1
    MULTIPLY = 2
    DIVIDE = 3
    MULTIPLY_ADD = 4
    POWER = 5
    LOGARITHM = 6
    SQRT = 7
    INVERSE_SQRT = 8
    ABSOLUTE = 9
    EXPONENT = 10
    MINIMUM = 11
    MAXIMUM = 12
    LESS_THAN = 13
    GREATER_THAN = 14
    SIGN = 15
    COMPARE = 16
    SMOOTH_MIN = 17
    SMOOTH_MAX = 18
    ROUND = 19
    FLOOR = 20
    CEIL = 21
    TRUNC = 22
    FRACT = 23
    MODULO = 24
    FLOORED_MODULO = 25
    WRAP = 26
    SNAP = 27
    PINGPONG = 28
    SINE = 29
    COSINE = 30
    TANGENT = 31
    ARCSINE = 32
    ARCCOSINE = 33
    ARCTANGENT = 34
    ARCTAN2 = 35
    SINH = 36
    COSH = 37
    TANH = 38
    RADIANS = 39
    DEGREES = 40


class VectorMath(IntEnum):
    ADD = 0
    SUBTRACT = 1
    MULTIPLY = 2
    DIVIDE = 3
    MULTIPLY_ADD = 4
    CROSS_PRODUCT = 5
    PROJECT = 6
    REFLECT = 7
    REFRACT = 8
    FACEFORWARD = 9
    DOT_PRODUCT = 10
    DISTANCE = 11
    LENGTH = 12
    SCALE = 13
    NORMALIZE = 14
    ABSOLUTE = 15
    POWER = 16
    SIGN = 17
    MINIMUM = 18
    MAXIMUM = 19
    FLOOR = 20
    CEIL = 21
    FRACTION = 22
    MODULO = 23
    WRAP = 24
    SNAP = 25
    SINE = 26
    COSINE = 27
    TANGENT = 28
    ROUND = 29


class Blend(IntEnum):
    MIX = 0
    DARKEN = 1
    MULTIPLY = 2
    BURN = 3
    LIGHTEN = 4
    SCREEN = 5
    DODGE = 6
    ADD = 7
    OVERLAY = 8
    SOFT_LIGHT = 9
    LINEAR_LIGHT = 10
    DIFFERENCE = 11
    EXCLUSION = 12
    SUBTRACT = 13
    DIVIDE = 14
    HUE = 15
    SATURATION = 16
    COLOR = 17
    VALUE = 18


class Range(IntEnum):
    LINEAR = 0
    STEPPED = 1
    SMOOTHSTEP = 2
    SMOOTHERSTEP = 3


class ColorSpace(IntEnum):
    HSV = 0
    HSL = 1


class Mapping(IntEnum):
    POINT = 0
    TEXTURE = 1
    VECTOR = 2
    NORMAL = 3


class Rotation(IntEnum):
    AXIS_ANGLE = 0
    X_AXIS = 1
    Y_AXIS = 2
    Z_AXIS = 3
    EULER_XYZ = 4


class Space(IntEnum):
    """CHANGE_SPACE: `mode` is kind * 9 + from * 3 + to, kind being 0 for a point, 1 for a vector, 2 for a normal."""

    WORLD = 0
    OBJECT = 1
    CAMERA = 2


class NormalSpace(IntEnum):
    TANGENT = 0
    OBJECT = 1
    WORLD = 2


class Interpolation(IntEnum):
    Linear = 0
    Closest = 1
    Cubic = 2
    Smart = 2


class Extension(IntEnum):
    REPEAT = 0
    EXTEND = 1
    CLIP = 2
    MIRROR = 3


class Projection(IntEnum):
    FLAT = 0
    BOX = 1
    SPHERE = 2
    TUBE = 3


class Panorama(IntEnum):
    EQUIRECTANGULAR = 0
    MIRROR_BALL = 1


class Gradient(IntEnum):
    LINEAR = 0
    QUADRATIC = 1
    EASING = 2
    DIAGONAL = 3
    SPHERICAL = 4
    QUADRATIC_SPHERE = 5
    RADIAL = 6


UNASSOCIATE = 64  # IMAGE: a flag of its mode: divide colours by alpha
INVERTED = 1  # BUMP
CLAMPED = 32  # MAP_RANGE, ROTATE and others: a flag of their modes: clamp the result, or the factor; or turn back
CLAMPED_RESULT = 64  # MATH, BLEND


class Signature(NamedTuple):
    """What an operation takes and gives."""

    family: Entry
    operands: tuple  # floats of each: 1 or 3
    width: int  # floats of the result
    modes: int  # modes are below this
    table: str = ""  # that `data` is a row of
    varies: bool = False  # even if its operands do not


SIGNATURES = {
    Op.INPUT_VECTOR: Signature(Entry.INPUT, (), 3, len(InputVector), varies=True),
    Op.INPUT_NUMBER: Signature(Entry.INPUT, (), 1, len(InputNumber), varies=True),
    Op.ATTRIBUTE: Signature(Entry.INPUT, (), 4, 1, "attribute", varies=True),
    Op.MATH: Signature(Entry.MATHS, (1, 1, 1), 1, 2 * CLAMPED_RESULT),
    Op.VECTOR_MATH: Signature(Entry.MATHS, (3, 3, 3, 1), 4, len(VectorMath)),
    Op.CLAMP: Signature(Entry.MATHS, (1, 1, 1), 1, 2),
    Op.MAP_RANGE: Signature(Entry.MATHS, (1, 1, 1, 1, 1, 1), 1, 2 * CLAMPED),
    Op.MAP_RANGE_VECTOR: Signature(Entry.MATHS, (3, 3, 3, 3, 3, 3), 3, 2 * CLAMPED),
    Op.MIX_NUMBER: Signature(Entry.MATHS, (1, 1, 1), 1, 2 * CLAMPED),
    Op.MIX_VECTOR: Signature(Entry.MATHS, (3, 3, 3), 3, 2 * CLAMPED),
    Op.COMBINE: Signature(Entry.MATHS, (1, 1, 1), 3, 1),
    Op.AVERAGE: Signature(Entry.MATHS, (3,), 1, 1),
    Op.LUMINANCE: Signature(Entry.MATHS, (3,), 1, 1),
    Op.SCALE: Signature(Entry.MATHS, (3, 1), 3, 1),
    Op.BLEND: Signature(Entry.COLOR, (1, 3, 3), 3, 2 * CLAMPED_RESULT),
    Op.HUE_SATURATION: Signature(Entry.COLOR, (1, 1, 1, 1, 3), 3, 1),
    Op.INVERT: Signature(Entry.COLOR, (1, 3), 3, 1),
    Op.GAMMA: Signature(Entry.COLOR, (3, 1), 3, 1),
    Op.BRIGHT_CONTRAST: Signature(Entry.COLOR, (3, 1, 1), 3, 1),
    Op.RAMP: Signature(Entry.COLOR, (1,), 4, 2, "curves"),
    Op.CURVES: Signature(Entry.COLOR, (1, 3, 1, 1), 3, 2, "curves"),
    Op.CURVE: Signature(Entry.COLOR, (1, 1, 1, 1), 1, 2, "curves"),
    Op.SEPARATE_COLOR: Signature(Entry.COLOR, (3,), 3, len(ColorSpace)),
    Op.COMBINE_COLOR: Signature(Entry.COLOR, (3,), 3, len(ColorSpace)),
    Op.BLACKBODY: Signature(Entry.COLOR, (1,), 3, 1),
    Op.MAPPING: Signature(Entry.VECTOR, (3, 3, 3, 3), 3, len(Mapping)),
    Op.TRANSFORM: Signature(Entry.VECTOR, (3, 3, 3, 3, 3), 3, 1),
    Op.ROTATE: Signature(Entry.VECTOR, (3, 3, 3, 1, 3), 3, 2 * CLAMPED),
    Op.CHANGE_SPACE: Signature(Entry.VECTOR, (3,), 3, 27, varies=True),
    Op.BUMP: Signature(Entry.VECTOR, (1, 1, 1, 1, 1, 3), 3, 2, varies=True),
    Op.NORMAL_MAP: Signature(Entry.VECTOR, (3, 1, 3, 1), 3, len(NormalSpace), varies=True),
    Op.FRESNEL: Signature(Entry.VECTOR, (1, 3), 1, 1, varies=True),
    Op.LAYER_WEIGHT: Signature(Entry.VECTOR, (1, 3), 1, 2, varies=True),
    Op.IMAGE: Signature(Entry.IMAGE, (3, 1), 4, 2 * UNASSOCIATE, "images"),
    Op.ENVIRONMENT: Signature(Entry.IMAGE, (3,), 4, 2 * UNASSOCIATE, "images"),
    Op.CHECKER: Signature(Entry.PATTERN, (3, 3, 3, 1), 4, 1),
    Op.GRADIENT: Signature(Entry.PATTERN, (3,), 1, len(Gradient)),
}
