# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows for lamps: one of LIGHT, to sample it, and one of SHAPE, for rays that run into it.

Each function returns (light, shape); shape is None for a lamp without extent, both are None for one that is dark.
"""

import math

import numpy as np

from ..tables import LIGHT, SHAPE, LightKind, ShapeKind
from . import checks

SMALLEST_SIZE = 1e-6  # metres; thinner area lights would have no area in float32
SMALLEST_ANGLE = 1e-4  # radians; suns and spreads below this are taken as exactly parallel


def point(name, to_world, power, radius, soft, visibility):
    """A sphere of radiance power / (4 pi^2 r^2), or a facing disk of as much intensity; without a radius a point."""
    matrix, power = _common(name, to_world, power)
    radius = checks.number(name, "radius", radius, 0.0)
    light = _light(LightKind.POINT, visibility)
    light["p"], light["radius"], light["soft"] = matrix[:, 3], radius, soft
    return _with_ball(light, power, radius, soft)


def spot(name, to_world, power, radius, angle, blend, soft, visibility):
    """A point light that fades out at the edge of a cone; its scale makes the cone elliptic, as in Cycles."""
    matrix, power = _common(name, to_world, power)
    radius = checks.number(name, "radius", radius, 0.0)
    cos_half = math.cos(min(checks.number(name, "cone angle", angle, 0.0), math.pi) / 2.0)
    light = _light(LightKind.SPOT, visibility)
    scale = np.maximum(np.linalg.norm(matrix[:, :3], axis=0), 1e-12)
    axes = matrix[:, :3] / scale
    light["p"], light["radius"], light["soft"] = matrix[:, 3], radius, soft
    light["u"], light["v"], light["n"] = (
        axes[:, 0] * (scale[2] / scale[0]),
        axes[:, 1] * (scale[2] / scale[1]),
        -axes[:, 2],
    )
    light["cos_angle"] = cos_half
    edge = (1.0 - cos_half) * min(max(checks.number(name, "blend", blend), 0.0), 1.0)
    light["blend"] = 1.0 / edge if edge > 0.0 else math.inf
    return _with_ball(light, power, radius, soft)


def _with_ball(light, power, radius, soft):
    if not power.any():
        return None, None
    if radius == 0.0:
        light["emission"], light["is_delta"] = power / (4.0 * math.pi), 1  # intensity
        return light, None
    light["emission"] = power / (4.0 * math.pi**2 * radius**2)
    light["area"] = 4.0 * math.pi * radius**2
    shape = _shape(ShapeKind.FACING_DISK if soft else ShapeKind.SPHERE, light["p"], radius=radius)
    return light, shape


def sun(name, direction, irradiance, angle, visibility):
    """Directions within `angle` / 2 of where the light comes from; as much irradiance whatever the angle."""
    direction = checks.array(name, "direction", direction, np.float64, 3)
    length = np.linalg.norm(direction)
    if length == 0.0:
        raise checks.SceneError(f"{name}: direction of the light is zero")
    irradiance = checks.color(name, "strength", irradiance)
    if not irradiance.any():
        return None, None
    half = min(checks.number(name, "angle", angle, 0.0), math.pi) / 2.0
    light = _light(LightKind.SUN, visibility)
    light["n"] = direction / length
    light["height"] = 2.0 * math.sin(half / 2.0) ** 2  # 1 - cos(half) without losing digits
    if half < SMALLEST_ANGLE:
        light["emission"], light["is_delta"] = irradiance, 1
    else:
        # the disk's radiance: irradiance over its projected solid angle, pi sin^2
        light["emission"] = irradiance / (math.pi * math.sin(half) ** 2)
    return light, None


def area(name, to_world, power, size_x, size_y, shape, spread, visibility):
    """A Lambertian emitter of radiance power / (pi area), its front along -z.

    Scaling the lamp changes its area, not its power.
    """
    matrix, power = _common(name, to_world, power)
    ellipse = shape == "ELLIPSE"
    u = matrix[:, 0] * (checks.number(name, "size", size_x, 0.0) / 2.0)
    v = matrix[:, 1] * (checks.number(name, "size", size_y, 0.0) / 2.0)
    surface = float(np.linalg.norm(np.cross(u, v))) * (math.pi if ellipse else 4.0)
    if not power.any() or surface < SMALLEST_SIZE**2:
        return None, None
    light = _light(LightKind.DISK if ellipse else LightKind.QUAD, visibility)
    normal = -matrix[:, 2] if np.linalg.norm(matrix[:, 2]) > 0 else -np.cross(u, v)
    front = np.cross(u, v)
    if np.dot(front, normal) < 0.0:
        v, front = -v, -front
    light["p"], light["u"], light["v"] = matrix[:, 3], u, v
    light["n"] = front / np.linalg.norm(front)
    light["area"] = surface
    half_spread = checks.number(name, "spread", spread, 0.0, math.pi + 1e-5) / 2.0
    if half_spread < SMALLEST_ANGLE:  # a beam
        light["spread"], light["is_delta"], light["emission"] = 0.0, 1, power / surface
        return light, None
    if half_spread < math.pi / 2.0 - SMALLEST_ANGLE:  # brighter ahead by what it does not send sideways, as in Cycles
        tangent = math.tan(half_spread)
        light["spread"], light["emission"] = tangent, power / (math.pi * surface * (1.0 - half_spread / tangent))
    else:
        light["emission"] = power / (math.pi * surface)
    return light, _shape(ShapeKind.DISK if ellipse else ShapeKind.QUAD, light["p"], u, v)


def _common(name, to_world, power):
    matrix, _ = checks.transform(name, to_world)
    return matrix, checks.color(name, "power", power)


def _light(kind, visibility):
    light = np.zeros(1, LIGHT)[0]
    light["kind"], light["visibility"] = kind, int(visibility)
    light["instance"] = light["prim"] = light["lamp"] = -1
    light["cos_angle"], light["spread"] = -1.0, math.inf
    return light


def _shape(kind, p, u=(0, 0, 0), v=(0, 0, 0), radius=0.0):
    shape = np.zeros(1, SHAPE)[0]
    shape["kind"], shape["p"], shape["u"], shape["v"], shape["radius"] = kind, p, u, v, radius
    shape["slot"], shape["instance"] = 0, -1
    return shape
