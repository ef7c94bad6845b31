# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixing two colours: the blend modes of Blender's Mix node, as Cycles defines them."""

from enum import IntEnum

import numpy as np

from ..jit import kernel
from .color import hsv_to_rgb, not_negative, rgb_to_hsv
from .vec3 import BLACK, WHITE, Vec3, lerp


class BlendMode(IntEnum):
    """Blend modes of the Mix node; names and numbers are Blender's."""

    MIX = 0
    ADD = 1
    MULTIPLY = 2
    SUBTRACT = 3
    SCREEN = 4
    DIVIDE = 5
    DIFFERENCE = 6
    DARKEN = 7
    LIGHTEN = 8
    OVERLAY = 9
    DODGE = 10
    BURN = 11
    HUE = 12
    SATURATION = 13
    VALUE = 14
    COLOR = 15
    SOFT_LIGHT = 16
    LINEAR_LIGHT = 17
    EXCLUSION = 18


@kernel
def blend(mode, t, a, b):
    """`b` laid over `a` by a BlendMode, to the share `t`, which is not clamped here."""
    if BlendMode.HUE <= mode <= BlendMode.COLOR:
        return _blend_hsv(mode, t, a, b)
    if mode == BlendMode.SCREEN:
        return WHITE - (WHITE - b * t) * (WHITE - a)
    if mode == BlendMode.SOFT_LIGHT:
        screen = WHITE - (WHITE - b) * (WHITE - a)
        return lerp(a, ((WHITE - a) * b + screen) * a, t)
    if mode == BlendMode.LINEAR_LIGHT:
        return a + (b * 2.0 - WHITE) * t
    if mode == BlendMode.EXCLUSION:
        return not_negative(lerp(a, a + b - a * b * 2.0, t))
    if BlendMode.OVERLAY <= mode <= BlendMode.BURN or mode == BlendMode.DIVIDE:
        return Vec3(_channel(mode, t, a.x, b.x), _channel(mode, t, a.y, b.y), _channel(mode, t, a.z, b.z))
    return lerp(a, _whole(mode, a, b), t)


@kernel
def _whole(mode, a, b):
    """What the simple modes give at full strength."""
    if mode == BlendMode.MIX:
        return b
    if mode == BlendMode.ADD:
        return a + b
    if mode == BlendMode.MULTIPLY:
        return a * b
    if mode == BlendMode.SUBTRACT:
        return a - b
    if mode == BlendMode.DIFFERENCE:
        return Vec3(abs(a.x - b.x), abs(a.y - b.y), abs(a.z - b.z))
    if mode == BlendMode.DARKEN:
        return Vec3(min(a.x, b.x), min(a.y, b.y), min(a.z, b.z))
    if mode == BlendMode.LIGHTEN:
        return Vec3(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z))
    return BLACK


@kernel
def _channel(mode, t, a, b):
    """Modes with cases, for one channel."""
    if mode == BlendMode.DIVIDE:
        return (1.0 - t) * a + t * a / b if b != 0.0 else a
    if mode == BlendMode.OVERLAY:
        if a < 0.5:
            return a * (1.0 - t + 2.0 * t * b)
        return 1.0 - (1.0 - t + 2.0 * t * (1.0 - b)) * (1.0 - a)
    if mode == BlendMode.DODGE:
        if a == 0.0:
            return a
        rest = 1.0 - t * b
        return min(a / rest, 1.0) if rest > 0.0 else np.float32(1.0)
    rest = 1.0 - t + t * b  # BURN
    return min(max(1.0 - (1.0 - a) / rest, 0.0), 1.0) if rest > 0.0 else np.float32(0.0)


@kernel
def _blend_hsv(mode, t, a, b):
    """Modes that exchange hue, saturation or value."""
    x, y = rgb_to_hsv(a), rgb_to_hsv(b)
    if mode == BlendMode.SATURATION:
        return hsv_to_rgb(Vec3(x.x, lerp(x.y, y.y, t), x.z)) if x.y != 0.0 else a
    if mode == BlendMode.VALUE:
        return hsv_to_rgb(Vec3(x.x, x.y, lerp(x.z, y.z, t)))
    if y.y == 0.0:  # grey has no hue to give
        return a
    changed = Vec3(y.x, x.y if mode == BlendMode.HUE else y.y, x.z)
    return lerp(a, hsv_to_rgb(changed), t)
