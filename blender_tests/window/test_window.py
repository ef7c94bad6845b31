# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist sees: the installed extension in a Blender with a window. Screenshots stay in build/window."""

import json
import os
import shlex
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tools.environment import ROOT

PICTURE_SIZE = (480, 320)  # and colours, linear: as in_window.py sets them
WORLD, CUBE = (0.0, 0.05, 0.8), (1.0, 0.5, 0.0)
TIMEOUT_S = 400


@pytest.fixture
def tell(lambent_in_blender):
    """A function that has a story of in_window.py told. Returns the folder with its screenshots, and its notes."""
    command = os.environ.get("WINDOWED_BLENDER")
    if not command:
        pytest.skip(
            "needs WINDOWED_BLENDER: a command that runs the installed Blender with a window, "
            "with xdotool and ImageMagick's import at hand"
        )

    def tell_story(story, **variables):
        folder = ROOT / "build" / "window" / story
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        script = Path(__file__).with_name("in_window.py")
        run = subprocess.run(
            [*shlex.split(command), "--python", script, "--", folder, story],
            env={**lambent_in_blender[1], **variables},
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
        )
        said = f"exit code {run.returncode}\n{run.stdout[-3000:]}{run.stderr[-3000:]}"
        assert (folder / "notes.json").exists(), said
        notes = json.loads((folder / "notes.json").read_text())
        assert "error" not in notes, notes["error"]
        assert run.returncode == 0, said
        return folder, {**notes, "said": said}

    return tell_story


def visible(screenshot, color):
    """Where the screen shows a linear colour, sRGB-encoded: bool (height, width)."""
    linear = np.array(color)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)
    pixels = np.asarray(Image.open(screenshot).convert("RGB"), float)
    return (np.abs(pixels - 255 * srgb) < 12).all(axis=-1)


def assert_shows_the_picture(screenshot):
    """The image editor has the whole picture on the screen, pixel by pixel: a cube in the middle of the world."""
    world, cube = visible(screenshot, WORLD), visible(screenshot, CUBE)
    rows, columns = np.nonzero(world | cube)
    assert (columns.max() - columns.min() + 1, rows.max() - rows.min() + 1) == PICTURE_SIZE
    assert (world | cube).sum() > 0.98 * PICTURE_SIZE[0] * PICTURE_SIZE[1]  # all but edges
    assert 0.08 < cube.sum() / world.sum() < 0.3
    for axis, total in enumerate(cube.shape):
        assert abs(np.nonzero(cube)[axis].mean() - np.nonzero(world)[axis].mean()) < 0.02 * total


def test_f12_shows_the_picture_in_the_image_editor(tell):
    folder, notes = tell("f12")
    assert_shows_the_picture(folder / "finished.png")
    assert notes["status"].startswith("Sample 64/64")


def test_escape_ends_a_render_that_would_take_hours(tell, record_property):
    """Its first samples are on the screen already, and stay there."""
    folder, notes = tell("escape")
    print(f"Esc took {1000 * notes['escape_s']:.0f} ms")
    record_property("escape_s", notes["escape_s"])
    assert notes["escape_s"] < 3.0  # a machine may be busy
    for screenshot in ("rough.png", "cancelled.png"):
        assert_shows_the_picture(folder / screenshot)


def test_a_failure_is_told_and_blender_goes_on(tell):
    folder, notes = tell("failure")
    assert "Lambent: Cube: is the scene's camera, but it is a mesh" in notes["said"]
    assert notes["completed_without_camera"] is False
    assert not visible(folder / "failed.png", CUBE).any()


def test_panels_draw_without_faults(tell):
    _, notes = tell("panels")
    assert len(notes["tabs"]) == 13
    assert "Traceback" not in notes["said"]


def test_the_rendered_viewport_follows_what_the_artist_does(tell):
    """It shows the cube where Blender draws it in the solid view, changes with the scene, and rests during F12."""
    folder, notes = tell("rendered_viewport")
    assert "Traceback" not in notes["said"]
    area = {}
    for name in ("CAMERA", "PERSP", "ORTHO", "smaller", "hidden"):
        assert visible(folder / f"{name}.png", WORLD).sum() > 100_000
        area[name] = visible(folder / f"{name}.png", CUBE).sum()
    for name in ("CAMERA", "PERSP", "ORTHO"):
        rendered, drawn = (visible(folder / f"{name}{end}.png", CUBE) for end in ("", "_solid"))
        assert (rendered & drawn).sum() > 0.97 * (rendered | drawn).sum()
    assert area["smaller"] / area["ORTHO"] == pytest.approx(0.3**2, rel=0.1)
    assert area["hidden"] == 0


def test_blender_can_be_closed_while_it_compiles_in_the_background(tell, tmp_path):
    """With an empty cache, the kernels are being compiled when the window is closed."""
    _, notes = tell("close_while_compiling", LAMBENT_CACHE=str(tmp_path))
    assert notes["warm_up"].startswith("Compiling kernels")


# ---- Without a window, as on a render farm ---------------------------------------------------------------------------


def render_in_background(lambent_in_blender, out, code, *more):
    """blender -b with Lambent as the engine of the startup scene, after some lines of Python; the finished process."""
    command, variables = lambent_in_blender
    code = f"import bpy; scene = bpy.context.scene; scene.render.resolution_percentage = 3; {code}"
    arguments = ["-b", "--python-expr", code, "-E", "LAMBENT", "-o", out, *more]
    return subprocess.run([*command, *map(str, arguments)], env=variables, capture_output=True, text=True)


def test_a_failure_gives_an_exit_code_and_no_file(lambent_in_blender, tmp_path):
    run = render_in_background(
        lambent_in_blender, tmp_path / "frame_", "scene.camera = bpy.data.objects['Cube']", "-f", "1"
    )
    assert run.returncode != 0
    assert "Cube: is the scene's camera, but it is a mesh" in run.stdout + run.stderr
    assert list(tmp_path.iterdir()) == []


def test_an_animation_ends_at_the_first_failure(lambent_in_blender, tmp_path):
    """The camera is replaced by a marker in frame 3."""
    markers = (
        "markers = scene.timeline_markers; good, bad = markers.new('A', frame=1), markers.new('B', frame=3); "
        "good.camera, bad.camera = bpy.data.objects['Camera'], bpy.data.objects['Cube']"
    )
    run = render_in_background(lambent_in_blender, tmp_path / "frame_", markers, "-s", "1", "-e", "4", "-a")
    assert run.returncode != 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["frame_0001.png", "frame_0002.png"]
