# SPDX-License-Identifier: GPL-3.0-or-later
"""What shader nodes give in Cycles, as numbers: many nodes in one picture, a tile of pixels for each.

A tile is a square that emits what its node puts out. The node reads points that vary over the square; the same picture
holds them too, in passes, so that whatever rounding led to them, both sides see the same numbers. For processes where
bpy is.
"""

import math
import tempfile
from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np

from engine_core.linalg.vec3 import Vec3

from .cycles import set_up_cycles
from .small_blend import enable_cycles, render

TILE = 16  # pixels along a side
POINTS = ("p", "q", "w")  # two vectors and a number


class Case(NamedTuple):
    """A node, and what it should put out."""

    name: str
    kind: str  # "Math" for ShaderNodeMath
    ours: object  # function of p, q (Vec3) and w (float32) that gives up to three numbers
    outputs: tuple  # identifiers: one of a colour or vector, or up to three of numbers
    settings: dict = {}  # properties of the node
    inputs: dict = {}  # socket identifiers to values, or to "p", "q", "w", or a component of the vectors such as "p.x"
    span: float = 2.0  # points reach from -span to span
    low: float = None  # ... or from here, with their middle in the middle of the tile
    varies: bool = True  # over the points; False where a constant is right


class Tile(NamedTuple):
    """What a case gave, pixel by pixel."""

    p: np.ndarray  # (n, 3)
    q: np.ndarray
    w: np.ndarray  # (n,)
    value: np.ndarray  # (n, 3), as many columns filled as there are outputs


def cycles_values(cases):
    """[Tile] of the cases, from one picture of one sample a pixel."""
    columns = math.ceil(math.sqrt(len(cases)))
    scene = _scene(cases, columns)
    with tempfile.TemporaryDirectory() as folder:
        passes = render(Path(folder, "nodes.exr"), scene, layers=True)
    pictures = {name: _channels(passes, name) for name in ("Combined", *POINTS)}
    tiles = []
    for i in range(len(cases)):
        x, y = i % columns * TILE, i // columns * TILE
        pixels = {
            name: picture[y : y + TILE, x : x + TILE].reshape(TILE * TILE, -1) for name, picture in pictures.items()
        }
        tiles.append(Tile(pixels["p"], pixels["q"], pixels["w"][:, 0], pixels["Combined"][:, :3]))
    return tiles


def assert_same(case, tile):
    """Our values are those of Cycles to 1e-3, relative where they exceed 1, in each pixel."""
    assert not case.varies or tile.value.std(axis=0).max() > 0
    assert differences(case, tile).max() <= 1e-3


def differences(case, tile):
    """How far our values are from Cycles', (n, number of outputs), relative where they exceed 1."""
    found = [case.ours(Vec3(*p), Vec3(*q), w) for p, q, w in zip(tile.p, tile.q, tile.w, strict=True)]
    ours = np.array([tuple(x) if hasattr(x, "__iter__") else (x,) for x in found], np.float32)
    theirs = tile.value[:, : ours.shape[1]]
    return abs(ours - theirs) / np.maximum(1, abs(theirs))


def _channels(passes, name):
    """A pass as (height, width, channels)."""
    found = {key.rsplit(".", 1)[1]: values for key, values in passes.items() if key.split(".")[-2] == name}
    return np.stack([found[c] for c in "RGBXYZV" if c in found], axis=-1).astype(np.float32)


def _scene(cases, columns):
    """A file with a square for each case, `columns` beside each other, seen by a camera of as many tiles."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    rows = math.ceil(len(cases) / columns)
    mesh = bpy.data.meshes.new("Tiles")
    corners = [(i % columns + a, i // columns + b, 0) for i in range(len(cases)) for a, b in _CORNERS]
    mesh.from_pydata(corners, [], [range(4 * i, 4 * i + 4) for i in range(len(cases))])
    mesh.polygons.foreach_set("material_index", range(len(cases)))
    random = np.random.default_rng(7)
    for name, size in zip(POINTS, (3, 3, 1), strict=True):
        low = np.array([-c.span if c.low is None else c.low for c in cases])
        high = np.array([c.span for c in cases])
        middle, half = (0.5 * (high + low))[:, None, None], (0.5 * (high - low))[:, None, None]
        slopes = random.uniform(0.5, 1.0, (len(cases), 2, size)) * random.choice((-1, 1), (len(cases), 2, size))
        values = middle + half * np.concatenate([slopes, -slopes], axis=1)  # opposite corners are opposite
        attribute = mesh.attributes.new(name, "FLOAT_VECTOR" if size == 3 else "FLOAT", "POINT")
        attribute.data.foreach_set("vector" if size == 3 else "value", values.astype(np.float32).ravel())
    for case in cases:
        mesh.materials.append(_material(case))
    scene.collection.objects.link(bpy.data.objects.new("Tiles", mesh))
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", max(columns, rows)
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location = (columns / 2, rows / 2, 1)
    scene.collection.objects.link(scene.camera)
    scene.render.resolution_x, scene.render.resolution_y = columns * TILE, rows * TILE
    for name, kind in zip(POINTS, ("COLOR", "COLOR", "VALUE"), strict=True):
        aov = scene.view_layers[0].aovs.add()
        aov.name, aov.type = name, kind
    enable_cycles()
    set_up_cycles(scene, samples=1)
    scene.cycles.pixel_filter_type = "BOX"
    return scene


_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))


def _material(case):
    """Emits the outputs of the case's node, and puts out the points that it read."""
    material = bpy.data.materials.new(case.name)
    if not material.node_tree:  # Blender 4
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    sources = {}
    for name in POINTS:
        attribute = tree.nodes.new("ShaderNodeAttribute")
        attribute.attribute_name = name
        sources[name] = attribute.outputs["Fac" if name == "w" else "Vector"]
        aov = tree.nodes.new("ShaderNodeOutputAOV")
        aov.aov_name = name
        tree.links.new(sources[name], aov.inputs["Value" if name == "w" else "Color"])
    for name in "pq":
        separate = tree.nodes.new("ShaderNodeSeparateXYZ")
        tree.links.new(sources[name], separate.inputs[0])
        sources |= {f"{name}.{axis}": separate.outputs[axis.upper()] for axis in "xyz"}
    node = tree.nodes.new(f"ShaderNode{case.kind}")
    for name, value in case.settings.items():
        setattr(node, name, value)
    for identifier, value in case.inputs.items():
        socket = next(s for s in node.inputs if s.identifier == identifier)
        if isinstance(value, str):
            tree.links.new(sources[value], socket)
        else:
            socket.default_value = value
    outputs = [next(s for s in node.outputs if s.identifier == name) for name in case.outputs]
    emission = tree.nodes.new("ShaderNodeEmission")
    if outputs[0].type == "VALUE":
        combine = tree.nodes.new("ShaderNodeCombineXYZ")
        for output, socket in zip(outputs, combine.inputs, strict=False):
            tree.links.new(output, socket)
        outputs = combine.outputs
    tree.links.new(outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material
