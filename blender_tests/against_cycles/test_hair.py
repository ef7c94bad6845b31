# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair looks as in Cycles: a tuft of strands."""

import functools
import math

import bpy
import numpy as np
import pytest

from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with
from blender_tests.helpers.exported import add, empty_scene

SIZE, SEEDS, SAMPLES = (32, 32), 8, 64


def tuft(model="CHIANG"):
    """Strands on a ball of the air, in grey light from everywhere and in the sun."""
    scene = empty_scene()
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 4.0
    scene.camera.location = (0, 0, 10)
    scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0):
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.3, 0.3, 0.3, 1.0)
    sun = add("Sun", bpy.data.lights.new("Sun", "SUN"), rotation_euler=(0.8, 0.5, 0.0))
    sun.data.energy, sun.data.angle = 3.0, 0.3
    random, t = np.random.default_rng(3), np.linspace(0.0, 1.0, 5)
    root = random.normal(size=(120, 3))
    root /= np.linalg.norm(root, axis=1, keepdims=True)
    bend = random.normal(size=(120, 3))[:, None] * t[:, None] ** 2
    keys = root[:, None] * (0.3 + 1.2 * t[:, None]) + 0.3 * bend
    b_curves = bpy.data.hair_curves.new("Tuft")
    b_curves.add_curves([len(t)] * len(root))
    b_curves.attributes["position"].data.foreach_set("vector", keys.astype(np.float32).ravel())
    radii = b_curves.attributes.new("radius", "FLOAT", "POINT")
    radii.data.foreach_set("value", np.tile(np.float32(0.05 - 0.03 * t), len(root)))
    b_curves.materials.append(_coloured_hair(model))
    add("Tuft", b_curves)


def _coloured_hair(model):
    """Redder towards the tips, and of several shades."""
    b_material = bpy.data.materials.new("Hair")
    if bpy.app.version < (5, 0):
        b_material.use_nodes = True
    tree = b_material.node_tree
    tree.nodes.clear()
    info, mix = tree.nodes.new("ShaderNodeHairInfo"), tree.nodes.new("ShaderNodeCombineColor")
    hair, output = tree.nodes.new("ShaderNodeBsdfHairPrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
    mix.inputs[1].default_value, hair.inputs["Random Roughness"].default_value = 0.4, 0.5
    hair.model = model
    next(s for s in hair.inputs if s.identifier == "Aspect Ratio").default_value = 1.0
    tree.links.new(info.outputs["Intercept"], mix.inputs[0])
    tree.links.new(info.outputs["Random"], mix.inputs[2])
    tree.links.new(mix.outputs[0], hair.inputs["Color"])
    tree.links.new(hair.outputs[0], output.inputs["Surface"])
    return b_material


@pytest.mark.parametrize(("model", "tolerance"), [("CHIANG", 0.01), ("HUANG", 0.02)])
def test_a_tuft_is_as_bright_as_in_cycles(model, tolerance):
    """The mean over the picture, by colour, but for what strands of a finite width differ from ribbons.

    Of Huang's model Cycles evaluates another sum of what is reflected often than it samples.
    """
    build = functools.partial(tuft, model)
    theirs = np.array([cycles_picture(build, SAMPLES, SIZE, seed)[..., :3].mean(axis=(0, 1)) for seed in range(SEEDS)])
    scene = open_for_both(build, SIZE)
    ours = [render_with("LAMBENT", scene, SAMPLES, seed)[0][..., :3].mean(axis=(0, 1)) for seed in range(SEEDS)]
    ours = np.array(ours)
    error = np.sqrt((ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / SEEDS)
    assert math.isfinite(ours.sum())
    assert (np.abs(ours.mean(axis=0) - theirs.mean(axis=0)) < 5.0 * error + tolerance * theirs.mean(axis=0)).all()
