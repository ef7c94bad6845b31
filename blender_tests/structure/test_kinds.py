# SPDX-License-Identifier: GPL-3.0-or-later
"""One file for each kind of a family, with the same functions in each: who has read one can read them all."""

import ast

import pytest
from sources import ROOT, functions, members, syntax

CORE = ROOT / "engine_core"
TABLES = CORE / "tables.py"
LOBES, LIGHTS, CAMERAS = (members(TABLES, name) for name in ("LobeKind", "LightKind", "CameraKind"))
PHASES = members(CORE / "medium_tables.py", "PhaseKind")

FUNCTIONS_OF_A_LOBE = {
    "evaluate_and_pdf": ["lobe", "wo", "wi"],
    "sample": ["lobe", "wo", "u_choice", "u0", "u1"],
    "albedo": ["lobe", "wo"],
}
# Of scene, light, p, wi, t each takes what it needs, in this order.
FUNCTIONS_OF_A_LIGHT = {
    "sample": ["scene", "light", "p", "u0", "u1"],
    "emitted": ["light", "p", "wi", "t"],
    "pdf": ["scene", "light", "p", "wi", "t"],
}


@pytest.mark.parametrize("kind", LOBES)
def test_every_lobe_has_its_file_with_the_same_functions(kind):
    found = functions(CORE / "bsdf" / f"{kind.lower()}.py")

    assert {name: found.get(name) for name in FUNCTIONS_OF_A_LOBE} == FUNCTIONS_OF_A_LOBE


@pytest.mark.parametrize("kind", LIGHTS)
def test_every_light_has_its_file_with_the_same_functions(kind):
    found = functions(CORE / "light" / f"{kind.lower()}.py")

    for name, order in FUNCTIONS_OF_A_LIGHT.items():
        assert name in found
        assert found[name] == [argument for argument in order if argument in found[name]]


@pytest.mark.parametrize("kind", CAMERAS)
def test_every_camera_has_its_file(kind):
    assert "generate_ray" in functions(CORE / "camera" / f"{kind.lower()}.py")


@pytest.mark.parametrize("kind", PHASES)
def test_every_phase_function_has_its_file_with_the_same_functions(kind):
    found = functions(CORE / "medium" / f"{kind.lower()}.py")

    assert found["evaluate"] == ["phase", "cosine"]
    assert found["sample_cosine"] == ["phase", "u"]


@pytest.mark.parametrize(
    ("dispatcher", "kinds"),
    [
        ("bsdf/kinds.py", LOBES),
        ("light/dispatch.py", LIGHTS),
        ("camera/dispatch.py", CAMERAS),
        ("medium/dispatch.py", PHASES),
    ],
)
def test_dispatchers_know_every_file_of_their_family(dispatcher, kinds):
    """A kind may be the one that is left over after the ifs, so look at what is called, not at what is compared."""
    called = {
        node.value.id
        for node in ast.walk(syntax(CORE / dispatcher))
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
    }

    assert {kind.lower() for kind in kinds} <= called


def test_every_lobe_has_parameters_for_the_tests():
    """The tests over all kinds run through CASES; a kind that is not there would go untested."""
    assert f"{{{', '.join(f'LobeKind.{kind}' for kind in sorted(LOBES))}}}" == cases_of_lobes()


def cases_of_lobes():
    tree = syntax(ROOT / "blender_tests" / "helpers" / "bsdfs.py")
    (cases,) = [n.value for n in tree.body if isinstance(n, ast.Assign) and n.targets[0].id == "CASES"]
    return f"{{{', '.join(sorted(ast.unparse(key) for key in cases.keys))}}}"


def test_members_of_enumerations_have_a_gloss():
    """What a number in a table means is said where it is declared."""
    lines = TABLES.read_text(encoding="utf-8").splitlines()
    bare = [
        f"tables.py:{statement.lineno} {node.name}.{statement.targets[0].id}"
        for node in syntax(TABLES).body
        if isinstance(node, ast.ClassDef) and node.name in {"LobeKind", "LightKind", "ShapeKind", "TreeKind"}
        for statement in node.body
        if isinstance(statement, ast.Assign) and "#" not in lines[statement.lineno - 1]
    ]

    assert bare == []
