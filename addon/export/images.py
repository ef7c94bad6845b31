# SPDX-License-Identifier: GPL-3.0-or-later
"""From the image of a node to its pixels, read once each: of a file, of tiles, or of the frame that is rendered."""

import os
from contextlib import contextmanager

import bpy
import numpy as np

from ..core import graph
from .graph import label
from .pixels import UnreadableError, read

MISSING = graph.Image("missing", np.array([[(1.0, 0.0, 1.0, 1.0)]], np.float32))  # magenta, as Blender shows it
FIRST_TILE, COLUMNS = 1001, 10  # of UDIM


def export_image(values, node, tiled=False):
    """The Image of an image or environment texture node, or with `tiled` its Tiles if it has several; a magenta pixel
    where there is none."""
    b_image = node.image
    if b_image is None:
        values.warn(node, f"{label(node)} has no image; magenta instead")
        return MISSING
    frame = None
    if b_image.source in ("SEQUENCE", "MOVIE"):
        frame = frame_of(node.image_user, values.context.scene.frame_current)
    tiled = tiled and b_image.source == "TILED"
    images, key = values.context.images, (b_image.as_pointer(), frame, tiled)
    if key not in images:
        images[key] = _tiles(values, node, b_image) if tiled else _picture(values, node, b_image, frame)
    return images[key]


def _picture(values, node, b_image, frame):
    try:
        if frame is not None:
            return _frame(b_image, frame)
        if b_image.source == "TILED":
            return _tile(b_image, b_image.tiles[0].number)
        return read(b_image)
    except UnreadableError as error:
        values.warn(node, f"{error}; magenta")
        return MISSING


# ---- Frames of sequences and movies ----------------------------------------------------------------------------------


def frame_of(user, now):
    """Which frame of its pictures an image user shows in frame `now` of the scene, as Blender counts."""
    length = user.frame_duration
    if length == 0:
        return 0
    frame = now - user.frame_start + 1
    frame = (frame - 1) % length + 1 if user.use_cyclic else min(max(frame, 0), length)
    return frame + user.frame_offset


def _frame(b_image, frame):
    """Whoever evaluates a texture makes Blender load the frame of its image user; then that is what pixels are of."""
    with _texture(b_image) as texture:
        texture.image_user.frame_current = frame
        path = b_image.filepath_from_user(image_user=texture.image_user)
        if b_image.source == "SEQUENCE" and not (b_image.packed_file or os.path.exists(path)):
            raise UnreadableError(f"frame {frame} of the image {b_image.name} is missing")
        texture.evaluate((0.0, 0.0, 0.0))
    return read(b_image)


@contextmanager
def _texture(b_image):
    texture = bpy.data.textures.new(".Frame", "IMAGE")
    try:
        texture.image = b_image
        yield texture
    finally:
        bpy.data.textures.remove(texture)


# ---- Tiles -----------------------------------------------------------------------------------------------------------


def _tiles(values, node, b_image):
    """Pictures beside each other, ten in a row: those of UDIM."""
    found = {}
    for b_tile in b_image.tiles:
        try:
            found[b_tile.number - FIRST_TILE] = _tile(b_image, b_tile.number)
        except UnreadableError as error:
            values.warn(node, f"{error}; magenta")
    columns = max((place % COLUMNS + 1 for place in found), default=1)
    rows = max((place // COLUMNS + 1 for place in found), default=1)
    places = (row * COLUMNS + column for row in range(rows) for column in range(columns))
    return graph.Tiles(columns, tuple(found.get(place, MISSING) for place in places))


def _tile(b_image, number):
    """Of a tiled image Blender hands out the first tile alone, so each is loaded as an image of its own."""
    packed = next((p.packed_file for p in b_image.packed_files if p.tile_number == number), None)
    with _texture(b_image) as texture:
        texture.image_user.tile = number
        path = b_image.filepath_from_user(image_user=texture.image_user)
    if not packed and not os.path.exists(path):
        raise UnreadableError(f"tile {number} of the image {b_image.name} is missing")
    b_tile = bpy.data.images.new(f"{b_image.name}.{number}", 1, 1)
    try:
        b_tile.source = "FILE"
        if packed:
            b_tile.pack(data=packed.data, data_len=packed.size)
        else:
            b_tile.filepath = path
        b_tile.colorspace_settings.name, b_tile.alpha_mode = b_image.colorspace_settings.name, b_image.alpha_mode
        return read(b_tile)
    finally:
        bpy.data.images.remove(b_tile)
