# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour of what glows by its heat, in a volume and by the node; both engines know it without noise."""

import functools
import math

import pytest

from blender_tests.against_cycles.test_volumes import CORNERS, FACES, PRINCIPLED, material
from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with
from blender_tests.helpers.exported import add, empty_scene, mesh

SIZE = (4, 4)


def stage(place, kelvins):
    scene = empty_scene()
    scene.camera.location, scene.camera.rotation_euler = (0, -5, 0), (math.pi / 2, 0, 0)
    scene.camera.data.angle = 0.001
    volume = surface = None
    if place == "volume":
        inputs = {"Color": (0, 0, 0, 1), "Density": 0.5, "Blackbody Intensity": 1.0, "Temperature": kelvins}
        volume = PRINCIPLED, inputs
    else:
        surface = "ShaderNodeEmission", {}
    b_material = material(surface, volume)
    if surface:
        tree = b_material.node_tree
        node = tree.nodes.new("ShaderNodeBlackbody")
        node.inputs[0].default_value = kelvins
        (shader,) = [n for n in tree.nodes if n.bl_idname == surface[0]]
        tree.links.new(node.outputs[0], shader.inputs["Color"])
    add("Box", mesh("Box", CORNERS, FACES)).data.materials.append(b_material)


@pytest.mark.parametrize("kelvins", [1200.0, 1800.0, 1950.0, 3000.0, 9000.0])
@pytest.mark.parametrize("place", ["volume", "surface"])
def test_what_glows_has_the_colour_that_it_has_in_cycles(place, kelvins):
    """Below 1900 K its blue is outside of Rec.709, and negative: the node cuts it off, a volume does not."""
    source = functools.partial(stage, place, kelvins)
    theirs = cycles_picture(source, 64, SIZE)[..., :3].astype(float).mean(axis=(0, 1))
    ours = render_with("LAMBENT", open_for_both(source, SIZE), 16)[0][..., :3].astype(float).mean(axis=(0, 1))
    assert theirs.max() > 0.0
    assert ours == pytest.approx(theirs, rel=1e-3)
