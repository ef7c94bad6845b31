# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs: whatever graph they are made of, they are assembled and run to the end, or refused with a reason."""

import numpy as np
import pytest

from blender_tests.helpers.programs import faults_of, faults_of_damage, picture, scene_with
from engine_core.program_tables import MAX_REGISTERS
from engine_core.scene.checks import SceneError
from engine_core.scene.files import load_scene, save_scene
from engine_core.scene.materials import Diffuse, Emission, Mix, Principled
from engine_core.settings import Settings
from engine_core.shader import graph
from engine_core.shader.graph import GraphError, Image, node, part
from engine_core.shader.opcodes import ONLY_DISTANCE, InputVector, Math, Op
from engine_core.shader.program import ProgramTables


def number_input():
    return part(node(Op.INPUT_VECTOR, mode=InputVector.POSITION), 0)


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


def test_what_is_asked_twice_is_computed_once():
    programs = ProgramTables()
    sums = [node(Op.MATH, number_input(), constant, 0.0) for constant in (1.0, 1.0, 2.0)]
    programs.add(node(Op.COMBINE, *sums))
    assert [Op(op["code"]) for op in programs.ops] == [Op.INPUT_VECTOR, Op.MATH, Op.MATH, Op.COMBINE]


@pytest.mark.parametrize("offset", [0, 1])
def test_voronoi_gives_but_the_distance_where_nothing_else_is_read(offset):
    programs = ProgramTables()
    cells = node(Op.VORONOI, node(Op.INPUT_VECTOR), *(1.0,) * 8, mode=3)
    programs.add(graph.splat(node(Op.MATH, part(cells, 0), part(cells, offset), 0.0)))
    (mode,) = [op["mode"] for op in programs.ops if op["code"] == Op.VORONOI]
    assert mode == (3 + ONLY_DISTANCE if offset == 0 else 3)


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


@pytest.mark.parametrize("seed", range(6))
def test_random_programs_end_and_stay_in_their_tables(seed):
    assert faults_of(seed) == []


@pytest.mark.parametrize("seed", range(4))
def test_programs_damaged_at_random_are_refused_or_end(seed):
    assert faults_of_damage(seed) == []


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
