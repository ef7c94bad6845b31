# SPDX-License-Identifier: GPL-3.0-or-later
"""Final renders through Blender's own pipeline: the right pixels land in the right place of the file."""

import bpy
import numpy as np
import pytest
from PIL import Image

from addon.result import MISSING_PASSES
from blender_tests.helpers.exr import read_exr
from blender_tests.helpers.small_blend import SIZE, enable_cycles, render, save_as_exr
from engine_core.integrator.tiles import make_tiles

WIDTH, HEIGHT = SIZE


def test_a_render_is_a_picture_of_the_scene(scene, tmp_path):
    picture = render(tmp_path / "picture.exr")

    assert picture.shape == (HEIGHT, WIDTH, 4)
    assert np.isfinite(picture).all()
    assert (picture[..., 3] == 1).all()
    world, ball = picture[-2, 2, :3], picture[HEIGHT // 2, WIDTH // 2, :3]
    assert world == pytest.approx(np.array(scene.world.node_tree.nodes["Background"].inputs[0].default_value[:3]))
    assert ball.mean() > 2 * world.mean()  # the lamp is bright


def test_a_render_is_saved_through_blenders_view_transform(scene, tmp_path):
    scene.view_settings.view_transform = "Standard"
    linear = render(tmp_path / "picture.exr")
    image = scene.render.image_settings
    image.file_format, image.color_mode, image.color_depth = "PNG", "RGBA", "16"
    scene.render.filepath, scene.render.dither_intensity = str(tmp_path / "picture.png"), 0.0
    bpy.ops.render.render(write_still=True)

    png = bpy.data.images.load(str(tmp_path / "picture.png"))
    png.colorspace_settings.name = "Non-Color"  # the numbers of the file
    stored = np.array(png.pixels).reshape(HEIGHT, WIDTH, 4)
    srgb = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)
    assert stored[..., :3] == pytest.approx(np.clip(srgb[..., :3], 0, 1), abs=2e-3)


def test_transparent_film_has_no_world_in_it(scene, tmp_path):
    scene.render.film_transparent = True
    picture = render(tmp_path / "picture.exr")
    assert picture[-1] == pytest.approx(0, abs=1e-6)
    assert picture[HEIGHT // 2, WIDTH // 2, 3] == 1


# ---- Which part of the frame -----------------------------------------------------------------------------------------


def set_border(scene, left, right, low, high, crop):
    b_render = scene.render
    b_render.use_border, b_render.use_crop_to_border = True, crop
    b_render.border_min_x, b_render.border_max_x = left, right
    b_render.border_min_y, b_render.border_max_y = low, high


BORDERS = [(0.25, 0.75, 0.0, 0.5), (0.3, 0.7, 0.1, 0.45), (0.61, 0.81, 0.33, 0.99), (0.0, 1.0, 0.0, 1.0)]


@pytest.mark.parametrize("border", BORDERS)
def test_a_crop_is_a_part_of_the_whole_picture(scene, border, tmp_path):
    """Bit by bit, as the noise of a pixel depends on its place in the frame. And it is the part that Cycles renders."""
    scene.lambent.use_shared_samples = False  # those at the border have no neighbours beyond it
    whole = render(tmp_path / "whole.exr")
    set_border(scene, *border, crop=True)
    part = render(tmp_path / "part.exr")

    enable_cycles()
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    assert part.shape == render(tmp_path / "cycles.exr").shape
    x, y = int(np.float32(border[0]) * np.float32(WIDTH)), int(np.float32(border[2]) * np.float32(HEIGHT))
    assert (part == whole[y : y + part.shape[0], x : x + part.shape[1]]).all()


def test_a_border_without_crop_leaves_the_rest_empty(scene, tmp_path):
    scene.lambent.use_shared_samples = False
    whole = render(tmp_path / "whole.exr")
    set_border(scene, 0.25, 0.75, 0.0, 0.5, crop=False)
    part = render(tmp_path / "part.exr")

    inside = np.zeros((HEIGHT, WIDTH), bool)
    inside[: HEIGHT // 2, WIDTH // 4 : 3 * WIDTH // 4] = True
    assert (part[inside] == whole[inside]).all()
    assert (part[~inside] == 0).all()


def test_percentage_scales_the_picture(scene, tmp_path):
    scene.render.resolution_percentage = 50
    half = render(tmp_path / "half.exr")
    scene.render.resolution_percentage = 100
    scene.render.resolution_x, scene.render.resolution_y = WIDTH // 2, HEIGHT // 2
    assert (half == render(tmp_path / "small.exr")).all()


def test_pixel_aspect_squeezes_the_picture(scene, tmp_path):
    """Pixels twice as wide as high: the same view in half as many columns."""
    scene.lambent.samples = 64
    scene.render.film_transparent = True
    bpy.data.objects["Ground"].hide_render = True
    square = render(tmp_path / "square.exr")[..., 3]
    scene.render.resolution_x, scene.render.pixel_aspect_x = WIDTH // 2, 2.0
    wide = render(tmp_path / "wide.exr")[..., 3]

    paired = square.reshape(HEIGHT, WIDTH // 2, 2).mean(axis=-1)
    assert 50 < wide.sum() < 300
    assert abs(wide - paired).mean() < 0.01


# ---- Layers, passes, views -------------------------------------------------------------------------------------------


def test_each_view_layer_has_its_own_objects(scene, tmp_path):
    collections = {name: bpy.data.collections.new(name) for name in ("Balls", "Grounds")}
    for name, collection in collections.items():
        scene.collection.children.link(collection)
        b_object = bpy.data.objects[name[:-1]]
        scene.collection.objects.unlink(b_object)
        collection.objects.link(b_object)
    scene.view_layers[0].name = "All"
    for name in collections:
        layer = scene.view_layers.new(name)
        for other in collections.keys() - {name}:
            layer.layer_collection.children[other].exclude = True
    scene.render.film_transparent = True

    channels = render(tmp_path / "layers.exr", layers=True)

    alpha = {name: channels[f"{name}.Combined.A"] for name in ("All", *collections)}
    assert (alpha["All"] >= np.maximum(alpha["Balls"], alpha["Grounds"]) - 1e-6).all()
    for name in collections:
        scene.view_layers["All"].layer_collection.children[name].exclude = True
        missing = render(tmp_path / "one.exr", layers=True)["All.Combined.A"]
        other = next(iter(collections.keys() - {name}))
        assert (missing == alpha[other]).all()
        scene.view_layers["All"].layer_collection.children[name].exclude = False


def test_passes_carry_what_their_names_say(scene, tmp_path):
    layer = scene.view_layers[0]
    layer.use_pass_z = layer.use_pass_normal = layer.use_pass_position = True
    layer.lambent.use_pass_denoising_data = layer.lambent.use_pass_sample_count = True
    scene.lambent.samples = 16

    channels = render(tmp_path / "passes.exr", layers=True)

    def read(name, parts):
        found = [channels[f"{layer.name}.{name}.{part}"] for part in parts]
        return np.stack(found, axis=-1) if len(parts) > 1 else found[0]

    row, column = 2, WIDTH // 2  # the ground, in front of the ball
    position, camera = read("Position", "XYZ")[row, column], np.array(scene.camera.location)
    assert position[2] == pytest.approx(0.0, abs=1e-3)
    assert read("Normal", "XYZ")[row, column] == pytest.approx([0, 0, 1], abs=1e-3)
    forward = -np.array(scene.camera.matrix_world.col[2][:3])
    assert read("Depth", "Z")[row, column] == pytest.approx(np.dot(position - camera, forward), rel=1e-3)
    assert read("Denoising Albedo", "RGB")[row, column] == pytest.approx(0.8, abs=0.02)
    assert read("Denoising Normal", "XYZ")[row, column] == pytest.approx([0, 0, 1], abs=1e-3)
    assert (read("Debug Sample Count", "X") == 16).all()
    assert read("Depth", "Z")[-1, 0] > 1e9  # nothing is there


def test_passes_that_there_are_not_are_named(scene, tmp_path, capfd):
    scene.view_layers[0].use_pass_mist = scene.view_layers[0].use_pass_uv = True
    render(tmp_path / "picture.exr")
    told = "".join(capfd.readouterr())
    assert "Mist, UV" in told
    assert told.count("Mist, UV") == 1


def test_switches_of_missing_passes_exist_in_blender():
    for switch in MISSING_PASSES:
        assert switch in bpy.types.ViewLayer.bl_rna.properties, switch


def test_stereo_views_differ_by_the_eye(scene, tmp_path):
    scene.render.use_multiview = True
    scene.camera.data.stereo.interocular_distance = 0.5
    save_as_exr(scene, tmp_path / "stereo.exr")
    scene.render.image_settings.views_format = "INDIVIDUAL"
    bpy.ops.render.render(write_still=True)
    left, right = (read_exr(tmp_path / f"stereo_{side}.exr")[0]["R"] for side in "LR")
    assert abs(left - right).max() > 0.1


# ---- What the file says, and what must not matter --------------------------------------------------------------------


SAID = ("engine", "integrator", "sampler", "adaptive", "guided", "seed", "samples", "render_time", "estimated_error")


def test_the_file_says_how_it_was_rendered(scene, tmp_path):
    scene.lambent.seed = 5
    save_as_exr(scene, tmp_path / "picture.exr", layers=True)
    bpy.ops.render.render(write_still=True)
    _, header = read_exr(tmp_path / "picture.exr")
    said = {name: header[f"lambent.{scene.view_layers[0].name}.{name}"] for name in SAID}
    assert said["samples"] == "4"
    assert said["seed"] == "5"
    assert said["integrator"] == "path"
    assert said["engine"].startswith("Lambent ")
    assert float(said["render_time"].split()[0]) > 0
    assert 0.01 < float(said["estimated_error"].split()[0]) < 100.0


def test_a_png_says_how_it_was_rendered_too(scene, tmp_path):
    scene.render.filepath = str(tmp_path / "picture.png")
    scene.render.image_settings.file_format = "PNG"
    bpy.ops.render.render(write_still=True)
    said = Image.open(tmp_path / "picture.png").text
    for name in SAID:
        assert said[f"lambent.{scene.view_layers[0].name}.{name}"]


def test_threads_do_not_matter(scene, tmp_path):
    scene.render.resolution_x, scene.render.resolution_y = 150, 70  # six tiles
    scene.render.threads_mode = "FIXED"
    pictures = []
    for threads in (1, 3):
        scene.render.threads = threads
        pictures.append(render(tmp_path / f"{threads}.exr"))
    assert (pictures[0] == pictures[1]).all()


def test_seeds_give_other_noise_of_the_same_picture(scene, tmp_path):
    scene.lambent.samples = 64
    pictures = {}
    for name, seed, frame, animated in (("a", 0, 1, False), ("b", 0, 2, False), ("c", 7, 1, False), ("d", 0, 2, True)):
        scene.lambent.seed, scene.lambent.use_animated_seed = seed, animated
        scene.frame_set(frame)
        pictures[name] = render(tmp_path / f"{name}.exr")
    assert (pictures["a"] == pictures["b"]).all()
    for other in "cd":
        assert (pictures["a"] != pictures[other]).any()
        assert pictures["a"].mean() == pytest.approx(pictures[other].mean(), rel=0.02)


def test_tiles_that_come_while_rendering_add_up_to_the_same_picture(scene, tmp_path, monkeypatch):
    """In the background nobody looks, and tiles are left out; here they are shown as with a window."""
    from addon import final

    written = []
    write = final.Result.write

    def recording_write(self, render, tile=None):
        written.append(tile)
        write(self, render, tile)

    scene.render.resolution_x, scene.render.resolution_y, scene.lambent.samples = 150, 70, 64
    whole = render(tmp_path / "whole.exr")
    monkeypatch.setattr(final, "is_watched", lambda: True)
    monkeypatch.setattr(final, "REFRESH_S", 0.0)
    monkeypatch.setattr(final.Result, "write", recording_write)
    tiled = render(tmp_path / "tiled.exr")

    assert (tiled == whole).all()
    assert written[-1] is None  # all of it in the end
    assert {tile for tile in written if tile} == set(make_tiles(150, 70))
