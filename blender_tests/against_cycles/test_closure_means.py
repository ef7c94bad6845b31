# SPDX-License-Identifier: GPL-3.0-or-later
"""How bright balls of every closure are: by the mean and a Z-test the same as in Cycles.

`test_closures.py` compares values for pairs of directions. This is about the rest: how directions are drawn, and how
paths that go on through and below surfaces are weighed, in light from a sky and a sun.
"""

import functools
from typing import NamedTuple

import bpy
import numpy as np
import pytest

from blender_tests.against_cycles import test_closures
from blender_tests.against_cycles.test_closures import COLOR, TINT, principled
from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with
from blender_tests.helpers.exported import add, empty_scene
from blender_tests.helpers.lobe_values import node

CELL, SAMPLES, SEEDS = 12, 32, 6
CASES = {name: case for name, case in test_closures.CASES.items() if "bent" not in name and "stretched" not in name}
CASES |= {
    "Diffuse": node("Diffuse", Color=COLOR),
    "Diffuse rough": node("Diffuse", Color=COLOR, Roughness=0.8),
    "Translucent": node("Translucent", Color=COLOR),
    "Transparent": node("Transparent", Color=COLOR),
    "Sheen": node("Sheen", Color=COLOR, Roughness=0.5),
    "Sheen ASHIKHMIN": node("Sheen", {"distribution": "ASHIKHMIN"}, Color=COLOR, Roughness=0.5),
    "Toon DIFFUSE": node("Toon", Color=COLOR, Size=0.7, Smooth=0.3),
    "Toon GLOSSY": node("Toon", {"component": "GLOSSY"}, Color=COLOR, Size=0.4, Smooth=0.3),
    "Glossy ASHIKHMIN_SHIRLEY": node("Glossy", {"distribution": "ASHIKHMIN_SHIRLEY"}, Color=COLOR, Roughness=0.4),
    "Glossy smooth": node("Glossy", Color=COLOR, Roughness=0.0),
    "Glass smooth": node("Glass", Color=COLOR, Roughness=0.0, IOR=1.4),
    "Principled emission": principled(Emission_Color=TINT, Emission_Strength=0.5, Coat_Weight=1.0, Coat_Tint=TINT),
    "Principled subsurface": principled(Subsurface_Weight=1.0, Subsurface_Scale=0.1),
}
COLUMNS = int(np.ceil(np.sqrt(len(CASES))))


class Means(NamedTuple):
    """Of a ball, over its pixels: by seed and colour, (SEEDS, 3)."""

    ours: np.ndarray
    theirs: np.ndarray

    def z(self):
        """By how many standard errors they differ, for each colour."""
        error = np.sqrt((self.ours.var(axis=0, ddof=1) + self.theirs.var(axis=0, ddof=1)) / SEEDS)
        return (self.ours.mean(axis=0) - self.theirs.mean(axis=0)) / np.maximum(error, 1e-6)


def balls(names):
    """One for each case, of a mesh that they share, below a sky that is brighter towards one side."""
    scene = empty_scene()
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", COLUMNS
    scene.camera.location = (COLUMNS / 2, COLUMNS / 2, 10)
    scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0):
        scene.world.use_nodes = True
    tree = scene.world.node_tree
    coordinates, ramp = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeVectorMath")
    ramp.operation = "MULTIPLY_ADD"
    ramp.inputs[1].default_value, ramp.inputs[2].default_value = (0.3, 0.2, 0.1), (0.4, 0.4, 0.5)
    tree.links.new(coordinates.outputs["Generated"], ramp.inputs[0])
    tree.links.new(ramp.outputs[0], tree.nodes["Background"].inputs["Color"])
    sun = add("Sun", bpy.data.lights.new("Sun", "SUN"), rotation_euler=(0.6, 0.4, 0.0))
    sun.data.energy, sun.data.angle = 1.5, 0.5
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=0.4)
    ball = bpy.context.object.data
    ball.shade_smooth()
    ball.materials.append(None)
    bpy.data.objects.remove(bpy.context.object)
    for number, name in enumerate(names):
        row, column = divmod(number, COLUMNS)
        b_object = add(name, ball, location=(column + 0.5, row + 0.5, 0.0))
        material = bpy.data.materials.new(name)
        if bpy.app.version < (5, 0):
            material.use_nodes = True
        b_object.material_slots[0].link = "OBJECT"
        b_object.material_slots[0].material = material
        tree = material.node_tree
        tree.nodes.clear()
        tree.links.new(CASES[name](tree), tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])


def means():
    """{name: Means}"""
    build = functools.partial(balls, tuple(CASES))
    size = (COLUMNS * CELL, COLUMNS * CELL)
    theirs = [in_cells(cycles_picture(build, SAMPLES, size, seed)) for seed in range(SEEDS)]
    scene = open_for_both(build, size)
    ours = [in_cells(render_with("LAMBENT", scene, SAMPLES, seed)[0]) for seed in range(SEEDS)]
    ours, theirs = np.array(ours, float), np.array(theirs, float)
    return {name: Means(ours[:, number], theirs[:, number]) for number, name in enumerate(CASES)}


def in_cells(picture):
    """Means over the cells, (COLUMNS^2, 3)."""
    return picture[..., :3].reshape(COLUMNS, CELL, COLUMNS, CELL, 3).mean(axis=(1, 3)).reshape(-1, 3)


@pytest.fixture(scope="module")
def found():
    return means()


@pytest.mark.parametrize("name", CASES)
def test_a_ball_is_as_bright_as_in_cycles(found, name):
    """Six standard errors beside 1 %, which tables of energy are good for."""
    ours, theirs = found[name]
    difference = np.abs(ours.mean(axis=0) - theirs.mean(axis=0))
    error = difference / np.maximum(np.abs(found[name].z()), 1e-6)
    assert (difference < 6.0 * error + 0.01 * theirs.mean(axis=0)).all(), found[name].z()
