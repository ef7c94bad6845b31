# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays a second, beside Embree's: one thread, a million triangles, three kinds of rays.

camera: from one point through a grid of pixels. incoherent: from random points within the surface, in all directions.
bounced: from where those hit, in random directions again: what most rays of a path tracer are like.

    python -m blender_tests.bench.rays
"""

import json
import time

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from blender_tests.helpers.rays import bumpy_sphere, closest_all, geometry_scene, make_rays, occluded_all
from engine_core.tables import Visibility

RINGS = 502  # 1 006 008 triangles


def run(quick=False):
    """{kind: {"ratio_embree": ..., ...}}: medians over repetitions in which both take turns.

    Times are those that the thread computed, not those on the clock of a shared machine. `quick`: fewer of everything.
    """
    vertices, faces = bumpy_sphere(60 if quick else RINGS)
    scene = geometry_scene(vertices[faces])
    embree = EmbreeScene()
    TriangleMesh(embree, vertices, faces.astype(np.int32))
    count, repetitions = (1 << 14, 3) if quick else (1 << 18, 9)
    result = {"triangles": len(faces)}
    for kind, (o, d) in ray_sets(scene, count).items():
        result[kind] = compare(scene, embree, o, d, repetitions)
    return result


def ray_sets(scene, count):
    """{kind: (o, d)}, float32 (count, 3)."""
    random = np.random.default_rng(1)
    side = int(count**0.5)
    x, y = np.meshgrid(np.linspace(-0.8, 0.8, side), np.linspace(-0.8, 0.8, side))
    grid = np.stack([x.ravel(), y.ravel(), np.ones(side * side)], axis=1)
    camera = np.tile(np.float32([0, 0, -2.5]), (len(grid), 1)), _unit(grid)
    incoherent = random.uniform(-0.5, 0.5, (count, 3)).astype(np.float32), _unit(random.normal(size=(count, 3)))
    rays = make_rays(*incoherent)
    closest_all(scene, rays, count, int(Visibility.ALL))
    hit = incoherent[0] + incoherent[1] * rays.rays["t"][:, None] * np.float32(0.999)
    return {"camera": camera, "incoherent": incoherent, "bounced": (hit, _unit(random.normal(size=(count, 3))))}


def compare(scene, embree, o, d, repetitions):
    """Rays a second of both, their ratio, and how many rays find the same triangle."""
    rays, count = make_rays(o, d), len(o)
    o, d = np.ascontiguousarray(o), np.ascontiguousarray(d)
    closest_all(scene, rays, count, int(Visibility.ALL))
    same = float(np.mean(embree.run(o, d) == rays.rays["prim"]))
    ours, theirs = _take_turns(
        lambda: closest_all(scene, rays, count, int(Visibility.ALL)), lambda: embree.run(o, d), repetitions
    )
    occluded_all(scene, rays, count)
    ours_occluded, theirs_occluded = _take_turns(
        lambda: occluded_all(scene, rays, count), lambda: embree.run(o, d, query="OCCLUDED"), repetitions
    )
    return {
        "ratio_embree": float(np.median(theirs / ours)),
        "mrays_per_s": float(count / np.median(ours) * 1e-6),
        "embree_mrays_per_s": float(count / np.median(theirs) * 1e-6),
        "same_triangle": same,
        "occluded": {
            "ratio_embree": float(np.median(theirs_occluded / ours_occluded)),
            "mrays_per_s": float(count / np.median(ours_occluded) * 1e-6),
            "embree_mrays_per_s": float(count / np.median(theirs_occluded) * 1e-6),
        },
    }


def _take_turns(first, second, repetitions):
    """Seconds of computing that each took, (repetitions,) both."""
    seconds = np.empty((2, repetitions))
    for i in range(repetitions):
        for which, work in enumerate((first, second)):
            start = time.thread_time()
            work()
            seconds[which, i] = time.thread_time() - start
    return seconds


def _unit(v):
    return (v / np.linalg.norm(v, axis=1, keepdims=True)).astype(np.float32)


if __name__ == "__main__":
    print(json.dumps(run(), indent=2))
