# SPDX-License-Identifier: GPL-3.0-or-later
"""How many rays find a gap between the triangles of a closed mesh of a million: there should be none.

Half of the rays run at points of edges, where rounding would open gaps, half into all directions.

    python -m blender_tests.bench.leaks
"""

import json
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from blender_tests.helpers.rays import bumpy_sphere, geometry_scene
from engine_core.accel.build import THREADS
from engine_core.accel.traverse import NO_FACE, intersect_closest, occluded
from engine_core.jit import kernel
from engine_core.linalg.vec3 import Vec3, lerp
from engine_core.sampling.rng import hash_float

RINGS, RAYS, CHUNK = 502, 100_000_000, 1_000_000
EVERYTHING, FAR, NOW = np.int32(63), np.float32(np.inf), np.float32(0.0)


def run(quick=False):
    return measure(*((60, CHUNK) if quick else (RINGS, RAYS)))


def measure(rings, rays):
    """{"triangles": ..., "rays": ..., "escaped": ..., "not_occluded": ...} of rays that start within."""
    vertices, faces = bumpy_sphere(rings)
    scene = geometry_scene(vertices[faces])
    packets = len(scene.packets)
    count_leaks(scene, packets, 0, 1)  # compiles
    with ThreadPoolExecutor(THREADS) as threads:
        parts = [threads.submit(count_leaks, scene, packets, i, min(CHUNK, rays - i)) for i in range(0, rays, CHUNK)]
        escaped, not_occluded = np.sum([part.result() for part in parts], axis=0)
    return {"triangles": len(faces), "rays": rays, "escaped": int(escaped), "not_occluded": int(not_occluded)}


@kernel
def random(i, dimension):
    return hash_float(i, dimension, 0)


@kernel
def count_leaks(scene, packets, first, count):
    """How many of the rays `first` to `first + count` hit nothing, and how many nothing blocks."""
    escaped, not_occluded = 0, 0
    for i in range(first, first + count):
        o = Vec3(random(i, 0) - 0.5, random(i, 1) - 0.5, random(i, 2) - 0.5) * 0.4
        if i % 2 == 0:
            packet = scene.packets[np.int64(random(i, 3) * np.float32(packets))]
            k, corner = np.int64(random(i, 4) * 8.0), np.int64(random(i, 5) * 3.0)
            after = (corner + 1) % 3
            along = random(i, 6) if i % 32 else np.float32(0.0)
            a = Vec3(packet.p[corner, 0, k], packet.p[corner, 1, k], packet.p[corner, 2, k])
            b = Vec3(packet.p[after, 0, k], packet.p[after, 1, k], packet.p[after, 2, k])
            d = lerp(a, b, along) - o
        else:
            d = Vec3(random(i, 3) - 0.5, random(i, 4) - 0.5, random(i, 5) - 0.5)
        if intersect_closest(scene, o, d, NOW, FAR, EVERYTHING, NOW, NO_FACE).prim < 0:
            escaped += 1
        if not occluded(scene, o, d, FAR, NOW, NO_FACE):
            not_occluded += 1
    return escaped, not_occluded


if __name__ == "__main__":
    print(json.dumps(run(), indent=2))
