# SPDX-License-Identifier: GPL-3.0-or-later
"""Noise, Voronoi and Gabor textures: much code each, so each is an entry point of its own."""

from ..jit import variant
from ..linalg.registers import store_float, store_vector
from ..texture.gabor import gabor
from ..texture.noise import noise
from ..texture.voronoi import voronoi
from ..texture.voronoi_of_4 import voronoi_of_4
from .opcodes import ONLY_DISTANCE
from .operands import give_both, number, vector


def run_noise(scene, op, point, registers):
    """Mode: dimensions + 8 kind + 64 normalize + 128 colored."""
    p, w, scale = vector(op, registers, 0), number(op, registers, 1), number(op, registers, 2)
    sample = noise(
        p * scale,
        w * scale,
        op.mode & 7,
        (op.mode >> 3) & 7,
        number(op, registers, 3),
        number(op, registers, 4),
        number(op, registers, 5),
        number(op, registers, 6),
        number(op, registers, 7),
        number(op, registers, 8),
        (op.mode >> 6) & 1,
        op.mode >= 128,
    )
    give_both(op, registers, sample.color, sample.value)


def run_voronoi(scene, op, point, registers):
    """Mode: dimensions + 8 feature + 64 metric + 256 normalize + ONLY_DISTANCE. Result: distance, colour, position, w,
    radius."""
    sample = voronoi(
        vector(op, registers, 0),
        number(op, registers, 1),
        op.mode & 7,
        (op.mode >> 3) & 7,
        (op.mode >> 6) & 3,
        number(op, registers, 2),
        number(op, registers, 3),
        number(op, registers, 4),
        number(op, registers, 5),
        number(op, registers, 6),
        number(op, registers, 7),
        number(op, registers, 8),
        (op.mode >> 8) & 1,
        op.mode & ONLY_DISTANCE,
    )
    store_float(registers, op.out, sample.distance)
    if op.mode & ONLY_DISTANCE:
        return
    store_vector(registers, op.out + 1, sample.color)
    store_vector(registers, op.out + 4, sample.position)
    store_float(registers, op.out + 7, sample.w)
    store_float(registers, op.out + 8, sample.radius)


run_voronoi_of_4 = variant(run_voronoi, "of_blender_4", voronoi=voronoi_of_4)


def run_gabor(scene, op, point, registers):
    """Mode: dimensions. Result: value, phase, intensity."""
    sample = gabor(
        vector(op, registers, 0) * number(op, registers, 1),
        op.mode,
        number(op, registers, 2),
        number(op, registers, 3),
        number(op, registers, 4),
        vector(op, registers, 5),
    )
    store_float(registers, op.out, sample.value)
    store_float(registers, op.out + 1, sample.phase)
    store_float(registers, op.out + 2, sample.intensity)
