# SPDX-License-Identifier: GPL-3.0-or-later
"""The contract of shader programs: rows of steps, of what they read, and of the place where they run. See shader/."""

from enum import IntEnum

import numpy as np


class ClosureKind(IntEnum):
    """What a row of CLOSURE describes; `shader/closures.py` turns it into lobes."""

    DIFFUSE = 0
    TRANSLUCENT = 1
    TRANSPARENT = 2
    GLOSSY = 3
    METALLIC = 4  # by colour: color seen head on, edge_tint at 82 degrees
    CONDUCTOR = 5  # by complex index of refraction: color + i edge_tint
    GLASS = 6
    REFRACTION = 7
    PRINCIPLED = 8
    TOON_DIFFUSE = 9  # roughness: the size of its cone
    TOON_GLOSSY = 10
    SHEEN = 11
    VELVET = 12
    ASHIKHMIN_SHIRLEY = 13
    SUBSURFACE = 14
    HAIR_COLOR = 15  # of a fibre, by the colour of much of it
    HAIR_MELANIN = 16  # ... by its pigments, and color to tint it
    HAIR_ABSORPTION = 17  # ... color is what it absorbs in one radius
    HAIR_REFLECTION = 18  # of the Hair node
    HAIR_TRANSMISSION = 19


class TexelFormat(IntEnum):
    """How an image's numbers are kept."""

    BYTE = 0  # 0 to 255 stands for 0 to 1
    SRGB = 1  # the same, colours with the curve of sRGB
    HALF = 2
    FLOAT = 3
    SRGB_FLOAT = 4  # colours with the curve of sRGB
    TILES = 5  # none: rows of IMAGE side by side


MAX_OPERANDS = 12
MAX_REGISTERS = 256
OP = np.dtype(
    [  # one step of a program: floats from registers to registers
        ("family", "i4"),  # row of KERNEL that knows `code`
        ("code", "i4"),  # shader/opcodes.py
        ("mode", "i4"),  # which variant of it
        ("data", "i4"),  # a row of the table that it reads
        ("shift", "i4"),  # inputs: 0 here, else a bit further along the surface, for slopes: see graph.shifted
        ("out", "i4"),  # first register of the result
        ("register", "i4", (MAX_OPERANDS,)),  # first register of each operand; -1: the constant
        ("constant", "f4", (MAX_OPERANDS, 3)),
    ]
)
CLOSURE = np.dtype(
    [  # what an artist sets of one way to scatter, in the words of Blender's nodes; programs can set the floats
        ("kind", "i4"),  # ClosureKind
        ("layer", "i4"),  # as in LOBE
        ("multiscatter", "i4"),
        ("facets", "i4"),  # Facets
        ("loose", "i4"),  # as in LOBE
        ("subsurface", "i4"),  # SubsurfaceKind
        ("patches", "i4"),  # rows of PATCH: fields that the program fills in
        ("patch_count", "i4"),
        ("weight", "f4"),  # mix factor
        ("color", "f4", (3,)),
        ("roughness", "f4"),
        ("anisotropy", "f4"),
        ("smooth", "f4"),  # TOON; HAIR: roughness around the fibre
        ("ior", "f4"),
        ("edge_tint", "f4", (3,)),  # METALLIC, CONDUCTOR; PRINCIPLED: specular tint; HAIR: see `shares`
        ("metallic", "f4"),
        ("melanin", "f4"),  # this and the next six: HAIR
        ("redness", "f4"),  # share of pheomelanin
        ("coat", "f4"),
        ("tilt", "f4"),  # of its scales, radians
        ("random", "f4"),  # 0 to 1, a number of the strand ...
        ("random_color", "f4"),  # ... and how far it changes the amount of melanin ...
        ("random_roughness", "f4"),  # ... and both kinds of roughness
        ("alpha", "f4"),
        ("specular_level", "f4"),
        ("transmission", "f4"),
        ("diffuse_roughness", "f4"),
        ("subsurface_weight", "f4"),
        ("subsurface_radius", "f4", (3,)),  # metres
        ("subsurface_ior", "f4"),
        ("subsurface_anisotropy", "f4"),
        ("film_thickness", "f4"),  # nanometres
        ("film_ior", "f4"),
        ("thin_wall", "f4"),  # above 0.5: a pane
        ("sheen_weight", "f4"),
        ("sheen_roughness", "f4"),
        ("sheen_tint", "f4", (3,)),
        ("coat_weight", "f4"),
        ("coat_roughness", "f4"),
        ("coat_ior", "f4"),
        ("coat_tint", "f4", (3,)),
        ("normal", "f4", (3,)),  # world space; zero: that of the mesh
        ("coat_normal", "f4", (3,)),  # likewise; zero: `normal`
        ("tangent", "f4", (3,)),  # likewise; zero: any
    ]
)
PATCH = np.dtype(
    [
        ("field", "i4"),  # number of the float in CLOSURE
        ("register", "i4"),
        ("width", "i4"),  # floats: 1 or 3
    ]
)
PROGRAM = np.dtype(
    [  # row 0 is empty, and means: there is no program
        ("ops", "i4"),  # rows of OP
        ("op_count", "i4"),
        ("closures", "i4"),  # rows of CLOSURE
        ("closure_count", "i4"),
        ("result", "i4"),  # register of three floats: emission or transparency; -1: the constant
        ("constant", "f4", (3,)),
    ]
)
POINT = np.dtype(
    [  # all that a program may ask of the place where it runs
        ("kind", "i4"),  # TreeKind; -1: the world, seen along -wo; -2: a lamp
        ("instance", "i4"),
        ("prim", "i4"),
        ("material", "i4"),
        ("backfacing", "i4"),
        ("visibility", "i4"),  # Visibility: the kind of the ray that came here
        ("bounces", "i4"),
        ("diffuse_bounces", "i4"),
        ("glossy_bounces", "i4"),
        ("transmission_bounces", "i4"),
        ("transparent_bounces", "i4"),
        ("time", "f4"),  # of the ray that came here, 0 to 1 while the shutter is open
        ("ray_length", "f4"),
        ("footprint", "f4"),  # about a tenth of the size of a pixel here, metres
        ("b1", "f4"),
        ("b2", "f4"),
        ("uv", "f4", (2,)),
        ("p", "f4", (3,)),  # world space, as all of these
        ("ng", "f4", (3,)),  # normals on the side that the ray came from
        ("ns", "f4", (3,)),
        ("wo", "f4", (3,)),
        ("result", "f4", (3,)),  # what a program without closures gave
    ]
)
OBJECT = np.dtype(
    [  # what is asked of an instance by programs, and where it meets its own shadow: row for row with INSTANCE
        ("color", "f4", (4,)),
        ("texture_scale", "f4", (3,)),  # generated coordinates: object space times this ...
        ("texture_offset", "f4", (3,)),  # ... plus this
        ("first_prim", "i4"),  # row of TRIANGLE or SHAPE of its first one; of hair: of STRAND
        ("attributes", "i4"),  # row of ATTRIBUTE_MAP of attribute 0, or -1
        ("number", "i4"),  # see INSTANCE_VALUE
        ("scale", "f4"),  # by how much its transform enlarges, if that keeps angles; else 0
        ("lift_below", "f4"),  # shadow rays at a cosine below this leave from where its smooth surface would be
        ("shadow_stretch", "f4"),  # angles to its normals count for so much in how bright it is; 1: for what they are
    ]
)
STRAND = np.dtype(
    [  # what programs ask of a piece of a hair
        ("start", "f4"),  # where it begins and ends on its hair, 0 to 1 of its length
        ("end", "f4"),
        ("length", "f4"),  # of the whole hair, object space
        ("random", "f4"),  # 0 to 1, a number of the hair
        ("uv", "f4", (2,)),  # of the place where the hair grows
        ("generated", "f4", (3,)),  # added to the generated coordinates of the object
    ]
)
REGISTERS = np.dtype([("value", "f4", (MAX_REGISTERS,))])
KERNEL = np.dtype([("address", "u8")])  # entry points of this process, by Family; never read from a file
CURVE = np.dtype([("value", "f4", (4,))])  # colour ramps and curves, CURVE_SIZE rows each, evenly from 0 to 1
CURVE_SIZE = 256
IMAGE = np.dtype(
    [
        ("width", "i4"),  # pixels; TILES: images
        ("height", "i4"),
        ("channels", "i4"),  # 1 or 4
        ("format", "i4"),  # TexelFormat
        ("first", "i8"),  # row of TEXEL of its lower left pixel; TILES: of IMAGE of its lower left image
    ]
)
TEXEL = np.dtype([("word", "u4")])  # 4 bytes of pixels: rows of an image follow each other, bottom row first
ATTRIBUTE_MAP = np.dtype(
    [("first", "i4")]
)  # row of ATTRIBUTE of its first triangle or piece of hair; -1: none; for each
# instance as many rows as the scene has names of attributes
ATTRIBUTE = np.dtype([("value", "f4", (3, 4))])  # at each corner of a triangle; at start and end of a piece of hair
# One for all of an instance: a block for each name, and in it a row for each instance, by the `number` of its OBJECT
INSTANCE_VALUE = np.dtype([("value", "f4", (4,))])
CELL = np.dtype([("cdf", "f4")])  # of the map by which the world is sampled, see light/background.py
