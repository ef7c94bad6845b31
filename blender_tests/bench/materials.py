# SPDX-License-Identifier: GPL-3.0-or-later
"""What materials cost: a constant one, a Principled with four image textures, and thirty nodes of procedures.

Each covers the whole picture, so every sample shades one hit and looks for light from there. `hit_ns`: seconds of the
processor for a sample, without what the same sample costs with a black material that shines. `ratio`: our samples a
second over those of Cycles, rendered in turn, and `cpu_ratio` the same by seconds of the processor. All are slopes
between two numbers of samples, so that export, compilation and files do not count.
"""

from typing import NamedTuple

import bpy
import numpy as np

from blender_tests.helpers.engines import enable_engines, render, set_alike
from blender_tests.helpers.exported import add, empty_scene, mesh

SIZE, QUICK_SIZE = 256, 32
LOW, HIGH = 24, 88  # more than the samples after which a render decides whether to share them
REPETITIONS = 3


class Cost(NamedTuple):
    """Of a sample."""

    seconds: float  # on the clock
    cpu_s: float


def run(quick=False):
    """{material: {"hit_ns", "samples_per_s", "ratio", "cpu_ratio"}}."""
    plain = measure(flat, quick)["LAMBENT"]
    figures = {}
    for name, build in (("constant", constant), ("textured", textured), ("procedural", procedural)):
        seconds = measure(build, quick)
        figures[name] = {
            "hit_ns": 1e9 * (seconds["LAMBENT"].cpu_s - plain.cpu_s),
            "samples_per_s": 1.0 / seconds["LAMBENT"].seconds,
            "ratio": seconds["CYCLES"].seconds / seconds["LAMBENT"].seconds,
            "cpu_ratio": seconds["CYCLES"].cpu_s / seconds["LAMBENT"].cpu_s,
        }
    return figures


def measure(build, quick):
    """{engine: Cost}: medians over repetitions in which the engines take turns."""
    scene = scene_of(build, QUICK_SIZE if quick else SIZE)
    low, high = (1, 5) if quick else (LOW, HIGH)
    samples = (high - low) * scene.render.resolution_x * scene.render.resolution_y
    found = {engine: [] for engine in ("LAMBENT", "CYCLES")}
    for engine in found:
        render(engine, scene, 1)  # compiles
    for _ in range(1 if quick else REPETITIONS):
        for engine, slopes in found.items():
            few, many = render(engine, scene, low), render(engine, scene, high)
            slopes.append((many.seconds - few.seconds, many.cpu_s - few.cpu_s))
    return {engine: Cost(*(np.median(slopes, axis=0) / samples)) for engine, slopes in found.items()}


def scene_of(build, size):
    """A square that fills the picture, in daylight, of the material whose surface `build(tree)` gives."""
    enable_engines()
    scene = empty_scene()
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 2.0
    scene.camera.location = (0.0, 0.0, 4.0)
    b_mesh = mesh("Square", [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], [(0, 1, 2, 3)])
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
    b_mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", corners.ravel())
    material, scene.world = bpy.data.materials.new(build.__name__), bpy.data.worlds.new("Day")
    if bpy.app.version < (5, 0):
        material.use_nodes = scene.world.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    tree.links.new(build(tree), tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    b_mesh.materials.append(material)
    add("Square", b_mesh)
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.1
    add("Sun", sun, rotation_euler=(0.6, 0.3, 0.0))
    set_alike(scene)
    return scene


# ---- Materials -------------------------------------------------------------------------------------------------------


def flat(tree):
    """Nothing but a colour."""
    return tree.nodes.new("ShaderNodeEmission").outputs[0]


def constant(tree):
    return principled(tree, {"Base Color": (0.6, 0.3, 0.1, 1.0), "Metallic": 0.3, "Roughness": 0.4})


def textured(tree):
    """Base colour, roughness, metallic and normals from pictures."""
    color, roughness, metallic, normals = (picture(tree, seed) for seed in range(4))
    normal = linked(tree, "NormalMap", {"Color": normals})
    return principled(tree, {"Base Color": color, "Roughness": roughness, "Metallic": metallic, "Normal": normal})


def procedural(tree):
    """Thirty nodes: six layers of noise, cells, a ramp, mathematics and a mix, and a bump."""
    where = linked(tree, "TexCoord", output="Object")
    color, height = (0.2, 0.1, 0.05, 1.0), 0.5
    for layer in range(6):
        kind, output = (("TexNoise", 0), ("TexVoronoi", "Distance"))[layer % 2]
        value = linked(tree, kind, {"Vector": where, "Scale": 3.0 + layer}, output)
        ramp = linked(tree, "ValToRGB", {0: value})
        color = linked(tree, "MixRGB", {0: value, 1: color, 2: ramp})
        height = linked(tree, "Math", {0: height, 1: value})
    roughness = linked(tree, "Math", {0: height, 1: 0.2})
    limited = linked(tree, "Clamp", {0: roughness})
    normal = linked(tree, "Bump", {"Height": height, "Strength": 0.3})
    return principled(tree, {"Base Color": color, "Roughness": limited, "Normal": normal})


def principled(tree, inputs):
    return linked(tree, "BsdfPrincipled", inputs)


def linked(tree, kind, inputs=(), output=0):
    """An output of a new node, of which some inputs are values or linked."""
    node = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in dict(inputs).items():
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, node.inputs[name])
        else:
            node.inputs[name].default_value = value
    return node.outputs[output]


def picture(tree, seed):
    """A picture of 512 x 512 pixels: colour, roughness and metallic anyhow, normals that point up."""
    low, high = ((0.45, 0.45, 0.9), (0.55, 0.55, 1.0)) if seed == 3 else ((0.1,) * 3, (0.9,) * 3)
    pixels = np.ones((512, 512, 4), np.float32)
    pixels[..., :3] = np.random.default_rng(seed).uniform(low, high, (512, 512, 3))
    image = bpy.data.images.new(f"Picture {seed}", 512, 512, is_data=seed > 0)
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    return node.outputs["Color"]
