# SPDX-License-Identifier: GPL-3.0-or-later
"""What shines through the layers of a Principled BSDF, and through its thin walls: as much as in Cycles."""

import tempfile
from pathlib import Path

import bpy
import numpy as np
import pytest
from scipy.stats import ttest_ind

from blender_tests.helpers.cycles import cycles_picture, set_up_cycles
from blender_tests.helpers.engines import enable_engines, open_for_both, render_with
from blender_tests.helpers.exported import add, empty_scene, square
from blender_tests.helpers.lobe_values import node, values_of_engines
from blender_tests.helpers.small_blend import render

COSINES = (1.0, 0.8, 0.5, 0.2)
TINT = (0.3, 0.7, 1.0, 1.0)
SHINING = {"Emission Color": (1.0, 0.6, 0.3, 1.0), "Emission Strength": 2.0, "Base Color": (0.0, 0.0, 0.0, 1.0)}
LAYERS = {
    "nothing": {},
    "coat": {"Coat Weight": 1.0, "Coat Roughness": 0.1},
    "half a rough coat": {"Coat Weight": 0.5, "Coat Roughness": 0.6, "Coat IOR": 2.2},
    "tinted coat": {"Coat Weight": 0.8, "Coat Tint": TINT, "Coat IOR": 1.7},
    "sheen": {"Sheen Weight": 1.0, "Sheen Roughness": 0.4},
    "tinted sheen": {"Sheen Weight": 0.7, "Sheen Tint": TINT},
    "both": {"Sheen Weight": 0.6, "Coat Weight": 0.7, "Coat Roughness": 0.3},
    "half there": {"Coat Weight": 1.0, "Alpha": 0.4},
}


def bent(closure, normal=(0.3, -0.2, 0.93)):
    def add_node(tree):
        output = closure(tree)
        vector = tree.nodes.new("ShaderNodeCombineXYZ")
        for value, slot in zip(normal, vector.inputs, strict=True):
            slot.default_value = value
        tree.links.new(vector.outputs[0], output.node.inputs["Coat Normal"])
        return output

    return add_node


@pytest.fixture(scope="module")
def emitted():
    """{name: (Lambent's radiance, Cycles'), (cosines, 3)}, in the dark."""
    enable_engines()
    closures = {name: node("Principled", **SHINING, **inputs) for name, inputs in LAYERS.items()}
    closures["bent coat"] = bent(node("Principled", **SHINING, **LAYERS["coat"]))
    ours, theirs = values_of_engines(list(closures.values()), COSINES, [(0.0, 0.0, -1.0)], ["LAMBENT", "CYCLES"])
    return {name: (ours[0, row], theirs[0, row]) for row, name in enumerate(closures)}


@pytest.mark.parametrize("name", [*LAYERS, "bent coat"])
def test_a_surface_shines_through_its_layers_as_in_cycles(emitted, name):
    ours, theirs = emitted[name]
    bare = np.array(SHINING["Emission Color"][:3]) * SHINING["Emission Strength"]
    assert (theirs < 0.97 * bare).any() or name == "nothing"
    np.testing.assert_allclose(ours, theirs, rtol=5e-3)  # tables of energy


PANES = {
    "clear": {},
    "dark": {"Base Color": TINT},
    "dense": {"IOR": 2.4, "Specular Tint": TINT},
    "half of it": {"Alpha": 0.5},
    "part glass": {"Transmission Weight": 0.6, "Base Color": TINT},
    "varnished": {"Coat Weight": 0.8, "Sheen Weight": 0.3, "Coat Tint": TINT},
    "with a film": {"Thin Film Thickness": 400.0},
    "frosted": {"Roughness": 0.5},
}


def pane(inputs):
    b_mesh, material = square("Pane"), bpy.data.materials.new("Pane")
    principled = material.node_tree.nodes["Principled BSDF"]
    for name, value in {"Transmission Weight": 1.0, "Thin Wall": True, "Roughness": 0.0, **inputs}.items():
        principled.inputs[name].default_value = value
    b_mesh.materials.append(material)
    return b_mesh


def shadows():
    """Each pane is beside the picture, between the sun and its part of a floor."""
    scene = empty_scene()
    scene.render.resolution_x, scene.render.resolution_y = 4 * len(PANES), 4
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", len(PANES)
    scene.camera.location = (len(PANES) / 2, 0.5, 10.0)
    add("Floor", square("Floor"), scale=(100.0, 100.0, 1.0))
    sun = add("Sun", bpy.data.lights.new("Sun", "SUN"), rotation_euler=(0.8, 0.0, 0.0))
    sun.data.angle = 0.0
    for number, inputs in enumerate(PANES.values()):
        add(f"Pane {number}", pane(inputs), location=(number + 0.5, 0.5 - 5 * np.tan(0.8), 5.0), scale=(0.5, 0.5, 1.0))
    return scene


@pytest.mark.skipif(bpy.app.version < (5, 2), reason="it has no thin walls")
def test_light_gets_through_panes_as_in_cycles():
    enable_engines()
    scene = shadows()
    set_up_cycles(scene, samples=4)
    scene.cycles.max_bounces = scene.lambent.max_bounces = 0
    scene.lambent.samples = 4
    with tempfile.TemporaryDirectory() as folder:
        theirs = render(Path(folder, "cycles.exr"), scene)
        scene.render.engine = "LAMBENT"
        ours = render(Path(folder, "lambent.exr"), scene)
    for number, name in enumerate(PANES):
        middle = np.s_[1:3, 4 * number + 1 : 4 * number + 3, :3]
        assert (theirs[middle].max() > 0.01) == (name != "frosted")
        np.testing.assert_allclose(ours[middle], theirs[middle], rtol=3e-3, atol=1e-5, err_msg=name)


def room():
    """A floor below a pane below a lamp that rays may find, too; the pane is in the picture as well."""
    scene = empty_scene()
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 4.0
    scene.camera.location, scene.camera.rotation_euler = (0.0, -8.0, 3.0), (1.3, 0.0, 0.0)
    add("Floor", square("Floor"), scale=(4.0, 4.0, 1.0))
    add("Pane", pane({"Base Color": TINT}), location=(0.0, 0.0, 1.0))
    lamp = square("Lamp")
    lamp.materials.append(bpy.data.materials.new("Lamp"))
    tree = lamp.materials[0].node_tree
    tree.nodes["Principled BSDF"].inputs["Emission Strength"].default_value = 5.0
    tree.nodes["Principled BSDF"].inputs["Coat Weight"].default_value = 1.0
    add("Lamp", lamp, location=(0.0, 0.0, 2.2), rotation_euler=(np.pi, 0.0, 0.0), scale=(0.8, 0.8, 1.0))


@pytest.mark.skipif(bpy.app.version < (5, 2), reason="it has no thin walls")
def test_light_is_not_counted_twice_behind_a_pane():
    """Welch's t-test of blocks of pixels."""
    size, samples, seeds = (24, 16), 64, 6
    theirs = np.array([blocks(cycles_picture(room, samples, size, seed)) for seed in range(seeds)], float)
    scene = open_for_both(room, size)
    ours = np.array([blocks(render_with("LAMBENT", scene, samples, seed)[0]) for seed in range(seeds)], float)

    noisy = ours.std(axis=0) + theirs.std(axis=0) > 1e-4
    assert noisy.mean() > 0.3
    assert ttest_ind(ours, theirs, equal_var=False).pvalue[noisy].min() > 1e-3 / noisy.sum()
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.01)


def blocks(picture):
    height, width = picture.shape[:2]
    return picture[..., :3].reshape(height // 4, 4, width // 4, 4, 3).mean(axis=(1, 3))
