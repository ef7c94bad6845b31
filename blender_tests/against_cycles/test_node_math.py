# SPDX-License-Identifier: GPL-3.0-or-later
"""Arithmetic and colour nodes give what Cycles gives, pixel by pixel, in all modes, undefined places included."""

import bpy
import numpy as np
import pytest

from blender_tests.helpers.node_values import Case, assert_same, cycles_values
from engine_core.linalg import blend, color, scalar_math, vector_math
from engine_core.linalg.blend import BlendMode
from engine_core.linalg.color import ColorModel
from engine_core.linalg.scalar_math import Interpolation, MathOp
from engine_core.linalg.vec3 import Vec3
from engine_core.linalg.vector_math import MappingKind, RotationKind, VectorMathOp
from engine_core.texture.cells import VoronoiMetric
from engine_core.texture.gradient import GradientKind
from engine_core.texture.noise import NoiseKind
from engine_core.texture.voronoi import VoronoiFeature
from engine_core.texture.wave import WaveDirection, WaveKind, WaveProfile

f = np.float32
ZERO = Vec3(0, 0, 0)


def math_cases():
    """Each operation on numbers that vary, and with a last one of 0, where many operations need a rule."""
    names = ("Value", "Value_001", "Value_002")
    for op in MathOp:
        for last in ("p.z", 0.0):
            inputs = dict(zip(names, ("p.x", "p.y", last), strict=True))
            if last == 0.0:
                inputs["Value_001"] = 0.0

            def ours(p, q, w, op=op, last=last):
                return scalar_math.evaluate(int(op), p.x, *((p.y, p.z) if last else (f(0), f(0))))

            settings = {"operation": op.name}
            varies = bool(last) or op not in CONSTANT_OF_ZERO
            yield Case(f"{op.name} {last}", "Math", ours, ("Value",), settings, inputs, varies=varies)


CONSTANT_OF_ZERO = {
    *(MathOp.MULTIPLY, MathOp.MULTIPLY_ADD, MathOp.DIVIDE, MathOp.POWER, MathOp.LOGARITHM, MathOp.MODULO),
    *(MathOp.FLOORED_MODULO, MathOp.WRAP, MathOp.SNAP, MathOp.PINGPONG, MathOp.COMPARE),
}


def vector_math_cases():
    offered = bpy.types.ShaderNodeVectorMath.bl_rna.properties["operation"].enum_items
    for op in (op for op in VectorMathOp if op.name in offered):
        inputs = {"Vector": "p", "Vector_001": "q", "Vector_002": (0.3, -0.4, 0.9), "Scale": "w"}

        def ours(p, q, w, op=op):
            sample = vector_math.evaluate(int(op), p, q, Vec3(0.3, -0.4, 0.9), w)
            return sample.value if op in SCALARS else sample.vector

        output = "Value" if op in SCALARS else "Vector"
        yield Case(f"vector {op.name}", "VectorMath", ours, (output,), {"operation": op.name}, inputs)


SCALARS = (VectorMathOp.DOT_PRODUCT, VectorMathOp.DISTANCE, VectorMathOp.LENGTH)


def range_cases():
    for kind in Interpolation:
        for low, high in ((-1.0, 1.5), (1.2, -0.7)):
            settings = {"interpolation_type": kind.name, "clamp": False}
            numbers = (low, high, 2.0, -0.5, 3.0)
            names = ("From Min", "From Max", "To Min", "To Max", "Steps")
            inputs = {"Value": "p.x"} | dict(zip(names, numbers, strict=True))

            def ours(p, q, w, kind=kind, numbers=numbers):
                return scalar_math.map_range(int(kind), p.x, *[f(x) for x in numbers])

            yield Case(f"range {kind.name} {low}", "MapRange", ours, ("Result",), settings, inputs)
            for clamped in (False, True):
                vectors = ((low, 0.4, -0.2), (high, 0.4, 0.9), (2.0, 0.0, 0.1), (-0.5, 1.0, 3.0), (3.0, 4.0, 0.0))
                names = ("From_Min_FLOAT3", "From_Max_FLOAT3", "To_Min_FLOAT3", "To_Max_FLOAT3", "Steps_FLOAT3")
                inputs = {"Vector": "p"} | dict(zip(names, vectors, strict=True))
                settings = {"data_type": "FLOAT_VECTOR", "interpolation_type": kind.name, "clamp": clamped}

                def ours(p, q, w, kind=kind, vectors=vectors, clamped=clamped):
                    return vector_math.map_range(int(kind), p, *[Vec3(*v) for v in vectors], clamped)

                name = f"vector range {kind.name} {low} {clamped}"
                yield Case(name, "MapRange", ours, ("Vector",), settings, inputs)
    for kind in ("MINMAX", "RANGE"):
        step = scalar_math.clamp if kind == "MINMAX" else scalar_math.clamp_range

        def ours(p, q, w, step=step):
            return step(p.x, p.y, p.z)

        inputs = {"Value": "p.x", "Min": "p.y", "Max": "p.z"}
        yield Case(f"clamp {kind}", "Clamp", ours, ("Result",), {"clamp_type": kind}, inputs)


def turning_cases():
    center, axis, euler = Vec3(0.3, -0.2, 0.5), Vec3(0.5, 0.7, -1.1), Vec3(0.4, -1.3, 2.2)
    for kind in RotationKind:
        for invert in (False, True):
            settings = {"rotation_type": kind.name, "invert": invert}
            inputs = {"Vector": "p", "Center": tuple(center), "Angle": "w"}
            if kind == RotationKind.AXIS_ANGLE:
                inputs["Axis"] = tuple(axis)
            if kind == RotationKind.EULER_XYZ:
                inputs["Rotation"] = tuple(euler)

            def ours(p, q, w, kind=kind, invert=invert):
                return vector_math.rotate(int(kind), p, center, axis, w, euler, invert)

            yield Case(f"rotate {kind.name} {invert}", "VectorRotate", ours, ("Vector",), settings, inputs)
    inputs = {"Vector": "p", "Center": tuple(center), "Axis": (0, 0, 0), "Angle": "w"}
    yield Case("rotate about nothing", "VectorRotate", lambda p, q, w: p, ("Vector",), {}, inputs)
    for kind in MappingKind:
        for scale in (Vec3(1.5, -0.6, 2.0), Vec3(1.0, 0.0, 3.0)):
            inputs = {"Vector": "p", "Rotation": tuple(euler), "Scale": tuple(scale)}
            if kind in (MappingKind.POINT, MappingKind.TEXTURE):
                inputs["Location"] = tuple(center)

            def ours(p, q, w, kind=kind, scale=scale):
                return vector_math.mapping(int(kind), p, center, euler, scale)

            name = f"mapping {kind.name} {scale.y}"
            yield Case(name, "Mapping", ours, ("Vector",), {"vector_type": kind.name}, inputs)


def blend_cases():
    """Colours and factors beyond 0 to 1 too; the factor is clamped by default, as the kernel leaves it to the node."""
    for mode in BlendMode:
        for low, clamped in ((0.0, True), (-0.7, False)):
            settings = {"data_type": "RGBA", "blend_type": mode.name, "clamp_factor": clamped}
            inputs = {"Factor_Float": "w", "A_Color": "p", "B_Color": "q"}

            def ours(p, q, w, mode=mode, clamped=clamped):
                return blend.blend(int(mode), scalar_math.clamp(w, f(0), f(1)) if clamped else w, p, q)

            yield Case(f"mix {mode.name} {low}", "Mix", ours, ("Result_Color",), settings, inputs, 1.4, low)


def color_cases():
    settings_of = {model: {"mode": model.name} for model in ColorModel}
    for model, settings in settings_of.items():
        for low in (0.0, -0.4):
            inputs = {"Red": "p.x", "Green": "p.y", "Blue": "p.z"}

            def ours(p, q, w, model=model):
                return color.combine(int(model), p)

            yield Case(f"combine {model.name} {low}", "CombineColor", ours, ("Color",), settings, inputs, 1.0, low)

            def ours(p, q, w, model=model):
                return color.separate(int(model), p)

            outputs = ("Red", "Green", "Blue")
            yield Case(
                f"separate {model.name} {low}", "SeparateColor", ours, outputs, settings, {"Color": "p"}, 1.3, low
            )
    for numbers in ((0.5, 1.0, 1.0, 1.0), (0.1, 1.6, 0.7, 0.8), (1.3, 0.4, 2.0, 1.5)):
        inputs = dict(zip(("Hue", "Saturation", "Value", "Fac"), numbers, strict=True)) | {"Color": "p"}

        def ours(p, q, w, numbers=numbers):
            return color.hue_saturation(p, *[f(x) for x in numbers])

        yield Case(f"hue {numbers}", "HueSaturation", ours, ("Color",), {}, inputs, 1.2, 0.0)
    inputs = {"Color": "p", "Bright": "q.x", "Contrast": "w"}
    yield Case(
        "bright contrast", "BrightContrast", lambda p, q, w: color.bright_contrast(p, q.x, w), ("Color",), {}, inputs
    )
    yield Case("gamma", "Gamma", lambda p, q, w: color.gamma(p, w), ("Color",), {}, {"Color": "p", "Gamma": "w"})
    yield Case(
        "gamma 0",
        "Gamma",
        lambda p, q, w: color.gamma(p, f(0)),
        ("Color",),
        {},
        {"Color": "p", "Gamma": 0.0},
        varies=False,
    )
    yield Case(
        "invert", "Invert", lambda p, q, w: color.invert(p, w), ("Color",), {}, {"Color": "p", "Fac": "w"}, 1.0, 0.0
    )
    for low, high in ((600, 1300), (1300, 4000), (4000, 13000)):

        def ours(p, q, w):
            return color.not_negative(color.blackbody(w))

        yield Case(f"blackbody {low}", "Blackbody", ours, ("Color",), {}, {"Temperature": "w"}, high, low)
    yield Case(
        "wavelength", "Wavelength", lambda p, q, w: color.wavelength(w), ("Color",), {}, {"Wavelength": "w"}, 800, 381
    )


CASES = [
    case
    for cases in (math_cases, vector_math_cases, range_cases, turning_cases, blend_cases, color_cases)
    for case in cases()
]


@pytest.fixture(scope="module")
def tiles():
    return dict(zip([case.name for case in CASES], cycles_values(CASES), strict=True))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_node_is_what_cycles_makes_of_it(case, tiles):
    assert_same(case, tiles[case.name])


@pytest.mark.parametrize(
    ("enum", "kind", "name"),
    [
        (MathOp, "Math", "operation"),
        (VectorMathOp, "VectorMath", "operation"),
        (Interpolation, "MapRange", "interpolation_type"),
        (RotationKind, "VectorRotate", "rotation_type"),
        (MappingKind, "Mapping", "vector_type"),
        (BlendMode, "Mix", "blend_type"),
        (ColorModel, "CombineColor", "mode"),
        (NoiseKind, "TexNoise", "noise_type"),
        (VoronoiFeature, "TexVoronoi", "feature"),
        (VoronoiMetric, "TexVoronoi", "distance"),
        (GradientKind, "TexGradient", "gradient_type"),
        (WaveKind, "TexWave", "wave_type"),
        (WaveProfile, "TexWave", "wave_profile"),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_members_are_named_and_numbered_as_in_blender(enum, kind, name):
    """Older versions of Blender lack some."""
    items = getattr(bpy.types, f"ShaderNode{kind}").bl_rna.properties[name].enum_items
    ours = {member.name: member.value for member in enum}

    assert {item.identifier: item.value for item in items}.items() <= ours.items()
    assert bpy.app.version < (5, 2) or len(items) == len(ours)


def test_both_kinds_of_directions_of_waves_are_known():
    for name in ("bands_direction", "rings_direction"):
        for item in bpy.types.ShaderNodeTexWave.bl_rna.properties[name].enum_items:
            assert WaveDirection[item.identifier] == item.value
