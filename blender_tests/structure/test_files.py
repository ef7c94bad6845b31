# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds for every file: a licence, a first line that says what it is for, and a length that can be read."""

import ast
import re

from sources import ROOT, python_files, syntax

LONGEST = 450  # lines; about 400 is meant, a longer one has become two rooms
SPDX = "# SPDX-License-Identifier: GPL-3.0-or-later"
FILES = [path for path in python_files() if path.read_text(encoding="utf-8").strip()]


def offenders(is_wrong):
    return [str(path.relative_to(ROOT)) for path in FILES if is_wrong(path)]


def test_every_file_names_the_licence_at_its_top():
    assert offenders(lambda path: SPDX not in path.read_text(encoding="utf-8").splitlines()[:2]) == []


def test_every_file_says_what_it_is_for():
    assert offenders(lambda path: not ast.get_docstring(syntax(path))) == []


def test_no_file_is_too_long_to_read():
    assert offenders(lambda path: len(path.read_text(encoding="utf-8").splitlines()) > LONGEST) == []


def test_one_version_is_named_everywhere():
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    manifest = (ROOT / "addon" / "blender_manifest.toml").read_text(encoding="utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    versions = [re.search(r'^version = "(.+)"', text, re.MULTILINE).group(1) for text in (project, manifest)]

    assert versions[0] == versions[1] == re.search(r"^## \[(\d.+?)\]", changes, re.MULTILINE).group(1)


def test_the_licence_is_the_gnu_general_public_license():
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")

    assert "GNU GENERAL PUBLIC LICENSE\n                       Version 3" in text
    assert "END OF TERMS AND CONDITIONS" in text
