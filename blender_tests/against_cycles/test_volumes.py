# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes in both engines: smoke, fog, what is coloured inside, and what glows."""

import functools

import bpy
import numpy as np
import pytest
from mathutils import Vector
from scipy.stats import ttest_ind

from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import enable_engines, open_for_both, render_with, set_alike
from blender_tests.helpers.exported import add, empty_scene, mesh, square
from blender_tests.helpers.shader_nodes import socket

SIZE, BLOCK, SEEDS, SAMPLES = (24, 24), 8, 8, 64
SCATTER, ABSORPTION, PRINCIPLED = "ShaderNodeVolumeScatter", "ShaderNodeVolumeAbsorption", "ShaderNodeVolumePrincipled"
CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


# ---- The scenes ------------------------------------------------------------------------------------------------------


def smoke_box():
    box("Smoke", material(volume=(SCATTER, {"Color": (0.9, 0.7, 0.5, 1.0), "Density": 0.8})))


def smoke_that_scatters_forward():
    box("Smoke", material(volume=(SCATTER, {"Density": 1.0, "Anisotropy": 0.7})))


def coloured_ball():
    ball("Ball", material(volume=(ABSORPTION, {"Color": (0.9, 0.5, 0.1, 1.0), "Density": 1.5})))


def camera_in_a_box_of_fog():
    box("Fog", material(volume=(SCATTER, {"Color": (0.6, 0.7, 0.9, 1.0), "Density": 0.15})), scale=9.0)
    ball("Ball", material(("ShaderNodeBsdfDiffuse", {"Color": (0.8, 0.3, 0.2, 1.0)})))


def fog_everywhere():
    world = bpy.context.scene.world.node_tree
    world.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    fill(world, "World", (SCATTER, {"Color": (0.8, 0.8, 0.6, 1.0), "Density": 0.1, "Anisotropy": 0.3}))
    ball("Ball", material(("ShaderNodeBsdfDiffuse", {"Color": (0.3, 0.8, 0.2, 1.0)})))


def smoke_within_fog():
    box("Fog", material(volume=(SCATTER, {"Color": (0.5, 0.6, 0.9, 1.0), "Density": 0.1})), scale=3.0)
    box("Smoke", material(volume=(SCATTER, {"Color": (0.9, 0.5, 0.3, 1.0), "Density": 1.5})))


def glass_that_is_coloured_inside():
    glass = "ShaderNodeBsdfGlass", {"Roughness": 0.0, "IOR": 1.4}
    ball("Ball", material(glass, (ABSORPTION, {"Color": (0.2, 0.6, 0.9, 1.0), "Density": 1.0})))


def fire():
    inputs = {"Color": (0.5, 0.5, 0.5, 1.0), "Density": 0.5, "Blackbody Intensity": 0.03, "Temperature": 3000.0}
    inputs |= {"Emission Strength": 0.1, "Emission Color": (0.2, 0.4, 1.0, 1.0), "Absorption Color": (0.5, 0.3, 0.1, 1)}
    box("Fire", material(volume=(PRINCIPLED, inputs)))


SCENES = (
    smoke_box,
    smoke_that_scatters_forward,
    coloured_ball,
    camera_in_a_box_of_fog,
    fog_everywhere,
    smoke_within_fog,
    glass_that_is_coloured_inside,
    fire,
)


def stage(name):
    """A floor in grey light from everywhere and that of a lamp, with what `name` of SCENES puts there."""
    scene = empty_scene()
    enable_engines()
    scene.lambent.max_bounces, scene.lambent.volume_bounces = 8, 4
    set_alike(scene)
    scene.camera.location = (0.5, -7.0, 3.5)
    scene.camera.rotation_euler = (Vector((0, 0, 0.8)) - scene.camera.location).to_track_quat("-Z", "Y").to_euler()
    scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0):
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.3, 0.3, 0.3, 1.0)
    lamp = add("Lamp", bpy.data.lights.new("Lamp", "POINT"), location=(-2.0, 1.5, 4.0))
    lamp.data.energy, lamp.data.shadow_soft_size = 400.0, 0.5
    add("Floor", square(), scale=(12, 12, 1)).data.materials.append(
        material(("ShaderNodeBsdfDiffuse", {"Color": (0.7, 0.7, 0.7, 1.0)}))
    )
    globals()[name]()


def box(name, b_material, scale=1.0):
    """A box that is sunk into the floor a little: where both lie in one plane, Cycles loses light."""
    b_object = add(name, mesh(name, CORNERS, FACES), scale=(scale,) * 3, location=(0, 0, scale - 0.01))
    b_object.data.materials.append(b_material)


def ball(name, b_material):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1.0, location=(0, 0, 1.1))
    bpy.context.object.data.shade_smooth()
    bpy.context.object.data.materials.append(b_material)


def material(surface=None, volume=None):
    """Of nodes (kind, inputs)."""
    b_material = bpy.data.materials.new("Material")
    if bpy.app.version < (5, 0):
        b_material.use_nodes = True
    b_material.node_tree.nodes.clear()
    b_material.node_tree.nodes.new("ShaderNodeOutputMaterial")
    for place, node in (("Surface", surface), ("Volume", volume)):
        if node:
            fill(b_material.node_tree, "Material", node, place)
    return b_material


def fill(tree, owner, node, place="Volume"):
    """Link a new node to the output."""
    (output,) = [n for n in tree.nodes if n.bl_idname == f"ShaderNodeOutput{owner}"]
    kind, inputs = node
    b_node = tree.nodes.new(kind)
    for name, value in inputs.items():
        socket(b_node, name).default_value = value
    tree.links.new(b_node.outputs[0], output.inputs[place])


# ---- The comparison --------------------------------------------------------------------------------------------------


def blocks(picture):
    height, width = picture.shape[:2]
    return picture[..., :3].reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).mean(axis=(1, 3))


@pytest.mark.parametrize("name", [function.__name__ for function in SCENES])
def test_volumes_are_those_of_cycles(name):
    """Welch's t-test for each block and colour, and for the whole picture, over seeds."""
    source = functools.partial(stage, name)
    theirs = np.array([blocks(cycles_picture(source, SAMPLES, SIZE, seed)) for seed in range(SEEDS)], float)
    scene = open_for_both(source, SIZE)
    ours = np.array([blocks(render_with("LAMBENT", scene, SAMPLES, seed)[0]) for seed in range(SEEDS)], float)
    error = np.sqrt((ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / SEEDS)
    assert (error < 0.05 * theirs.mean(axis=0)).all()
    p = ttest_ind(ours, theirs, equal_var=False).pvalue
    p_whole = ttest_ind(ours.mean(axis=(1, 2)), theirs.mean(axis=(1, 2)), equal_var=False).pvalue
    assert p.min() > 1e-5
    assert p_whole.min() > 1e-5
