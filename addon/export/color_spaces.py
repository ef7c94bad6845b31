# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours from the spaces that Blender's configuration of OpenColorIO knows to the one that is rendered in.

Blender's Python has no OpenColorIO. But Blender converts the pixels of a file of floats when it loads it, and a picture
that is packed counts as a file: so colours are put into one, and read again in their space.
"""

from enum import Enum

import bpy
import numpy as np


class Encoding(Enum):
    """What the numbers of an image of bytes stand for."""

    LINEAR = 0  # as they are
    SRGB = 1  # undone after interpolation, as in Cycles
    OTHER = 2  # to be converted before


def encoding(settings):
    """Encoding of the `colorspace_settings` of an image."""
    if settings.is_data or settings.name in (_working_space(), "scene_linear"):
        return Encoding.LINEAR
    return Encoding.SRGB if settings.name == "sRGB" and _working_space() == "Linear Rec.709" else Encoding.OTHER


def _working_space():
    """The space that is rendered in, which Blender 5 lets one choose."""
    return bpy.data.colorspace.working_space if hasattr(bpy.data, "colorspace") else "Linear Rec.709"


def to_scene_linear(colors, space):
    """Colours (height, width, 3) in the space of this name: the same in the space that is rendered in, float32."""
    height, width, _ = colors.shape
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = colors
    b_image = bpy.data.images.new(".Colours", width, height, alpha=True, float_buffer=True, is_data=True)
    try:
        b_image.pixels.foreach_set(pixels.ravel())
        b_image.pack()
        b_image.colorspace_settings.name = space
        b_image.pixels.foreach_get(pixels.ravel())
    finally:
        bpy.data.images.remove(b_image)
    return pixels[..., :3]
