# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a user waits for the first tile: with nothing compiled yet, and with a filled cache.

All from the start of a process, so interpreter, imports and building the scene are in it. Seconds of the processor are
given beside them, since those hardly depend on what else the machine does. Nothing is compiled on two cores at once: on
a machine that does nothing else both are the same.

`plain`: a glass ball on a floor. `everything`: all operations of shader programs, in materials, lamps and a sky, with
images, hair, subsurface scattering, instances, motion, displacement and media.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from engine_core.integrator.tiles import Render
from engine_core.scene.builder import LampShader, SceneBuilder, look_at, perspective_screen
from engine_core.scene.materials import Add, Diffuse, Emission, Glass, PrincipledHair, Subsurface, Transparent
from engine_core.scene.volumes import VolumeScatter
from engine_core.settings import Settings
from engine_core.shader import link
from engine_core.shader.graph import Image, node, part
from engine_core.shader.opcodes import InputVector, Op

IDENTITY = [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)]
ROOT = Path(__file__).resolve().parents[2]
FIRST_TILE = """
from blender_tests.bench.compile import {scene}
from engine_core.integrator.tiles import Render
render = Render(*{scene}())
render.start()
while not render.finished_tiles(timeout_s=0.05):
    if not render.is_running:
        render.wait()
print("first tile", flush=True)
render.cancel()
render.wait()
"""


def run(quick):
    """{scene: {"cold_s", "warm_s", and both with "cpu_" for seconds of the processor}}: of one start, and medians."""
    return {scene: starts(scene, 1 if quick else 5) for scene in ("plain", "everything")}


def starts(scene, count):
    with tempfile.TemporaryDirectory() as cache:
        colds = [first_tile_s(scene, cache)]
        warms = [first_tile_s(scene, cache) for _ in range(count)]
    figures = {}
    for name, seconds in (("cold_s", colds), ("warm_s", warms)):
        figures[name], figures["cpu_" + name] = (statistics.median(column) for column in zip(*seconds, strict=True))
    return figures


def plain():
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


def everything():
    """A scene that needs all that path tracing may have to compile, after one that needs as little as possible.

    Those two have a kernel each. The other integrators, which have to be chosen, are left out.
    """
    Render(*plain()).run()
    link.compile_all()
    builder, mirrored = SceneBuilder(), node(Op.INPUT_VECTOR, mode=InputVector.OBJECT)
    pixels = Image("Pixels", np.full((4, 4, 4), 128, np.uint8), True)
    painted = part(node(Op.IMAGE, mirrored, 0.0, data=pixels), 0, 3)
    shining = builder.material("Shining", Add(Diffuse(painted), Emission(painted)))
    veil = builder.material("Veil", Add(Transparent(painted), Diffuse(painted)))
    wax = builder.material("Wax", Subsurface((0.8, 0.5, 0.3), (0.1, 0.1, 0.1)))
    smoke = builder.material("Smoke", None, volume=VolumeScatter())
    bent = builder.material("Bent", Diffuse((0.5, 0.5, 0.5)), displacement=painted)
    floor = builder.mesh("Floor", [(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)], [(0, 1, 2), (0, 2, 3)])
    for material in (shining, veil, wax, bent):
        builder.instance(floor, materials=[material])
    box = builder.boxes("Box", [(0, 0, 1)], [(1, 1, 1)])
    builder.instance(box, materials=[smoke])
    ball = builder.spheres("Ball", [(0, 0, 1)], [0.5])
    builder.instance(ball, materials=[builder.material("Glass", Glass((1, 1, 1), 0.0, 1.5))])
    poses = np.array([np.eye(4), np.eye(4)])
    poses[1, 0, 3] = 1.0
    builder.instance(ball, materials=[shining], motion=poses)
    hairs = builder.strands("Hairs", [(0, 0, z) for z in (0, 1, 2)], [0.01] * 3, [3])
    builder.instance(hairs, materials=[builder.material("Hair", PrincipledHair())])
    builder.point_light("Lamp", (2, -2, 4), (300, 300, 300), radius=0.2, shader=LampShader(mirrored, IDENTITY))
    builder.background(part(node(Op.INPUT_VECTOR, mode=InputVector.GENERATED), 0, 3))
    builder.camera(look_at((0, -6, 3), (0, 0, 1)), perspective_screen(40))
    return builder.build(), Settings(width=128, height=128, crop_width=128, crop_height=128, samples=4)


def first_tile_s(scene, cache):
    """Seconds from the start of a process to its first finished tile, and what it took of the processor to its end."""
    began, cpu_began = time.perf_counter(), cpu_s_of_children()
    process = subprocess.Popen(
        [sys.executable, "-c", FIRST_TILE.format(scene=scene)],
        cwd=ROOT,
        env={**os.environ, "LAMBENT_CACHE": str(cache)},
        stdout=subprocess.PIPE,
        text=True,
    )
    line = process.stdout.readline()
    seconds = time.perf_counter() - began
    if process.wait() != 0 or line.strip() != "first tile":
        raise RuntimeError(f"rendering the scene {scene} failed with exit code {process.returncode}")
    return seconds, cpu_s_of_children() - cpu_began


def cpu_s_of_children():
    spent = os.times()
    return spent.children_user + spent.children_system
