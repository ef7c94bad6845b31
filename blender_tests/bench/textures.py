# SPDX-License-Identifier: GPL-3.0-or-later
"""What a value of a texture costs the processor: nanoseconds, and seconds to compile them all."""

import time

import numpy as np

from engine_core.jit import kernel
from engine_core.linalg.vec3 import Vec3
from engine_core.texture.brick import brick
from engine_core.texture.checker import checker
from engine_core.texture.gabor import gabor
from engine_core.texture.gradient import gradient
from engine_core.texture.magic import magic
from engine_core.texture.noise import NoiseKind, noise
from engine_core.texture.perlin import perlin
from engine_core.texture.voronoi import VoronoiFeature, voronoi
from engine_core.texture.wave import wave
from engine_core.texture.white_noise import white_noise

DIMENSIONS = (1, 2, 3, 4)
FBM, FEATURES = int(NoiseKind.FBM), [int(feature) for feature in VoronoiFeature]
f = np.float32
# {name: (number of the texture below, dimensions, kind)}
TEXTURES = (
    {f"perlin_{n}d": (0, n, 0) for n in DIMENSIONS}
    | {f"noise_{n}d_detail_2": (1, n, FBM) for n in DIMENSIONS}
    | {"noise_3d_detail_2_color": (2, 3, FBM)}
    | {f"voronoi_{n}d_{VoronoiFeature(k).name.lower()}": (3, n, k) for n in DIMENSIONS for k in FEATURES}
    | {"wave_distorted": (4, 3, 0), "magic": (5, 3, 0), "brick": (6, 3, 0), "checker": (7, 3, 0), "gradient": (8, 3, 0)}
    | {"white_noise_3d": (9, 3, 0), "gabor_2d": (10, 2, 0), "gabor_3d": (10, 3, 0)}
)


def run(quick=False):
    """{"compile_cpu_s", texture: ns a value}; compiling counts only where the machine code is not in the cache."""
    began = time.process_time()
    _values(1, *TEXTURES["checker"])
    figures = {"compile_cpu_s": time.process_time() - began}
    for name, texture in TEXTURES.items():
        figures[name + "_ns"] = min(ns_a_value(texture, 1e6 if quick else 2e7) for _ in range(1 if quick else 3))
    return figures


def ns_a_value(texture, budget_ns):
    """Mean over about as many values as fit into the budget."""
    count, spent = 100, 0
    while spent < 0.3 * budget_ns:
        count *= 2
        began = time.thread_time_ns()
        _values(count, *texture)
        spent = time.thread_time_ns() - began
    return spent / count


@kernel
def _values(count, texture, dimensions, kind):
    """The sum of many values, so that none is left out."""
    total = f(0.0)
    one = Vec3(1.0, 1.0, 1.0)
    for i in range(count):
        p = Vec3(0.37 * f(i % 1000), 0.11 * f(i % 777), 0.07 * f(i % 313))
        if texture == 0:
            total += perlin(p, p.x if dimensions == 4 else f(0.0), dimensions)
        elif texture == 1 or texture == 2:
            total += noise(
                p, p.x, dimensions, kind, f(2.0), f(0.5), f(2.0), f(0.0), f(1.0), f(0.0), True, texture == 2
            ).value
        elif texture == 3:
            total += voronoi(
                p, p.x, dimensions, kind, 0, f(5.0), f(0.0), f(0.5), f(2.0), f(1.0), f(1.0), f(1.0), True, False
            ).distance
        elif texture == 4:
            total += wave(p, 0, 0, 0, f(1.0), f(2.0), f(0.5), f(0.5), f(0.0))
        elif texture == 5:
            total += magic(p, 2, f(1.0)).x
        elif texture == 6:
            total += brick(p, one, one, one, f(0.02), f(0.1), f(0.0), f(0.5), f(0.25), f(0.5), 2, f(1.0), 2).color.x
        elif texture == 7:
            total += checker(p)
        elif texture == 8:
            total += gradient(p, kind)
        elif texture == 9:
            total += white_noise(p, p.x, dimensions).value
        else:
            total += gabor(p, dimensions, f(2.0), f(1.0), f(0.0), one).value
    return total
