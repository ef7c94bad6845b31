# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps with node programs light a floor as in Cycles: gobos, falloff, IES, what a lamp knows of itself."""

import math
import tempfile
from functools import partial
from pathlib import Path

import bpy
import numpy as np
import pytest

from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with

SIZE, SAMPLES = (16, 16), 512
IES = (
    "IESNA:LM-63-1995\n[TEST] made up\nTILT=NONE\n1 1000 2.0 5 3 1 2 0.1 0.1 0.1\n1.0 1.0 60\n"
    "0 20 45 70 90\n0 45 90\n900 800 500 200 0\n700 600 700 100 0\n500 900 300 50 0\n"
)
POINT = {"kind": "POINT", "shadow_soft_size": 0.1}
BALL = {"kind": "POINT", "shadow_soft_size": 0.5, "use_soft_falloff": False}
SPOT = {"kind": "SPOT", "shadow_soft_size": 0.0, "spot_size": 1.2, "spot_blend": 0.3}
AREA = {"kind": "AREA", "shape": "RECTANGLE", "size": 0.4, "size_y": 0.8}
SUN = {"kind": "SUN", "angle": 0.6, "energy": 1.0}
TURNED = {"rotation_euler": (0.4, 0.3, 0.8)}


def colour(tree, output):
    """Bright and positive: half of it plus a half."""
    add = tree.nodes.new("ShaderNodeVectorMath")
    add.operation = "MULTIPLY_ADD"
    add.inputs[1].default_value, add.inputs[2].default_value = (0.5,) * 3, (0.6,) * 3
    tree.links.new(output, add.inputs[0])
    return add.outputs[0]


def coordinate(name):
    return lambda tree: colour(tree, tree.nodes.new("ShaderNodeTexCoord").outputs[name])


def geometry(name):
    return lambda tree: colour(tree, tree.nodes.new("ShaderNodeNewGeometry").outputs[name])


def falloff(name, smooth=0.0):
    def build(tree):
        node = tree.nodes.new("ShaderNodeLightFalloff")
        node.inputs["Strength"].default_value, node.inputs["Smooth"].default_value = 0.7, smooth
        return node.outputs[name]

    return build


def checker(tree):
    coordinates, texture = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeTexChecker")
    texture.inputs["Scale"].default_value = 4.0
    texture.inputs["Color1"].default_value, texture.inputs["Color2"].default_value = (1, 0.2, 0, 1), (0, 0.3, 1, 1)
    tree.links.new(coordinates.outputs["UV"], texture.inputs["Vector"])
    return texture.outputs["Color"]


def luminaire(tree):
    node = tree.nodes.new("ShaderNodeTexIES")
    node.ies = bpy.data.texts.new("lamp.ies")
    node.ies.write(IES)
    return node.outputs[0]


def luminaire_of_a_file(tree):
    path = Path(tempfile.gettempdir(), "lambent_test.ies")
    path.write_text(IES, encoding="ascii")
    node = tree.nodes.new("ShaderNodeTexIES")
    node.mode, node.filepath = "EXTERNAL", str(path)
    return node.outputs[0]


def blackbody(tree):
    node = tree.nodes.new("ShaderNodeBlackbody")
    node.inputs[0].default_value = 3000
    return node.outputs[0]


def about_the_object(tree):
    return colour(tree, tree.nodes.new("ShaderNodeObjectInfo").outputs["Color"])


CASES = {
    "point, normal": (POINT | TURNED, coordinate("Normal")),
    "point, UV": (POINT | TURNED, coordinate("UV")),
    "point, object": (POINT | TURNED | {"scale": (1, 2, 3)}, coordinate("Object")),
    "point, generated": (POINT | TURNED, coordinate("Generated")),
    "point, position": (POINT | TURNED, geometry("Position")),
    "point, incoming": (POINT, geometry("Incoming")),
    "ball, normal": (BALL | TURNED, coordinate("Normal")),
    "ball, UV": (BALL | TURNED, coordinate("UV")),
    "spot, UV": (SPOT, coordinate("UV")),
    "spot, a gobo": (SPOT | {"rotation_euler": (0.2, 0.1, 0.5)}, checker),
    "wide spot, normal": (SPOT | TURNED, coordinate("Normal")),
    "area, UV": (AREA, coordinate("UV")),
    "area, a checker": (AREA | {"rotation_euler": (0.3, 0.2, 0.4)}, checker),
    "area, object": (AREA | TURNED, coordinate("Object")),
    "area, normal": (AREA | TURNED, coordinate("Normal")),
    "disk, UV": (AREA | {"shape": "DISK"}, coordinate("UV")),
    "sun, UV": (SUN | {"rotation_euler": (0.3, 0.1, 0.4)}, coordinate("UV")),
    "sun, normal": (SUN | {"rotation_euler": (0.3, 0.1, 0.4)}, coordinate("Normal")),
    "linear falloff": (POINT, falloff("Linear")),
    "constant falloff": (POINT, falloff("Constant")),
    "smooth falloff": (POINT, falloff("Quadratic", 2.0)),
    "smooth linear falloff": (SPOT, falloff("Linear", 1.0)),
    "IES": (POINT | {"energy": 0.3}, luminaire),
    "IES, turned": (SPOT | TURNED | {"energy": 0.3}, luminaire),
    "IES of a file": (POINT | {"energy": 0.3}, luminaire_of_a_file),
    "blackbody": (POINT, blackbody),
    "object info": (POINT, about_the_object),
}


def lamp_scene(name, look_at_lamp):
    """A lamp 2 m above a white floor; the camera sees 3 m of the floor, or the lamp from below."""
    properties, build = CASES[name]
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=20)
    floor = bpy.data.materials.new("Floor")
    use_nodes(floor)
    tree = floor.node_tree
    tree.nodes.clear()
    diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    bpy.context.object.data.materials.append(floor)

    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", properties["kind"]))
    scene.collection.objects.link(lamp)
    lamp.location, lamp.visible_camera, lamp.color = (0.2, -0.1, 2), look_at_lamp, (0.2, 0.8, 0.4, 1)
    lamp.data.energy = 30
    for key, value in properties.items():
        if key != "kind":
            setattr(lamp if key in ("scale", "rotation_euler") else lamp.data, key, value)
    use_nodes(lamp.data)
    tree = lamp.data.node_tree
    emission = next(n for n in tree.nodes if n.type == "EMISSION")
    tree.links.new(build(tree), emission.inputs["Color"])

    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    if look_at_lamp:
        camera.data.lens, camera.location, camera.rotation_euler = 50, (0, 0, 0.2), (math.pi, 0, 0)
    else:
        camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 3, (0, 0, 5)


def use_nodes(b_owner):
    if bpy.app.version < (5, 0):  # later ones always do
        b_owner.use_nodes = True


def pictures(name, look_at_lamp):
    """(Lambent's, Cycles') radiance, (height, width, 3) each."""
    build = partial(lamp_scene, name, look_at_lamp)
    theirs = cycles_picture(build, SAMPLES, SIZE)
    ours, _ = render_with("LAMBENT", open_for_both(build, SIZE), SAMPLES)
    return ours[..., :3].astype(float), theirs[..., :3].astype(float)


@pytest.mark.parametrize("name", CASES)
def test_a_lamp_with_nodes_lights_the_floor_as_in_cycles(name):
    ours, theirs = pictures(name, look_at_lamp=False)
    assert theirs.mean() > 1e-3
    assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=0.01, abs=2e-3 * theirs.mean())
    assert abs(ours - theirs).max() < 0.06 * theirs.max()
    assert abs(ours - theirs).mean() < 0.01 * theirs.mean()


@pytest.mark.parametrize("name", ["point, normal", "ball, UV", "area, a checker", "disk, UV"])
def test_a_lamp_with_nodes_looks_as_in_cycles(name):
    ours, theirs = pictures(name, look_at_lamp=True)
    assert theirs.max() > 1e-3
    assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=0.01)
    assert np.quantile(abs(ours - theirs), 0.9) < 0.02 * theirs.max()
