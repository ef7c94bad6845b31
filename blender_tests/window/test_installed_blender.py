# SPDX-License-Identifier: GPL-3.0-or-later
"""The package in an installed Blender, without a window: what `build.py render --blender` and a render farm do."""

import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from tools.environment import ROOT


@pytest.fixture(scope="module")
def startup_scene(installed_blender, tmp_path_factory):
    """Blender's own startup scene, small: a cube, a lamp and a camera."""
    path = tmp_path_factory.mktemp("scene") / "startup.blend"
    code = (
        "import bpy; render = bpy.context.scene.render; render.resolution_x, render.resolution_y = 48, 32; "
        f"bpy.ops.wm.save_as_mainfile(filepath={str(path)!r})"
    )
    subprocess.run([*installed_blender, "-b", "--factory-startup", "--python-expr", code], check=True)
    return path


def test_the_package_renders_what_the_sources_render(installed_blender, startup_scene, tmp_path):
    """Installed as an extension with its wheels, on that Blender's Python, against the sources in the bpy module."""
    pictures = {}
    for name, choice in (("installed", ["--blender", " ".join(installed_blender)]), ("module", [])):
        out = tmp_path / f"{name}.png"
        command = [sys.executable, ROOT / "build.py", "render", startup_scene, "-o", out]
        subprocess.run([*command, "--samples", "4", *choice], check=True)
        pictures[name] = np.asarray(Image.open(out).convert("RGB"), float)

    assert pictures["installed"].shape == (32, 48, 3)
    assert pictures["module"].std() > 10  # there is something to see
    assert np.abs(pictures["installed"] - pictures["module"]).mean() < 1.0  # of 255


def test_blenders_own_command_line_renders(lambent_in_blender, startup_scene, tmp_path):
    """blender -b FILE -E LAMBENT -o OUT -f 1"""
    command, variables = lambent_in_blender
    arguments = ["-b", startup_scene, "-E", "LAMBENT", "-o", tmp_path / "frame_", "-f", "1"]

    result = subprocess.run([*command, *map(str, arguments)], env=variables, capture_output=True, text=True)

    assert result.returncode == 0, result.stdout + result.stderr
    assert (tmp_path / "frame_0001.png").exists()
