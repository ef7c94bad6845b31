# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that calculate: Blender's converters, colours and vectors. Functions take (values, node, output, groups)."""

import math

import numpy as np

from ..core import CURVE_SIZE, graph, opcodes

Op = opcodes.Op
ZERO3 = (0.0, 0.0, 0.0)
CLAMPED, CLAMPED_RESULT = opcodes.CLAMPED, opcodes.CLAMPED_RESULT


def _rgb(values, node, output, groups):
    return tuple(output.default_value)[:3]


def _value(values, node, output, groups):
    return float(output.default_value)


def _math(values, node, output, groups):
    a, b, c = (values.number(node, groups, name) for name in ("Value", "Value_001", "Value_002"))
    mode = opcodes.Math[node.operation] + (CLAMPED_RESULT if node.use_clamp else 0)
    return graph.node(Op.MATH, a, b, c, mode=mode)


def _vector_math(values, node, output, groups):
    a, b, c = (values.vector(node, groups, name) for name in ("Vector", "Vector_001", "Vector_002"))
    result = graph.node(
        Op.VECTOR_MATH, a, b, c, values.number(node, groups, "Scale"), mode=opcodes.VectorMath[node.operation]
    )
    return graph.part(result, 3) if output.identifier == "Value" else graph.part(result, 0, 3)


def _clamp(values, node, output, groups):
    a = [values.number(node, groups, name) for name in ("Value", "Min", "Max")]
    return graph.node(Op.CLAMP, *a, mode=int(node.clamp_type == "RANGE"))


def _map_range(values, node, output, groups):
    mode = opcodes.Range[node.interpolation_type]
    if node.clamp:
        mode += CLAMPED
    if node.data_type == "FLOAT_VECTOR":
        names = ("Vector", "From_Min_FLOAT3", "From_Max_FLOAT3", "To_Min_FLOAT3", "To_Max_FLOAT3", "Steps_FLOAT3")
        return graph.node(Op.MAP_RANGE_VECTOR, *(values.vector(node, groups, n) for n in names), mode=mode)
    names = ("Value", "From Min", "From Max", "To Min", "To Max", "Steps")
    return graph.node(Op.MAP_RANGE, *(values.number(node, groups, n) for n in names), mode=mode)


def _mix(values, node, output, groups):
    clamps = CLAMPED if node.clamp_factor else 0
    if node.data_type == "RGBA":
        a, b = (values.color(node, groups, name) for name in ("A_Color", "B_Color"))
        factor = values.number(node, groups, "Factor_Float")
        return _blend(factor, a, b, node.blend_type, clamps + (CLAMPED_RESULT if node.clamp_result else 0))
    if node.data_type == "VECTOR":
        a, b = (values.vector(node, groups, name) for name in ("A_Vector", "B_Vector"))
        uniform = node.factor_mode == "UNIFORM"
        factor = (
            graph.splat(values.number(node, groups, "Factor_Float"))
            if uniform
            else values.vector(node, groups, "Factor_Vector")
        )
        return graph.node(Op.MIX_VECTOR, factor, a, b, mode=clamps)
    a, b = (values.number(node, groups, name) for name in ("A_Float", "B_Float"))
    return graph.node(Op.MIX_NUMBER, values.number(node, groups, "Factor_Float"), a, b, mode=clamps)


def _mix_rgb(values, node, output, groups):
    a, b = (values.color(node, groups, name) for name in ("Color1", "Color2"))
    clamps = CLAMPED + (CLAMPED_RESULT if node.use_clamp else 0)
    return _blend(values.number(node, groups, "Fac"), a, b, node.blend_type, clamps)


def _blend(factor, a, b, blend_type, flags):
    if graph.is_constant(factor) and factor <= 0.0 and flags == CLAMPED:
        return a
    return graph.node(Op.BLEND, factor, a, b, mode=opcodes.Blend[blend_type] + flags)


def _separate_xyz(values, node, output, groups):
    return graph.part(values.vector(node, groups, "Vector"), "XYZ".index(output.identifier))


def _combine_xyz(values, node, output, groups):
    return _combined(*(values.number(node, groups, name) for name in "XYZ"))


def _input_vector(values, node, output, groups):
    """What Blender leaves of constant nodes when it resolves a tree."""
    return tuple(float(v) for v in node.vector)


def _combined(x, y, z):
    if all(graph.is_constant(v) for v in (x, y, z)):
        return (x, y, z)
    return graph.node(Op.COMBINE, x, y, z)


def _separate_color(values, node, output, groups):
    color = values.color(node, groups, "Color")
    if node.mode != "RGB":
        color = graph.node(Op.SEPARATE_COLOR, color, mode=opcodes.ColorModel[node.mode])
    return graph.part(color, ("Red", "Green", "Blue").index(output.identifier))


def _combine_color(values, node, output, groups):
    color = _combined(*(values.number(node, groups, name) for name in ("Red", "Green", "Blue")))
    return color if node.mode == "RGB" else graph.node(Op.COMBINE_COLOR, color, mode=opcodes.ColorModel[node.mode])


def _separate_rgb(values, node, output, groups):
    return graph.part(values.color(node, groups, "Image"), "RGB".index(output.identifier))


def _combine_rgb(values, node, output, groups):
    return _combined(*(values.number(node, groups, name) for name in "RGB"))


def _separate_hsv(values, node, output, groups):
    return graph.part(
        graph.node(Op.SEPARATE_COLOR, values.color(node, groups, "Color"), mode=opcodes.ColorModel.HSV),
        "HSV".index(output.identifier),
    )


def _combine_hsv(values, node, output, groups):
    hsv = _combined(*(values.number(node, groups, name) for name in "HSV"))
    return graph.node(Op.COMBINE_COLOR, hsv, mode=opcodes.ColorModel.HSV)


def _rgb_to_bw(values, node, output, groups):
    return graph.luminance(values.color(node, groups, "Color"))


def _hue_saturation(values, node, output, groups):
    numbers = [values.number(node, groups, name) for name in ("Hue", "Saturation", "Value", "Fac")]
    return graph.node(Op.HUE_SATURATION, *numbers, values.color(node, groups, "Color"))


def _invert(values, node, output, groups):
    return graph.node(Op.INVERT, values.number(node, groups, "Fac"), values.color(node, groups, "Color"))


def _gamma(values, node, output, groups):
    return graph.node(Op.GAMMA, values.color(node, groups, "Color"), values.number(node, groups, "Gamma"))


def _bright_contrast(values, node, output, groups):
    bright, contrast = (values.number(node, groups, name) for name in ("Bright", "Contrast"))
    return graph.node(Op.BRIGHT_CONTRAST, values.color(node, groups, "Color"), bright, contrast)


def _blackbody(values, node, output, groups):
    return graph.node(Op.BLACKBODY, values.number(node, groups, "Temperature"))


def _wavelength(values, node, output, groups):
    return graph.node(Op.WAVELENGTH, values.number(node, groups, "Wavelength"))


# ---- Curves ----------------------------------------------------------------------------------------------------------


def _color_ramp(values, node, output, groups):
    ramp = node.color_ramp
    table = np.array([ramp.evaluate(i / (CURVE_SIZE - 1)) for i in range(CURVE_SIZE)], np.float32)
    steps = int(ramp.interpolation == "CONSTANT")
    result = graph.node(Op.RAMP, values.number(node, groups, "Fac"), mode=steps, data=graph.Curve(table))
    return graph.part(result, 3) if output.identifier == "Alpha" else graph.part(result, 0, 3)


def _curve_table(mapping, used, through=None):
    """(Curve, first x, 1 / width of its range) of curves of a CurveMapping, over the range that their points span."""
    mapping.initialize()
    points = [p.location[0] for curve in mapping.curves for p in curve.points]
    low, high = min(points), max(points)
    positions = np.linspace(low, high, CURVE_SIZE)
    if through is not None:
        positions = [mapping.evaluate(through, float(x)) for x in positions]
    table = np.zeros((CURVE_SIZE, 4), np.float32)
    for channel, curve in enumerate(used):
        table[:, channel] = [mapping.evaluate(curve, float(x)) for x in positions]
    return graph.Curve(table), low, 1.0 / max(high - low, 1e-6)


def _curves(values, node, groups, color, factor, through):
    mapping = node.mapping
    combined = mapping.curves[3] if through else None
    curve, low, scale = _curve_table(mapping, list(mapping.curves)[:3], combined)
    extends = int(mapping.extend == "EXTRAPOLATED")
    return graph.node(Op.CURVES, factor, color, low, scale, mode=extends, data=curve)


def _rgb_curves(values, node, output, groups):
    color, factor = values.color(node, groups, "Color"), values.number(node, groups, "Fac")
    return _curves(values, node, groups, color, factor, True)


def _vector_curves(values, node, output, groups):
    vector, factor = values.vector(node, groups, "Vector"), values.number(node, groups, "Fac")
    return _curves(values, node, groups, vector, factor, False)


def _float_curve(values, node, output, groups):
    mapping = node.mapping
    curve, low, scale = _curve_table(mapping, list(mapping.curves)[:1])
    extends = int(mapping.extend == "EXTRAPOLATED")
    factor, value = values.number(node, groups, "Factor"), values.number(node, groups, "Value")
    return graph.node(Op.CURVE, factor, value, low, scale, mode=extends, data=curve)


# ---- Vectors ---------------------------------------------------------------------------------------------------------


def _mapping(values, node, output, groups):
    vectors = [values.vector(node, groups, name) for name in ("Vector", "Location", "Rotation", "Scale")]
    return graph.node(Op.MAPPING, *vectors, mode=opcodes.Mapping[node.vector_type])


def _vector_rotate(values, node, output, groups):
    vector, center, axis = (values.vector(node, groups, name) for name in ("Vector", "Center", "Axis"))
    angle, rotation = values.number(node, groups, "Angle"), values.vector(node, groups, "Rotation")
    mode = opcodes.Rotation[node.rotation_type] + (CLAMPED if node.invert else 0)
    return graph.node(Op.ROTATE, vector, center, axis, angle, rotation, mode=mode)


def _vector_transform(values, node, output, groups):
    kind = ("POINT", "VECTOR", "NORMAL").index(node.vector_type)
    mode = kind * 9 + opcodes.Space[node.convert_from] * 3 + opcodes.Space[node.convert_to]
    return graph.node(Op.CHANGE_SPACE, values.vector(node, groups, "Vector"), mode=mode)


def _normal(values, node, output, groups):
    own = tuple(node.outputs["Normal"].default_value)
    if output.identifier == "Normal":
        return own
    unit = [
        graph.part(graph.node(Op.VECTOR_MATH, v, ZERO3, ZERO3, 0.0, mode=opcodes.VectorMath.NORMALIZE), 0, 3)
        for v in (own, values.vector(node, groups, "Normal"))
    ]
    return graph.part(graph.node(Op.VECTOR_MATH, *unit, ZERO3, 0.0, mode=opcodes.VectorMath.DOT_PRODUCT), 3)


TILING = {  # first float, floats
    "Segment Coordinates": (0, 3),
    "Segment Width": (3, 1),
    "Segment Rotation": (4, 1),
    "Segment ID": (5, 1),
}


def _radial_tiling(values, node, output, groups):
    vector = values.vector(node, groups, "Vector")
    if graph.is_constant(vector):
        vector = (*vector, 0.0, 0.0)[:3]  # its own value has two numbers
    sides, roundness = (values.number(node, groups, name) for name in ("Sides", "Roundness"))
    tile = graph.node(Op.RADIAL_TILING, vector, sides, roundness, mode=int(node.normalize))
    return graph.part(tile, *TILING[output.identifier])


def _squeeze(values, node, output, groups):
    """A sigmoid of (value - centre) * width. Cycles has none of it; this is what Blender's own engines do."""
    value, width, center = (values.number(node, groups, name) for name in ("Value", "Width", "Center"))
    x = graph.node(Op.MATH, center, value, 0.0, mode=opcodes.Math.SUBTRACT)
    power = graph.node(Op.MATH, math.e, graph.product(x, width), 0.0, mode=opcodes.Math.POWER)
    return graph.node(Op.MATH, 1.0, graph.node(Op.MATH, power, 1.0, 0.0), 0.0, mode=opcodes.Math.DIVIDE)


FUNCTIONS = {
    "RGB": _rgb,
    "VALUE": _value,
    "INPUT_VECTOR": _input_vector,
    "MATH": _math,
    "VECT_MATH": _vector_math,
    "CLAMP": _clamp,
    "MAP_RANGE": _map_range,
    "MIX": _mix,
    "MIX_RGB": _mix_rgb,
    "SEPXYZ": _separate_xyz,
    "COMBXYZ": _combine_xyz,
    "SEPARATE_COLOR": _separate_color,
    "COMBINE_COLOR": _combine_color,
    "SEPRGB": _separate_rgb,
    "COMBRGB": _combine_rgb,
    "SEPHSV": _separate_hsv,
    "COMBHSV": _combine_hsv,
    "RGBTOBW": _rgb_to_bw,
    "HUE_SAT": _hue_saturation,
    "INVERT": _invert,
    "GAMMA": _gamma,
    "BRIGHTCONTRAST": _bright_contrast,
    "BLACKBODY": _blackbody,
    "WAVELENGTH": _wavelength,
    "VALTORGB": _color_ramp,
    "CURVE_RGB": _rgb_curves,
    "CURVE_VEC": _vector_curves,
    "CURVE_FLOAT": _float_curve,
    "MAPPING": _mapping,
    "VECTOR_ROTATE": _vector_rotate,
    "VECT_TRANSFORM": _vector_transform,
    "NORMAL": _normal,
    "ShaderNodeRadialTiling": _radial_tiling,
    "SQUEEZE": _squeeze,
}
