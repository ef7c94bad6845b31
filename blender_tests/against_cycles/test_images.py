# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of every source, space and kind of alpha, pixel by pixel: the same as in Cycles."""

import bpy
import numpy as np
import pytest
from PIL import Image

from blender_tests.helpers.exported import add, empty_scene, export, square
from blender_tests.helpers.node_sheet import compared

TOLERANCE = 1e-3  # of the value, or where that is below 1 of 1
IS_OLD = bpy.app.version < (5, 0)
OLD_TOLERANCE = 0.013  # Cycles 4 rounds bytes to half precision before it converts them from other spaces than sRGB
UNASSOCIATED_IN_OLD = ("IRIS", "WEBP", "JPEG2000")  # it does not multiply their colours by their alpha
BLOCKS, BLOCK = (5, 4), 8  # squares of one colour, as lossy formats keep them
SIZE = (BLOCKS[0] * BLOCK, BLOCKS[1] * BLOCK)
NOW = 4  # frame of the scene
SPACES = [s.identifier for s in bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items]
FILES = {  # file format: its settings; colours of lossy ones are compared as they are read
    "PNG": [{}, {"color_depth": "16"}, {"color_mode": "BW"}, {"color_mode": "RGB"}],
    "JPEG": [{"color_mode": "RGB"}],
    "TIFF": [{}, {"color_depth": "16"}],
    "BMP": [{"color_mode": "RGB"}],
    "TARGA": [{}],
    "IRIS": [{}],
    "WEBP": [{}],
    "JPEG2000": [{}],
    "DPX": [{"color_mode": "RGB"}],
    "HDR": [{"color_mode": "RGB"}],
    "OPEN_EXR": [{}, {"color_depth": "32"}, {"color_mode": "BW"}],
}


def picture(seed=1, is_float=False, alpha=True):
    """A generated image of random squares."""
    b_image = bpy.data.images.new("Picture", *SIZE, alpha=alpha, float_buffer=is_float)
    pixels = np.random.default_rng(seed).random((BLOCKS[1], BLOCKS[0], 4), dtype=np.float32)
    pixels[0, 0, 3], pixels[1, 1, 3] = 0.0, 1.0
    if not alpha:
        pixels[..., 3] = 1.0
    pixels = pixels.repeat(BLOCK, axis=0).repeat(BLOCK, axis=1)
    b_image.pixels.foreach_set(pixels.ravel())
    b_image.update()
    return b_image


def packed(space=None, alpha_mode=None, **arguments):
    b_image = picture(**arguments)
    b_image.pack()
    if space:
        b_image.colorspace_settings.name = space
    if alpha_mode:
        b_image.alpha_mode = alpha_mode
    return b_image


def saved(path, file_format="PNG", seed=1, **settings):
    """The path of a file with a picture."""
    b_image = picture(seed, is_float=True)
    scene = bpy.data.scenes.new("Saving")
    scene.view_settings.view_transform = "Standard"
    image = scene.render.image_settings
    image.file_format = file_format
    for name, value in ({"color_mode": "RGBA"} | settings).items():
        setattr(image, name, value)
    b_image.save_render(str(path), scene=scene)
    bpy.data.scenes.remove(scene)
    bpy.data.images.remove(b_image)
    return str(path)


def texture(tree, b_image, output="Color", scale=1.0, **properties):
    """The output of an Image Texture node, with its corner at one quarter of the square."""
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.interpolation = b_image, "Closest"
    user = node.image_user
    for name, value in properties.items():
        setattr(user if hasattr(user, name) else node, name, value)
    mapping, uv = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    mapping.inputs["Scale"].default_value = (scale, scale, 1.0)
    mapping.inputs["Location"].default_value = (-0.25 * scale + 0.25, -0.25 * scale + 0.25, 0.0)
    tree.links.new(uv.outputs["UV"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    return node.outputs[output]


def both(tree, b_image, **properties):
    """Colour plus alpha: Cycles divides the one by the other where both are asked for."""
    color = texture(tree, b_image, **properties)
    add = tree.nodes.new("ShaderNodeVectorMath")
    tree.links.new(color, add.inputs[0])
    tree.links.new(color.node.outputs["Alpha"], add.inputs[1])
    return add.outputs[0]


def cases(folder):
    """{name: function of a tree} of all that is compared."""
    made = {}
    for space in SPACES:
        made[f"bytes in {space}"] = lambda t, s=space: texture(t, packed(s, alpha=False))
        made[f"bytes with alpha in {space}"] = lambda t, s=space: texture(t, packed(s))
        made[f"floats in {space}"] = lambda t, s=space: texture(t, packed(s, is_float=True, alpha=False))
    for mode in ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"):
        for space in ("sRGB", "Non-Color", "Linear Rec.2020"):
            for is_float in (False, True) if mode != "PREMUL" else (True,):
                name = f"{mode} {space} {'float' if is_float else 'byte'}"
                made[f"{name} color"] = lambda t, a=(space, mode), f=is_float: texture(t, packed(*a, is_float=f))
                made[f"{name} both"] = lambda t, a=(space, mode), f=is_float: both(t, packed(*a, is_float=f))
    for file_format, variants in FILES.items():
        for number, settings in enumerate(variants):
            if IS_OLD and file_format in UNASSOCIATED_IN_OLD:
                settings = {**settings, "color_mode": "RGB"}
            path = folder / f"{file_format}{number}"
            name = " ".join((file_format, *settings.values()))
            made[f"file {name}"] = lambda t, p=path, f=file_format, s=settings: texture(
                t, bpy.data.images.load(saved(p, f, **s))
            )
    for depth in "8", "16":
        path = folder / f"with_alpha_{depth}.png"
        made[f"file with alpha {depth}"] = lambda t, p=path, d=depth: both(
            t, bpy.data.images.load(saved(p, color_depth=d))
        )
    if not IS_OLD:  # the Cycles before reads such files of any mode as straight
        made["file premultiplied"] = lambda t: both(t, premultiplied(folder / "premultiplied.png"))
    for kind in ("BLANK", "UV_GRID", "COLOR_GRID"):
        for is_float in (False, True):
            made[f"generated {kind} {is_float}"] = lambda t, k=kind, f=is_float: texture(t, generated(k, f))
    for pack in (False, True):
        made[f"tiles {pack}"] = lambda t, p=pack: texture(t, tiles(folder, p), scale=3.0)
        made[f"tiles {pack} from a sphere"] = lambda t, p=pack: texture(t, tiles(folder, p), projection="SPHERE")
        made[f"tiles {pack} in a box"] = lambda t, p=pack: texture(t, tiles(folder, p), projection="BOX")
    for name, properties in {
        "first": {},
        "offset": {"frame_offset": 1},
        "late": {"frame_start": 3},
        "not yet": {"frame_start": 7, "frame_offset": 2},
        "over": {"frame_duration": 2},
        "cyclic": {"frame_duration": 3, "use_cyclic": True, "frame_offset": 1},
        "missing": {"frame_offset": 40},
        "refreshed": {"use_auto_refresh": True},
    }.items():
        properties = {"frame_duration": 6, **properties}
        made[f"sequence {name}"] = lambda t, p=properties: texture(t, sequence(folder), **p)
        made[f"movie {name}"] = lambda t, p=properties: texture(t, bpy.data.images.load(str(folder / "movie.avi")), **p)
    return made


def premultiplied(path):
    """A file in which no colour is brighter than its alpha."""
    pixels = np.random.default_rng(1).integers(1, 256, (BLOCKS[1], BLOCKS[0], 4), np.uint8)
    pixels[..., :3] = pixels[..., :3].astype(int) * pixels[..., 3:] // 255
    Image.fromarray(pixels).save(path)
    b_image = bpy.data.images.load(str(path))
    b_image.alpha_mode = "PREMUL"
    return b_image


def generated(kind, is_float):
    b_image = bpy.data.images.new(kind, 64, 32, float_buffer=is_float)
    b_image.generated_type, b_image.generated_color = kind, (0.2, 0.5, 0.8, 0.5)
    return b_image


def tiles(folder, pack):
    """Of four tiles, one of which is in no file."""
    for seed, number in enumerate((1001, 1002, 1012)):
        saved(folder / f"tile.{number}.png", seed=seed)
    b_image = bpy.data.images.load(str(folder / "tile.1001.png"))
    b_image.source = "TILED"
    for number in (1002, 1011, 1012):
        b_image.tiles.new(number)
    b_image.filepath = str(folder / "tile.<UDIM>.png")
    if pack:
        b_image.pack()
    return b_image


def sequence(folder):
    for frame in range(1, 7):
        saved(folder / f"frame_{frame:03}.png", seed=frame)
    b_image = bpy.data.images.load(str(folder / "frame_001.png"))
    b_image.source = "SEQUENCE"
    return b_image


def make_movie(path):
    """Six frames of one colour each."""
    scene = bpy.data.scenes.new("Movie")
    scene.frame_end, render = 6, scene.render
    render.resolution_x = render.resolution_y = 16
    editor = scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    for frame in range(1, 7):
        length = {"length": 1} if bpy.app.version >= (5, 0) else {"frame_end": frame + 1}
        strip = strips.new_effect(f"Frame {frame}", "COLOR", 1, frame, **length)
        strip.color = (frame / 10, 0.5, 1.0 - frame / 10)
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "VIDEO"
    render.image_settings.file_format = "FFMPEG"
    render.ffmpeg.format, render.ffmpeg.codec = "AVI", "FFV1"
    render.use_file_extension, render.filepath = False, str(path)
    bpy.ops.render.render(animation=True, scene=scene.name)
    bpy.data.scenes.remove(scene)


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("images")
    empty_scene()
    make_movie(folder / "movie.avi")
    return compared(cases(folder), frame=NOW)


def is_converted(name):
    return name.startswith(("bytes in", "bytes with alpha in")) or "Linear Rec.2020 byte" in name


def test_images_give_what_they_give_in_cycles(pictures):
    """All but pixels at borders, whose middles differ by a hundredth of their size."""
    wrong = {}
    for name, (ours, theirs) in pictures.items():
        difference = (np.abs(ours - theirs) / np.maximum(np.abs(theirs), 1.0)).max(axis=-1)
        error = np.quantile(np.where(np.isfinite(difference), difference, np.inf), 0.9)
        if error > (OLD_TOLERANCE if IS_OLD and is_converted(name) else TOLERANCE):
            wrong[name] = f"{error:.2g}"
    assert not wrong


def test_a_frame_that_is_not_there_is_magenta_and_told(tmp_path):
    empty_scene()
    assert (
        warnings_of(sequence(tmp_path), frame_duration=6, frame_offset=40)
        == "frame 41 of the image frame_001.png is missing"
    )


def test_a_tile_that_is_not_there_is_told(tmp_path):
    empty_scene()
    b_image = tiles(tmp_path, False)
    (tmp_path / "tile.1012.png").unlink()
    assert warnings_of(b_image) == "tile 1012 of the image tile.1001.png is missing"


def test_images_are_read_once_and_bytes_stay_bytes():
    """The same image in two nodes and two ways to look at it: as many words as it has pixels."""
    empty_scene()
    b_image = packed()
    add("One", textured_square(b_image))
    add("Two", textured_square(b_image, interpolation="Linear"))
    builder, _ = export()
    assert len(builder.build().texels) == SIZE[0] * SIZE[1]


def test_what_converts_images_leaves_nothing_in_the_file(tmp_path):
    empty_scene()
    images = [packed("ACEScg"), tiles(tmp_path, False), sequence(tmp_path)]
    for b_image in images:
        add("Square", textured_square(b_image))
    export()
    assert len(bpy.data.images) == len(images)
    assert not bpy.data.textures


def warnings_of(b_image, **properties):
    """What is told of the image of a square."""
    add("Square", textured_square(b_image, **properties))
    (text,) = export()[1]
    return text.rpartition(": ")[2].removesuffix("; magenta")


def textured_square(b_image, **properties):
    b_mesh = square()
    material = bpy.data.materials.new("Textured")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    color = texture(material.node_tree, b_image, **properties)
    material.node_tree.links.new(color, material.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    b_mesh.materials.append(material)
    return b_mesh
