# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles a second that go into a tree, from corners to packets, and what the tree takes of memory.

python -m blender_tests.bench.build
"""

import json
import time

import numpy as np

from blender_tests.helpers.rays import bumpy_sphere
from engine_core.accel.build import THREADS, build_triangles

RINGS = 502  # 1 006 008 triangles


def run(quick=False):
    """{"triangles_per_s": ..., ...}: a surface of a million triangles; medians of some repetitions.

    `triangles_per_s`: by the clock, on all cores. `triangles_per_core_s`: by the time that they computed.
    `soup_...`: random triangles all over each other. `bytes_per_triangle`: of the tree and its packets.
    """
    vertices, faces = bumpy_sphere(60 if quick else RINGS)
    surface = vertices[faces]
    random = np.random.default_rng(1)
    soup = (random.random((len(faces), 1, 3)) + 0.02 * random.random((len(faces), 3, 3))).astype(np.float32)
    build_triangles(surface)  # compiles
    repetitions, count = 3 if quick else 7, len(faces)
    nodes, packets = build_triangles(surface)
    return {
        "triangles": count,
        "cores": THREADS,
        "triangles_per_s": count / _seconds(lambda: build_triangles(surface), repetitions, time.perf_counter),
        "triangles_per_core_s": count / _seconds(lambda: build_triangles(surface), repetitions, time.process_time),
        "soup_triangles_per_s": count / _seconds(lambda: build_triangles(soup), repetitions, time.perf_counter),
        "bytes_per_triangle": (nodes.nbytes + packets.nbytes) / count,
    }


def _seconds(work, repetitions, clock):
    taken = []
    for _ in range(repetitions):
        start = clock()
        work()
        taken.append(clock() - start)
    return float(np.median(taken))


if __name__ == "__main__":
    print(json.dumps(run(), indent=2))
