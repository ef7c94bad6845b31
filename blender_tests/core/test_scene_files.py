# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene files: what is written is read again, and what is damaged is refused before a kernel sees it."""

import json

import numpy as np
import pytest

from blender_tests.helpers.scenes import builder, cube, settings, sphere
from engine_core.__main__ import main
from engine_core.integrator.tiles import Render
from engine_core.scene.checks import SceneError
from engine_core.scene.files import load_scene, save_scene
from engine_core.scene.materials import Diffuse, Emission
from engine_core.scene.volumes import VolumeScatter


@pytest.fixture
def scene():
    b = builder(eye=(0, -4, 1))
    cube(b, Diffuse((0.8, 0.3, 0.2)))
    for x in (-2, 2):
        matrix = np.diag([0.4, 0.4, 0.4, 1.0])
        matrix[0, 3] = x
        cube(b, Emission((1, 1, 1)), matrix)
    sphere(b, Diffuse(), (0, 0, 1.5), 0.4)
    mesh = len(b.geometries) - 2
    b.instance(mesh, np.diag([0.2, 0.2, 0.2, 1.0]), [1])
    poses = np.array([np.diag([0.2, 0.2, 0.2 + 0.1 * time, 1.0]) for time in range(3)])
    b.instance(mesh, poses[1], motion=poses)
    b.point_light("Lamp", (2, -2, 2), (50, 50, 50), radius=0.1)
    b.background((0.2, 0.2, 0.3), volume=VolumeScatter(density=0.01))
    return b.build()


def test_a_scene_comes_back_as_it_was(scene, tmp_path):
    path = tmp_path / "scene.lambent"
    save_scene(path, scene, settings(24, samples=4))
    loaded, loaded_settings = load_scene(path)
    assert loaded_settings == settings(24, samples=4)
    pictures = [Render(s, loaded_settings).run().pixels for s in (scene, loaded)]
    np.testing.assert_array_equal(*pictures)


def test_the_command_line_renders_it(scene, tmp_path, capsys):
    path, output = tmp_path / "scene.lambent", tmp_path / "picture.npy"
    save_scene(path, scene, settings(24, samples=2))
    assert main(["render", str(path), "-o", str(output), "--samples", "3"]) == 0
    assert np.load(output).shape == (24, 24, 4)
    assert "Sample 3/3" in capsys.readouterr().out
    assert main(["info", str(path)]) == 0
    assert "triangles" in capsys.readouterr().out


@pytest.mark.parametrize("content", [b"", b"not a zip", b"PK\x03\x04 torn"])
def test_other_files_are_refused_by_name(content, tmp_path, capsys):
    path = tmp_path / "holiday.lambent"
    path.write_bytes(content)
    with pytest.raises(SceneError, match=r"holiday\.lambent"):
        load_scene(path)
    assert main(["render", str(path)]) == 1
    assert "holiday.lambent" in capsys.readouterr().err


def test_a_missing_file_is_told_plainly(tmp_path, capsys):
    assert main(["render", str(tmp_path / "nowhere.lambent")]) == 1
    assert "nowhere.lambent" in capsys.readouterr().err


@pytest.mark.parametrize("out", ["picture.gif", "nowhere/picture.png"])
def test_a_picture_that_cannot_be_written_is_refused_before_rendering(scene, out, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(Render, "start", lambda render: pytest.fail("it renders"))
    save_scene(tmp_path / "scene.lambent", scene, settings(8, samples=1))
    assert main(["render", str(tmp_path / "scene.lambent"), "-o", str(tmp_path / out)]) == 1
    assert out.split("/")[0] in capsys.readouterr().err


def damage(path, table, change):
    """Rewrite one table of a scene file."""
    with np.load(path) as stored:
        arrays = dict(stored)
    arrays[table] = change(arrays[table])
    with open(path, "wb") as file:
        np.savez_compressed(file, **arrays)


def rewrite(table, field, value):
    def change(raw, dtype):
        rows = np.frombuffer(raw.tobytes(), dtype).copy()
        rows[field] = value
        return rows.view(np.uint8)

    return table, change


@pytest.mark.parametrize(
    ("table", "field", "value"),
    [
        ("nodes", "child", 10_000),
        ("nodes", "child", 0),
        ("nodes", "child", -(2**30)),
        ("packets", "prim", 10**6),
        ("triangles", "instance", 99),
        ("slots", "material", -5),
        ("materials", "lobes", 77),
        ("materials", "lobe_count", 9),
        ("instances", "root", 10**6),
        ("instances", "kind", 7),
        ("instances", "lights", 10**6),
        ("instances", "motion", 10**6),
        ("instances", "motion", -1),
        ("camera", "motion", 99),
        ("camera", "shutter", 2.0),
        ("world", "moving_root", 10**6),
        ("world", "pose_count", 1),
        ("world", "light_count", 10**6),
        ("lights", "level", 5),
        ("lights", "level", 6),
        ("lights", "level", -1),
        ("world", "background_light", 10**6),
        ("world", "far_count", 10**6),
        ("world", "light_root", 10**6),
        ("world", "only_light", 10**6),
        ("lights", "leaf", 10**6),
        ("world", "target_root", 10**6),
        ("world", "target_count", 10**6),
        ("world", "delta_count", 10**6),
        ("targets", "light", 10**6),
        ("targets", "light", -1),
        ("light_nodes", "child", 0),
        ("light_nodes", "child", 10**6),
        ("light_nodes", "child", -(10**6)),
        ("light_nodes", "parent", 10**6),
        ("light_nodes", "parent", -2),
        ("materials", "medium", 10**6),
        ("world", "medium", 10**6),
        ("media", "phases", 10**6),
        ("media", "phases", -1),
        ("media", "phase_count", 17),
        ("media", "phase_count", 2),
        ("media", "phase_count", -1),
    ],
)
def test_row_numbers_that_lead_outside_are_refused(scene, tmp_path, table, field, value):
    path = tmp_path / "scene.lambent"
    save_scene(path, scene, settings())
    dtype = scene.dtypes()[table]
    _, change = rewrite(table, field, value)
    damage(path, table, lambda raw: change(raw, dtype))
    with pytest.raises(SceneError, match="scene"):
        load_scene(path)


@pytest.mark.parametrize("count", [1, 2])
def test_a_pair_that_ends_with_the_table_is_refused(count, tmp_path):
    path = tmp_path / "scene.lambent"
    b = builder()
    for i in range(count):
        b.point_light("Lamp", (i, 0, 2), (50, 50, 50))
    scene = b.build()
    save_scene(path, scene, settings())
    load_scene(path)
    _, change = rewrite("lights", "share", 0.5)
    damage(path, "lights", lambda raw: change(raw, scene.dtypes()["lights"]))
    with pytest.raises(SceneError, match="pairs"):
        load_scene(path)


def test_another_version_is_refused(scene, tmp_path):
    path = tmp_path / "scene.lambent"
    save_scene(path, scene, settings())

    def newer(raw):
        header = json.loads(raw.tobytes())
        header["version"] = 999
        return np.frombuffer(json.dumps(header).encode(), np.uint8)

    damage(path, "header", newer)
    with pytest.raises(SceneError, match="999"):
        load_scene(path)
