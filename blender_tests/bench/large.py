# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether large scenes fit: a mesh of 10 million triangles, and a million instances of one mesh, built and rendered.

Each in a process of its own, so that the largest memory it ever held is that of the scene.

    python -m blender_tests.bench.large
"""

import json
import resource
import subprocess
import sys
import time

import numpy as np

from blender_tests.helpers.rays import bumpy_sphere
from engine_core.integrator.tiles import Render
from engine_core.scene.builder import SceneBuilder, look_at, perspective_screen
from engine_core.scene.materials import Diffuse
from engine_core.settings import Settings

SIZE = 64


def run(quick=False):
    """{scene: {"peak_gb": ..., "build_s": ..., "render_s": ...}}; seconds on the clock, the kernels compiled before."""
    result = {}
    for name, count in (("mesh", 10_000_000), ("instances", 1_000_000)):
        command = [sys.executable, "-m", __spec__.name, name, str(count // 100 if quick else count)]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
        result[name] = json.loads(done.stdout.splitlines()[-1])
    return result


def measure(name, count):
    render(make(name, 1000).build())  # compiles
    builder = make(name, count)
    start = time.perf_counter()
    scene = builder.build()
    build_s = time.perf_counter() - start
    start = time.perf_counter()
    image = render(scene)
    render_s = time.perf_counter() - start
    if not 0.05 < image[..., :3].mean() < 1.0:
        raise AssertionError("nothing to be seen")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024  # Linux counts in KiB
    return {
        "triangles": len(scene.triangles),
        "instances": len(builder.placements),
        "peak_gb": peak * 1e-9,
        "tables_gb": sum(table.nbytes for table in scene.tables().values()) * 1e-9,
        "build_s": build_s,
        "render_s": render_s,
    }


def make(name, count):
    b = SceneBuilder()
    clay = b.material("Clay", Diffuse((0.8, 0.5, 0.3)))
    if name == "mesh":
        vertices, faces = bumpy_sphere(max(3, round(0.5 + 0.5 * count**0.5)))
        b.instance(b.mesh("Mesh", vertices, faces.astype(np.int32)), materials=[clay])
        b.camera(look_at((0, -3, 1), (0, 0, 0)), perspective_screen(40))
    else:
        vertices, faces = bumpy_sphere(16)
        mesh = b.mesh("Mesh", vertices * np.float32(0.4), faces.astype(np.int32))
        side = round(count ** (1 / 3))
        to_world = np.eye(4)
        for x, y, z in np.ndindex(side, side, side):
            to_world[:3, 3] = x, y, z
            b.instance(mesh, to_world.copy(), [clay])
        b.camera(look_at((-side, -side, 2 * side), (side / 2,) * 3), perspective_screen(40))
    b.background((0.5, 0.7, 1.0))
    return b


def render(scene):
    settings = Settings(samples=1, width=SIZE, height=SIZE, crop_width=SIZE, crop_height=SIZE)
    job = Render(scene, settings)
    job.run()
    return job.image("Combined")


if __name__ == "__main__":
    print(json.dumps(measure(sys.argv[1], int(sys.argv[2])) if len(sys.argv) > 2 else run(), indent=None))
