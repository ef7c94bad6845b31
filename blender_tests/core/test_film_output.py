# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendering to files without Blender: the picture is the render's, and the file says how it was made."""

import re
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image

import engine_core
from blender_tests.helpers.scenes import builder, settings, sphere
from engine_core.__main__ import main
from engine_core.film.output import save_image
from engine_core.integrator.tiles import Render
from engine_core.scene.files import save_scene
from engine_core.scene.materials import Diffuse


@pytest.fixture(scope="module")
def scene():
    b = builder(eye=(0, -3, 0))
    sphere(b, Diffuse((0.7, 0.5, 0.3)))
    b.background((0.4, 0.5, 0.6))
    b.point_light("Lamp", (2, -2, 2), (100, 100, 100), radius=0.3)
    return b.build()


@pytest.fixture
def file(scene, tmp_path):
    path = tmp_path / "ball.lambent"
    save_scene(path, scene, settings(24, samples=4, seed=3))
    return str(path)


def header_of(path):
    if Path(path).suffix == ".png":
        return Image.open(path).text
    return OpenEXR.File(str(path)).header()


def said(path):
    return {name[len("lambent.") :]: text for name, text in header_of(path).items() if name.startswith("lambent.")}


@pytest.mark.parametrize("ending", [".png", ".exr"])
def test_a_file_says_how_it_was_rendered(file, tmp_path, ending):
    out = tmp_path / f"out{ending}"
    assert main(["render", file, "-o", str(out), "--sampler", "random", "--uniform", "--samples", "8"]) == 0
    told = said(out)
    assert told["engine"] == f"Lambent {engine_core.__version__}"
    assert (told["integrator"], told["sampler"], told["adaptive"]) == ("path", "random", "no")
    assert (told["seed"], told["samples"]) == ("3", "8")
    assert float(told["render_time"].split()[0]) > 0
    assert re.fullmatch(r"[0-9.e+]+ %", told["estimated_error"])


def test_a_file_holds_the_picture(scene, file, tmp_path):
    out = tmp_path / "out.npy"
    assert main(["render", file, "-o", str(out)]) == 0
    render = Render(scene, settings(24, samples=4, seed=3))
    render.run()
    np.testing.assert_array_equal(np.load(out)[::-1], render.image("Combined"))


def test_a_ppm_can_be_read_and_shows_what_a_png_shows(file, tmp_path):
    """The plain text is parsed here, without a library; Pillow, which reads such files, sees the same."""
    ppm, png = tmp_path / "out.ppm", tmp_path / "out.png"
    for path in (ppm, png):
        assert main(["render", file, "-o", str(path)]) == 0
    lines = ppm.read_text(encoding="ascii").splitlines()
    assert "# lambent.integrator: path" in lines
    magic, size, largest, *rows = [line for line in lines if not line.startswith("#")]
    assert (magic, size, largest) == ("P3", "24 24", "255")
    numbers = np.array([row.split() for row in rows], int).reshape(24, 24, 3)
    np.testing.assert_array_equal(numbers, np.asarray(Image.open(png).convert("RGB")))
    np.testing.assert_array_equal(numbers, np.asarray(Image.open(ppm)))


def test_a_ppm_goes_from_left_to_right_and_from_top_to_bottom_over_black(tmp_path):
    pixels = np.zeros((2, 3, 4), np.float32)  # bottom row first
    pixels[1, 0] = (1.0, 0.0, 0.0, 1.0)
    pixels[0, 2] = (0.0, 0.0, 4.0, 1.0)
    pixels[0, 0] = (0.214, 0.214, 0.214, 0.5)
    save_image(tmp_path / "flag.ppm", pixels)
    lines = (tmp_path / "flag.ppm").read_text().splitlines()
    assert lines[:3] == ["P3", "3 2", "255"]
    assert lines[3:] == ["255 0 0", "0 0 0", "0 0 0", "127 127 127", "0 0 0", "0 0 255"]


def test_the_command_line_stops_at_a_noise_target(file, tmp_path):
    out = tmp_path / "out.exr"
    assert main(["render", file, "-o", str(out), "--samples", "100000", "--noise-target", "5"]) == 0
    assert float(said(out)["estimated_error"].split()[0]) <= 5.0
    assert int(said(out)["samples"]) < 100_000


def test_the_version_is_that_of_the_project():
    text = (Path(engine_core.__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8")
    assert f'version = "{engine_core.__version__}"' in text
