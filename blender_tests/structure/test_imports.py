# SPDX-License-Identifier: GPL-3.0-or-later
"""Imports go downwards only. The table of ranks is the architecture; it is also in ARCHITECTURE.md."""

import ast
import sys

from sources import ROOT, imports, python_files, syntax

RANKS_OF_ENGINE = [
    {
        "jit",
        "linking",
        "tables",
        "program_tables",
        "medium_tables",
        "guide_tables",
        "film_tables",
        "settings",
        "linalg",
    },  # these few may know each other
    {"sampling", "motion"},
    {"shape", "texture", "camera", "film"},
    {"shader", "bsdf", "light", "medium", "accel", "guiding"},
    {"integrator"},
    {"scene"},
    {"__main__", "__init__"},
]
RANKS_OF_ADDON = [
    {"core", "properties", "preferences", "messages"},
    {"compile_cache", "export", "result"},
    {"session"},
    {"final", "viewport"},
    {"engine"},
    {"ui"},
    {"__init__"},
]
ENGINE, ADDON = python_files("engine_core"), python_files("addon")


def rank(ranks, room):
    for number, rooms in enumerate(ranks):
        if room in rooms:
            return number
    raise AssertionError(f"the room '{room}' is in no rank: add it to the table here and in ARCHITECTURE.md")


def upward_imports(package, ranks, files):
    """Imports of a room of the same rank or above, as text; inside of one room all is allowed."""
    wrong = []
    for path in files:
        here = path.relative_to(ROOT / package).parts[0].removesuffix(".py")
        for line, module in imports(path):
            parts = module.split(".")
            if parts[0] != package or len(parts) < 2 or parts[1] == here:
                continue
            mine, other = rank(ranks, here), rank(ranks, parts[1])
            if other > mine or (other == mine > 0):
                wrong.append(f"{path.relative_to(ROOT)}:{line} {here} (rank {mine}) imports {parts[1]} (rank {other})")
    return wrong


def test_rooms_of_the_engine_import_downwards_only():
    assert upward_imports("engine_core", RANKS_OF_ENGINE, ENGINE) == []


def test_rooms_of_the_addon_import_downwards_only():
    assert upward_imports("addon", RANKS_OF_ADDON, ADDON) == []


def test_the_engine_knows_numpy_and_numba_and_nothing_of_blender():
    """More may be imported inside a function that Blender's users never call: writing picture files."""
    everywhere = {"numpy", "numba", "llvmlite", "engine_core", *sys.stdlib_module_names}
    in_functions = everywhere | {"PIL", "OpenEXR"}
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {module}"
        for path in ENGINE
        for allowed, nodes in ((everywhere, syntax(path).body), (in_functions, None))
        for line, module in imports(path, nodes)
        if module.split(".")[0] not in allowed
    ]

    assert wrong == []


def test_the_engine_is_imported_by_no_name_of_its_own():
    """In the extension it is called bl_ext.<repository>.lambent.engine_core, so only relative imports find it."""
    wrong = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in ENGINE + ADDON
        for node in ast.walk(syntax(path))
        if (isinstance(node, ast.ImportFrom) and not node.level and (node.module or "").startswith("engine_core"))
        or (isinstance(node, ast.Import) and any(alias.name.startswith("engine_core") for alias in node.names))
    ]

    assert wrong == []


def test_blender_starts_without_loading_numba():
    """What addon/__init__.py imports on the level of modules never reaches core.py: numba costs 0.3 s."""
    reached, ahead = set(), ["addon"]
    while ahead:
        module = ahead.pop()
        if module in reached or not module.startswith("addon"):
            continue
        reached.add(module)
        path = ROOT.joinpath(*module.split("."))
        path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        ahead += [name for _, name in imports(path, syntax(path).body)]

    assert "addon.engine" in reached
    assert "addon.core" not in reached


def test_numba_options_are_named_in_one_file_only():
    """`jit.py` says how kernels are compiled; the types in `linalg` extend the compiler and decorate no kernels."""
    wrong = [
        f"{path.relative_to(ROOT)}:{node.lineno} uses {node.attr if isinstance(node, ast.Attribute) else node.id}"
        for path in ENGINE
        if path.name != "jit.py"
        for node in ast.walk(syntax(path))
        if (isinstance(node, ast.Attribute) and node.attr in {"njit", "jit", "vectorize", "prange"})
        or (isinstance(node, ast.Name) and node.id in {"njit", "vectorize", "guvectorize", "prange"})
    ]

    assert wrong == []


def test_nothing_is_imported_by_a_star():
    wrong = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in ENGINE + ADDON
        for node in ast.walk(syntax(path))
        if isinstance(node, ast.ImportFrom) and node.names[0].name == "*"
    ]

    assert wrong == []
