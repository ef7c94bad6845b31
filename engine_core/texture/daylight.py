# SPDX-License-Identifier: GPL-3.0-or-later
"""Skies by formulas: the numbers that `sky.preetham` and `sky.hosek_wilkie` are given.

Preetham, Shirley and Smits (1999), "A practical analytic model for daylight"; Hosek and Wilkie (2012), "An analytic
model for full spectral sky-dome radiance", whose data set has a notice of its own, `hosek_wilkie.txt`.
"""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

# By turbidity, slope and offset: of Y, x and y
PEREZ = np.array(
    [[(0.1787, -1.4630), (-0.3554, 0.4275), (-0.0227, 5.3251), (0.1206, -2.5771), (-0.0670, 0.3703)],
     [(-0.0193, -0.2592), (-0.0665, 0.0008), (-0.0004, 0.2125), (-0.0641, -0.8989), (-0.0033, 0.0452)],
     [(-0.0167, -0.2608), (-0.0950, 0.0092), (-0.0079, 0.2102), (-0.0441, -1.6537), (-0.0109, 0.0529)]]
)  # fmt: skip
# Chromaticities of the zenith: rows by powers 2, 1, 0 of turbidity, columns by powers 3 to 0 of the sun's angle
ZENITH_X = [
    (0.00166, -0.00375, 0.00209, 0.0),
    (-0.02903, 0.06377, -0.03202, 0.00394),
    (0.11693, -0.21196, 0.06052, 0.25886),
]
ZENITH_Y = [
    (0.00275, -0.00610, 0.00317, 0.0),
    (-0.04214, 0.08970, -0.04153, 0.00516),
    (0.15346, -0.26756, 0.06670, 0.26688),
]
BRIGHTNESS = 0.06  # Blender's factor


class Sky(NamedTuple):
    config: np.ndarray  # (9, 3), by channel
    radiance: np.ndarray  # (3,)
    angle: float  # of the sun to the vertical
    azimuth: float  # from +y towards +x


def preetham(sun_direction, turbidity):
    """`sun_direction`: unit, (3,)."""
    angle, azimuth = _angles(sun_direction)
    shape = PEREZ @ (turbidity, 1.0)
    chi = (4.0 / 9.0 - turbidity / 120.0) * (math.pi - 2.0 * angle)
    zenith = BRIGHTNESS * ((4.0453 * turbidity - 4.9710) * math.tan(chi) - 0.2155 * turbidity + 2.4192)
    colour = [np.polyval([np.polyval(row, angle) for row in rows], turbidity) for rows in (ZENITH_X, ZENITH_Y)]
    radiance = np.array([zenith, *colour]) / [_perez(row, 0.0, angle) for row in shape]
    return Sky(np.pad(shape.T, ((0, 4), (0, 0))), radiance, angle, azimuth)


def _perez(row, theta, gamma):
    a, b, c, d, e = row
    return (1.0 + a * math.exp(b / math.cos(theta))) * (1.0 + c * math.exp(d * gamma) + e * math.cos(gamma) ** 2)


def hosek_wilkie(sun_direction, turbidity, ground_albedo):
    """`turbidity`: 1 to 10; `ground_albedo`: 0 to 1."""
    data = np.load(Path(__file__).with_name("hosek_wilkie.npz"))
    angle, azimuth = _angles(sun_direction)
    angle = min(angle, math.pi / 2.0)
    t = (1.0 - angle / (math.pi / 2.0)) ** (1.0 / 3.0)
    bezier = [math.comb(5, k) * (1.0 - t) ** (5 - k) * t**k for k in range(6)]
    turbidity = min(max(turbidity, 1.0), 10.0) - 1.0
    low = min(int(turbidity), 8)
    by_turbidity = [1.0 - (turbidity - low), turbidity - low]
    by_albedo = [1.0 - ground_albedo, ground_albedo]
    shapes, radiances = data["shapes"][:, :, low : low + 2], data["radiances"][:, :, low : low + 2]
    config = np.einsum("catkn,a,t,k->nc", shapes, by_albedo, by_turbidity, bezier)
    radiance = np.einsum("catk,a,t,k->c", radiances, by_albedo, by_turbidity, bezier)
    return Sky(config, radiance, angle, azimuth)


def _angles(direction):
    x, y, z = direction
    return math.acos(min(max(z, -1.0), 1.0)), math.atan2(x, y)
