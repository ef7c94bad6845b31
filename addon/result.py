# SPDX-License-Identifier: GPL-3.0-or-later
"""Where pixels go in Blender: the render result with its layers, views and passes, and what part of the frame it is."""

from typing import NamedTuple

import numpy as np

# Passes that engine_core can fill, by the names that Blender's compositor knows: (channels, type, who asks for it).
PASSES = {
    "Combined": ("RGBA", "COLOR", lambda layer: True),
    "Depth": ("Z", "VALUE", lambda layer: layer.use_pass_z),
    "Position": ("XYZ", "VECTOR", lambda layer: layer.use_pass_position),
    "Normal": ("XYZ", "VECTOR", lambda layer: layer.use_pass_normal),
    "Denoising Albedo": ("RGB", "COLOR", lambda layer: layer.lambent.use_pass_denoising_data),
    "Denoising Normal": ("XYZ", "VECTOR", lambda layer: layer.lambent.use_pass_denoising_data),
    "Debug Sample Count": ("X", "VALUE", lambda layer: layer.lambent.use_pass_sample_count),
}
# Switches of a view layer that ask for passes which are not there yet.
MISSING_PASSES = {
    "use_pass_mist": "Mist",
    "use_pass_vector": "Vector",
    "use_pass_uv": "UV",
    "use_pass_object_index": "Object Index",
    "use_pass_material_index": "Material Index",
    "use_pass_diffuse_direct": "Diffuse Direct",
    "use_pass_diffuse_indirect": "Diffuse Indirect",
    "use_pass_diffuse_color": "Diffuse Color",
    "use_pass_glossy_direct": "Glossy Direct",
    "use_pass_glossy_indirect": "Glossy Indirect",
    "use_pass_glossy_color": "Glossy Color",
    "use_pass_transmission_direct": "Transmission Direct",
    "use_pass_transmission_indirect": "Transmission Indirect",
    "use_pass_transmission_color": "Transmission Color",
    "use_pass_emit": "Emission",
    "use_pass_environment": "Environment",
    "use_pass_ambient_occlusion": "Ambient Occlusion",
    "use_pass_cryptomatte_object": "Cryptomatte Object",
    "use_pass_cryptomatte_material": "Cryptomatte Material",
    "use_pass_cryptomatte_asset": "Cryptomatte Asset",
}


class Crop(NamedTuple):
    """The part of the frame that is rendered, in pixels from the frame's lower left."""

    x: int
    y: int
    width: int
    height: int
    frame_width: int
    frame_height: int


def crop_of(engine, b_render):
    """The border's rectangle, as Blender cuts it: edges are truncated to whole pixels in float32 arithmetic.

    `resolution_x` of the engine is that of the whole frame, with or without border or crop.
    """
    width, height = engine.resolution_x, engine.resolution_y
    if not b_render.use_border:
        return Crop(0, 0, width, height, width, height)
    left, right = (int(np.float32(edge) * np.float32(width)) for edge in (b_render.border_min_x, b_render.border_max_x))
    low, high = (int(np.float32(edge) * np.float32(height)) for edge in (b_render.border_min_y, b_render.border_max_y))
    return Crop(left, low, right - left, high - low, width, height)


def passes_of(b_layer):
    """Names of the passes that a view layer asks for."""
    return [name for name, (_, _, is_asked) in PASSES.items() if is_asked(b_layer)]


def missing_passes(b_layer):
    """Names of the passes that a view layer asks for in vain."""
    return [name for switch, name in MISSING_PASSES.items() if getattr(b_layer, switch, False)]


def register_passes(engine, b_scene, b_layer):
    """Tell Blender what passes will come; the compositor's sockets are made from it."""
    for name in passes_of(b_layer):
        channels, kind, _ = PASSES[name]
        engine.register_pass(b_scene, b_layer, name, len(channels), channels, kind)


class Result:
    """The pixels of one view layer and view."""

    def __init__(self, engine, layer, view, crop):
        self._engine, self._layer, self._view, self._crop = engine, layer, view, crop
        self._is_begun = False

    def write(self, render, tile=None):
        """Copy a tile (x, y, width, height) of the film, or all of it, into Blender's picture."""
        self._is_begun = True
        x, y, width, height = tile or (0, 0, self._crop.width, self._crop.height)
        result = self._engine.begin_result(x, y, width, height, layer=self._layer, view=self._view)
        if (result.resolution_x, result.resolution_y) != (width, height):
            self._engine.end_result(result, cancel=True)
            raise RuntimeError(
                f"Blender has {result.resolution_x} x {result.resolution_y} pixels for a tile of {width} x {height}"
            )
        for b_pass in result.layers[0].passes:
            if b_pass.name in PASSES:
                pixels = render.image(b_pass.name, tile)
                b_pass.rect.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
        self._engine.end_result(result)

    def ensure(self):
        """Let there be a picture, if an empty one: Blender crashes when it saves one that no engine has begun."""
        if not self._is_begun:
            self._engine.end_result(self._engine.begin_result(0, 0, 1, 1, layer=self._layer, view=self._view))

    def stamp(self, fields):
        """Put texts, by name, beside the pixels: they land in the header of the saved file."""
        for name, text in fields.items():
            self._engine.get_result().stamp_data_add_field(f"lambent.{self._layer}.{name}", text)
