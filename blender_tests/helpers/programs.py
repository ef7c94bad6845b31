# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader programs made at random: of any operations in any mode, linked anyhow, of numbers that nobody would choose."""

import numpy as np

from engine_core.program_tables import CURVE_SIZE
from engine_core.scene.builder import SceneBuilder, look_at, perspective_screen
from engine_core.scene.materials import Diffuse, Emission, Mix, Principled
from engine_core.settings import Settings
from engine_core.shader import graph, verify
from engine_core.shader.graph import Curve, Image, Tiles, node, part
from engine_core.shader.opcodes import SIGNATURES, InputVector, Op

FLAT = ((-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0))


def scene_with(surface):
    b = SceneBuilder()
    square = b.mesh("Square", FLAT, [(0, 1, 2), (0, 2, 3)], attributes={"paint": np.ones((2, 3, 3))})
    b.instance(square, materials=[b.material("Material", surface)])
    b.background((0.5, 0.5, 0.5))
    b.camera(look_at((0, -4, 3), (0, 0, 0)), perspective_screen(60))
    return b


def picture(builder, samples=2, size=16):
    from engine_core.integrator.tiles import Render

    settings = Settings(width=size, height=size, crop_width=size, crop_height=size, samples=samples)
    render = Render(builder.build(), settings, threads=1)
    render.run()
    return render.image("Combined")[..., :3]


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
        if op in (Op.NOISE, Op.VORONOI):  # octaves take their time, and a mode may be no noise at all
            operands[3] = float(rng.random())
        pool.append(node(op, *operands, mode=int(rng.integers(signature.modes)), data=data.get(signature.table)))
    return pool


def finite(value):
    """Constants that are no numbers are refused before there is a program."""
    if not graph.is_constant(value):
        return value
    return tuple(np.clip(value, -1e6, 1e6).tolist()) if isinstance(value, tuple) else float(np.clip(value, -1e6, 1e6))


def faults_of(seed, size=40):
    """What is wrong with a random material and what is rendered of it: a list of texts."""
    rng = np.random.default_rng(seed)
    pool = random_graph(rng, size)
    value = {width: finite(random_value(rng, pool[-8:], width)) for width in (1, 3)}
    surface = Mix(value[1], Principled(value[3], roughness=value[1], normal=value[3]), Diffuse(value[3]))
    b = scene_with(Mix(0.5, surface, Emission(finite(random_value(rng, pool[-8:], 3)))))
    b.background(part(node(Op.INPUT_VECTOR, mode=InputVector.GENERATED), 0, 3))
    scene = b.build()
    faults = list(verify.faults({name: np.asarray(table) for name, table in scene.tables().items()}))
    if faults:
        return faults
    return [] if np.isfinite(picture(b, samples=1, size=8)).all() else ["the picture has pixels that are no numbers"]
