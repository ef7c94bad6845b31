# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader programs made at random: of any operations in any mode, linked anyhow, of numbers that nobody would choose.

And scene files whose programs are damaged at random, which have to be refused, or to be rendered without harm.
"""

import contextlib
import tempfile
from pathlib import Path

import numpy as np

from engine_core.integrator.tiles import Render
from engine_core.program_tables import CURVE_SIZE
from engine_core.scene.builder import SceneBuilder, look_at, perspective_screen
from engine_core.scene.checks import SceneError
from engine_core.scene.files import load_scene, save_scene
from engine_core.scene.materials import Diffuse, Emission, Mix, Principled
from engine_core.settings import Settings
from engine_core.shader import graph, verify
from engine_core.shader.graph import Curve, Image, Tiles, node, part
from engine_core.shader.opcodes import SIGNATURES, InputVector, Op

DAMAGED = ("ops", "ops", "ops", "programs", "closures", "patches", "images", "curves")  # tables, as often as here
FLAT = ((-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0))


def scene_with(surface):
    b = SceneBuilder()
    square = b.mesh("Square", FLAT, [(0, 1, 2), (0, 2, 3)], attributes={"paint": np.ones((2, 3, 3))})
    b.instance(square, materials=[b.material("Material", surface)])
    b.background((0.5, 0.5, 0.5))
    b.camera(look_at((0, -4, 3), (0, 0, 0)), perspective_screen(60))
    return b


def picture(builder, samples=2, size=16):
    return render(builder.build(), samples, size)


def render(scene, samples, size):
    settings = Settings(width=size, height=size, crop_width=size, crop_height=size, samples=samples)
    rendered = Render(scene, settings, threads=1)
    rendered.run()
    return rendered.image("Combined")[..., :3]


def random_value(rng, pool, width):
    """A constant, or something of the pool."""
    if pool and rng.random() < 0.7:
        chosen = pool[rng.integers(len(pool))]
        if graph.width(chosen) >= width:
            return part(chosen, int(rng.integers(graph.width(chosen) - width + 1)), width)
    numbers = [float(v) for v in rng.choice([0.0, 1.0, -1.0, 0.3, 1e-30, 1e30, 7.7, np.inf, -4.2], width)]
    return numbers[0] if width == 1 else tuple(numbers)


def random_graph(rng, size):
    """Nodes of any operation in any mode, linked at random."""
    curve = Curve(rng.random((CURVE_SIZE, 4)))
    images = [
        Image("bytes", rng.integers(0, 255, (3, 5, 4), dtype=np.uint8), True),
        Image("grey", rng.integers(0, 255, (3, 3, 1), dtype=np.uint8)),
        Image("half", rng.random((2, 3, 4)).astype(np.float16)),
        Image("float", rng.random((1, 2, 1)).astype(np.float32)),
    ]
    images.append(Tiles(2, tuple(images[:4])))
    pool = []
    for _ in range(size):
        op = Op(rng.choice(list(SIGNATURES)))
        signature = SIGNATURES[op]
        data = {"curves": curve, "images": images[rng.integers(5)], "attribute": rng.choice(["paint", "none"])}
        operands = [random_value(rng, pool, width) for width in signature.operands]
        if op in (Op.NOISE, Op.VORONOI, Op.VORONOI_OF_4):  # octaves take their time, and a mode may be no noise at all
            operands[3] = float(rng.random())
        pool.append(node(op, *operands, mode=int(rng.integers(signature.modes)), data=data.get(signature.table)))
    return pool


def finite(value):
    """Constants that are no numbers are refused before there is a program."""
    if not graph.is_constant(value):
        return value
    return tuple(np.clip(value, -1e6, 1e6).tolist()) if isinstance(value, tuple) else float(np.clip(value, -1e6, 1e6))


def random_scene(rng, size):
    """A square of a random material under a random sky."""
    pool = random_graph(rng, size)
    value = {width: finite(random_value(rng, pool[-8:], width)) for width in (1, 3)}
    surface = Mix(value[1], Principled(value[3], roughness=value[1], normal=value[3]), Diffuse(value[3]))
    b = scene_with(Mix(0.5, surface, Emission(finite(random_value(rng, pool[-8:], 3)))))
    b.background(part(node(Op.INPUT_VECTOR, mode=InputVector.GENERATED), 0, 3))
    return b.build()


def faults_of(seed, size=40):
    """What is wrong with a random material and what is rendered of it: a list of texts."""
    scene = random_scene(np.random.default_rng(seed), size)
    faults = list(verify.faults({name: np.asarray(table) for name, table in scene.tables().items()}))
    return faults or faults_of_picture(scene)


def faults_of_picture(scene):
    return [] if np.isfinite(render(scene, 1, 8)).all() else ["the picture has pixels that are no numbers"]


# ---- Damaged files ---------------------------------------------------------------------------------------------------


def faults_of_damage(seed, size=40, tries=10):
    """What is wrong with what is rendered of a random material, of whose steps some were changed behind its back.

    A file that is refused is as it should be. (How many are not: about a half.)
    """
    rng = np.random.default_rng(seed)
    scene, faults = random_scene(rng, size), []
    whole = {name: np.asarray(table).copy() for name, table in scene.tables().items()}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "damaged"
        for _ in range(tries):
            tables = scene.tables()
            for _ in range(rng.integers(1, 4)):
                damage(rng, tables)
            save_scene(path, scene, Settings())
            with contextlib.suppress(SceneError):
                faults += faults_of_picture(load_scene(path)[0])
            for name in set(DAMAGED):
                np.asarray(tables[name])[:] = whole[name]
    return faults


def damage(rng, tables):
    """Change one number of one table, in place: to one nearby, to that of another row, to any."""
    table = np.asarray(tables[rng.choice(DAMAGED)])
    if not len(table):
        return
    row = table[rng.integers(len(table)) :][:1]
    if "family" in table.dtype.names and rng.random() < 0.3:
        row["code"] = op = Op(rng.choice(list(SIGNATURES)))
        row["family"], row["mode"] = SIGNATURES[op].family, rng.integers(SIGNATURES[op].modes)
        return
    numbers = row[rng.choice(table.dtype.names)].reshape(-1)
    at, way = rng.integers(len(numbers)), rng.random()
    if numbers.dtype.kind == "f":
        numbers[at] = rng.choice([0.0, -1.0, 1e30, np.inf, np.nan, rng.normal()])
    elif way < 0.6:
        numbers[at] = int(numbers[at]) + rng.integers(-3, 4)
    elif way < 0.9:
        numbers[at] = rng.integers(-2, 300)
    else:
        numbers[at] = rng.integers(-(2**31), 2**31)
