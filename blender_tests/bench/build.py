# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles a second that go into a tree, from corners to packets, one core; and over both cores.

python -m blender_tests.bench.build
"""

import json
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from blender_tests.helpers.rays import bumpy_sphere
from engine_core.accel.build import build_triangles

RINGS = 502  # 1 006 008 triangles


def run(quick=False):
    """{"triangles_per_s": ..., ...}: a surface of a million triangles; medians of some repetitions.

    `soup_triangles_per_s`: random triangles all over each other. `two_threads_triangles_per_s`: two trees at a time.
    Of one thread the time that it computed counts, of two threads the time on the clock.
    """
    vertices, faces = bumpy_sphere(60 if quick else RINGS)
    surface = vertices[faces]
    random = np.random.default_rng(1)
    soup = (random.random((len(faces), 1, 3)) + 0.02 * random.random((len(faces), 3, 3))).astype(np.float32)
    build_triangles(surface[:100])  # compiles
    repetitions = 3 if quick else 7
    with ThreadPoolExecutor(2) as threads:
        two = _seconds(lambda: list(threads.map(build_triangles, [surface, surface])), repetitions, time.perf_counter)
    return {
        "triangles": len(faces),
        "triangles_per_s": len(faces) / _seconds(lambda: build_triangles(surface), repetitions),
        "soup_triangles_per_s": len(faces) / _seconds(lambda: build_triangles(soup), repetitions),
        "two_threads_triangles_per_s": 2 * len(faces) / two,
    }


def _seconds(work, repetitions, clock=time.thread_time):
    taken = []
    for _ in range(repetitions):
        start = clock()
        work()
        taken.append(clock() - start)
    return float(np.median(taken))


if __name__ == "__main__":
    print(json.dumps(run(), indent=2))
