# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps whose radiance a program makes: where their own space is, and how bright they are on average.

`emission` of such a lamp is what it would be without the program times the program's mean, which the tree of lights
goes by; `gain` is one over that mean.
"""

import numpy as np

from ..jit import kernel
from ..light import dispatch as lights_dispatch
from ..linalg.vec3 import average, load3
from ..program_tables import OBJECT
from ..sampling.warp import square_to_sphere
from ..shader.evaluate import light_radiance
from ..shader.point import new_point
from ..tables import INSTANCE, LightKind, Visibility
from . import checks
from .triangles import inverse

PLACES = 512  # that a lamp is looked at from
LEAST_MEAN = 1e-3  # what is dark wherever one looks may still shine elsewhere
LEAST_OF_LARGEST = 0.02


def instance_rows(shaders):
    """Rows of INSTANCE and of OBJECT for lamps with shaders: things without geometry."""
    rows, told = np.zeros(len(shaders), INSTANCE), np.zeros(len(shaders), OBJECT)
    rows["root"] = rows["lights"] = told["attributes"] = told["first_prim"] = -1
    told["texture_scale"] = 1.0
    for row, about, shader in zip(rows, told, shaders, strict=True):
        matrix, regular = checks.transform("Lamp", shader.to_world)
        matrix = matrix if regular else np.eye(4)[:3]
        row["to_world"], row["to_object"] = matrix, inverse(matrix[None])[0]
        row["random"], row["pass_index"], about["color"] = shader.random, shader.pass_index, shader.color
    return rows, told


def bake_lamps(scene, lights):
    """Set `gain` and `emission` of the rows of LIGHT that have programs of lamps."""
    for row in np.flatnonzero(lights["lamp"] >= 0):
        mean, largest = _mean(scene, row, float(scene.world["radius"][0]))
        mean = max(mean, LEAST_OF_LARGEST * largest, LEAST_MEAN)
        lights["emission"][row] *= mean
        lights["gain"][row] = 1.0 / mean


@kernel
def _mean(scene, row, size):
    """(mean, largest) of what the program gives, of colours the mean, over directions and places that the lamp lights,
    about as far away as the scene is large."""
    light, point = scene.lights[row], new_point()
    total, largest, count = np.float32(0.0), np.float32(0.0), 0
    distance = max(size, light.radius, np.float32(1.0))
    for i in range(PLACES):
        u0, u1 = (np.float32(i) + 0.5) / np.float32(PLACES), (np.float32(i) + 0.5) * np.float32(0.618034)
        u2, u3 = (np.float32(i) + 0.5) * np.float32(0.754878), (np.float32(i) + 0.5) * np.float32(0.569840)
        p = load3(light, "p") + square_to_sphere(u0, u1 - np.floor(u1)) * distance
        s = lights_dispatch.sample(scene, light, p, u2 - np.floor(u2), u3 - np.floor(u3))
        if s.pdf <= 0.0 or average(s.radiance) <= 0.0:
            continue
        q = p + s.wi * s.distance if light.kind != LightKind.SUN else s.wi
        value = average(light_radiance(scene, light, point, q, s.wi, s.distance, Visibility.DIFFUSE.value))
        if np.isfinite(value) and value > 0.0:
            total += value
            largest = max(largest, value)
        count += 1
    return total / np.float32(max(count, 1)), largest
