# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/render_driver.py, as `build.py render` starts it: exit codes, culprits, and the files that it names."""

import json
import subprocess
import sys

import bpy
import pytest

from blender_tests.helpers.small_blend import small_scene
from tools.environment import ROOT

MARK = "lambent> "


@pytest.fixture
def drive(registered, tmp_path):
    """A function that saves the small scene after `change(scene)` and renders it: (exit code, last word of it)."""

    def save_and_render(change, **job):
        file = tmp_path / "shot.blend"
        change(small_scene(samples=1))
        bpy.ops.wm.save_as_mainfile(filepath=str(file))
        job = {"file": str(file), "out": str(tmp_path / "picture.png"), "engine": "LAMBENT", **job}
        command = [sys.executable, str(ROOT / "tools" / "render_driver.py"), "--", json.dumps(job)]
        run = subprocess.run(command, capture_output=True, text=True)
        words = [json.loads(line[len(MARK) :]) for line in run.stdout.splitlines() if line.startswith(MARK)]
        return run.returncode, words[-1]

    return save_and_render


def test_each_view_of_a_stereo_picture_is_a_file(drive, tmp_path):
    def see_with_two_eyes(scene):
        scene.render.use_multiview = True

    left, right = (str(tmp_path / f"picture_{side}.png") for side in "LR")
    assert drive(see_with_two_eyes) == (0, ["done", left, right])
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["picture_L.png", "picture_R.png"]


def shrink_the_region(scene):
    scene.render.use_border = True
    scene.render.border_min_x = scene.render.border_max_x = 0.5


def lose_the_camera(scene):
    scene.camera = None


def spoil_a_number(scene):
    scene.camera.location.x = float("nan")


def keep_all(scene):
    pass


@pytest.mark.parametrize(
    ("change", "job", "message"),
    [
        (shrink_the_region, {}, "the render region of scene 'Scene' is empty"),
        (lose_the_camera, {}, "shot.blend has no camera in its scene 'Scene'"),
        (spoil_a_number, {}, "Lambent: Camera: transform: 1 of 16 numbers are not finite"),
        (keep_all, {"integrator": "forward"}, "there is no integrator forward; there are: brute-force, mix"),
        (keep_all, {"out": "/dev/null/picture.png"}, "/dev/null/picture.png"),
    ],
)
def test_what_cannot_be_rendered_is_named_and_has_an_exit_code(drive, tmp_path, change, job, message):
    code, (kind, text) = drive(change, **job)
    assert code == 1
    assert kind == "error"
    assert message in text
    assert list(tmp_path.glob("*.png")) == []
