# SPDX-License-Identifier: GPL-3.0-or-later
"""`build.py compare`: two engines on one sheet, with figures that say what they claim to say."""

import json
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from PIL import Image

from blender_tests.bench.compare import CompareError, add_errors, compare, open_scene
from blender_tests.bench.sheet import difference_map, flip
from blender_tests.helpers.engines import ENGINES, enable_engines
from blender_tests.helpers.small_blend import small_scene

ROOT = Path(__file__).parents[2]


@pytest.fixture
def blend(tmp_path):
    enable_engines()
    small_scene(samples=8)
    path = tmp_path / "small.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.fixture
def own_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def gradient(factor=1.0):
    x = np.linspace(0.1, 0.9, 64, dtype=np.float32)
    return np.repeat(np.repeat((x[None] * x[:, None])[..., None], 3, axis=2), 1, axis=0) * np.float32(factor)


def test_equal_pictures_do_not_differ():
    colored, _ = difference_map(gradient(), gradient())

    np.testing.assert_array_equal(colored, 1.0)
    assert flip(gradient(), gradient())[1] == 0.0


def test_a_brighter_picture_is_red_and_a_darker_one_blue():
    brighter, darker = (difference_map(gradient(f), gradient())[0].mean(axis=(0, 1)) for f in (1.2, 0.8))

    assert brighter[0] > brighter[1] + 0.2
    assert darker[2] > darker[0] + 0.2
    assert 0.02 < flip(gradient(), gradient(1.2))[1] < 0.5


def test_bias_is_the_difference_of_the_references():
    """Not that of the noisy pictures."""
    figures = {
        engine: {"seconds": s, "reference_mean_error": 0.0} for engine, s in zip(ENGINES, (2.0, 6.0), strict=True)
    }
    pictures = {}
    for engine, factor in (("LAMBENT", 1.02), ("CYCLES", 1.0)):
        pictures[engine, "reference"] = gradient(factor), gradient(factor)
        pictures[engine, "picture"] = gradient(factor * 1.1), gradient(factor * 1.1)

    add_errors(figures, pictures, has_references=True)

    assert figures["difference"]["bias"] == pytest.approx(0.02, rel=1e-4)
    assert figures["LAMBENT"]["rmse"] == pytest.approx(1.02 * figures["CYCLES"]["rmse"], rel=1e-4)
    assert figures["efficiency_vs_cycles"] == pytest.approx(3.0, rel=0.03)


def test_both_engines_render_the_same_and_errors_fall_with_samples(blend, own_cache):
    few, _, about = compare(blend, samples=4, reference_samples=256)
    many, pictures, _ = compare(blend, samples=64, reference_samples=256)

    assert about["size"] == [48, 32]
    for engine in ENGINES:
        assert (few[engine]["samples"], many[engine]["samples"]) == (4, 64)
        assert many[engine]["relative_mse"] < 0.5 * few[engine]["relative_mse"]
        assert pictures[engine, "picture"][0].shape == pictures[engine, "reference"][1].shape == (32, 48, 3)
    assert abs(many["difference"]["bias"]) < max(4 * many["difference"]["bias_noise"], 0.005)


def test_engines_get_the_same_time(blend):
    figures, _, _ = compare(blend, seconds=0.5)

    for engine in ENGINES:
        assert figures[engine]["samples"] > 8
        assert figures[engine]["samples"] < 1 << 20


def test_the_engine_that_the_file_was_saved_for_leads(blend):
    bpy.context.scene.render.engine = "CYCLES"
    bpy.context.scene.cycles.max_bounces, bpy.context.scene.lambent.max_bounces = 3, 7
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    assert open_scene(blend).lambent.max_bounces == 3

    bpy.context.scene.render.engine = "LAMBENT"
    bpy.context.scene.cycles.max_bounces, bpy.context.scene.lambent.max_bounces = 3, 7
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    assert open_scene(blend).cycles.max_bounces == 7


def test_a_scene_without_camera_is_refused_by_name(blend):
    bpy.data.objects.remove(bpy.context.scene.camera)
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))

    with pytest.raises(CompareError, match=r"small\.blend has no camera"):
        open_scene(blend)


def test_the_command_writes_a_sheet_and_figures(blend, tmp_path):
    words = [str(blend), "--output", str(tmp_path / "out"), "--samples", "2", "--size", "40", "20"]
    command = [sys.executable, "-m", "blender_tests.bench.compare", *words]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)

    assert result.returncode == 0, result.stderr
    figures = json.loads((tmp_path / "out" / "small_compare.json").read_text())
    assert figures["size"] == [40, 20]
    assert figures["LAMBENT"]["samples"] == figures["CYCLES"]["samples"] == 2
    assert Image.open(tmp_path / "out" / "small_compare.png").width > 4 * 40
    assert "Saved" not in result.stdout  # Blender's own lines
