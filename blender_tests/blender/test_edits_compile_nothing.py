# SPDX-License-Identifier: GPL-3.0-or-later
"""Once the kernels are there, no edit of a material has anybody wait for a compiler, and no first picture of it."""

import bpy
import numpy as np
import pytest
from numba.core import event

from addon import compile_cache
from blender_tests.helpers.exported import add, export, square
from blender_tests.helpers.programs import render
from blender_tests.helpers.shader_nodes import link, material_tree, node, output_node


class Compilations(event.Listener):
    """Names of all functions that numba compiles, rather than to find them in memory or on disk."""

    def __init__(self):
        self.names = []

    def on_start(self, event):
        self.names.append(event.data["dispatcher"].__qualname__)

    def on_end(self, event):
        pass


@pytest.fixture
def tree():
    """A square of a Principled BSDF that is coloured by an image and a ramp, seen by the camera."""
    tree = material_tree()
    principled, image, ramp = node(tree, "BsdfPrincipled"), node(tree, "TexImage"), node(tree, "ValToRGB")
    image.image = picture(4, is_float=False)
    link(tree, image, ramp, "Fac")
    link(tree, ramp, principled, "Base Color")
    link(tree, principled, output_node(tree))
    b_square = square()
    b_square.uv_layers.new(name="UVMap")
    b_square.materials.append(bpy.data.materials["Material"])
    add("Square", b_square)
    add("Lamp", bpy.data.lights.new("Lamp", "POINT"), location=(1.0, 1.0, 2.0))
    bpy.context.scene.camera.location = (0.0, 0.0, 3.0)
    return tree


def picture(size, is_float):
    image = bpy.data.images.new("Picture", size, size, float_buffer=is_float)
    image.pixels[:] = np.linspace(0.0, 1.0, size * size * 4)
    return image


def nodes(tree, kind):
    return next(n for n in tree.nodes if n.bl_idname == f"ShaderNode{kind}")


def change_numbers(tree):
    for socket in ("Roughness", "Metallic", "IOR"):
        nodes(tree, "BsdfPrincipled").inputs[socket].default_value *= 0.9


def move_points_of_the_ramp(tree):
    ramp = nodes(tree, "ValToRGB").color_ramp
    ramp.elements[0].position, ramp.elements[0].color = 0.3, (0.9, 0.1, 0.1, 1.0)
    ramp.elements.new(0.5)
    ramp.interpolation = "CONSTANT"


def show_another_image(tree):
    nodes(tree, "TexImage").image = picture(7, is_float=True)
    nodes(tree, "TexImage").interpolation = "Cubic"


def put_nodes_in_between(tree):
    """One of each family, the roughness driven by noise, and a bump of it."""
    noise, cells, mix = node(tree, "TexNoise"), node(tree, "TexVoronoi"), node(tree, "MixRGB")
    bump, wave, occlusion = node(tree, "Bump"), node(tree, "TexWave"), node(tree, "AmbientOcclusion")
    principled = nodes(tree, "BsdfPrincipled")
    link(tree, noise, wave, "Vector", output=1)
    link(tree, wave, principled, "Roughness")
    link(tree, cells, bump, "Height")
    link(tree, bump, principled, "Normal")
    link(tree, occlusion, mix, "Color1")
    link(tree, nodes(tree, "ValToRGB"), mix, "Color2")
    link(tree, mix, principled, "Base Color")


def make_it_shine_in_a_textured_world(tree):
    link(tree, nodes(tree, "ValToRGB"), nodes(tree, "BsdfPrincipled"), "Emission Color")
    nodes(tree, "BsdfPrincipled").inputs["Emission Strength"].default_value = 2.0
    world = bpy.context.scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    sky = world.node_tree.nodes.new("ShaderNodeTexGradient")
    background = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    world.node_tree.links.new(sky.outputs[0], background.inputs["Color"])


def test_neither_a_first_picture_nor_an_edit_compiles_anything(tree):
    compile_cache.prepare()
    with event.install_listener("numba:compile", Compilations()) as compilations:
        before = shown()
        assert compilations.names == []
        for edit in (
            change_numbers,
            move_points_of_the_ramp,
            show_another_image,
            put_nodes_in_between,
            make_it_shine_in_a_textured_world,
        ):
            edit(tree)
            after = shown()
            assert compilations.names == [], edit.__name__
            assert not np.array_equal(before, after), "the edit shows"
            before = after


def shown():
    builder, _ = export((16, 16))
    return render(builder.build(), samples=1, size=16)
