# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural textures give what Cycles' nodes give, pixel by pixel, in all modes and dimensions."""

import functools

import bpy
import numpy as np
import pytest

from blender_tests.helpers.node_values import Case, assert_same, cycles_values
from engine_core.linalg.vec3 import Vec3
from engine_core.texture.brick import brick
from engine_core.texture.cells import VoronoiMetric
from engine_core.texture.checker import checker
from engine_core.texture.gabor import gabor
from engine_core.texture.gradient import GradientKind, gradient
from engine_core.texture.magic import magic
from engine_core.texture.noise import NoiseKind, noise
from engine_core.texture.voronoi import VoronoiFeature, voronoi
from engine_core.texture.voronoi_of_4 import voronoi_of_4
from engine_core.texture.wave import WaveDirection, WaveKind, WaveProfile, wave
from engine_core.texture.white_noise import white_noise

f = np.float32
DIMENSIONS = (1, 2, 3, 4)
RED, BLUE, GREY = (0.8, 0.1, 0.05, 1.0), (0.1, 0.3, 0.9, 1.0), (0.3, 0.35, 0.4, 1.0)


def floats(numbers):
    return [f(x) for x in numbers]


def noise_cases():
    sets = {
        "plain": (5.0, 2.0, 0.5, 2.0, 0.0, 1.0, 0.0),
        "rough": (1.7, 3.4, 0.8, 2.3, 0.4, 1.6, 0.0),
        "bent": (0.9, 0.0, 0.3, 1.5, 0.7, 0.8, 1.3),
        "fine": (-11.0, 6.7, 0.65, 1.9, 1.0, 2.0, -0.4),
    }
    names = ("Scale", "Detail", "Roughness", "Lacunarity", "Offset", "Gain", "Distortion")
    for dimensions in DIMENSIONS:
        for kind in NoiseKind:
            for label, numbers in sets.items():
                for normalize in (True, False) if kind == NoiseKind.FBM else (True,):
                    settings = {"noise_dimensions": f"{dimensions}D", "noise_type": kind.name, "normalize": normalize}
                    inputs = dict(zip(names, numbers, strict=True)) | {"Vector": "p", "W": "w"}
                    if dimensions == 1:
                        del inputs["Vector"]
                    ours = functools.partial(our_noise, dimensions, kind, normalize, floats(numbers))
                    name = f"noise {dimensions}D {kind.name} {label}{'' if normalize else ' signed'}"
                    yield Case(name, "TexNoise", ours, ("Color",), settings, inputs)


def our_noise(dimensions, kind, normalize, numbers, p, q, w):
    scale, *rest = numbers
    return noise(p * scale, w * scale, dimensions, int(kind), *rest, normalize, True).color


def voronoi_cases():
    sets = {
        "plain": (2.0, 0.0, 0.5, 2.0, 1.0, 0.5, 1.0),
        "octaves": (1.3, 2.6, 0.6, 1.8, 0.4, 3.0, 0.7),
        "even": (-1.1, 1.0, 0.8, 2.2, 0.2, 1.5, 0.1),
    }
    names = ("Scale", "Detail", "Roughness", "Lacunarity", "Smoothness", "Exponent", "Randomness")
    for dimensions in DIMENSIONS:
        for feature in VoronoiFeature:
            near = feature <= VoronoiFeature.SMOOTH_F1
            for metric in VoronoiMetric if near and dimensions > 1 else (VoronoiMetric.EUCLIDEAN,):
                for label, numbers in sets.items():
                    if feature == VoronoiFeature.N_SPHERE_RADIUS and label == "octaves":
                        continue
                    settings = {
                        "voronoi_dimensions": f"{dimensions}D",
                        "feature": feature.name,
                        "normalize": label != "plain",
                    }
                    inputs = dict(zip(names, numbers, strict=True)) | {"Vector": "p", "W": "w"}
                    if near and dimensions > 1:
                        settings["distance"] = metric.name
                    ours = functools.partial(
                        our_voronoi, dimensions, feature, metric, label != "plain", floats(numbers)
                    )
                    name = f"voronoi {dimensions}D {feature.name} {metric.name} {label}"
                    if not near:
                        output = "Radius" if feature == VoronoiFeature.N_SPHERE_RADIUS else "Distance"
                        pick = functools.partial(picked, ours, output)
                        yield Case(name, "TexVoronoi", pick, (output,), settings, inputs)
                        continue
                    position = "W" if dimensions == 1 else "Position"
                    for outputs in (
                        ("Distance", "W") if dimensions in (1, 4) else ("Distance",),
                        ("Color",),
                        (position,),
                    ):
                        pick = functools.partial(picked, ours, *outputs)
                        yield Case(f"{name} {outputs[0]}", "TexVoronoi", pick, outputs, settings, inputs)


def our_voronoi(dimensions, feature, metric, normalize, numbers, only_distance, p, q, w):
    function = voronoi_of_4 if bpy.app.version < (5, 0) else voronoi
    return function(p, w, dimensions, int(feature), int(metric), *numbers, normalize, only_distance)


def picked(ours, *rest):
    *outputs, p, q, w = rest
    sample = ours(outputs == ["Distance"], p, q, w)
    found = [getattr(sample, name.lower()) for name in outputs]
    return found[0] if len(found) == 1 else found


def wave_cases():
    for kind in WaveKind:
        for direction in ("X", "Y", "Z", "DIAGONAL" if kind == WaveKind.BANDS else "SPHERICAL"):
            for profile in WaveProfile:
                for distortion in (0.0, 2.7):
                    numbers = (0.4, distortion, 2.5, 1.6, 0.6, 0.8)
                    names = ("Scale", "Distortion", "Detail", "Detail Scale", "Detail Roughness", "Phase Offset")
                    settings = {"wave_type": kind.name, "wave_profile": profile.name}
                    settings["bands_direction" if kind == WaveKind.BANDS else "rings_direction"] = direction
                    inputs = dict(zip(names, numbers, strict=True)) | {"Vector": "p"}
                    ours = functools.partial(our_wave, kind, WaveDirection[direction], profile, floats(numbers))
                    name = f"wave {kind.name} {direction} {profile.name} {distortion}"
                    yield Case(name, "TexWave", ours, ("Fac",), settings, inputs)


def our_wave(kind, direction, profile, numbers, p, q, w):
    scale, distortion, detail, detail_scale, roughness, phase = numbers
    return wave(p * scale, int(kind), int(direction), int(profile), distortion, detail, detail_scale, roughness, phase)


def brick_cases():
    names = ("Scale", "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")
    for numbers, offset, every, squash, squash_every in (
        ((5.0, 0.02, 0.1, 0.0, 0.5, 0.25), 0.5, 2, 1.0, 2),
        ((2.0, 0.1, 1.0, 0.3, 0.7, 0.4), 0.3, 3, 0.6, 2),
        ((-3.0, 0.06, 0.0, -0.4, 0.4, 0.5), 0.8, 1, 1.7, 5),
    ):
        settings = {"offset": offset, "offset_frequency": every, "squash": squash, "squash_frequency": squash_every}
        inputs = dict(zip(names, numbers, strict=True)) | {"Color1": RED, "Color2": BLUE, "Mortar": GREY, "Vector": "p"}

        def ours(p, q, w, numbers=numbers, offset=offset, every=every, squash=squash, squash_every=squash_every):
            scale, size, smooth, bias, width, height = floats(numbers)
            colors = [Vec3(*c[:3]) for c in (RED, BLUE, GREY)]
            return brick(
                p * scale, *colors, size, smooth, bias, width, height, f(offset), every, f(squash), squash_every
            )

        yield Case(f"brick {numbers} Color", "TexBrick", lambda *x, o=ours: o(*x).color, ("Color",), settings, inputs)
        yield Case(f"brick {numbers} Fac", "TexBrick", lambda *x, o=ours: o(*x).mortar, ("Fac",), settings, inputs)


def gabor_cases():
    for dimensions in (2, 3):
        for scale, frequency, anisotropy, angle, axis in (
            (1.5, 2.0, 1.0, 0.7, (1.0, 1.0, 0.0)),
            (0.8, 3.3, 0.0, -0.4, (0.3, -0.5, 0.9)),
            (-1.2, 1.1, 0.6, 2.0, (0.0, 0.2, -1.0)),
        ):
            inputs = {"Scale": scale, "Frequency": frequency, "Anisotropy": anisotropy, "Vector": "p"}
            inputs |= {"Orientation 2D": angle, "Orientation 3D": axis}

            def ours(p, q, w, n=dimensions, numbers=(scale, frequency, anisotropy, angle), axis=axis):
                scale, *rest = floats(numbers)
                return gabor(p * scale, n, *rest, Vec3(*axis))

            outputs = ("Value", "Phase", "Intensity")
            yield Case(
                f"gabor {dimensions}D {scale}", "TexGabor", ours, outputs, {"gabor_type": f"{dimensions}D"}, inputs
            )


def other_cases():
    for dimensions in DIMENSIONS:
        settings, inputs = {"noise_dimensions": f"{dimensions}D"}, {"Vector": "p", "W": "w"}
        for output in ("Color", "Value"):
            name = f"white noise {dimensions}D {output}"

            def ours(p, q, w, n=dimensions, output=output):
                return getattr(white_noise(p, w, n), output.lower())

            yield Case(name, "TexWhiteNoise", ours, (output,), settings, inputs)
    for depth in range(11):
        scale, distortion = (5.0, 1.0) if depth % 2 else (0.3, 1.7)
        inputs = {"Scale": scale, "Distortion": distortion, "Vector": "p"}

        def ours(p, q, w, depth=depth, scale=scale, distortion=distortion):
            return magic(p * f(scale), depth, f(distortion))

        yield Case(f"magic {depth}", "TexMagic", ours, ("Color",), {"turbulence_depth": depth}, inputs)
    for kind in GradientKind:

        def ours(p, q, w, kind=kind):
            return gradient(p, int(kind))

        yield Case(
            f"gradient {kind.name}", "TexGradient", ours, ("Fac",), {"gradient_type": kind.name}, {"Vector": "p"}, 1.2
        )
    for scale in (1.0, 5.0):
        inputs = {"Scale": scale, "Vector": "p", "Color1": RED, "Color2": BLUE}

        def ours(p, q, w, scale=scale):
            return Vec3(*(RED if checker(p * f(scale)) == 1 else BLUE)[:3])

        yield Case(f"checker {scale}", "TexChecker", ours, ("Color",), {}, inputs)


CASES = [
    case
    for cases in (noise_cases, voronoi_cases, wave_cases, brick_cases, gabor_cases, other_cases)
    for case in cases()
]


@pytest.fixture(scope="module")
def tiles():
    return dict(zip([case.name for case in CASES], cycles_values(CASES), strict=True))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_texture_is_what_cycles_makes_of_it(case, tiles):
    assert_same(case, tiles[case.name])
