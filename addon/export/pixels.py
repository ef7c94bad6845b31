# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixels of one picture of Blender's, kept as small as they come: bytes stay bytes where they can."""

import bpy
import numpy as np

from ..core import graph
from .color_spaces import Encoding, encoding, to_scene_linear

LARGEST_IMAGE = 1 << 30  # numbers
MOST_FLOATS = 1 << 24  # larger images of floats are kept as half floats
LARGEST_HALF = 65504.0
STRIP = 1 << 20  # pixels that are converted at a time


class UnreadableError(Exception):
    """There is no picture; the text says why."""


def read(b_image):
    """The Image of what `b_image` shows at the moment; raises UnreadableError."""
    width, height = b_image.size
    if width * height == 0:
        raise UnreadableError(f"the image {b_image.name} cannot be read")
    if width * height * b_image.channels > LARGEST_IMAGE:
        raise UnreadableError(f"{b_image.name} is too large")
    raw = np.empty(width * height * b_image.channels, np.float32)
    b_image.pixels.foreach_get(raw)
    raw = raw.reshape(height, width, b_image.channels)
    encode = _encode_floats if b_image.is_float else _encode_bytes
    dtype = _kept_as(b_image, raw)
    pixels = np.empty((height, width, 1 if b_image.channels == 1 else 4), dtype)
    step = max(STRIP // width, 1)
    for first in range(0, height, step):
        strip = _grey_or_rgba(raw[first : first + step])
        if b_image.alpha_mode == "NONE" and strip.shape[-1] == 4:
            strip[..., 3] = 1.0
        pixels[first : first + step] = encode(b_image, strip, dtype)
    is_srgb = encoding(b_image.colorspace_settings) == Encoding.SRGB
    return graph.Image(b_image.name, pixels, is_srgb and (dtype == np.uint8 or _stays_encoded(b_image)))


def _kept_as(b_image, raw):
    if b_image.is_float:
        is_large = raw.size > MOST_FLOATS and not _stays_encoded(b_image) and max(raw.max(), -raw.min()) <= LARGEST_HALF
        return np.float16 if is_large else np.float32
    return np.float16 if encoding(b_image.colorspace_settings) == Encoding.OTHER else np.uint8


def _grey_or_rgba(pixels):
    """A copy with one channel or four."""
    height, width, channels = pixels.shape
    if channels in (1, 4):
        return pixels.copy()
    color = pixels[..., :3] if channels == 3 else np.repeat(pixels[..., :1], 3, axis=-1)
    alpha = pixels[..., 1:] if channels == 2 else np.ones((height, width, 1), np.float32)
    return np.concatenate([color, alpha], axis=-1)


def has_cover(b_image):
    """Whether the alpha of an image says how much its colours cover, by which they are multiplied."""
    return b_image.alpha_mode not in ("CHANNEL_PACKED", "NONE") and not b_image.colorspace_settings.is_data


def _is_read_by_cycles(b_image):
    """Whether Cycles reads the file itself; else it is handed what Blender has read, and some things come out
    differently."""
    return b_image.source in ("FILE", "SEQUENCE") and not b_image.packed_file


def _stays_encoded(b_image):
    """Whether colours of floats are multiplied by alpha in the encoding of sRGB, as Cycles does it with its files."""
    is_srgb = encoding(b_image.colorspace_settings) == Encoding.SRGB
    return b_image.is_float and is_srgb and b_image.channels == 4 and has_cover(b_image) and _is_read_by_cycles(b_image)


def _encode_floats(b_image, pixels, dtype):
    """Blender has converted these, and multiplied them; what is not finite is black, as in Cycles."""
    pixels[~np.isfinite(pixels).all(axis=-1)] = 0.0
    if pixels.shape[-1] == 4 and _stays_encoded(b_image):
        alpha = np.where(pixels[..., 3:] > 0.0, pixels[..., 3:], 1.0)
        pixels[..., :3] = linear_to_srgb(pixels[..., :3] / alpha) * alpha
    elif _is_read_by_cycles(b_image):
        pixels[..., :3] *= _brightness_of_displays(b_image)
    elif (
        bpy.app.version >= (5, 0) and pixels.shape[-1] == 4 and b_image.alpha_mode == "STRAIGHT" and has_cover(b_image)
    ):
        pixels[..., :3] *= pixels[..., 3:]  # what Cycles is handed it multiplies once more
    return pixels


def _brightness_of_displays(b_image):
    """Blender takes 203 nits in pictures made for bright displays for white, Cycles 100."""
    return 2.03 if b_image.colorspace_settings.name.startswith("Rec.2100") else 1.0


def linear_to_srgb(x):
    """IEC 61966-2-1."""
    x = np.maximum(x, 0.0)
    return np.where(x < 0.0031308, 12.92 * x, 1.055 * x ** (1.0 / 2.4) - 0.055)


def srgb_to_linear(x):
    """Of numbers from 0 to 1."""
    return np.where(x < 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4).astype(np.float32)


def _encode_bytes(b_image, pixels, dtype):
    covers = pixels.shape[-1] == 4 and has_cover(b_image)
    if dtype == np.uint8:
        pixels = (np.clip(pixels, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
        if covers:  # rounded as Cycles rounds; what Blender has divided comes out as it was in the file
            half_way = 127 if b_image.alpha_mode == "PREMUL" else 0
            pixels[..., :3] = (pixels[..., :3].astype(np.uint16) * pixels[..., 3:] + half_way) // 255
        return pixels
    color = np.broadcast_to(pixels[..., :3], (*pixels.shape[:2], 3)).astype(np.float16)  # Cycles begins with half, too
    alpha = pixels[..., 3:].astype(np.float16) if covers else np.float16(1.0)
    cover = np.where(alpha > 0.0, alpha, np.float16(1.0)).astype(np.float32)
    color = to_scene_linear(color * alpha / cover, b_image.colorspace_settings.name) * cover
    color = np.clip(color * _brightness_of_displays(b_image), -LARGEST_HALF, LARGEST_HALF)
    return color[..., :1] if pixels.shape[-1] == 1 else np.concatenate([color, pixels[..., 3:]], axis=-1)
