# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs: whatever graph they are made of, they are assembled and run to the end, or refused with a reason."""

import numpy as np
import pytest

from engine_core.program_tables import CURVE_SIZE, MAX_REGISTERS
from engine_core.scene.builder import SceneBuilder, look_at, perspective_screen
from engine_core.scene.checks import SceneError
from engine_core.scene.files import load_scene, save_scene
from engine_core.scene.materials import Diffuse, Emission, Mix, Principled
from engine_core.settings import Settings
from engine_core.shader import graph, verify
from engine_core.shader.graph import Curve, GraphError, Image, node, part
from engine_core.shader.opcodes import SIGNATURES, InputVector, Math, Op
from engine_core.shader.program import ProgramTables

FLAT = ((-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0))


def number_input():
    return part(node(Op.INPUT_VECTOR, mode=InputVector.POSITION), 0)


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


def test_what_is_constant_is_computed_once():
    programs = ProgramTables()
    value = node(Op.MATH, node(Op.MATH, 2.0, 3.0, 0.0, mode=Math.ADD), 4.0, 0.0, mode=Math.MULTIPLY)
    assert programs.constant(value) == 20.0
    programs.add(graph.splat(part(node(Op.VECTOR_MATH, (1.0, 2.0, 3.0), (1.0, 1.0, 1.0), (0.0,) * 3, 0.0), 1)))
    assert len(programs.ops) == 0


def test_what_nobody_asks_for_is_left_out():
    programs = ProgramTables()
    shared = number_input()
    node(Op.MATH, shared, 1.0, 0.0)  # not a part of the result
    programs.add(graph.splat(node(Op.MATH, shared, shared, 0.0)))
    assert [Op(op["code"]) for op in programs.ops] == [Op.INPUT_VECTOR, Op.MATH, Op.COMBINE]


def test_registers_are_used_again():
    value = number_input()
    for _ in range(2000):
        value = node(Op.MATH, value, 1.0, 0.0)
    programs = ProgramTables()
    programs.add(graph.splat(value))
    assert max(op["out"] for op in programs.ops) < 16


def test_too_many_numbers_at_once_are_refused():
    values = [node(Op.MATH, number_input(), float(i), 0.0) for i in range(MAX_REGISTERS + 1)]
    value = values[0]
    for other in values[1:]:
        value = node(Op.MATH, value, other, 0.0)
    backwards = values[-1]
    for other in values[::-1]:
        backwards = node(Op.MATH, backwards, other, 0.0)
    with pytest.raises(GraphError, match=r"at the same time|operations"):
        ProgramTables().add(graph.splat(node(Op.MATH, value, backwards, 0.0)))


def test_operands_that_do_not_fit_are_refused():
    with pytest.raises(GraphError, match="takes operands"):
        node(Op.MATH, (1.0, 2.0, 3.0), 1.0, 0.0)
    with pytest.raises(GraphError, match="no mode"):
        node(Op.MATH, 1.0, 1.0, 0.0, mode=10**6)


def test_a_material_too_large_is_grey_with_a_warning():
    value = number_input()
    for _ in range(5000):
        value = node(Op.MATH, value, 1.0, 0.0)
    b = scene_with(Emission(graph.splat(value)))
    b.build()
    assert any("too much for one shader" in warning for warning in b.warnings)


def test_a_mix_by_a_value_weighs_both_sides():
    """Half of a square shines with 1, the other with 3."""
    right = node(Op.MATH, number_input(), 0.0, 0.0, mode=Math.GREATER_THAN)
    image = picture(scene_with(Mix(right, Emission((1, 1, 1)), Emission((3, 3, 3)))))
    np.testing.assert_allclose(image[4, 2], 1.0, rtol=1e-5)
    np.testing.assert_allclose(image[4, -3], 3.0, rtol=1e-5)


def test_a_principled_by_values_looks_as_the_constant_one():
    constant = {
        "base_color": (0.8, 0.3, 0.1),
        "metallic": 0.4,
        "roughness": 0.3,
        "coat_weight": 0.5,
        "sheen_weight": 0.3,
    }
    zero = node(Op.MATH, number_input(), 0.0, 0.0, mode=Math.MULTIPLY)

    def hidden(value):
        """The same number, but the assembler does not know."""
        if isinstance(value, tuple):
            return node(Op.COMBINE, *(hidden(v) for v in value))
        return node(Op.MATH, zero, value, 0.0)

    varying = Principled(**{name: hidden(value) for name, value in constant.items()})
    np.testing.assert_allclose(picture(scene_with(varying)), picture(scene_with(Principled(**constant))), rtol=1e-4)


# ---- Fuzzing ---------------------------------------------------------------------------------------------------------


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
    pool = []
    for _ in range(size):
        op = Op(rng.choice(list(SIGNATURES)))
        signature = SIGNATURES[op]
        data = {"curves": curve, "images": images[rng.integers(4)], "attribute": rng.choice(["paint", "none"])}
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


@pytest.mark.parametrize("seed", range(6))
def test_random_programs_end_and_stay_in_their_tables(seed):
    rng = np.random.default_rng(seed)
    pool = random_graph(rng, 40)
    value = {width: finite(random_value(rng, pool[-8:], width)) for width in (1, 3)}
    surface = Mix(value[1], Principled(value[3], roughness=value[1], normal=value[3]), Diffuse(value[3]))
    b = scene_with(Mix(0.5, surface, Emission(finite(random_value(rng, pool[-8:], 3)))))
    b.background(part(node(Op.INPUT_VECTOR, mode=InputVector.GENERATED), 0, 3))
    scene = b.build()
    assert verify.faults({name: np.asarray(table) for name, table in scene.tables().items()}) == []
    assert np.isfinite(picture(b, samples=1, size=8)).all()


@pytest.mark.parametrize(
    ("table", "field", "value"),
    [
        ("ops", "out", MAX_REGISTERS),
        ("ops", "register", MAX_REGISTERS),
        ("ops", "code", 999),
        ("ops", "family", 0),
        ("ops", "mode", 10**7),
        ("ops", "data", 10**6),
        ("programs", "ops", 10**6),
        ("programs", "result", MAX_REGISTERS),
        ("closures", "patches", 10**6),
        ("closures", "kind", 77),
        ("patches", "field", 0),
        ("patches", "field", 10**4),
        ("patches", "register", -2),
        ("images", "first", 10**9),
        ("images", "width", 10**6),
        ("materials", "program", 10**6),
        ("kernels", "address", 12345),
    ],
)
def test_damaged_programs_in_files_are_refused(tmp_path, table, field, value):
    """Addresses are not even read."""
    uv = node(Op.INPUT_VECTOR, mode=InputVector.UV)
    texture = node(Op.IMAGE, uv, 0.0, data=Image("grey", np.zeros((2, 2, 1), np.uint8)))
    scene = scene_with(Diffuse(part(texture, 0, 3))).build()
    scene.tables()[table][field][-1] = value
    save_scene(tmp_path / "scene", scene, Settings())
    if table == "kernels":
        loaded, _ = load_scene(tmp_path / "scene")
        assert 12345 not in loaded.kernels["address"]
    else:
        with pytest.raises(SceneError):
            load_scene(tmp_path / "scene")
