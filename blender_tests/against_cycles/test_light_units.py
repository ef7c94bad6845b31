# SPDX-License-Identifier: GPL-3.0-or-later
"""A lamp of the same settings is as bright as in Cycles: on a floor that it lights, and looked at."""

import math
from functools import partial

import bpy
import numpy as np
import pytest

from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with

SIZE, SAMPLES = (16, 16), 1024
TOLERANCE = 0.005

POINTS = {
    "point": ("POINT", {"shadow_soft_size": 0.0}),
    "soft point": ("POINT", {"shadow_soft_size": 0.5}),
    "ball": ("POINT", {"shadow_soft_size": 0.5, "use_soft_falloff": False}),
    "scaled ball": ("POINT", {"shadow_soft_size": 0.5, "use_soft_falloff": False, "scale": (2, 3, 0.5)}),
    "point by exitance": ("POINT", {"shadow_soft_size": 0.0, "normalize": False}),
    "soft point by exitance": ("POINT", {"shadow_soft_size": 0.3, "normalize": False}),
    "ball by exitance": ("POINT", {"shadow_soft_size": 0.3, "use_soft_falloff": False, "normalize": False}),
    "exposed": ("POINT", {"exposure": 1.5, "color": (0.2, 0.5, 1.0)}),
    "warm": ("POINT", {"use_temperature": True, "temperature": 2500}),
    "with nodes": ("POINT", {"node_strength": 2.5}),
}
SPOTS = {
    "spot": ("SPOT", {"shadow_soft_size": 0.0, "spot_size": 0.9, "spot_blend": 0.5}),
    "sharp spot": ("SPOT", {"shadow_soft_size": 0.0, "spot_size": 0.9, "spot_blend": 0.0}),
    "blended spot": ("SPOT", {"shadow_soft_size": 0.0, "spot_size": 1.2, "spot_blend": 1.0}),
    "wide spot": ("SPOT", {"shadow_soft_size": 0.0, "spot_size": 3.0, "spot_blend": 0.15}),
    "soft spot": ("SPOT", {"shadow_soft_size": 0.4, "spot_size": 1.0}),
    "round spot": ("SPOT", {"shadow_soft_size": 0.4, "spot_size": 1.0, "use_soft_falloff": False}),
    "spot by exitance": ("SPOT", {"shadow_soft_size": 0.4, "spot_size": 1.0, "normalize": False}),
    "squeezed spot": ("SPOT", {"shadow_soft_size": 0.1, "spot_size": 0.9, "scale": (1.0, 0.5, 1.0)}),
}
AREAS = {
    "square": ("AREA", {"size": 0.5}),
    "rectangle": ("AREA", {"shape": "RECTANGLE", "size": 0.5, "size_y": 1.5}),
    "disk": ("AREA", {"shape": "DISK", "size": 0.7}),
    "ellipse": ("AREA", {"shape": "ELLIPSE", "size": 0.5, "size_y": 1.5}),
    "scaled rectangle": ("AREA", {"shape": "RECTANGLE", "size": 0.5, "size_y": 0.4, "scale": (2, 3, 1)}),
    "mirrored rectangle": ("AREA", {"shape": "RECTANGLE", "size": 0.5, "size_y": 0.4, "scale": (-2, 1, 1)}),
    "tilted rectangle": ("AREA", {"shape": "RECTANGLE", "size": 0.5, "size_y": 1.0, "rotation_euler": (0.5, 0.3, 1)}),
    "square by exitance": ("AREA", {"size": 0.5, "normalize": False}),
    "scaled ellipse by exitance": (
        "AREA",
        {"shape": "ELLIPSE", "size": 0.5, "size_y": 0.8, "normalize": False, "scale": (2, 1.5, 1)},
    ),
    "square with spread": ("AREA", {"size": 0.5, "spread": 1.2}),
    "disk with spread": ("AREA", {"shape": "DISK", "size": 0.5, "spread": 2.0}),
}
SUNS = {
    "parallel sun": ("SUN", {"energy": 3.0, "angle": 0.0}),
    "sun": ("SUN", {"energy": 3.0, "angle": 0.1}),
    "low sun": ("SUN", {"energy": 3.0, "angle": 0.05, "rotation_euler": (1.2, 0, 0.3)}),
    "great sun": ("SUN", {"energy": 3.0, "angle": 1.0}),
    "sun by radiance": ("SUN", {"energy": 3.0, "angle": 0.3, "normalize": False}),
    "parallel sun by radiance": ("SUN", {"energy": 3.0, "angle": 0.0, "normalize": False}),
}
LAMPS = {**POINTS, **SPOTS, **AREAS, **SUNS}


def lamp_scene(name, look_at_lamp):
    """A lamp 2 m above a white floor; the camera sees 3 m of the floor, or looks up into the middle of the lamp."""
    kind, properties = LAMPS[name]
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=20)
    floor = bpy.data.materials.new("Floor")
    use_nodes(floor)
    tree = floor.node_tree
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(diffuse.outputs[0], next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL").inputs["Surface"])
    bpy.context.object.data.materials.append(floor)

    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", kind))
    scene.collection.objects.link(lamp)
    lamp.location, lamp.visible_camera = (0, 0, 2), look_at_lamp
    lamp.data.energy = 100
    for key, value in properties.items():
        if key == "node_strength":
            use_nodes(lamp.data)
            next(n for n in lamp.data.node_tree.nodes if n.type == "EMISSION").inputs["Strength"].default_value = value
        else:
            setattr(lamp if key in ("scale", "rotation_euler") else lamp.data, key, value)

    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    if look_at_lamp:
        camera.data.lens, camera.location, camera.rotation_euler = 300, (0, 0, 0.5), (math.pi, 0, 0)
        if kind == "SUN":  # which stands where it shines from
            camera.rotation_euler = lamp.rotation_euler
            camera.rotation_euler.rotate_axis("X", math.pi)
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


@pytest.mark.parametrize("name", LAMPS)
def test_a_lamp_lights_the_floor_as_in_cycles(name):
    ours, theirs = pictures(name, look_at_lamp=False)
    assert theirs.mean() > 0.01
    assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=TOLERANCE)
    # everywhere: edges of cones and penumbras lie in the same place
    assert abs(ours - theirs).max() < 0.03 * theirs.max()
    bright = theirs > 0.3 * theirs.max()
    assert np.median(ours[bright] / theirs[bright]) == pytest.approx(1.0, rel=TOLERANCE)


HAS_SIZE = [name for name, (_, p) in LAMPS.items() if p.get("shadow_soft_size", 1) and p.get("angle", 1)]


@pytest.mark.parametrize("name", [n for n in HAS_SIZE if n not in ("exposed", "warm", "with nodes")])
def test_a_lamp_looks_as_bright_as_in_cycles(name):
    ours, theirs = pictures(name, look_at_lamp=True)
    assert theirs.mean() > 0.01
    assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=TOLERANCE)
