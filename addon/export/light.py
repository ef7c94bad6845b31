# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps: point, spot, sun and area lights."""

import numpy as np

from ..core import Aim, LampShader, graph
from . import nodes, units


def export_light(context, b_object, to_world, visibility, random, values):
    """Add one lamp. `to_world`: (4, 4), instances included; `visibility`: Visibility; `random`: 0 to 1.
    `values`: a function that gives what its nodes ask of this instance."""
    b_light = b_object.data
    name = b_object.name
    if getattr(getattr(b_light, "cycles", None), "is_portal", False):
        return  # guides Cycles' sampling of the world, and does not shine
    if not b_light.use_shadow:
        context.warn(name, "lights without shadows are not rendered yet; it casts shadows")
    factor = nodes.light_factor(context, b_light)
    color = np.array(units.light_color(b_light))
    rays = {"visibility": visibility, "aim": aim_of(b_object)}
    if graph.is_constant(factor):
        color = color * factor
    else:
        told = random, tuple(b_object.color), b_object.pass_index, values()
        rays["shader"] = LampShader(factor, to_world, *told)
    EXPORTERS[b_light.type](context.builder, name, b_light, to_world, color, rays)


def aim_of(b_object):
    """Whether the mixture integrator sends rays at it, as the artist set it."""
    return Aim[getattr(getattr(b_object, "lambent", None), "aim", "AUTOMATIC")]


def _export_point(builder, name, b_light, to_world, color, rays):
    radius = b_light.shadow_soft_size
    power = color * units.ball_power(b_light.energy, radius, b_light.normalize)
    builder.point_light(name, to_world[:3, 3], power, radius, b_light.use_soft_falloff, **rays)


def _export_spot(builder, name, b_light, to_world, color, rays):
    radius = b_light.shadow_soft_size
    power = color * units.ball_power(b_light.energy, radius, b_light.normalize)
    angle, blend = b_light.spot_size, b_light.spot_blend
    builder.spot_light(name, to_world, power, radius, angle, blend, b_light.use_soft_falloff, **rays)


def _export_sun(builder, name, b_light, to_world, color, rays):
    irradiance = color * units.sun_irradiance(b_light.energy, b_light.angle, b_light.normalize)
    builder.sun_light(name, -to_world[:3, 2], irradiance, b_light.angle, **rays)


def _export_area(builder, name, b_light, to_world, color, rays):
    size_x = b_light.size
    size_y = b_light.size_y if b_light.shape in ("RECTANGLE", "ELLIPSE") else size_x
    shape = "ELLIPSE" if b_light.shape in ("DISK", "ELLIPSE") else "RECTANGLE"
    area = units.area(to_world, size_x, size_y, shape)
    power = color * units.area_power(b_light.energy, area, b_light.normalize)
    builder.area_light(name, to_world, power, size_x, size_y, shape, b_light.spread, **rays)


EXPORTERS = {"POINT": _export_point, "SPOT": _export_spot, "SUN": _export_sun, "AREA": _export_area}
