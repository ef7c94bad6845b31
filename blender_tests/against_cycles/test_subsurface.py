# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that walks below surfaces: balls of every method, near and far, in both engines."""

import bpy
import numpy as np
from scipy.stats import ttest_ind

from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with
from blender_tests.helpers.exported import add, empty_scene
from blender_tests.helpers.shader_nodes import socket

CELL, SEEDS, SAMPLES = 16, 8, 64
COLUMNS, ROWS = 4, 3
SUBSURFACE, PRINCIPLED = "ShaderNodeSubsurfaceScattering", "ShaderNodeBsdfPrincipled"
BASE = {"Color": (0.8, 0.5, 0.2, 1.0), "Radius": (1.0, 0.5, 0.2), "Scale": 0.2}
WEIGHTED = {"Base Color": (0.8, 0.5, 0.2, 1.0), "Subsurface Radius": (1.0, 0.5, 0.2), "Subsurface Scale": 0.2}
BALLS = (  # node, method, inputs
    (SUBSURFACE, "RANDOM_WALK", {}),
    (SUBSURFACE, "RANDOM_WALK", {"Anisotropy": 0.5}),
    (SUBSURFACE, "RANDOM_WALK", {"Anisotropy": -0.5, "IOR": 1.8, "Roughness": 0.1}),
    (SUBSURFACE, "RANDOM_WALK", {"Scale": 2.0}),
    (SUBSURFACE, "RANDOM_WALK_SKIN", {}),
    (SUBSURFACE, "RANDOM_WALK_SKIN", {"Anisotropy": 0.5, "Scale": 1.0}),
    (SUBSURFACE, "RANDOM_WALK_LEGACY", {}),
    (SUBSURFACE, "RANDOM_WALK_LEGACY", {"Anisotropy": 0.5, "Scale": 1.0}),
    (PRINCIPLED, "RANDOM_WALK", {"Subsurface Weight": 1.0, "Subsurface Anisotropy": 0.3}),
    (PRINCIPLED, "RANDOM_WALK", {"Subsurface Weight": 0.5, "Roughness": 0.2}),
    (PRINCIPLED, "RANDOM_WALK_SKIN", {"Subsurface Weight": 1.0, "Subsurface IOR": 1.8}),
    (PRINCIPLED, "RANDOM_WALK", {"Subsurface Weight": 0.7, "Coat Weight": 0.5}),
)


def balls():
    """A sheet of balls, in grey light from everywhere and in the sun."""
    scene = empty_scene()
    scene.render.resolution_x, scene.render.resolution_y = COLUMNS * CELL, ROWS * CELL
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", COLUMNS
    scene.camera.location = (COLUMNS / 2, ROWS / 2, 10)
    scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0):
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    sun = add("Sun", bpy.data.lights.new("Sun", "SUN"), rotation_euler=(0.8, 0.5, 0.0))
    sun.data.energy, sun.data.angle = 2.0, 0.3
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=0.42)
    b_mesh = bpy.context.object.data
    b_mesh.shade_smooth()
    bpy.data.objects.remove(bpy.context.object)
    b_mesh.materials.append(None)
    for number, (kind, method, inputs) in enumerate(BALLS):
        ball = add(f"Ball {number}", b_mesh, location=(number % COLUMNS + 0.5, number // COLUMNS + 0.5, 0.0))
        ball.material_slots[0].link, ball.material_slots[0].material = "OBJECT", material(kind, method, inputs)


def material(kind, method, inputs):
    b_material = bpy.data.materials.new(method)
    if bpy.app.version < (5, 0):
        b_material.use_nodes = True
    tree = b_material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    setting = "falloff" if kind == SUBSURFACE else "subsurface_method"
    if method not in node.bl_rna.properties[setting].enum_items:
        method = "RANDOM_WALK"  # Blender 4 has no other one of that name
    setattr(node, setting, method)
    for name, value in {**(BASE if kind == SUBSURFACE else WEIGHTED), **inputs}.items():
        socket(node, name).default_value = value
    return b_material


def blocks(picture):
    """Means over 4 x 4 pixels."""
    height, width = picture.shape[:2]
    return picture[..., :3].reshape(height // 4, 4, width // 4, 4, 3).mean(axis=(1, 3))


def test_light_below_surfaces_is_that_of_cycles():
    """Welch's t-test for each block and colour, and the mean of each ball within its noise."""
    size = (COLUMNS * CELL, ROWS * CELL)
    theirs = np.array([blocks(cycles_picture(balls, SAMPLES, size, seed)) for seed in range(SEEDS)], float)
    scene = open_for_both(balls, size)
    ours = np.array([blocks(render_with("LAMBENT", scene, SAMPLES, seed)[0]) for seed in range(SEEDS)], float)

    noisy = ours.std(axis=0) + theirs.std(axis=0) > 1e-4
    assert noisy.mean() > 0.5
    p = ttest_ind(ours, theirs, equal_var=False).pvalue[noisy]
    assert (p < 0.01).mean() < 0.025
    assert p.min() > 1e-3 / len(p)
    for number, ball in enumerate(BALLS):
        row, column = divmod(number, COLUMNS)
        part = np.s_[:, 4 * row : 4 * row + 4, 4 * column : 4 * column + 4]
        means = [pictures[part].mean(axis=(1, 2)) for pictures in (ours, theirs)]
        error = np.sqrt(sum(m.var(axis=0, ddof=1) / SEEDS for m in means))
        difference = np.abs(means[0].mean(axis=0) - means[1].mean(axis=0))
        assert (difference < 5.0 * error + 0.005).all(), ball
