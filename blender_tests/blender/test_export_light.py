# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps and the world: what their settings and nodes add to the light. Their units are in against_cycles."""

import math

import bpy
import numpy as np
import pytest

from blender_tests.helpers.exported import add, empty_scene, export
from engine_core.tables import LightKind, Visibility


@pytest.fixture(autouse=True)
def scene():
    return empty_scene()


def lamp(kind="POINT", name="Lamp", **properties):
    b_light = bpy.data.lights.new(name, kind)
    b_light.energy = 100
    for key, value in properties.items():
        setattr(b_light, key, value)
    return add(name, b_light)


def the_light():
    builder, warnings = export()
    assert warnings == []
    (light,) = builder.lights
    return light


def intensity():
    """Of a point lamp without radius, over that of a white one of 100 W."""
    return the_light()["emission"] / (100 / (4 * math.pi))


# ---- Lamps -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "properties", "expected"),
    [
        ("POINT", {}, LightKind.POINT),
        ("SPOT", {}, LightKind.SPOT),
        ("SUN", {}, LightKind.SUN),
        ("AREA", {"shape": "SQUARE"}, LightKind.QUAD),
        ("AREA", {"shape": "RECTANGLE"}, LightKind.QUAD),
        ("AREA", {"shape": "DISK"}, LightKind.DISK),
        ("AREA", {"shape": "ELLIPSE"}, LightKind.DISK),
    ],
)
def test_each_type_of_lamp_is_there_at_its_place(kind, properties, expected):
    b_object = lamp(kind, **properties)
    b_object.location, b_object.rotation_euler = (1, 2, 3), (math.pi / 2, 0, 0)
    light = the_light()
    assert light["kind"] == expected
    if kind != "SUN":
        assert light["p"] == pytest.approx([1, 2, 3])
    if kind != "POINT":
        assert light["n"] == pytest.approx([0, 1, 0], abs=1e-6)  # -z, turned about x


def test_sizes_of_an_area_light_are_scaled_with_it():
    lamp("AREA", shape="RECTANGLE", size=2, size_y=3).scale = (4, 5, 1)
    light = the_light()
    assert light["area"] == pytest.approx(2 * 4 * 3 * 5)
    assert np.linalg.norm(light["u"]) * 2 == pytest.approx(8)


def test_a_square_takes_no_notice_of_the_second_size():
    lamp("AREA", shape="SQUARE", size=2, size_y=3)
    assert the_light()["area"] == pytest.approx(4)


def test_exposure_counts_in_stops():
    lamp(shadow_soft_size=0, exposure=3)
    assert intensity() == pytest.approx([8, 8, 8])


def test_colour_and_temperature_multiply():
    b_light = lamp(shadow_soft_size=0, color=(1, 0.5, 0.25), use_temperature=True, temperature=3000).data
    assert intensity() == pytest.approx(np.array(b_light.color) * np.array(b_light.temperature_color), rel=1e-5)
    assert b_light.temperature_color[0] > 1.5 * b_light.temperature_color[2]  # warm


def test_rays_that_do_not_see_a_lamp_are_in():
    b_object = lamp()
    b_object.visible_camera, b_object.visible_glossy = True, False
    assert the_light()["visibility"] == Visibility.ALL & ~Visibility.GLOSSY


def test_a_lamp_without_shadows_is_named():
    lamp(use_shadow=False)
    assert any(w.startswith("Lamp: lights without shadows") for w in export()[1])


# ---- Nodes of lamps --------------------------------------------------------------------------------------------------


def nodes_of(b_owner):
    """Switch nodes on. Returns the tree, its output, and its node that shines."""
    if bpy.app.version < (5, 0):
        b_owner.use_nodes = True
    tree = b_owner.node_tree
    output = next(n for n in tree.nodes if n.type.startswith("OUTPUT"))
    shining = next(n for n in tree.nodes if n.type in ("EMISSION", "BACKGROUND"))
    return tree, output, shining


def test_emission_node_multiplies_the_strength():
    _, _, emission = nodes_of(lamp(shadow_soft_size=0).data)
    emission.inputs["Strength"].default_value = 3
    emission.inputs["Color"].default_value = (1, 0.5, 0, 1)
    assert intensity() == pytest.approx([3, 1.5, 0])


def test_quadratic_falloff_is_what_light_does_anyway():
    tree, _, emission = nodes_of(lamp(shadow_soft_size=0).data)
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value = 5
    tree.links.new(falloff.outputs["Quadratic"], emission.inputs["Strength"])
    assert intensity() == pytest.approx([5, 5, 5])


def test_other_falloffs_are_programs_of_the_lamp():
    tree, _, emission = nodes_of(lamp(name="Lamp data").data)
    tree.links.new(tree.nodes.new("ShaderNodeLightFalloff").outputs["Linear"], emission.inputs["Strength"])
    builder, warnings = export()
    (light,) = builder.build().lights
    assert warnings == []
    assert light["program"] > 0
    assert light["gain"] > 0.0


# ---- The world -------------------------------------------------------------------------------------------------------


def test_without_a_world_it_is_dark(scene):
    scene.world = None
    assert export()[0].world_radiance == pytest.approx([0, 0, 0])


def test_background_is_colour_times_strength(scene):
    scene.world = bpy.data.worlds.new("World")
    _, _, background = nodes_of(scene.world)
    background.inputs["Color"].default_value = (0.1, 0.2, 0.4, 1)
    background.inputs["Strength"].default_value = 2.5
    assert export()[0].world_radiance == pytest.approx([0.25, 0.5, 1.0])


@pytest.mark.skipif(bpy.app.version >= (5, 0), reason="worlds always have nodes since Blender 5.0")
def test_a_world_without_nodes_has_its_colour(scene):
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes, scene.world.color = False, (0.3, 0.2, 0.1)
    assert export()[0].world_radiance == pytest.approx([0.3, 0.2, 0.1])


def test_a_sky_is_a_light_and_its_sun_another(scene):
    scene.world = bpy.data.worlds.new("World")
    tree, _, background = nodes_of(scene.world)
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sun_elevation, sky.sun_rotation = 0.5, math.pi / 2
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    builder, warnings = export()
    built = builder.build()
    assert warnings == []
    sun, rest = built.lights[built.world.disk_light[0]], built.lights[built.world.background_light[0]]
    assert tuple(-sun["n"]) == pytest.approx((math.cos(0.5), 0.0, math.sin(0.5)), abs=1e-6)
    assert sun["emission"].min() > 1e4 > rest["emission"].max() > 0.1


def test_an_environment_image_is_sampled_by_a_map_of_its_light(scene):
    image = bpy.data.images.new("Sky", 4, 2, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.ones((2, 4, 4), np.float32)
    pixels[1, :, :3] = (1, 2, 3)
    pixels[0, :, :3] = (3, 4, 5)
    image.pixels.foreach_set(pixels.ravel())
    scene.world = bpy.data.worlds.new("World")
    tree, _, background = nodes_of(scene.world)
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = image
    tree.links.new(node.outputs[0], background.inputs["Color"])
    builder, warnings = export()
    assert warnings == []
    world = builder.build().world
    assert world["background"][0] == pytest.approx([2, 3, 4], rel=1e-2)  # the rows blend into each other
    assert world["map_width"][0] > 0


def test_rays_that_do_not_see_the_world_are_in(scene):
    import addon_utils

    addon_utils.enable("cycles")  # which owns these switches
    scene.world = bpy.data.worlds.new("World")
    scene.world.cycles_visibility.camera = False
    assert export()[0].world_visibility == Visibility.ALL & ~Visibility.CAMERA


def test_a_portal_does_not_shine():
    import addon_utils

    addon_utils.enable("cycles")
    lamp("AREA").data.cycles.is_portal = True
    assert export()[0].lights == []
