# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive triangles whose radiance a program makes: their means, and parts to sample them by.

Where the radiance varies over a triangle, it is divided into 4^level equal parts, each a row of LIGHT with a mean of
its own, so that the tree of lights, and the mixture's targets, choose the bright ones. The row of the whole triangle
keeps the way from a hit to its parts (`light.triangle.row_at`) and is never selected itself.
"""

import numpy as np

from ..jit import kernel
from ..linalg.color import not_negative
from ..linalg.records import Tables
from ..linalg.vec3 import Vec3, average, load3, store3
from ..sampling.warp import square_to_triangle
from ..shader.evaluate import light_radiance
from ..shader.point import new_point
from ..tables import LIGHT, MAX_PART_LEVEL, LightKind, Visibility

SAMPLES = 16  # of the program, for the mean of a part
MOST_PARTS = 2**16  # of a scene, given out by area
EVEN = 0.1  # parts are joined again where they differ from their mean by less than this share of the triangle's mean
# The least mean of a part, of its triangle's: what the samples missed shall not be left to chance.
FLOOR = np.float32(0.03)


class Parts(Tables):
    lights = LIGHT


def bake_lights(scene):
    """The table LIGHT of `scene` with the means of what programs emit, and behind all others the parts of triangles."""
    lights = np.asarray(scene.lights).copy()
    rows = np.flatnonzero((lights["program"] > 0) & (lights["kind"] == LightKind.TRIANGLE))
    tables = [lights]
    for level, (numbers, means) in enumerate(_fit(scene, lights[rows])):
        numbers = rows[numbers]
        if level == 0:
            lights["emission"][numbers] = means[:, 0]
            continue
        parts = _divide(lights[numbers], level)
        floor = FLOOR * means.mean(axis=1, keepdims=True)
        parts["emission"] = np.maximum(means, floor).reshape(-1, 3)
        lights["level"][numbers] = level
        lights["parts"][numbers] = sum(map(len, tables)) + np.arange(len(numbers)) * 4**level
        lights["emission"][numbers], lights["aimed_at"][numbers] = 0.0, 0
        tables.append(parts)
    return np.concatenate(tables)


def _fit(scene, triangles):
    """For each level the numbers of the triangles to be divided so, and the means of their parts (n, 4^level, 3)."""
    finest = _finest(triangles["area"].astype(np.float64))
    result, number, means = [], np.zeros(0, np.int64), np.zeros((0, 4**MAX_PART_LEVEL, 3), np.float32)
    for level in range(MAX_PART_LEVEL, -1, -1):
        own = np.flatnonzero(finest == level)
        number = np.concatenate([number, own])
        means = np.concatenate([means, _means(scene, triangles[own], level)])
        if level > 0:
            joined = means.reshape(len(means), 4 ** (level - 1), 4, 3).mean(axis=2)
            apart = np.abs(means.mean(axis=2) - joined.mean(axis=2).repeat(4, axis=1)).mean(axis=1)
            varies = apart > EVEN * joined.mean(axis=(1, 2))
            result.append((number[varies], means[varies]))
            number, means = number[~varies], joined[~varies]
        else:
            result.append((number, means))
    return result[::-1]


def _finest(area):
    """The level that each triangle gets if its radiance varies: as many parts as it has of the area of all."""
    share = MOST_PARTS * area / max(area.sum(), 1e-300)
    return np.clip(np.log2(np.maximum(share, 1.0)) // 2, 0, MAX_PART_LEVEL).astype(np.int64)


def _divide(lights, level):
    """Rows of LIGHT for the 4^level parts of triangles, those of one together, in the order of `row_at`."""
    for _ in range(level):
        parts = np.repeat(lights, 4).reshape(-1, 4)
        u, v = lights["u"] / 2.0, lights["v"] / 2.0
        parts["area"] /= 4.0
        parts["u"], parts["v"] = u[:, None], v[:, None]
        parts["p"][:, 1] += u
        parts["p"][:, 2] += v
        parts["p"][:, 3] += u + v
        parts["u"][:, 3], parts["v"][:, 3] = -u, -v  # the one in the middle, turned by half a circle
        lights = parts.ravel()
    return lights


def _means(scene, triangles, level):
    """Mean radiance of the parts of triangles, (n, 4^level, 3)."""
    parts = Parts(lights=_divide(triangles, level))
    _bake(scene, parts, len(parts.lights), SAMPLES)
    return np.asarray(parts.lights)["emission"].reshape(len(triangles), 4**level, 3)


@kernel
def _bake(scene, parts, count, samples):
    """Set `emission` to the mean of the program."""
    point = new_point()
    for row in range(count):
        light = parts.lights[row]
        total = Vec3(0.0, 0.0, 0.0)
        for i in range(samples):
            # a Hammersley-like set: strata one way, the golden ratio the other
            u0 = (np.float32(i) + 0.5) / np.float32(samples)
            u1 = (np.float32(i) + 0.5) * np.float32(0.618034)
            b1, b2 = square_to_triangle(u0, u1 - np.floor(u1))
            q = load3(light, "p") + load3(light, "u") * b1 + load3(light, "v") * b2
            n = load3(light, "n")
            L = light_radiance(scene, light, point, q, -n, np.float32(1.0), Visibility.DIFFUSE.value)
            if np.isfinite(average(L)):
                total = total + not_negative(L)
        store3(light, "emission", total * (1.0 / np.float32(samples)))
