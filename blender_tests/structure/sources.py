# SPDX-License-Identifier: GPL-3.0-or-later
"""The project's Python files, read but not run, and what they import."""

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("addon", "engine_core", "blender_tests", "scenes_blend", "tools")


def python_files(*folders):
    files = [path for folder in folders or FOLDERS for path in (ROOT / folder).rglob("*.py")]
    return sorted(files if folders else [*files, ROOT / "build.py"])


@cache
def syntax(path):
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


def imports(path, nodes=None):
    """[(line, module)]: every module that a file imports, with its full dotted name.

    `from .a import b` in package p is p.a.b where that is a module of ours, and p.a where b is a name inside.
    """
    found = []
    for node in nodes or ast.walk(syntax(path)):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        if isinstance(node, ast.ImportFrom):
            package = path.relative_to(ROOT).parent.parts
            base = [*package[: len(package) + 1 - node.level]] if node.level else []
            base += node.module.split(".") if node.module else []
            for alias in node.names:
                inner = ROOT.joinpath(*base, alias.name)
                is_module = inner.is_dir() or inner.with_suffix(".py").is_file()
                found.append((node.lineno, ".".join([*base, alias.name] if is_module else base)))
    return found


def functions(path):
    """{name: names of its arguments} of the functions of a file."""
    body = syntax(path).body
    return {node.name: [a.arg for a in node.args.args] for node in body if isinstance(node, ast.FunctionDef)}


def members(path, enumeration):
    """Names of the members of an enumeration."""
    (found,) = [n for n in syntax(path).body if isinstance(n, ast.ClassDef) and n.name == enumeration]
    return [statement.targets[0].id for statement in found.body if isinstance(statement, ast.Assign)]
