# SPDX-License-Identifier: GPL-3.0-or-later
"""Balls that their materials bump or displace, in both engines, by the light of a sun: pixel by pixel."""

import bpy
import numpy as np
import pytest

from blender_tests.helpers.engines import cells_in_both
from blender_tests.helpers.exported import add, empty_scene
from blender_tests.helpers.shader_nodes import socket

CELL, COLUMNS, ROWS = 96, 4, 2 + (bpy.app.version >= (5, 2))
BALLS = {  # name: displacement method, node, its space
    "bumped": ("BUMP", "Displacement", "OBJECT"),
    "displaced": ("DISPLACEMENT", "Displacement", "OBJECT"),
    "displaced and bumped": ("BOTH", "Displacement", "OBJECT"),
    "displaced in the world": ("DISPLACEMENT", "Displacement", "WORLD"),
    "displaced by a vector": ("DISPLACEMENT", "VectorDisplacement", "OBJECT"),
    "displaced along tangents": ("DISPLACEMENT", "VectorDisplacement", "TANGENT"),
    "bumped by a vector": ("BUMP", "VectorDisplacement", "OBJECT"),
    "displaced and flat": ("DISPLACEMENT", "Displacement", "OBJECT"),
}
MAPS = {  # strength of a normal map that is relative to the surface before; only the later Blender lets choose
    "mapped": 1.0,
    "mapped weakly": 0.4,
    "mapped strongly": 1.6,
    "mapped and flat": 0.7,
}
if bpy.app.version >= (5, 2):
    BALLS |= dict.fromkeys(MAPS, ("DISPLACEMENT", "Displacement", "OBJECT"))


def balls():
    """Stretched and turned; each point of them is lit by the sun alone, and seen by itself."""
    scene = empty_scene()
    scene.render.resolution_x, scene.render.resolution_y = COLUMNS * CELL, ROWS * CELL
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", COLUMNS
    scene.camera.location = (COLUMNS / 2, ROWS / 2, 10)
    scene.cycles.max_bounces = scene.lambent.max_bounces = 0
    scene.lambent.use_adaptive, scene.lambent.filter_type, scene.lambent.filter_width = False, "BOX", 0.01
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
    sun = add("Sun", bpy.data.lights.new("Sun", "SUN"), rotation_euler=(0.5, 0.3, 0.0))
    sun.data.energy, sun.data.angle = 3.0, 0.0
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.35)
    b_mesh = bpy.context.object.data
    b_mesh.materials.append(None)
    bpy.data.objects.remove(bpy.context.object)
    for number, (name, arguments) in enumerate(BALLS.items()):
        own = b_mesh.copy()
        if not name.endswith("flat"):
            own.shade_smooth()
        ball = add(name, own, location=(number % COLUMNS + 0.5, number // COLUMNS + 0.5, 0.0))
        ball.rotation_euler, ball.scale = (0.3, 0.2, 0.1 * number), (1.1, 0.9, 1.0)
        ball.material_slots[0].link, ball.material_slots[0].material = "OBJECT", material(name, *arguments)


def material(name, method, kind, space):
    b_material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0):
        b_material.use_nodes = True
    b_material.displacement_method = method
    tree = b_material.node_tree
    tree.nodes.clear()
    kinds = ("OutputMaterial", "BsdfDiffuse", "TexNoise", kind)
    output, diffuse, noise, moved = (tree.nodes.new(f"ShaderNode{kind}") for kind in kinds)
    moved.space = space
    socket(noise, "Scale").default_value = 4.0
    socket(moved, "Scale").default_value, socket(moved, "Midlevel").default_value = 0.12, 0.4
    tree.links.new(noise.outputs["Color"], moved.inputs[0])
    tree.links.new(moved.outputs[0], output.inputs["Displacement"])
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    if name in MAPS:
        normal_map = tree.nodes.new("ShaderNodeNormalMap")
        normal_map.base, socket(normal_map, "Strength").default_value = "ORIGINAL", MAPS[name]
        socket(normal_map, "Color").default_value = (0.7, 0.35, 0.9, 1.0)
        tree.links.new(normal_map.outputs[0], diffuse.inputs["Normal"])
    return b_material


@pytest.fixture(scope="module")
def pictures():
    """(ours, theirs) by ball."""
    return cells_in_both(balls, BALLS, COLUMNS, CELL)


@pytest.mark.parametrize("name", BALLS)
def test_a_surface_is_moved_as_in_cycles(name, pictures):
    """But for pixels at outlines and edges of shadows, which rounding decides; and of bumps those that turn away.

    Slopes of bumps are differences over a tenth of a pixel, in directions that each engine chooses.
    """
    is_bumped = BALLS[name][0] != "DISPLACEMENT"
    ours, theirs = pictures[name]
    lit = theirs.max(axis=-1) > 0.02
    assert 0.15 < lit.mean() < 0.8
    difference = np.abs(ours - theirs).max(axis=-1)[lit]
    assert np.median(difference) < (0.006 if is_bumped else 0.002)
    assert np.mean(difference > 0.05) < (0.08 if is_bumped else 0.04)


def test_balls_differ(pictures):
    """Each in its own way: what is compared shows the displacement."""
    means = [theirs for _, theirs in pictures.values()]
    for i, a in enumerate(means):
        for b in means[:i]:
            assert np.abs(a - b).mean() > 0.01
