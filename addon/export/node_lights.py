# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that lamps and worlds are made of: Sky Texture, IES Texture, Light Falloff."""

import math

import numpy as np

from ..core import atmosphere, daylight, graph, opcodes
from . import ies
from .node_inputs import number_input, vector_input

Op, Math, InputVector, InputNumber = opcodes.Op, opcodes.Math, opcodes.InputVector, opcodes.InputNumber
SMALLEST_SUN = 0.0005  # radians, as in Cycles
WITHOUT_FILE = 100.0  # what Cycles gives for an IES file that cannot be read


def _direction(values, node, groups, default):
    if values.is_linked(node, groups, "Vector"):
        return values.vector(node, groups, "Vector")
    return vector_input(default)


# ---- Sky -------------------------------------------------------------------------------------------------------------


def _sky(values, node, output, groups):
    d = _direction(values, node, groups, InputVector.GENERATED)
    if node.sky_type in ("PREETHAM", "HOSEK_WILKIE"):
        return _daylight(node, d)
    elevation, rotation = _sun_place(node.sun_elevation, node.sun_rotation)
    aerosols = node.aerosol_density if hasattr(node, "aerosol_density") else node.dust_density
    air = atmosphere.Air(node.altitude, node.air_density, aerosols, node.ozone_density)
    size, multiple, is_old = max(node.sun_size, SMALLEST_SUN), node.sky_type == "MULTIPLE_SCATTERING", False
    if node.sky_type == "NISHITA":  # Blender 4
        is_old, pixels, horizon = True, atmosphere.old_table(elevation, air), -math.pi
    else:
        pixels, horizon = atmosphere.table(elevation, air, multiple), atmosphere.horizon(node.altitude)
    disk = atmosphere.disk(elevation, size, air, multiple)
    numbers = (elevation, rotation, size if node.sun_disc else -1.0, node.sun_intensity, horizon)
    ends = (tuple(end.tolist()) for end in disk)
    mode = opcodes.SkyTable.UPPER_HALF if is_old else opcodes.SkyTable.WHOLE
    image = values.context.images.setdefault(id(pixels), graph.Image("sky", pixels))
    return graph.node(Op.SKY, d, *(float(x) for x in numbers), *ends, mode=mode, data=image)


def _sun_place(elevation, rotation):
    """The same place with an elevation from -90 to 90 degrees: beyond the zenith the sun sinks on the other side."""
    elevation = math.remainder(elevation, 2.0 * math.pi)
    if abs(elevation) > math.pi / 2.0:
        elevation, rotation = math.copysign(math.pi, elevation) - elevation, rotation + math.pi
    return elevation, rotation % (2.0 * math.pi)


def _daylight(node, d):
    sun = np.array(node.sun_direction, np.float64)
    sun = sun / np.linalg.norm(sun) if sun.any() else np.array([0.0, 0.0, 1.0])
    if node.sky_type == "PREETHAM":
        sky = daylight.preetham(sun, node.turbidity)
    else:
        sky = daylight.hosek_wilkie(sun, node.turbidity, node.ground_albedo)
    shapes = (tuple(row) for row in sky.config.tolist())
    place = (sky.angle, sky.azimuth, 0.0)
    mode = opcodes.Daylight[node.sky_type]
    return graph.node(Op.DAYLIGHT, d, *shapes, tuple(sky.radiance.tolist()), place, mode=mode)


# ---- Lamps -----------------------------------------------------------------------------------------------------------


def _ies(values, node, output, groups):
    strength = values.number(node, groups, "Strength")
    try:
        table = ies.table(ies.text_of(node))
    except (ies.IesError, OSError) as error:
        values.warn(node, f"{error}; shining evenly, as Cycles does")
        return graph.product(strength, WITHOUT_FILE)
    d = _direction(values, node, groups, InputVector.OBJECT_NORMAL)
    return graph.node(Op.IES, d, strength, data=graph.Image("IES", table[..., None]))


def _light_falloff(values, node, output, groups):
    """Strength over a power of the distance: light falls off with its square, so that and that much is given back."""
    distance = number_input(InputNumber.RAY_LENGTH)
    strength, smooth = values.number(node, groups, "Strength"), values.number(node, groups, "Smooth")
    square = graph.product(distance, distance)
    if not graph.is_constant(smooth) or smooth > 0.0:
        softened = graph.node(Op.MATH, square, smooth, 0.0, mode=Math.ADD)
        softened = graph.node(Op.MATH, square, softened, 0.0, mode=Math.DIVIDE)
        strength = graph.product(strength, softened)
    if output.identifier == "Linear":
        return graph.product(strength, distance)
    return graph.product(strength, square) if output.identifier == "Constant" else strength


FUNCTIONS = {"TEX_SKY": _sky, "TEX_IES": _ies, "LIGHT_FALLOFF": _light_falloff}
