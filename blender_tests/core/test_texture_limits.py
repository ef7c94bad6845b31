# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever artists' graphs hand to textures and arithmetic, they come back: no endless loop, no fault."""

import itertools

import numpy as np

from engine_core.linalg import blend, color, scalar_math, vector_math
from engine_core.linalg.vec3 import Vec3
from engine_core.texture.brick import brick
from engine_core.texture.checker import checker
from engine_core.texture.gabor import gabor
from engine_core.texture.gradient import GradientKind, gradient
from engine_core.texture.magic import magic
from engine_core.texture.noise import NoiseKind, noise
from engine_core.texture.voronoi import VoronoiFeature, voronoi
from engine_core.texture.wave import wave
from engine_core.texture.white_noise import white_noise

EXTREMES = np.float32([0, -0.0, 1, -1, 1e-30, 1e9, -1e9, 3e38, -3e38, np.inf, -np.inf, np.nan])
RANDOM = np.random.default_rng(2)


def draw(n):
    return [np.float32(x) for x in RANDOM.choice(EXTREMES, n)]


def test_textures_take_any_numbers():
    for _ in range(20):
        p, q = Vec3(*draw(3)), Vec3(*draw(3))
        for dimensions, kind, flag in itertools.product((1, 2, 3, 4), NoiseKind, (False, True)):
            noise(p, draw(1)[0], dimensions, int(kind), *draw(6), flag, flag)
        for dimensions, feature in itertools.product((1, 2, 3, 4), VoronoiFeature):
            voronoi(p, draw(1)[0], dimensions, int(feature), int(RANDOM.integers(4)), *draw(7), True, False)
        for dimensions in (2, 3):
            gabor(p, dimensions, *draw(3), q)
        wave(p, 1, 0, 1, *draw(5))
        magic(p, 10, draw(1)[0])
        brick(p, q, q, q, *draw(6), 2, draw(1)[0], 3)
        checker(p)
        white_noise(p, draw(1)[0], 4)
        for kind in GradientKind:
            gradient(p, int(kind))


def test_arithmetic_takes_any_numbers():
    for _ in range(20):
        a, b, c = (Vec3(*draw(3)) for _ in range(3))
        for op in scalar_math.MathOp:
            scalar_math.evaluate(int(op), *draw(3))
        for op in vector_math.VectorMathOp:
            vector_math.evaluate(int(op), a, b, c, draw(1)[0])
        for mode in blend.BlendMode:
            blend.blend(int(mode), draw(1)[0], a, b)
        color.hue_saturation(a, *draw(4))
        color.blackbody(draw(1)[0])
        color.wavelength(draw(1)[0])


def test_where_numbers_make_no_sense_the_result_still_is_one():
    """Cycles' rules: division by zero and roots and logarithms of negative numbers give 0."""
    zero, one = np.float32(0), np.float32(1)
    op = scalar_math.MathOp
    for code in (op.DIVIDE, op.MODULO, op.FLOORED_MODULO, op.SNAP, op.PINGPONG):
        assert scalar_math.evaluate(int(code), one, zero, zero) == 0
    for code in (op.SQRT, op.INVERSE_SQRT, op.LOGARITHM):
        assert scalar_math.evaluate(int(code), -one, one, zero) == 0
    assert scalar_math.evaluate(int(op.POWER), -one, np.float32(0.5), zero) == 0
    assert scalar_math.evaluate(int(op.POWER), zero, zero, zero) == 1
    assert tuple(vector_math.safe_normalize(Vec3(0, 0, 0))) == (0, 0, 0)
