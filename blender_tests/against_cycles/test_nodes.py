# SPDX-License-Identifier: GPL-3.0-or-later
"""What shader nodes give out, pixel by pixel: the same as in Cycles."""

import bpy
import numpy as np
import pytest

from blender_tests.helpers.node_sheet import add, compared, difference, named, position

CASES = {}
TOLERANCE = 1e-3  # of the value, or where that is below 1 of 1
# {name: (a wider tolerance, the reason)}
LOOSE = {
    "Brick Texture 1": (2e-3, "edges narrower than a hundredth of a pixel's width"),
    "Brick Texture by default": (0.1, "edges narrower than a hundredth of a pixel's width"),
    "Wave Texture rings": (2e-3, "waves so narrow that a thousandth of a pixel is a thousandth of one"),
    "Math LOGARITHM": (3e-3, "to a base near 1"),
    **dict.fromkeys(
        ("Math MODULO", "Math FLOORED_MODULO", "Math SNAP"), (0.03, "by numbers near 0: it jumps within each pixel")
    ),
}

if bpy.app.version < (5, 0):
    LOOSE["Voronoi Texture 1"] = (0.02, "a twentieth of the pixels lies at borders of its cells")


def case(name):
    def add(build):
        CASES[name] = build
        return build

    return add


def component(tree, axis, **arguments):
    return add(tree, "SeparateXYZ", {0: position(tree, **arguments)}).outputs[axis]


def set_output(tree, kind, value):
    output = add(tree, kind).outputs[0]
    output.default_value = value
    return output


def color(tree):
    """A colour that varies within 0 to 1, and a bit beyond."""
    return add(tree, "VectorMath", {0: position(tree, 0.6, (0.5, 0.5, 0.45))}, operation="ADD").outputs[0]


# ---- Coordinates and the like ----------------------------------------------------------------------------------------

for output in ("Generated", "Normal", "UV", "Object", "Camera", "Window", "Reflection"):
    case(f"Texture Coordinate {output}")(lambda tree, output=output: add(tree, "TexCoord").outputs[output])
for output in ("Position", "Normal", "True Normal", "Incoming", "Parametric", "Backfacing", "Tangent"):
    case(f"Geometry {output}")(lambda tree, output=output: add(tree, "NewGeometry").outputs[output])
for output in ("Location", "Color", "Alpha", "Object Index", "Material Index", "Random"):
    case(f"Object Info {output}")(lambda tree, output=output: add(tree, "ObjectInfo").outputs[output])
for output in ("Is Camera Ray", "Is Diffuse Ray", "Ray Depth", "Ray Length"):
    case(f"Light Path {output}")(lambda tree, output=output: add(tree, "LightPath").outputs[output])
for output in ("View Vector", "View Z Depth", "View Distance"):
    case(f"Camera Data {output}")(lambda tree, output=output: add(tree, "CameraData").outputs[output])
for name, output in (("Paint", "Color"), ("Paint", "Alpha"), ("Paint", "Fac"), ("Heat", "Fac"), ("Second", "Vector")):
    case(f"Attribute {name} {output}")(
        lambda tree, n=name, o=output: add(tree, "Attribute", attribute_name=n).outputs[o]
    )
for axis in "XYZ":
    case(f"Tangent about {axis}")(lambda tree, axis=axis: add(tree, "Tangent", axis=axis).outputs[0])
for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL"):

    @case(f"Mapping of a texture {kind}")
    def _mapping_of_a_texture(tree, kind=kind):
        node = add(tree, "TexGradient", {0: position(tree, 0.3)})
        mapping = node.texture_mapping
        mapping.vector_type, mapping.mapping_x, mapping.mapping_y = kind, "Y", "Z"
        mapping.translation, mapping.rotation, mapping.scale = (0.5, 0.1, 0.2), (0.1, 0.2, 0.3), (0.7, 1.5, 1.2)
        return node.outputs["Fac"]


case("UV Map")(lambda tree: add(tree, "UVMap", uv_map="Second").outputs[0])
case("UV Map none")(lambda tree: add(tree, "UVMap").outputs[0])
case("Color Attribute")(lambda tree: add(tree, "VertexColor", layer_name="Paint").outputs[0])
case("Color Attribute active")(lambda tree: add(tree, "VertexColor").outputs[0])

# ---- Maths -----------------------------------------------------------------------------------------------------------

MATH = [
    "ADD", "SUBTRACT", "MULTIPLY", "DIVIDE", "MULTIPLY_ADD", "POWER", "LOGARITHM", "SQRT", "INVERSE_SQRT",
    "ABSOLUTE", "EXPONENT", "MINIMUM", "MAXIMUM", "LESS_THAN", "GREATER_THAN", "SIGN", "COMPARE", "SMOOTH_MIN",
    "SMOOTH_MAX", "ROUND", "FLOOR", "CEIL", "TRUNC", "FRACT", "MODULO", "FLOORED_MODULO", "WRAP", "SNAP",
    "PINGPONG", "SINE", "COSINE", "TANGENT", "ARCSINE", "ARCCOSINE", "ARCTANGENT", "ARCTAN2", "SINH", "COSH",
    "TANH", "RADIANS", "DEGREES",
]  # fmt: skip
for operation in MATH:

    @case(f"Math {operation}")
    def _(tree, operation=operation):
        inputs = {0: component(tree, "X"), 1: component(tree, "Y"), 2: 0.37}
        return add(tree, "Math", inputs, operation=operation).outputs[0]


VECTOR_MATH = [
    "ADD", "SUBTRACT", "MULTIPLY", "DIVIDE", "MULTIPLY_ADD", "CROSS_PRODUCT", "PROJECT", "REFLECT", "REFRACT",
    "FACEFORWARD", "DOT_PRODUCT", "DISTANCE", "LENGTH", "SCALE", "NORMALIZE", "ABSOLUTE", "MINIMUM", "MAXIMUM",
    "FLOOR", "CEIL", "FRACTION", "MODULO", "WRAP", "SNAP", "SINE", "COSINE", "TANGENT",
]  # fmt: skip
for operation in VECTOR_MATH:

    @case(f"Vector Math {operation}")
    def _(tree, operation=operation):
        node = add(tree, "VectorMath", operation=operation)
        values = (position(tree), (0.4, -0.7, 0.9), (-0.3, 0.2, 1.1))
        for socket, value in zip([s for s in node.inputs if s.type == "VECTOR"], values, strict=False):
            if socket.enabled and isinstance(value, bpy.types.NodeSocket):
                tree.links.new(value, socket)
            else:
                socket.default_value = value
        named(node.inputs, "Scale").default_value = 0.8
        return node.outputs["Value" if operation in ("DOT_PRODUCT", "DISTANCE", "LENGTH") else "Vector"]


for interpolation in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP"):
    for data_type in ("FLOAT", "FLOAT_VECTOR"):

        @case(f"Map Range {interpolation} {data_type}")
        def _(tree, interpolation=interpolation, data_type=data_type):
            node = add(tree, "MapRange", interpolation_type=interpolation, data_type=data_type)
            if data_type == "FLOAT":
                tree.links.new(component(tree, "X"), node.inputs[0])
                numbers = (-0.4, 0.7, 0.2, 1.5)
                for name, value in zip(("From Min", "From Max", "To Min", "To Max"), numbers, strict=True):
                    named(node.inputs, name).default_value = value
                return node.outputs[0]
            tree.links.new(position(tree), named(node.inputs, "Vector"))
            return named(node.outputs, "Vector")


for kind in ("MINMAX", "RANGE"):
    case(f"Clamp {kind}")(
        lambda tree, kind=kind: add(tree, "Clamp", {0: component(tree, "X"), 1: 0.6, 2: -0.3}, clamp_type=kind).outputs[
            0
        ]
    )
case("Math clamped")(
    lambda tree: add(tree, "Math", {0: component(tree, "X"), 1: 0.5}, operation="ADD", use_clamp=True).outputs[0]
)
case("Separate XYZ")(lambda tree: component(tree, "Y"))
case("Value")(lambda tree: set_output(tree, "Value", 0.37))
case("Color")(lambda tree: set_output(tree, "RGB", (0.7, 0.2, 0.4, 1.0)))
case("Combine XYZ")(lambda tree: add(tree, "CombineXYZ", {0: component(tree, "Z"), 1: component(tree, "X")}).outputs[0])
case("Math of a vector")(lambda tree: add(tree, "Math", {0: position(tree), 1: 0.0}).outputs[0])
case("Math of a color")(lambda tree: add(tree, "Math", {0: add(tree, "Gamma", {0: color(tree)}).outputs[0]}).outputs[0])

# ---- Colours ---------------------------------------------------------------------------------------------------------

BLENDS = [
    "MIX", "DARKEN", "MULTIPLY", "BURN", "LIGHTEN", "SCREEN", "DODGE", "ADD", "OVERLAY", "SOFT_LIGHT",
    "LINEAR_LIGHT", "DIFFERENCE", "EXCLUSION", "SUBTRACT", "DIVIDE", "HUE", "SATURATION", "COLOR", "VALUE",
]  # fmt: skip
for blend in BLENDS:

    @case(f"Mix {blend}")
    def _(tree, blend=blend):
        node = add(tree, "Mix", data_type="RGBA", blend_type=blend, clamp_factor=False)
        named(node.inputs, "Factor_Float").default_value = 0.7
        tree.links.new(color(tree), named(node.inputs, "A_Color"))
        named(node.inputs, "B_Color").default_value = (0.8, 0.35, 0.15, 1.0)
        return named(node.outputs, "Result_Color")


case("Mix (Legacy) SCREEN")(
    lambda tree: add(tree, "MixRGB", {0: 0.7, 1: color(tree), 2: (0.8, 0.4, 0.1, 1)}, blend_type="SCREEN").outputs[0]
)
for output in ("Quadratic", "Linear", "Constant"):
    case(f"Light Falloff {output}")(
        lambda tree, output=output: add(tree, "LightFalloff", {0: 0.1, 1: 0.5}).outputs[output]
    )


@case("Mix FLOAT")
def _(tree):
    node = add(tree, "Mix", data_type="FLOAT")
    tree.links.new(component(tree, "X"), named(node.inputs, "Factor_Float"))
    named(node.inputs, "A_Float").default_value, named(node.inputs, "B_Float").default_value = 2.0, -1.0
    return named(node.outputs, "Result_Float")


@case("Mix VECTOR")
def _(tree):
    node = add(tree, "Mix", data_type="VECTOR", factor_mode="NON_UNIFORM")
    tree.links.new(position(tree), named(node.inputs, "Factor_Vector"))
    named(node.inputs, "A_Vector").default_value = (2.0, 1.0, 0.0)
    named(node.inputs, "B_Vector").default_value = (-1.0, 3.0, 0.5)
    return named(node.outputs, "Result_Vector")


case("Hue/Saturation/Value")(
    lambda tree: add(tree, "HueSaturation", {0: 0.7, 1: 1.3, 2: 0.8, 3: 0.9, 4: color(tree)}).outputs[0]
)
case("Invert Color")(lambda tree: add(tree, "Invert", {0: 0.6, 1: color(tree)}).outputs[0])
case("Gamma")(lambda tree: add(tree, "Gamma", {0: color(tree), 1: 2.2}).outputs[0])
case("Brightness/Contrast")(lambda tree: add(tree, "BrightContrast", {0: color(tree), 1: 0.1, 2: 0.4}).outputs[0])
case("RGB to BW")(lambda tree: add(tree, "RGBToBW", {0: color(tree)}).outputs[0])
for mode in ("RGB", "HSV", "HSL"):
    case(f"Separate Color {mode}")(
        lambda tree, mode=mode: add(tree, "SeparateColor", {0: color(tree)}, mode=mode).outputs[0]
    )
    case(f"Combine Color {mode}")(
        lambda tree, mode=mode: add(
            tree, "CombineColor", {0: component(tree, "X", scale=0.4, offset=(0.5, 0, 0)), 1: 0.7, 2: 0.6}, mode=mode
        ).outputs[0]
    )
case("Blackbody")(
    lambda tree: add(tree, "Blackbody", {0: component(tree, "X", scale=6000.0, offset=(6000.0, 0, 0))}).outputs[0]
)
for interpolation in ("LINEAR", "CONSTANT", "EASE", "B_SPLINE"):

    @case(f"Color Ramp {interpolation}")
    def _(tree, interpolation=interpolation):
        node = add(tree, "ValToRGB", {0: component(tree, "X")})
        node.color_ramp.interpolation = interpolation
        node.color_ramp.elements.new(0.35).color = (1.0, 0.2, 0.1, 0.5)
        return node.outputs[0]


def bend(mapping, curve):
    mapping.curves[curve].points.new(0.3, 0.6)
    mapping.update()


@case("RGB Curves")
def _(tree):
    node = add(tree, "RGBCurve", {0: 0.8, 1: color(tree)})
    bend(node.mapping, 0)
    bend(node.mapping, 3)
    return node.outputs[0]


@case("Vector Curves")
def _(tree):
    node = add(tree, "VectorCurve", {0: 0.8, 1: position(tree)})
    bend(node.mapping, 1)
    return node.outputs[0]


@case("Float Curve")
def _(tree):
    node = add(tree, "FloatCurve", {0: 0.9, 1: component(tree, "X")})
    bend(node.mapping, 0)
    return node.outputs[0]


# ---- Vectors ---------------------------------------------------------------------------------------------------------

for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL"):

    @case(f"Mapping {kind}")
    def _(tree, kind=kind):
        node = add(tree, "Mapping", {"Vector": position(tree)}, vector_type=kind)
        for name, value in (("Location", (0.3, 0.1, -0.2)), ("Rotation", (0.4, -0.9, 1.3)), ("Scale", (2, 0.5, 1.5))):
            named(node.inputs, name).default_value = value
        return node.outputs[0]


for kind in ("AXIS_ANGLE", "X_AXIS", "Y_AXIS", "Z_AXIS", "EULER_XYZ"):
    for invert in (False, True):

        @case(f"Vector Rotate {kind} {invert}")
        def _(tree, kind=kind, invert=invert):
            node = add(tree, "VectorRotate", {"Vector": position(tree)}, rotation_type=kind, invert=invert)
            for name, value in (
                ("Center", (0.1, 0.2, 0.3)),
                ("Axis", (1.0, 2.0, -0.5)),
                ("Rotation", (0.3, 0.7, -1.2)),
            ):
                named(node.inputs, name).default_value = value
            named(node.inputs, "Angle").default_value = 0.8
            return node.outputs[0]


for kind in ("POINT", "VECTOR", "NORMAL"):
    for start, end in (("WORLD", "OBJECT"), ("OBJECT", "WORLD"), ("WORLD", "CAMERA"), ("CAMERA", "OBJECT")):
        case(f"Vector Transform {kind} {start} {end}")(
            lambda tree, kind=kind, start=start, end=end: add(
                tree,
                "VectorTransform",
                {0: position(tree)},
                vector_type=kind,
                convert_from=start,
                convert_to=end,
            ).outputs[0]
        )
case("Normal Dot")(lambda tree: add(tree, "Normal", {0: position(tree)}).outputs["Dot"])
case("Fresnel")(lambda tree: add(tree, "Fresnel", {0: 1.6}).outputs[0])
case("Layer Weight Fresnel")(lambda tree: add(tree, "LayerWeight", {0: 0.3}).outputs[0])
case("Layer Weight Facing")(lambda tree: add(tree, "LayerWeight", {0: 0.3}).outputs[1])


@case("Bump, slopes over some pixels")
def _(tree):
    noise = add(tree, "TexNoise", {"Vector": position(tree), "Scale": 3.0, "Detail": 8.0}).outputs[0]
    return add(tree, "Bump", {"Height": noise, "Distance": 0.1, "Filter Width": 4.0}).outputs[0]


@case("Bump")
def _(tree):
    height = add(tree, "Math", {0: component(tree, "X"), 1: component(tree, "Y")}, operation="MULTIPLY")
    return add(tree, "Bump", {"Strength": 0.6, "Distance": 0.4, "Height": height.outputs[0]}).outputs[0]


for space in ("TANGENT", "OBJECT", "WORLD", "BLENDER_OBJECT", "BLENDER_WORLD"):
    case(f"Normal Map {space}")(
        lambda tree, space=space: add(
            tree, "NormalMap", {"Color": (0.7, 0.4, 0.9, 1.0), "Strength": 0.8}, space=space
        ).outputs[0]
    )

if bpy.app.version >= (5, 0):
    case("Normal Map DIRECTX")(
        lambda tree: add(tree, "NormalMap", {"Color": (0.7, 0.4, 0.9, 1.0)}, convention="DIRECTX").outputs[0]
    )

# ---- Procedural textures: which numbers go where; what they make of them is tested in test_textures ------------------


def texture(tree, kind, output=0, **properties):
    """A texture node with its own numbers, made uneven."""
    node = add(tree, kind, {0: position(tree, 1.3)}, **properties)
    for number, socket in enumerate(node.inputs):
        if socket.type == "VALUE":
            socket.default_value = min(max(socket.default_value * 0.9 + 0.05 * number, socket.default_value * 0.5), 3.0)
    return node.outputs[output]


for kind in ("Noise", "Voronoi", "Wave", "Magic", "Checker", "Brick", "Gabor"):
    for output in (0, 1):
        case(f"{kind} Texture {output}")(lambda tree, kind=kind, output=output: texture(tree, f"Tex{kind}", output))
    case(f"{kind} Texture by default")(lambda tree, kind=kind: add(tree, f"Tex{kind}").outputs[0])
for output in (0, 1):
    case(f"White Noise Texture {output}")(
        lambda tree, output=output: add(
            tree, "TexWhiteNoise", {0: add(tree, "VectorMath", {0: position(tree, 4.0)}, operation="FLOOR").outputs[0]}
        ).outputs[output]
    )
case("Tangent UV")(lambda tree: add(tree, "Tangent", direction_type="UV_MAP").outputs[0])
case("Gradient Texture")(lambda tree: texture(tree, "TexGradient", gradient_type="RADIAL"))
case("Noise Texture ridged")(
    lambda tree: texture(tree, "TexNoise", noise_dimensions="4D", noise_type="RIDGED_MULTIFRACTAL")
)
case("Voronoi Texture SMOOTH_F1")(lambda tree: texture(tree, "TexVoronoi", 2, feature="SMOOTH_F1"))
case("Voronoi Texture DISTANCE_TO_EDGE")(lambda tree: texture(tree, "TexVoronoi", feature="DISTANCE_TO_EDGE"))
case("Wave Texture rings")(
    lambda tree: texture(tree, "TexWave", wave_type="RINGS", rings_direction="Y", wave_profile="TRI")
)
case("Wavelength")(
    lambda tree: add(tree, "Wavelength", {0: component(tree, "X", scale=150.0, offset=(550.0, 0, 0))}).outputs[0]
)

# ---- Images ----------------------------------------------------------------------------------------------------------


def picture(is_float=False, alpha=True, colorspace=None):
    """A generated image of 5 x 4 random pixels."""
    image = bpy.data.images.new("Picture", 5, 4, alpha=alpha, float_buffer=is_float)
    pixels = np.random.default_rng(1).random((20, 4), dtype=np.float32)
    if not alpha:
        pixels[:, 3] = 1.0
    if colorspace:
        image.colorspace_settings.name = colorspace
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    return image


def image_texture(tree, vector=None, output="Color", image=None, **properties):
    node = add(tree, "TexImage", {0: vector} if vector else {}, **properties)
    node.image = image or picture()
    return node.outputs[output]


for interpolation in ("Linear", "Closest", "Cubic"):
    for extension in ("REPEAT", "EXTEND", "CLIP", "MIRROR"):
        case(f"Image Texture {interpolation} {extension}")(
            lambda tree, i=interpolation, e=extension: image_texture(
                tree, position(tree, 1.1), interpolation=i, extension=e
            )
        )
for projection in ("FLAT", "BOX", "SPHERE", "TUBE"):
    case(f"Image Texture {projection}")(
        lambda tree, p=projection: image_texture(tree, position(tree), projection=p, projection_blend=0.3)
    )
    case(f"Image Texture {projection} by default")(lambda tree, p=projection: image_texture(tree, projection=p))
case("Image Texture Alpha")(lambda tree: image_texture(tree, output="Alpha"))
case("Image Texture float")(lambda tree: image_texture(tree, image=picture(is_float=True, alpha=False)))
case("Image Texture opaque")(lambda tree: image_texture(tree, image=picture(alpha=False)))
case("Image Texture data")(lambda tree: image_texture(tree, image=picture(colorspace="Non-Color")))


@case("Image Texture with its alpha")
def _(tree):
    node = add(tree, "TexImage")
    node.image = picture()
    return add(tree, "VectorMath", {0: node.outputs[0], 1: node.outputs[1]}, operation="ADD").outputs[0]


for projection in ("EQUIRECTANGULAR", "MIRROR_BALL"):

    @case(f"Environment Texture {projection}")
    def _(tree, projection=projection):
        node = add(tree, "TexEnvironment", {0: position(tree)}, projection=projection)
        node.image = picture()
        return node.outputs[0]


# ---- The comparison --------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pictures():
    return compared(CASES)


@pytest.mark.parametrize("name", CASES)
def test_a_node_gives_what_it_gives_in_cycles(pictures, name):
    tolerance, _ = LOOSE.get(name, (TOLERANCE, ""))
    assert difference(*pictures[name]) <= tolerance
