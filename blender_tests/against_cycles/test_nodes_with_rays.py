# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient Occlusion, Bevel and Raycast: a cube and a ball on a floor that shine with what the node gives, in both
engines. What is random is compared by means over squares of pixels."""

import math

import bpy
import numpy as np
import pytest

from blender_tests.helpers.engines import cells_in_both
from blender_tests.helpers.exported import add, empty_scene, square
from blender_tests.helpers.node_sheet import add as add_node
from blender_tests.helpers.node_sheet import named

CELL, BLOCK, SAMPLES = 32, 4, 32
HAS_RAYCAST = bpy.app.version >= (5, 1)


def occlusion(tree, output="Color", distance=1.0, **properties):
    node = add_node(tree, "AmbientOcclusion", {"Color": (1.0, 0.5, 0.2, 1.0), "Distance": distance}, **properties)
    return node.outputs[output]


def occlusion_about(tree):
    """About a direction of its own."""
    node = add_node(tree, "AmbientOcclusion", {"Distance": 1.0}, samples=8)
    node.inputs["Normal"].default_value = (0.6, 0.0, 0.8)
    up = add_node(tree, "CombineXYZ", {0: 0.6, 2: 0.8}).outputs[0]
    tree.links.new(up, named(node.inputs, "Normal"))
    return node.outputs["AO"]


def bevel(tree, radius=0.25, samples=8):
    normal = add_node(tree, "Bevel", {"Radius": radius}, samples=samples).outputs[0]
    return add_node(tree, "VectorMath", {0: normal, 1: (0.5,) * 3, 2: (0.5,) * 3}, operation="MULTIPLY_ADD").outputs[0]


def bevel_of_normal(tree):
    """On top of a normal that is bent already."""
    bent = add_node(tree, "NormalMap", {"Color": (0.7, 0.5, 0.8, 1.0)}, space="OBJECT").outputs[0]
    normal = add_node(tree, "Bevel", {"Radius": 0.25, "Normal": bent}, samples=8).outputs[0]
    return add_node(tree, "VectorMath", {0: normal, 1: (0.5,) * 3, 2: (0.5,) * 3}, operation="MULTIPLY_ADD").outputs[0]


def raycast(tree, output, direction=(0.3, 0.2, 0.9), reach=0.8, scale=0.5, **properties):
    where = add_node(tree, "CombineXYZ", {0: direction[0], 1: direction[1], 2: direction[2]}).outputs[0]
    node = add_node(tree, "Raycast", {"Direction": where, "Length": reach}, **properties)
    inputs = {0: node.outputs[output], 1: (scale,) * 3, 2: (0.5,) * 3}
    return add_node(tree, "VectorMath", inputs, operation="MULTIPLY_ADD").outputs[0]


CASES = {
    "Ambient Occlusion": occlusion,
    "Ambient Occlusion as a number": lambda tree: occlusion(tree, "AO", 0.5, samples=3),
    "Ambient Occlusion only_local": lambda tree: occlusion(tree, distance=2.0, only_local=True),
    "Ambient Occlusion inside": lambda tree: occlusion(tree, distance=0.6, inside=True),
    "Ambient Occlusion about a normal": occlusion_about,
    "Ambient Occlusion at the world's distance": lambda tree: occlusion(tree, distance=0.0),
    "Bevel": bevel,
    "Bevel of few samples": lambda tree: bevel(tree, 0.1, 2),
    "Bevel of a normal": bevel_of_normal,
}
if HAS_RAYCAST:
    CASES |= {
        "Raycast Is Hit": lambda tree: raycast(tree, "Is Hit"),
        "Raycast Self Hit": lambda tree: raycast(tree, "Self Hit", (0.2, -0.1, -1.0)),
        "Raycast Hit Distance": lambda tree: raycast(tree, "Hit Distance"),
        "Raycast Hit Position": lambda tree: raycast(tree, "Hit Position", scale=0.1),
        "Raycast Hit Normal": lambda tree: raycast(tree, "Hit Normal"),
        "Raycast only_local": lambda tree: raycast(tree, "Is Hit", (0.2, -0.1, -1.0), only_local=True),
    }
COLUMNS = 4
ROWS = -(-len(CASES) // COLUMNS)
STEP = 6.0  # metres from group to group, farther than any ray looks


def groups():
    scene = empty_scene()
    scene.world = bpy.data.worlds.new("World")
    scene.world.light_settings.distance = 1.5
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", COLUMNS * STEP * 0.5
    scene.camera.data.clip_end = 500.0
    tilt = math.radians(35.0)
    scene.camera.rotation_euler = (tilt, 0.0, 0.0)
    middle = np.array([COLUMNS * STEP / 4, ROWS * STEP / 4 / math.cos(tilt), 0.4])
    scene.camera.location = middle + 60.0 * np.array([0.0, -math.sin(tilt), math.cos(tilt)])
    scene.lambent.filter_type, scene.lambent.filter_width, scene.lambent.use_adaptive = "BOX", 1.0, False
    scene.cycles.pixel_filter_type = "BOX"
    bpy.ops.mesh.primitive_cube_add(size=0.9)
    cube = bpy.context.object.data
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.4)
    ball = bpy.context.object.data
    ball.shade_smooth()
    for number, (name, build) in enumerate(CASES.items()):
        b_material = shining(name, build)
        x = (number % COLUMNS + 0.5) * STEP / 2
        y = (number // COLUMNS + 0.5) * STEP / 2 / math.cos(tilt)
        for b_mesh, place in (
            (square(), (0, 0, 0)),
            (cube.copy(), (-0.45, 0.1, 0.47)),
            (ball.copy(), (0.5, -0.3, 0.4)),
        ):
            b_mesh.materials.append(b_material)
            b_object = add(name, b_mesh, location=(x + place[0], y + place[1], place[2]))
            b_object.rotation_euler = (0.0, 0.0, 0.5)
    for b_object in [o for o in bpy.data.objects if o.name in ("Cube", "Sphere")]:
        bpy.data.objects.remove(b_object)


def shining(name, build):
    b_material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0):
        b_material.use_nodes = True
    tree = b_material.node_tree
    tree.nodes.clear()
    emission = add_node(tree, "Emission", {0: build(tree)})
    tree.links.new(emission.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return b_material


def cells():
    """{case: (ours, theirs)}"""
    return cells_in_both(groups, CASES, COLUMNS, CELL, SAMPLES)


@pytest.fixture(scope="module")
def pictures():
    return cells()


def blocks(picture):
    return picture.reshape(CELL // BLOCK, BLOCK, CELL // BLOCK, BLOCK, 3).mean(axis=(1, 3))


def difference(ours, theirs):
    """Of the means over blocks of pixels."""
    return np.abs(blocks(ours) - blocks(theirs)).max()


@pytest.mark.parametrize("name", CASES)
def test_what_rays_find_is_what_they_find_in_cycles(pictures, name):
    """A block has 512 samples, of two rays at least: a deviation of 0.5 at most makes 0.016 in its mean."""
    ours, theirs = (blocks(picture) for picture in pictures[name])
    assert theirs.std() > 0.02
    assert difference(*pictures[name]) < 0.03
    assert abs((ours - theirs).mean()) < 0.002
