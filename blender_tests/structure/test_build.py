# SPDX-License-Identifier: GPL-3.0-or-later
"""build.py as a newcomer meets it: what it can do, what it says when something is wrong, and what it packs."""

import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from sources import ROOT

from tools import environment, extension


def build(*arguments, **options):
    command = [sys.executable, str(ROOT / "build.py"), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, **options)


def test_it_tells_what_it_can_do():
    result = build()

    assert result.returncode == 0
    for command in ("setup", "render", "compare", "test", "bench", "figures", "gallery", "fuzz", "package", "check"):
        assert re.search(rf"^    {command} +\w", result.stdout, re.MULTILINE)
    assert "python3 build.py render scenes_blend/cornell_box.blend" in result.stdout


def test_every_part_of_the_benchmark_is_told():
    from blender_tests.bench.__main__ import PARTS

    told = " ".join(build("bench", "--help").stdout.split())

    assert ", ".join(PARTS) in told


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["render", "missing.blend"], "there is no file missing.blend"),
        (["render", __file__], "is no .blend file"),
        (["render", "x.blend", "--size", "640"], "'640' is no size; write width x height in pixels, such as 640x480"),
        (["render", "x.blend", "--samples", "0"], "0 is out of range: at least 1"),
        (["render", "x.blend", "--time-limit", "nan"], "nan is out of range"),
        (["render", "x.blend", "--engine", "EEVEE"], "invalid choice: 'EEVEE'"),
        (["render", "x.blend", "--sampels", "3"], "unknown argument --sampels"),
        (["compare", "missing.blend"], "there is no file missing.blend"),
        (["compare", "x.blend", "--samples", "4", "--seconds", "2"], "not allowed with argument --samples"),
        (["compare", "x.blend", "--reference", "1"], "1 is out of range: at least 2"),
        (["gallery", "--samples", "none"], "'none' is no number"),
        (["fuzz", "--minutes", "0"], "0 is out of range"),
        (["rendre"], "invalid choice: 'rendre'"),
    ],
    ids=lambda value: " ".join(map(str, value)) if isinstance(value, list) else "",
)
def test_a_mistake_ends_in_one_clear_line(arguments, message, tmp_path):
    result = build(*arguments, cwd=tmp_path)

    assert result.returncode != 0
    assert message in result.stderr.splitlines()[0]
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    ("out", "message"),
    [("picture.gif", "has to end in one of .png"), ("nowhere/picture.png", "there is no folder nowhere")],
)
def test_a_picture_that_cannot_be_written_is_refused_before_rendering(out, message, tmp_path):
    (tmp_path / "scene.blend").touch()

    result = build("render", "scene.blend", "-o", out, cwd=tmp_path)

    assert result.returncode == 1
    assert message in result.stderr


def test_a_command_that_is_no_blender_is_named(tmp_path):
    (tmp_path / "scene.blend").touch()

    result = build("render", "scene.blend", "--blender", f"{sys.executable} -c pass", cwd=tmp_path)

    assert result.returncode == 1
    assert "does not behave like Blender" in result.stderr


def test_it_reads_as_python_3_8():
    """A newcomer starts it with whatever Python there is."""
    import ast

    for path in [ROOT / "build.py", *(ROOT / "tools").glob("*.py")]:
        ast.parse(path.read_text(encoding="utf-8"), str(path), feature_version=(3, 8))


@pytest.mark.parametrize("version", environment.PYTHON_OF_BLENDER)
def test_a_ready_environment_is_not_made_again(version, monkeypatch, tmp_path):
    """A stamp with other pins, or none after an interrupted setup, does not count; nor a Python that does not start."""
    folder = tmp_path / "environment"
    python = environment.python_in(folder)
    python.parent.mkdir(parents=True)
    monkeypatch.setitem(environment.FOLDER_OF_BLENDER, version, folder)
    assert not environment.is_ready(version)

    (folder / "lambent-stamp").write_text(environment.stamp(version))
    assert not environment.is_ready(version)

    python.symlink_to(sys.executable)
    assert environment.is_ready(version)
    assert environment.environment(version) == python

    (folder / "lambent-stamp").write_text("other pins")
    assert not environment.is_ready(version)


def test_pythons_of_pyenv_and_uv_are_found(monkeypatch, tmp_path):
    pyenv, uv = tmp_path / "pyenv", tmp_path / "uv"
    places = [
        pyenv / "versions" / "3.13.9" / "bin" / "python",
        pyenv / "versions" / "3.13.10" / "bin" / "python",
        uv / "cpython-3.13.1-linux-x86_64-gnu" / "bin" / "python3.13",
    ]
    for place in [*places, pyenv / "versions" / "3.12.1" / "bin" / "python"]:
        place.parent.mkdir(parents=True)
        place.touch()
    monkeypatch.setenv("PYENV_ROOT", str(pyenv))
    monkeypatch.setenv("UV_PYTHON_INSTALL_DIR", str(uv))

    found = [Path(path) for path in environment.candidates("3.13") if path and str(path).startswith(str(tmp_path))]

    assert found == [places[1], places[0], places[2]]  # of one kind, the newest first


def test_missing_libraries_are_named_with_their_packages(tmp_path):
    message = "ImportError: libXrender.so.1: cannot open shared object file: No such file or directory"

    assert environment.missing_libraries(tmp_path, message) == ["libXrender.so.1"]
    packages = {
        "libXrender.so.1": "libxrender1",
        "libX11.so.6": "libx11-6",
        "libXxf86vm.so.1": "libxxf86vm1",
        "libxkbcommon.so.0": "libxkbcommon0",
        "libSM.so.6": "libsm6",
        "libGL.so.1": "libgl1",
        "libEGL.so.1": "libegl1",
    }
    assert {library: environment.debian_package(library) for library in packages} == packages


def test_the_package_holds_the_addon_the_engine_and_their_wheels(monkeypatch, tmp_path):
    """Wheels are stand-ins here: what is asked for is that they are packed, listed and fit the platform."""
    wheels = tmp_path / "wheels"
    monkeypatch.setattr(extension, "WHEELS", wheels)
    (wheels / "linux-x64").mkdir(parents=True)
    expected = set()
    for pin in extension.pins():
        for tag in ("cp311-cp311", "cp313-cp313"):
            wheel = wheels / "linux-x64" / f"{pin.replace('==', '-')}-{tag}-manylinux_2_28_x86_64.whl"
            wheel.write_bytes(b"wheel")
            expected.add(f"wheels/{wheel.name}")

    package = extension.make_package("linux-x64", ["3.11", "3.13"], tmp_path)

    with zipfile.ZipFile(package) as archive:
        names = set(archive.namelist())
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
    assert package.name == f"lambent-{manifest['version']}-linux-x64.zip"
    assert {"__init__.py", "engine.py", "engine_core/__init__.py", "engine_core/jit.py", "LICENSE"} <= names
    assert {name for name in names if name.endswith(".whl")} == expected
    assert {wheel.removeprefix("./") for wheel in manifest["wheels"]} == expected
    assert manifest["platforms"] == ["linux-x64"]
    assert "files" in manifest["permissions"]
    assert [path.name for path in tmp_path.iterdir() if path.is_file()] == [package.name]


def test_what_python_leaves_behind_is_not_packed(monkeypatch, tmp_path):
    for name in ("addon/__init__.py", "addon/__pycache__/__init__.cpython-313.pyc", "engine_core/data.npz"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    monkeypatch.setattr(extension, "ROOT", tmp_path)

    assert set(extension.sources()) == {"__init__.py", "engine_core/data.npz"}
