# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours: Mix in all its modes, ramps and curves, Hue/Saturation, Invert, Gamma, and models of colour."""

import numpy as np

from ..jit import kernel
from ..linalg.registers import store_float
from ..linalg.vec3 import WHITE, Vec3
from ..program_tables import CURVE_SIZE
from .blackbody import blackbody_color
from .maths import saturate
from .opcodes import CLAMPED, CLAMPED_RESULT, Blend, ColorSpace, Op
from .operands import give_number, give_vector, number, vector

ZERO, ONE = np.float32(0.0), np.float32(1.0)


def run(scene, op, point, registers):
    """One step: see `opcodes.SIGNATURES`."""
    code = op.code
    if code == Op.BLEND:
        t = number(op, registers, 0)
        if op.mode & CLAMPED:
            t = saturate(t)
        c = blend(op.mode & 31, t, vector(op, registers, 1), vector(op, registers, 2))
        if op.mode & CLAMPED_RESULT:
            c = Vec3(saturate(c.x), saturate(c.y), saturate(c.z))
        give_vector(op, registers, c)
    elif code == Op.RAMP:
        ramp(scene, op, registers)
    elif code == Op.CURVES:
        curves(scene, op, registers)
    elif code == Op.CURVE:
        t, x = number(op, registers, 0), number(op, registers, 1)
        position = (x - number(op, registers, 2)) * number(op, registers, 3)
        give_number(op, registers, x * (1.0 - t) + lookup(scene, op, position, 0) * t)
    elif code == Op.HUE_SATURATION:
        hue_saturation(op, registers)
    elif code == Op.INVERT:
        t, c = number(op, registers, 0), vector(op, registers, 1)
        give_vector(op, registers, (WHITE - c) * t + c * (1.0 - t))
    elif code == Op.GAMMA:
        c, e = vector(op, registers, 0), number(op, registers, 1)
        give_vector(op, registers, Vec3(gamma(c.x, e), gamma(c.y, e), gamma(c.z, e)))
    elif code == Op.BRIGHT_CONTRAST:
        c, bright, contrast = vector(op, registers, 0), number(op, registers, 1), number(op, registers, 2)
        a, b = 1.0 + contrast, bright - contrast * 0.5
        give_vector(op, registers, Vec3(max(c.x * a + b, ZERO), max(c.y * a + b, ZERO), max(c.z * a + b, ZERO)))
    elif code == Op.SEPARATE_COLOR:
        c = vector(op, registers, 0)
        give_vector(op, registers, rgb_to_hsv(c) if op.mode == ColorSpace.HSV else rgb_to_hsl(c))
    elif code == Op.COMBINE_COLOR:
        c = vector(op, registers, 0)
        give_vector(op, registers, hsv_to_rgb(c) if op.mode == ColorSpace.HSV else hsl_to_rgb(c))
    elif code == Op.BLACKBODY:
        give_vector(op, registers, blackbody_color(number(op, registers, 0)))


@kernel
def gamma(x, exponent):
    if exponent == 0.0:
        return ONE
    return x**exponent if x > 0.0 else x


# ---- Tables ----------------------------------------------------------------------------------------------------------


@kernel
def lookup(scene, op, x, channel):
    """A curve's value at `x`, 0 to 1; beyond, its end goes on as it is, or (mode 1) as straight as it was."""
    last = np.float32(CURVE_SIZE - 1)
    if op.mode == 1 and (x < 0.0 or x > 1.0):
        end, before = (0, 1) if x < 0.0 else (CURVE_SIZE - 1, CURVE_SIZE - 2)
        beyond = -x if x < 0.0 else x - 1.0
        value = scene.curves[op.data + end].value[channel]
        return value + (value - scene.curves[op.data + before].value[channel]) * beyond * last
    at = saturate(x) * last
    i = np.int32(at)
    t = at - np.float32(i)
    value = scene.curves[op.data + i].value[channel]
    if t > 0.0:
        value = value * (1.0 - t) + scene.curves[op.data + i + 1].value[channel] * t
    return value


@kernel
def ramp(scene, op, registers):
    """A colour ramp; mode 1: in steps, without interpolation."""
    at = saturate(number(op, registers, 0)) * np.float32(CURVE_SIZE - 1)
    i = np.int32(at)
    t = at - np.float32(i)
    here = scene.curves[op.data + i]
    for k in range(4):
        value = here.value[k]
        if op.mode == 0 and t > 0.0:
            value = value * (1.0 - t) + scene.curves[op.data + i + 1].value[k] * t
        store_float(registers, op.out + k, value)


@kernel
def curves(scene, op, registers):
    """RGB Curves and Vector Curves: a curve for each channel, over the range of their points."""
    t, c = number(op, registers, 0), vector(op, registers, 1)
    low, scale = number(op, registers, 2), number(op, registers, 3)
    x = lookup(scene, op, (c.x - low) * scale, 0)
    y = lookup(scene, op, (c.y - low) * scale, 1)
    z = lookup(scene, op, (c.z - low) * scale, 2)
    give_vector(op, registers, c * (1.0 - t) + Vec3(x, y, z) * t)


# ---- Mixing ----------------------------------------------------------------------------------------------------------


@kernel
def blend(mode, t, a, b):
    """Blender's blend modes: `a` where t is 0."""
    if mode == Blend.MIX:
        return a + (b - a) * t
    if mode == Blend.MULTIPLY:
        return a + (a * b - a) * t
    if mode == Blend.ADD:
        return a + b * t
    if mode == Blend.SUBTRACT:
        return a - b * t
    if mode == Blend.LINEAR_LIGHT:
        return a + (b * 2.0 - WHITE) * t
    if mode == Blend.SCREEN:
        return WHITE - (WHITE * (1.0 - t) + (WHITE - b) * t) * (WHITE - a)
    if mode == Blend.SOFT_LIGHT:
        screen = WHITE - (WHITE - b) * (WHITE - a)
        return a * (1.0 - t) + ((WHITE - a) * b * a + a * screen) * t
    if mode >= Blend.HUE:
        return blend_hsv(mode, t, a, b)
    return Vec3(blend_number(mode, t, a.x, b.x), blend_number(mode, t, a.y, b.y), blend_number(mode, t, a.z, b.z))


@kernel
def blend_number(mode, t, a, b):
    rest = 1.0 - t
    if mode == Blend.DARKEN:
        return a * rest + min(a, b) * t
    if mode == Blend.LIGHTEN:
        return a * rest + max(a, b) * t
    if mode == Blend.DIFFERENCE:
        return a * rest + abs(a - b) * t
    if mode == Blend.EXCLUSION:
        return max(a * rest + (a + b - 2.0 * a * b) * t, ZERO)
    if mode == Blend.DIVIDE:
        return a * rest + t * a / b if b != 0.0 else a
    if mode == Blend.OVERLAY:
        if a < 0.5:
            return a * (rest + 2.0 * t * b)
        return 1.0 - (rest + 2.0 * t * (1.0 - b)) * (1.0 - a)
    if mode == Blend.DODGE:
        if a == 0.0:
            return a
        x = 1.0 - t * b
        return ONE if x <= 0.0 else min(a / x, ONE)
    x = rest + t * b
    return ZERO if x <= 0.0 else saturate(1.0 - (1.0 - a) / x)  # BURN


@kernel
def blend_hsv(mode, t, a, b):
    p, q = rgb_to_hsv(a), rgb_to_hsv(b)
    if mode == Blend.VALUE:
        return hsv_to_rgb(Vec3(p.x, p.y, p.z * (1.0 - t) + q.z * t))
    if mode == Blend.SATURATION:
        return hsv_to_rgb(Vec3(p.x, p.y * (1.0 - t) + q.y * t, p.z)) if p.y != 0.0 else a
    if q.y == 0.0:  # grey has no hue
        return a
    c = hsv_to_rgb(Vec3(q.x, p.y if mode == Blend.HUE else q.y, p.z))
    return a + (c - a) * t


@kernel
def hue_saturation(op, registers):
    c, t = vector(op, registers, 4), number(op, registers, 3)
    hsv = rgb_to_hsv(c)
    hue = hsv.x + number(op, registers, 0) + 0.5
    hue -= np.floor(hue)
    hsv = Vec3(hue, saturate(hsv.y * number(op, registers, 1)), hsv.z * number(op, registers, 2))
    c = hsv_to_rgb(hsv) * t + c * (1.0 - t)
    give_vector(op, registers, Vec3(max(c.x, ZERO), max(c.y, ZERO), max(c.z, ZERO)))


# ---- Models of colour ------------------------------------------------------------------------------------------------


@kernel
def hue_of(c, high, span):
    if span == 0.0:
        return ZERO
    if c.x == high:
        h = (c.y - c.z) / span
    elif c.y == high:
        h = 2.0 + (c.z - c.x) / span
    else:
        h = 4.0 + (c.x - c.y) / span
    h *= np.float32(1.0 / 6.0)
    return h + 1.0 if h < 0.0 else h


@kernel
def rgb_to_hsv(c):
    high, low = max(c.x, max(c.y, c.z)), min(c.x, min(c.y, c.z))
    span = high - low
    saturation = span / high if high != 0.0 else ZERO
    return Vec3(hue_of(c, high, span) if saturation != 0.0 else ZERO, saturation, high)


@kernel
def hsv_to_rgb(c):
    h, s, v = c.x, c.y, c.z
    if s == 0.0:
        return Vec3(v, v, v)
    h = ZERO if h == 1.0 else h * 6.0
    i = np.floor(h)
    f = h - i
    p, q, t = v * (1.0 - s), v * (1.0 - s * f), v * (1.0 - s * (1.0 - f))
    if i == 0.0:
        return Vec3(v, t, p)
    if i == 1.0:
        return Vec3(q, v, p)
    if i == 2.0:
        return Vec3(p, v, t)
    if i == 3.0:
        return Vec3(p, q, v)
    if i == 4.0:
        return Vec3(t, p, v)
    return Vec3(v, p, q)


@kernel
def rgb_to_hsl(c):
    high, low = max(c.x, max(c.y, c.z)), min(c.x, min(c.y, c.z))
    lightness, span = min((high + low) * 0.5, ONE), high - low
    if span == 0.0:
        return Vec3(0.0, 0.0, lightness)
    saturation = span / (2.0 - high - low) if lightness > 0.5 else span / (high + low)
    return Vec3(hue_of(c, high, span), saturation, lightness)


@kernel
def hsl_to_rgb(c):
    """From the hue at full saturation, which is three ramps."""
    h = c.x * 6.0
    full = Vec3(saturate(abs(h - 3.0) - 1.0), saturate(2.0 - abs(h - 2.0)), saturate(2.0 - abs(h - 4.0)))
    chroma = (1.0 - abs(2.0 * c.z - 1.0)) * c.y
    return (full - Vec3(0.5, 0.5, 0.5)) * chroma + Vec3(c.z, c.z, c.z)
