# SPDX-License-Identifier: GPL-3.0-or-later
"""What the machine can do: families of operations, and for each operation its operands and its result.

Members of the modes have the names that Blender gives to them, in the order of Blender's menus.
"""

from enum import IntEnum
from typing import NamedTuple

from ..linalg.blend import BlendMode as Blend
from ..linalg.color import ColorModel
from ..linalg.scalar_math import Interpolation as Range
from ..linalg.scalar_math import MathOp as Math
from ..linalg.vector_math import MappingKind as Mapping
from ..linalg.vector_math import RotationKind as Rotation
from ..linalg.vector_math import VectorMathOp as VectorMath
from ..texture.gradient import GradientKind as Gradient
from ..texture.noise import NoiseKind
from ..texture.voronoi import VoronoiFeature, VoronoiMetric
from ..texture.wave import WaveDirection, WaveKind, WaveProfile


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
    GABOR = 11
    SUBSURFACE = 12  # walk below a surface, see integrator/subsurface.py
    LIGHTING = 13
    LINES = 14
    PROBES = 15  # rays that programs send, see integrator/probes.py
    LAYERS = 16  # of lobes that cover light: see integrator/layers.py
    PANE = 17  # what shadow rays see of a material that may have smooth thin walls: likewise
    VORONOI_OF_4 = 18


class Op(IntEnum):
    INPUT_VECTOR = 0
    INPUT_NUMBER = 1
    ATTRIBUTE = 2
    INSTANCE_VALUE = 3
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
    WAVELENGTH = 41
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
    MAGIC = 82
    WHITE_NOISE = 83
    BRICK = 84
    WAVE = 85
    NOISE = 90
    VORONOI = 100
    VORONOI_OF_4 = 101  # as in Blender 4, which has other points
    GABOR = 110
    SKY = 120
    DAYLIGHT = 121
    IES = 122
    WIREFRAME = 130
    RADIAL_TILING = 131
    POINT_VALUE = 132
    OCCLUSION = 140
    BEVEL = 141
    RAYCAST = 142
    LEFT_BELOW = 150


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
    RADIAL_TANGENT_X = 15
    RADIAL_TANGENT_Y = 16
    STRAND_NORMAL = 17


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
    IS_STRAND = 20
    INTERCEPT = 21
    STRAND_LENGTH = 22
    THICKNESS = 23
    STRAND_RANDOM = 24


class Space(IntEnum):
    """CHANGE_SPACE: `mode` is kind * 9 + from * 3 + to, kind being 0 for a point, 1 for a vector, 2 for a unit vector,
    3 for the normal of a plane."""

    WORLD = 0
    OBJECT = 1
    CAMERA = 2


class NormalSpace(IntEnum):
    TANGENT = 0
    OBJECT = 1
    WORLD = 2
    TANGENT_OF_4 = 3  # as in Blender 4: the normal, too, is as long as interpolation leaves it


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


class SkyTable(IntEnum):
    """SKY: which table of `texture.atmosphere` it looks at."""

    WHOLE = 0
    UPPER_HALF = 1  # Blender 4's


class Daylight(IntEnum):
    PREETHAM = 0
    HOSEK_WILKIE = 1


ONLY_LOCAL = 1  # OCCLUSION, RAYCAST: a flag of their modes: rays meet the object itself alone
INSIDE = 2  # OCCLUSION: the rays go inwards
UNASSOCIATE = 64  # IMAGE: a flag of its mode: divide colours by alpha
INVERTED = 1  # BUMP
FOOTPRINT = 0.1  # pixels that the footprint of a point is wide
DIRECTION_BITS = 2  # of a shift; above them stands how far, in parts of a footprint:
STEPS_PER_FOOTPRINT = 100
MOST_STEPS = 1 << 24
CLAMPED = 32  # MAP_RANGE, ROTATE and others: a flag of their modes: clamp the result, or the factor; or turn back
CLAMPED_RESULT = 64  # MATH, BLEND
ONLY_DISTANCE = 512  # VORONOI: a flag that the assembler sets where nobody reads more than the distance
MOST_EVERY = 100  # BRICK: its mode holds two numbers below this


__all__ = [  # the modes that other rooms define
    "Blend",
    "ColorModel",
    "Gradient",
    "Mapping",
    "Math",
    "NoiseKind",
    "Range",
    "Rotation",
    "VectorMath",
    "VoronoiFeature",
    "VoronoiMetric",
    "WaveDirection",
    "WaveKind",
    "WaveProfile",
]


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
    Op.INSTANCE_VALUE: Signature(Entry.INPUT, (), 4, 1, "instance_values", varies=True),
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
    Op.SEPARATE_COLOR: Signature(Entry.COLOR, (3,), 3, len(ColorModel)),
    Op.COMBINE_COLOR: Signature(Entry.COLOR, (3,), 3, len(ColorModel)),
    Op.BLACKBODY: Signature(Entry.COLOR, (1,), 3, 1),
    Op.WAVELENGTH: Signature(Entry.COLOR, (1,), 3, 1),
    Op.MAPPING: Signature(Entry.VECTOR, (3, 3, 3, 3), 3, len(Mapping)),
    Op.TRANSFORM: Signature(Entry.VECTOR, (3, 3, 3, 3, 3), 3, 1),
    Op.ROTATE: Signature(Entry.VECTOR, (3, 3, 3, 1, 3), 3, 2 * CLAMPED),
    Op.CHANGE_SPACE: Signature(Entry.VECTOR, (3,), 3, 36, varies=True),
    Op.BUMP: Signature(Entry.VECTOR, (1, 1, 1, 1, 1, 3, 1), 3, 2, varies=True),
    Op.NORMAL_MAP: Signature(Entry.VECTOR, (3, 1, 3, 1), 3, len(NormalSpace), varies=True),
    Op.FRESNEL: Signature(Entry.VECTOR, (1, 3), 1, 1, varies=True),
    Op.LAYER_WEIGHT: Signature(Entry.VECTOR, (1, 3), 1, 2, varies=True),
    Op.IMAGE: Signature(Entry.IMAGE, (3, 1), 5, 2 * UNASSOCIATE, "images"),
    Op.ENVIRONMENT: Signature(Entry.IMAGE, (3,), 5, 2 * UNASSOCIATE, "images"),
    Op.CHECKER: Signature(Entry.PATTERN, (3, 3, 3, 1), 4, 1),
    Op.GRADIENT: Signature(Entry.PATTERN, (3,), 1, len(Gradient)),
    Op.MAGIC: Signature(Entry.PATTERN, (3, 1, 1), 3, 11),
    Op.WHITE_NOISE: Signature(Entry.PATTERN, (3, 1), 4, 5),
    Op.BRICK: Signature(Entry.PATTERN, (3, 3, 3, 3, 1, 1, 1, 1, 1, 1, 1, 1), 4, MOST_EVERY**2),
    Op.WAVE: Signature(Entry.PATTERN, (3, 1, 1, 1, 1, 1, 1), 1, 24),
    Op.NOISE: Signature(Entry.NOISE, (3, 1, 1, 1, 1, 1, 1, 1, 1), 4, 256),
    Op.VORONOI: Signature(Entry.VORONOI, (3, 1, 1, 1, 1, 1, 1, 1, 1), 9, 2 * ONLY_DISTANCE),
    Op.VORONOI_OF_4: Signature(Entry.VORONOI_OF_4, (3, 1, 1, 1, 1, 1, 1, 1, 1), 9, 2 * ONLY_DISTANCE),
    Op.GABOR: Signature(Entry.GABOR, (3, 1, 1, 1, 1, 3), 3, 4),
    # direction, elevation, azimuth, size, intensity of the sun, horizon, bottom and top of its disk
    Op.SKY: Signature(Entry.LIGHTING, (3, 1, 1, 1, 1, 1, 3, 3), 3, len(SkyTable), "images"),
    # direction, nine shapes of channels, their factors, (angle to the vertical, azimuth, 0) of the sun
    Op.DAYLIGHT: Signature(Entry.LIGHTING, (3,) * 12, 3, len(Daylight)),
    Op.IES: Signature(Entry.LIGHTING, (3, 1), 1, 1, "images"),
    # size; mode 1: in pixels
    Op.WIREFRAME: Signature(Entry.LINES, (1,), 1, 2, varies=True),
    # vector, sides, roundness; mode 1: normalized. Gives segment coordinates, width, rotation, number of the segment
    Op.RADIAL_TILING: Signature(Entry.LINES, (3, 1, 1), 6, 2),
    Op.POINT_VALUE: Signature(Entry.LINES, (), 5, 1, varies=True),  # centre, radius, random
    # distance, normal (zero: that of the surface), samples
    Op.OCCLUSION: Signature(Entry.PROBES, (1, 3, 1), 1, 4, varies=True),
    Op.BEVEL: Signature(Entry.PROBES, (1, 3, 1), 3, 1, varies=True),  # radius, normal, samples
    # position, direction, length. Gives whether it hits, whether itself, how far, where, the normal there
    Op.RAYCAST: Signature(Entry.PROBES, (3, 3, 1), 9, 2, varies=True),
    # weight, roughness and tint of a sheen; weight, roughness, index and tint of a coat; normals of a base and the coat
    Op.LEFT_BELOW: Signature(Entry.LAYERS, (1, 1, 3, 1, 1, 1, 3, 3, 3), 3, 1, varies=True),
}
