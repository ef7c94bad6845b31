# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural textures that are cheap: Checker, Gradient, Magic, White Noise, Brick, Wave."""

from ..linalg.vec3 import lerp
from ..texture.brick import brick
from ..texture.checker import checker
from ..texture.gradient import gradient
from ..texture.magic import magic
from ..texture.wave import wave
from ..texture.white_noise import white_noise
from .opcodes import MOST_EVERY, Op
from .operands import give_both, give_number, give_vector, number, vector


def run(scene, op, point, registers):
    """One step. Modes: kind, dimensions or depth; WAVE: kind + 2 direction + 8 profile; BRICK: how often rows are
    moved + MOST_EVERY times how often they are squashed."""
    code = op.code
    p = vector(op, registers, 0)
    if code == Op.CHECKER:
        first = checker(p * number(op, registers, 3))
        give_both(op, registers, lerp(vector(op, registers, 2), vector(op, registers, 1), first), first)
    elif code == Op.GRADIENT:
        give_number(op, registers, gradient(p, op.mode))
    elif code == Op.MAGIC:
        give_vector(op, registers, magic(p * number(op, registers, 1), op.mode, number(op, registers, 2)))
    elif code == Op.WHITE_NOISE:
        sample = white_noise(p, number(op, registers, 1), op.mode)
        give_both(op, registers, sample.color, sample.value)
    elif code == Op.WAVE:
        kind, direction, profile = op.mode & 1, (op.mode >> 1) & 3, op.mode >> 3
        distortion, detail = number(op, registers, 2), number(op, registers, 3)
        detail_scale, roughness = number(op, registers, 4), number(op, registers, 5)
        phase, p = number(op, registers, 6), p * number(op, registers, 1)
        give_number(
            op, registers, wave(p, kind, direction, profile, distortion, detail, detail_scale, roughness, phase)
        )
    elif code == Op.BRICK:
        laid = brick(
            p * number(op, registers, 4),
            vector(op, registers, 1),
            vector(op, registers, 2),
            vector(op, registers, 3),
            number(op, registers, 5),
            number(op, registers, 6),
            number(op, registers, 7),
            number(op, registers, 8),
            number(op, registers, 9),
            number(op, registers, 10),
            op.mode % MOST_EVERY,
            number(op, registers, 11),
            op.mode // MOST_EVERY,
        )
        give_both(op, registers, laid.color, laid.mortar)
