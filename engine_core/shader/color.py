# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours: Mix in all its modes, ramps and curves, Hue/Saturation, Invert, Gamma, models of colour, spectra."""

import numpy as np

from ..jit import kernel
from ..linalg import color as colors
from ..linalg.blend import blend
from ..linalg.registers import store_float
from ..linalg.vec3 import Vec3
from ..program_tables import CURVE_SIZE
from .maths import saturate
from .opcodes import CLAMPED, CLAMPED_RESULT, Op
from .operands import give_number, give_vector, number, vector

LAST = np.float32(CURVE_SIZE - 1)


def run(scene, op, point, registers):
    """One step: see `opcodes.SIGNATURES`."""
    code = op.code
    if code == Op.BLEND:
        t = number(op, registers, 0)
        t = saturate(t) if op.mode & CLAMPED else t
        c = blend(op.mode & ~(CLAMPED | CLAMPED_RESULT), t, vector(op, registers, 1), vector(op, registers, 2))
        give_vector(op, registers, colors.saturate(c) if op.mode & CLAMPED_RESULT else c)
    elif code == Op.RAMP:
        ramp(scene, op, registers)
    elif code == Op.CURVES:
        curves(scene, op, registers)
    elif code == Op.CURVE:
        t, x = number(op, registers, 0), number(op, registers, 1)
        position = (x - number(op, registers, 2)) * number(op, registers, 3)
        give_number(op, registers, x * (1.0 - t) + lookup(scene, op, position, 0) * t)
    elif code == Op.HUE_SATURATION:
        hue, saturation, value = number(op, registers, 0), number(op, registers, 1), number(op, registers, 2)
        c, t = vector(op, registers, 4), number(op, registers, 3)
        give_vector(op, registers, colors.hue_saturation(c, hue, saturation, value, t))
    elif code == Op.INVERT:
        give_vector(op, registers, colors.invert(vector(op, registers, 1), number(op, registers, 0)))
    elif code == Op.GAMMA:
        give_vector(op, registers, colors.gamma(vector(op, registers, 0), number(op, registers, 1)))
    elif code == Op.BRIGHT_CONTRAST:
        c, bright, contrast = vector(op, registers, 0), number(op, registers, 1), number(op, registers, 2)
        give_vector(op, registers, colors.bright_contrast(c, bright, contrast))
    elif code == Op.SEPARATE_COLOR:
        give_vector(op, registers, colors.separate(op.mode, vector(op, registers, 0)))
    elif code == Op.COMBINE_COLOR:
        give_vector(op, registers, colors.combine(op.mode, vector(op, registers, 0)))
    elif code == Op.BLACKBODY:
        give_vector(op, registers, colors.not_negative(colors.blackbody(number(op, registers, 0))))
    elif code == Op.WAVELENGTH:
        give_vector(op, registers, colors.wavelength(number(op, registers, 0)))


# ---- Tables ----------------------------------------------------------------------------------------------------------


@kernel
def lookup(scene, op, x, channel):
    """A curve's value at `x`, 0 to 1; beyond, its end goes on as it is, or (mode 1) as straight as it was."""
    if op.mode == 1 and (x < 0.0 or x > 1.0):
        end, before = (0, 1) if x < 0.0 else (CURVE_SIZE - 1, CURVE_SIZE - 2)
        beyond = -x if x < 0.0 else x - 1.0
        value = scene.curves[op.data + end].value[channel]
        return value + (value - scene.curves[op.data + before].value[channel]) * beyond * LAST
    return between(scene, op.data, saturate(x) * LAST, channel)


@kernel
def between(scene, first, at, channel):
    """A table's value at row `at`, a fraction and all."""
    i = max(min(np.int32(at), CURVE_SIZE - 1), 0)
    t = at - np.float32(i)
    value = scene.curves[first + i].value[channel]
    if t > 0.0:
        value = value * (1.0 - t) + scene.curves[first + i + 1].value[channel] * t
    return value


@kernel
def ramp(scene, op, registers):
    """A colour ramp; mode 1: in steps, without interpolation."""
    at = saturate(number(op, registers, 0)) * LAST
    if op.mode == 1:
        at = np.floor(at)
    for channel in range(4):
        store_float(registers, op.out + channel, between(scene, op.data, at, channel))


@kernel
def curves(scene, op, registers):
    """RGB Curves and Vector Curves: a curve for each channel, over the range of their points."""
    t, c = number(op, registers, 0), vector(op, registers, 1)
    low, scale = number(op, registers, 2), number(op, registers, 3)
    x = lookup(scene, op, (c.x - low) * scale, 0)
    y = lookup(scene, op, (c.y - low) * scale, 1)
    z = lookup(scene, op, (c.z - low) * scale, 2)
    give_vector(op, registers, c * (1.0 - t) + Vec3(x, y, z) * t)
