# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheen of fine fibres (Zeltner, Burley and Chiang, "Practical Multiple-Scattering Sheen Using LTCs", 2022).

A cosine lobe, stretched and sheared (Heitz et al. 2016) by two numbers A and B that depend on roughness and view, as
does the share of light that is scattered at all. The three are in a table, measured from Blender's Microfiber sheen by
`blender_tests/helpers/lobe_values.py`.

Of the lobe: alpha_x is the roughness. Not reciprocal, as A and B belong to the view. Stays lit where a smooth normal
turns away, as `diffuse`.
"""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import WHITE, Vec3, lerp, normalize
from ..sampling.warp import square_to_cosine_hemisphere
from .lobe import ONE, ZERO, LobeSample, LobeValue, nothing

MICROFIBER = np.load(Path(__file__).with_name("sheen_table.npz"))["microfiber"]  # [A, B or albedo, roughness, cos]
NODES = MICROFIBER.shape[1]
INV_PI = np.float32(1.0 / np.pi)


class Stretch(NamedTuple):
    """The lobe at a view: the plane of the view is y = 0 in its frame."""

    a: np.float32
    b: np.float32
    albedo: np.float32
    x: np.float32  # of the view, in the tangent plane: a unit vector
    y: np.float32


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    if wi.z <= 0.0:
        return nothing()
    stretch = _stretch(lobe, wo)
    pdf = _density(stretch, wi)
    return LobeValue(WHITE * (stretch.albedo * pdf), pdf)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    stretch = _stretch(lobe, wo)
    w = square_to_cosine_hemisphere(u0, u1)
    w = normalize(Vec3(w.x - w.z * stretch.b, w.y, w.z * stretch.a))
    wi = Vec3(w.x * stretch.x - w.y * stretch.y, w.x * stretch.y + w.y * stretch.x, w.z)
    return LobeSample(wi, WHITE * stretch.albedo, _density(stretch, wi), False)


@kernel
def albedo(lobe, wo):
    return WHITE * _stretch(lobe, wo).albedo


@kernel
def _stretch(lobe, wo):
    row = min(max(lobe.alpha_x, 1e-3), 1.0) * np.float32(NODES - 1)
    column = min(max(wo.z, 0.0), 1.0) * np.float32(NODES - 1)
    i, j = max(min(int(row), NODES - 2), 0), max(min(int(column), NODES - 2), 0)  # inside even for what is no number
    t, s = row - np.float32(i), column - np.float32(j)
    size = math.sqrt(wo.x * wo.x + wo.y * wo.y)
    x, y = (wo.x / size, wo.y / size) if size > 1e-6 else (ONE, ZERO)
    return Stretch(_between(0, i, j, t, s), _between(1, i, j, t, s), _between(2, i, j, t, s), x, y)


@kernel
def _between(which, i, j, t, s):
    table = MICROFIBER
    low = lerp(table[which, i, j], table[which, i, j + 1], s)
    return lerp(low, lerp(table[which, i + 1, j], table[which, i + 1, j + 1], s), t)


@kernel
def _density(stretch, wi):
    """The cosine lobe, seen through the stretch; also its value, beside the albedo."""
    x, y = wi.x * stretch.x + wi.y * stretch.y, wi.y * stretch.x - wi.x * stretch.y
    a, u = stretch.a, stretch.a * x + stretch.b * wi.z
    ratio = a / (u * u + a * a * y * y + wi.z * wi.z)
    return INV_PI * wi.z * ratio * ratio
