# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a user waits for the first tile: with nothing compiled yet, and with a filled cache.

Both from the start of a process, so interpreter, imports, reading the scene and building its trees are in it. Seconds
of the processor are given beside them, since those hardly depend on what else the machine does.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from engine_core.scene.builder import SceneBuilder, look_at, perspective_screen
from engine_core.scene.files import save_scene
from engine_core.scene.materials import Diffuse, Glass
from engine_core.settings import Settings

ROOT = Path(__file__).resolve().parents[2]
FIRST_TILE = """
import sys
from engine_core.integrator.tiles import Render
from engine_core.scene.files import load_scene
render = Render(*load_scene(sys.argv[1]))
render.start()
while not render.finished_tiles(timeout_s=0.05):
    if not render.is_running:
        render.wait()
print("first tile", flush=True)
render.cancel()
render.wait()
"""


def run(quick):
    """{"cold_s", "warm_first_tile_s", and both with "cpu_" for seconds of the processor}: of one start, and medians."""
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "small.lambent"
        save_scene(scene, *small_scene())
        colds = [first_tile_s(scene, Path(folder) / "cache")]
        warms = [first_tile_s(scene, Path(folder) / "cache") for _ in range(1 if quick else 5)]
    figures = {}
    for name, seconds in (("cold_s", colds), ("warm_first_tile_s", warms)):
        figures[name], figures["cpu_" + name] = (statistics.median(column) for column in zip(*seconds, strict=True))
    return figures


def small_scene():
    """A glass ball and a lamp over a floor: (Scene, Settings)."""
    builder = SceneBuilder()
    floor = builder.mesh("Floor", [(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)], [(0, 1, 2), (0, 2, 3)])
    builder.instance(floor, materials=[builder.material("Grey", Diffuse((0.5, 0.5, 0.5)))])
    ball = builder.spheres("Ball", [(0, 0, 1)], [1.0])
    builder.instance(ball, materials=[builder.material("Glass", Glass((1, 1, 1), 0.0, 1.5))])
    builder.point_light("Lamp", (2, -2, 4), (300, 300, 300), radius=0.2)
    builder.background((0.2, 0.2, 0.2))
    builder.camera(look_at((0, -6, 3), (0, 0, 1)), perspective_screen(40))
    return builder.build(), Settings(width=128, height=128, crop_width=128, crop_height=128, samples=4)


def first_tile_s(scene, cache):
    """Seconds from the start of a process to its first finished tile, and what it took of the processor to its end."""
    began, cpu_began = time.perf_counter(), cpu_s_of_children()
    process = subprocess.Popen(
        [sys.executable, "-c", FIRST_TILE, str(scene)],
        cwd=ROOT,
        env={**os.environ, "LAMBENT_CACHE": str(cache)},
        stdout=subprocess.PIPE,
        text=True,
    )
    line = process.stdout.readline()
    seconds = time.perf_counter() - began
    if process.wait() != 0 or line.strip() != "first tile":
        raise RuntimeError(f"rendering {scene.name} failed with exit code {process.returncode}")
    return seconds, cpu_s_of_children() - cpu_began


def cpu_s_of_children():
    spent = os.times()
    return spent.children_user + spent.children_system
