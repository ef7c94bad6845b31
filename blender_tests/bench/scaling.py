# SPDX-License-Identifier: GPL-3.0-or-later
"""What a ray costs among 100 to 10 million triangles: by the tree, and by trying a plain list from end to end.

The list grows in proportion to the triangles, the tree about with their logarithm, until it no longer fits the caches.
Both test triangles by the same instructions, four at a time; one thread.

    python -m blender_tests.bench.scaling
"""

import json
import time

import numpy as np

from blender_tests.helpers.rays import bumpy_sphere, closest_all, geometry_scene, make_rays
from engine_core.accel.packet import intersect_packet, make_shear
from engine_core.jit import kernel
from engine_core.linalg.simd import lane, load1, lowest_bit, without_lowest_bit
from engine_core.linalg.vec3 import load3
from engine_core.tables import Visibility

SIZES = (100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000)
LONGEST_LIST = 100_000
RAYS, TESTS = 1 << 16, 1 << 27  # of a list as many rays as make so many tests


def run(quick=False):
    """{primitives: {"tree_ns": ..., "list_ns": ...}}; no list_ns where the list is too long"""
    points = measure(SIZES[:3] if quick else SIZES)
    return {f"{point.pop('primitives')}": {k: v for k, v in point.items() if v is not None} for point in points}


def measure(sizes=SIZES, longest_list=LONGEST_LIST, repetitions=5):
    """For each of about `sizes` triangles: primitives; tree_ns, list_ns: nanoseconds that a ray computes, the least of
    some repetitions. list_ns is None beyond `longest_list`.

    The triangles make a closed, bumpy surface. Rays start within it and run into all directions, so each hits.
    """
    return [_measure_one(size, longest_list, repetitions) for size in sizes]


def _measure_one(size, longest_list, repetitions):
    vertices, faces = bumpy_sphere(max(3, round(0.5 + 0.5 * size**0.5)))  # 4 r (r - 1) triangles of r rings
    triangles, count = vertices[faces], len(faces)
    del vertices, faces
    scene = geometry_scene(triangles)
    random = np.random.default_rng(1)
    d = random.normal(size=(RAYS, 3))
    o = random.uniform(-0.5, 0.5, (RAYS, 3))
    rays = make_rays(o, d / np.linalg.norm(d, axis=1, keepdims=True))
    tree_ns = _least(lambda: closest_all(scene, rays, RAYS, int(Visibility.ALL)), repetitions) / RAYS * 1e9
    point = {"primitives": count, "tree_ns": tree_ns, "list_ns": None}
    if count <= 1.5 * longest_list:
        some = min(max(TESTS // count, 64), RAYS)
        found = rays.rays["t"][:some].copy()
        packets = len(scene.packets)
        point["list_ns"] = _least(lambda: closest_of_list(scene, packets, rays, some), repetitions) / some * 1e9
        if not np.array_equal(found, rays.rays["t"][:some]):
            raise AssertionError("the tree and the list found different hits")
    return point


@kernel
def closest_of_list(scene, packets, rays, count):
    """What `closest_all` finds, by trying all triangles."""
    for i in range(count):
        ray = rays.rays[i]
        shear = make_shear(load3(ray, "o"), load3(ray, "d"))
        t = ray.t_max
        prim = np.int32(-1)
        for k in range(packets):
            packet = scene.packets[k]
            found = intersect_packet(packet, shear, np.float32(0.0), t)
            hits = found.hits
            while hits != 0:
                j = lowest_bit(hits)
                hits = without_lowest_bit(hits)
                if lane(found.t, j) < t:
                    t, prim = lane(found.t, j), load1(packet, "prim", j)
        ray.t, ray.prim = t, prim


def _least(work, repetitions):
    """Seconds that the thread computed, where it was disturbed the least."""
    work()  # compiles
    taken = []
    for _ in range(repetitions):
        start = time.thread_time()
        work()
        taken.append(time.thread_time() - start)
    return min(taken)


if __name__ == "__main__":
    print(json.dumps(run(), indent=2))
