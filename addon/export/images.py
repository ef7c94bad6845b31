# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels of Blender's images, read once each."""

import numpy as np

from ..core import graph
from .graph import label

MAGENTA = (1.0, 0.0, 1.0, 1.0)  # what Blender shows for an image that is not there
LARGEST_IMAGE = 1 << 30  # numbers
MOST_FLOATS = 1 << 24  # larger images of floats are kept as half floats
LARGEST_HALF = 65504.0
DATA = {"Non-Color", "Raw", "Generic Data", "Linear Rec.709", "Linear", "scene_linear"}


def export_image(values, node):
    """The Image of an image or environment texture node; a magenta pixel where there is none."""
    b_image = node.image
    if b_image is None:
        return _missing(values, node, "no image")
    images = values.context.images
    key = b_image.as_pointer()
    if key not in images:
        width, height = b_image.size
        if not 0 < width * height * b_image.channels <= LARGEST_IMAGE:
            reason = (
                f"the image {b_image.name} cannot be read" if width * height == 0 else f"{b_image.name} is too large"
            )
            return _missing(values, node, reason)
        images[key] = _read(values, node, b_image)
    return images[key]


def _missing(values, node, reason):
    values.warn(node, f"{label(node)} has {reason}; magenta instead" if reason == "no image" else f"{reason}; magenta")
    return graph.Image("missing", np.array([[MAGENTA]], np.float32))


def _read(values, node, b_image):
    if b_image.source in ("TILED", "SEQUENCE", "MOVIE"):
        what = "the first tile" if b_image.source == "TILED" else "the frame that Blender has loaded"
        values.warn(node, f"{b_image.name} is one of several pictures; using {what} only")
    width, height = b_image.size
    channels = b_image.channels
    pixels = np.empty(width * height * channels, np.float32)
    b_image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, channels)
    if channels not in (1, 4):
        color = pixels[..., :3] if channels == 3 else np.repeat(pixels[..., :1], 3, axis=-1)
        alpha = pixels[..., 1:] if channels == 2 else np.ones((height, width, 1), np.float32)
        pixels = np.concatenate([color, alpha], axis=-1)
    if b_image.alpha_mode == "NONE" and pixels.shape[-1] == 4:
        pixels[..., 3] = 1.0
    if b_image.is_float:
        if pixels.size > MOST_FLOATS and np.abs(pixels).max() <= LARGEST_HALF:
            pixels = pixels.astype(np.float16)
        return graph.Image(b_image.name, pixels)
    space = b_image.colorspace_settings
    is_srgb = space.name not in DATA and not space.is_data
    if is_srgb and space.name != "sRGB":
        values.warn(node, f"{b_image.name} is in the colour space {space.name}; taken as sRGB")
    pixels = (np.clip(pixels, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    if pixels.shape[-1] == 4 and not space.is_data and b_image.alpha_mode not in ("CHANNEL_PACKED", "NONE"):
        # colours as much as they cover, rounded as Cycles rounds them
        pixels[..., :3] = (pixels[..., :3].astype(np.uint16) * pixels[..., 3:]) // 255
    return graph.Image(b_image.name, pixels, is_srgb)
