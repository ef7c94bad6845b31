# SPDX-License-Identifier: GPL-3.0-or-later
"""From the numbers of Blender's lights to watts, and watts per square metre.

Blender gives a lamp's strength in watts of radiant power, as if it shone evenly in all directions; a spot is a point
lamp with most of its light blocked, so it is not brighter for being narrow. The builder wants that power P:

    point, spot    intensity P / (4 pi)               a point lamp sends P evenly into the sphere
    ... radius r   radiance P / (4 pi^2 r^2)          a sphere of that area and the exitance pi L
    area           radiance P / (pi A)                one side, exitance pi L
    sun            irradiance, W / m2                 not power: a sun is infinitely far away

A lamp with "normalize" off keeps its radiance when its size is changed: Cycles then leaves out the division by the
area, and the strength stands for exitance, W / m2.
All checked against Cycles in against_cycles/test_light_units.py.
"""

import math

import numpy as np


def light_color(b_light):
    """Colour of a lamp with its temperature and its exposure (stops), linear; to be multiplied by the strength."""
    color = b_light.color[:]
    if b_light.use_temperature:
        color = tuple(a * b for a, b in zip(color, b_light.temperature_color, strict=True))
    return tuple(c * 2.0**b_light.exposure for c in color)


def ball_power(strength, radius, normalize):
    """Watts of a point or a spot light; with "normalize" off `strength` is its exitance (without a radius: that of a
    ball of 4 m2)."""
    if normalize:
        return strength
    return strength * (4.0 * math.pi * radius**2 if radius > 0.0 else 4.0)


def area_power(strength, area, normalize):
    """Watts of an area light of `area` m2; with "normalize" off `strength` is its exitance."""
    return strength if normalize else strength * area


def sun_irradiance(strength, angle, normalize):
    """W / m2 on a surface that faces a sun of full `angle`; with "normalize" off `strength` is its radiance (but still
    irradiance if it is a mere direction)."""
    if normalize or angle == 0.0:
        return strength
    return strength * math.pi * math.sin(min(angle, math.pi) / 2.0) ** 2


def area(to_world, size_x, size_y, shape):
    """Area of a light in the world, m2, by the lengths of its scaled sides."""
    x, y = np.linalg.norm(to_world[:3, 0]) * size_x, np.linalg.norm(to_world[:3, 1]) * size_y
    return x * y * (math.pi / 4.0 if shape == "ELLIPSE" else 1.0)
