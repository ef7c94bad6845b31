# SPDX-License-Identifier: GPL-3.0-or-later
"""One value for a socket, whatever is linked to it: the true one if the nodes are constant, else the likeliest.

Stands where shader programs will stand. Nodes that vary over a surface are taken at their average, so that the picture
keeps its brightness and its colours where it loses its texture. With a node of which nothing is known the socket counts
as if it were not linked.
"""

import math
from typing import NamedTuple

import bpy
import numpy as np

from .graph import by_identifier, source

REC709 = (0.2126, 0.7152, 0.0722)
DEEPEST, MOST_NODES = 100, 1000  # a tree may use a node many times over, and so grow exponentially
LARGEST_IMAGE = 1 << 27  # values; larger ones are not worth their loading time for one colour
SAMPLES = 256  # rows and columns of an image that are looked at
# Averages over all directions, as Cycles renders these skies with Blender's default settings, without the sun's disk
SKIES = {"HOSEK_WILKIE": (0.08, 0.15, 0.22), "PREETHAM": (0.6, 0.7, 1.0)}
LATER_SKIES = (2.0, 2.6, 3.5)

BLENDS = {
    "MIX": lambda a, b: b,
    "MULTIPLY": lambda a, b: a * b,
    "ADD": lambda a, b: a + b,
    "SUBTRACT": lambda a, b: a - b,
}
OPERATIONS = {
    "ADD": lambda a, b: a + b,
    "SUBTRACT": lambda a, b: a - b,
    "MULTIPLY": lambda a, b: a * b,
    "DIVIDE": lambda a, b: a / b if b else 0.0,
    "POWER": lambda a, b: a**b if a > 0.0 else 0.0,
    "MINIMUM": min,
    "MAXIMUM": max,
}


class Value(NamedTuple):
    value: float | tuple  # a number, or three
    culprit: bpy.types.Node | None = None  # the node for which it only stands in


class StandIns:
    """Evaluates sockets. Methods with a node's type for a name give the value of that node's output, or None."""

    def __init__(self):
        self._averages = {}  # an image's address in Blender, is panorama: average
        self._depth = self._count = 0  # of nodes on the way to the socket that was asked for

    def evaluate(self, socket, groups, kind):
        """Value of an input socket as `kind`: "VALUE" a number, "RGBA" three."""
        node, output, inner = source(socket, groups)
        if node is None:
            return Value(_convert(_own_value(output), kind))
        self._count = self._count + 1 if self._depth else 1
        function = getattr(self, f"_{node.type.lower()}", None)
        result = None
        if function and self._depth < DEEPEST and self._count < MOST_NODES:
            self._depth += 1
            try:
                result = function(node, output, inner)
            finally:
                self._depth -= 1
        if result is None:
            return Value(_convert(_own_value(socket), kind), node)
        return Value(_convert(result.value, kind), result.culprit)

    def _number(self, node, groups, name):
        return self.evaluate(by_identifier(node.inputs, name), groups, "VALUE")

    def _color(self, node, groups, name):
        return self.evaluate(by_identifier(node.inputs, name), groups, "RGBA")

    # ---- Constant nodes ----

    def _rgb(self, node, output, groups):
        return Value(_own_value(output))

    _value = _rgb

    def _blackbody(self, node, output, groups):
        temperature = self._number(node, groups, "Temperature")
        return Value(blackbody_color(temperature.value), temperature.culprit)

    def _math(self, node, output, groups):
        inputs = [self.evaluate(socket, groups, "VALUE") for socket in node.inputs]
        culprit = next((i.culprit for i in inputs if i.culprit), None)
        if node.operation not in OPERATIONS:
            # a comparison of an average would be one extreme or the other: the average itself is nearer
            return next((i for i in inputs if i.culprit), Value(inputs[0].value, node))
        result = OPERATIONS[node.operation](inputs[0].value, inputs[1].value)
        return Value(_clamp(result) if node.use_clamp else result, culprit)

    def _mix(self, node, output, groups):
        kind = {"RGBA": "Color", "FLOAT": "Float", "VECTOR": "Vector"}.get(node.data_type)
        if kind is None:
            return None
        a, b = (self._color(node, groups, f"{side}_{kind}") for side in "AB")
        blend_type = node.blend_type if kind == "Color" else "MIX"
        return _mixed(node, self._number(node, groups, "Factor_Float"), a, b, blend_type)

    def _mix_rgb(self, node, output, groups):
        a, b = (self._color(node, groups, name) for name in ("Color1", "Color2"))
        return _mixed(node, self._number(node, groups, "Fac"), a, b, node.blend_type)

    def _valtorgb(self, node, output, groups):
        factor = self._number(node, groups, "Fac")
        color = tuple(node.color_ramp.evaluate(factor.value))
        return Value(color[3] if output.identifier == "Alpha" else color[:3], factor.culprit)

    def _light_falloff(self, node, output, groups):
        """Quadratic is what light does anyway."""
        strength = self._number(node, groups, "Strength")
        is_plain = output.identifier == "Quadratic" and self._number(node, groups, "Smooth").value == 0.0
        return strength if is_plain else Value(strength.value, node)

    # ---- Nodes that vary over a surface ----

    def _hue_sat(self, node, output, groups):
        return Value(self._color(node, groups, "Color").value, node)

    _gamma = _brightcontrast = _curve_rgb = _hue_sat

    def _tex_checker(self, node, output, groups):
        if output.identifier == "Fac":
            return Value(0.5, node)
        a, b = (self._color(node, groups, name).value for name in ("Color1", "Color2"))
        return Value(tuple((x + y) / 2.0 for x, y in zip(a, b, strict=True)), node)

    _tex_brick = _tex_checker

    def _tex_noise(self, node, output, groups):
        return Value(0.5, node) if output.type in ("VALUE", "RGBA") else None

    _tex_voronoi = _tex_wave = _tex_magic = _tex_gradient = _tex_white_noise = _tex_gabor = _tex_noise

    def _object_info(self, node, output, groups):
        return Value(0.5, node) if output.identifier == "Random" else None

    def _light_path(self, node, output, groups):
        """What the camera sees counts most."""
        return Value(1.0 if output.identifier == "Is Camera Ray" else 0.0, node)

    def _fresnel(self, node, output, groups):
        return Value(average_fresnel(self._number(node, groups, "IOR").value), node)

    def _layer_weight(self, node, output, groups):
        blend = min(_clamp(self._number(node, groups, "Blend").value), 1.0 - 1e-5)
        if output.identifier == "Fresnel":
            return Value(average_fresnel(1.0 / (1.0 - blend)), node)
        exponent = 2.0 * blend if blend < 0.5 else 0.5 / (1.0 - blend)
        return Value(1.0 - 2.0 / (2.0 + exponent), node)  # mean of 1 - cos ** exponent, weighted by cos

    def _tex_sky(self, node, output, groups):
        return Value(SKIES.get(node.sky_type, LATER_SKIES), node)

    def _tex_image(self, node, output, groups):
        if node.image is None:
            return None
        key = node.image.as_pointer(), node.type == "TEX_ENVIRONMENT"
        if key not in self._averages:
            self._averages[key] = image_average(node.image, is_panorama=key[1])
        average = self._averages[key]
        if average is None:
            return None
        return Value(average[3] if output.identifier == "Alpha" else average[:3], node)

    _tex_environment = _tex_image


def _own_value(socket):
    value = getattr(socket, "default_value", 0.0)
    return tuple(value)[:3] if hasattr(value, "__len__") else value


def _convert(value, kind):
    """As Blender's sockets do: a colour becomes its luminance."""
    if kind == "VALUE":
        return sum(a * b for a, b in zip(value, REC709, strict=True)) if isinstance(value, tuple) else value
    return value if isinstance(value, tuple) else (float(value),) * 3


def _clamp(value):
    return min(max(value, 0.0), 1.0)


def _mixed(node, factor, a, b, blend_type):
    t, blend = _clamp(factor.value), BLENDS.get(blend_type, BLENDS["MIX"])
    mixed = tuple(x + (blend(x, y) - x) * t for x, y in zip(a.value, b.value, strict=True))
    return Value(mixed, factor.culprit or a.culprit or b.culprit or (None if blend_type in BLENDS else node))


# ---- Averages and constants ------------------------------------------------------------------------------------------


def average_fresnel(ior):
    """Share of diffuse light that a smooth dielectric reflects: the mean over the hemisphere, weighted by cosine."""
    ior = max(ior, 1e-3)
    cos = np.sqrt((np.arange(1024) + 0.5) / 1024.0)  # evenly spread in cos ** 2
    g2 = ior**2 - 1.0 + cos**2
    g = np.sqrt(np.maximum(g2, 0.0))
    a = ((g - cos) / (g + cos)) ** 2
    b = ((cos * (g + cos) - 1.0) / (cos * (g - cos) + 1.0)) ** 2
    return float(np.where(g2 > 0.0, 0.5 * a * (1.0 + b), 1.0).mean())


def image_average(b_image, is_panorama):
    """Average linear colour of an image, weighted by its alpha, and its average alpha: four numbers. None if there is
    no image. A panorama's rows count by their solid angle."""
    width, height = b_image.size
    channels = b_image.channels
    if not 0 < width * height * channels <= LARGEST_IMAGE:
        return None
    pixels = np.empty(width * height * channels, np.float32)
    b_image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, channels)[:: -(-height // SAMPLES), :: -(-width // SAMPLES)]
    color = pixels[:, :, :3] if channels >= 3 else np.repeat(pixels[:, :, :1], 3, axis=2)
    if not b_image.is_float and b_image.colorspace_settings.name == "sRGB":
        color = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)  # IEC 61966-2-1
    weight = np.ones(pixels.shape[:2])
    if is_panorama:
        weight *= np.sin((np.arange(len(pixels)) + 0.5) * (math.pi / len(pixels)))[:, None]
    weight /= weight.sum()
    alpha = pixels[:, :, 3] if channels == 4 else np.ones_like(weight)
    coverage = (weight * alpha).sum()
    if coverage == 0.0:
        return (0.0, 0.0, 0.0, 0.0)
    average = (color * (weight * alpha)[:, :, None]).sum(axis=(0, 1)) / coverage
    return (*(float(c) for c in average), float(coverage))


def blackbody_color(kelvin):
    """Linear Rec.709 colour of a black body, of luminance 1.

    Planck's law, weighted by analytic colour matching functions (Wyman, Sloan, Shirley 2013), to Rec.709 primaries.
    """
    nm = np.arange(380.0, 781.0, 5.0)
    kelvin = min(max(kelvin, 800.0), 12000.0)  # where Blender's node ends
    spectrum = nm**-5.0 / np.expm1(1.43878e7 / (nm * kelvin))  # up to a factor; h c / k in nm K

    def lobe(height, centre, below, above):
        return height * np.exp(-0.5 * ((nm - centre) * np.where(nm < centre, below, above)) ** 2)

    x = lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323) + lobe(-0.065, 501.1, 0.0490, 0.0382)
    y = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322)
    z = lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)
    xyz = np.array([(spectrum * curve).sum() for curve in (x, y, z)])
    to_rgb = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])
    rgb = to_rgb @ (xyz / xyz[1])
    return tuple(float(max(c, 0.0)) for c in rgb)
