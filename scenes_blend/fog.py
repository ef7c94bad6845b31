# SPDX-License-Identifier: GPL-3.0-or-later
"""What fills space: fog with beams of light in it, a cloud, glass that is coloured inside."""

import math

import bpy
from boxes import let_light_scatter
from kit import (
    add,
    add_block,
    add_cuboid,
    add_made,
    add_mesh,
    arrange,
    ball_group,
    camera,
    material,
    plug,
    shader,
    sky,
    wired_material,
    world,
)


def foggy_room(scene):
    """A room full of thin fog, with a small lamp behind slats: beams of light, and shadows between them."""
    grey = material("Grey", "BsdfDiffuse", Color=(0.6, 0.6, 0.6))
    dark = material("Dark", "BsdfDiffuse", Color=(0.12, 0.1, 0.09))
    x, y, z = 3.0, 4.0, 3.0
    for name, corners in (
        ("Floor", [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)]),
        ("Ceiling", [(-x, -y, z), (-x, y, z), (x, y, z), (x, -y, z)]),
        ("Back wall", [(-x, y, 0), (x, y, 0), (x, y, z), (-x, y, z)]),
        ("Left wall", [(-x, -y, 0), (-x, y, 0), (-x, y, z), (-x, -y, z)]),
        ("Right wall", [(x, -y, 0), (x, -y, z), (x, y, z), (x, y, 0)]),
    ):
        add_mesh(name, corners, [(0, 1, 2, 3)], grey)
    for i in range(7):
        left = -1.75 + 0.5 * i
        add_cuboid("Slat", (left, 1.9, 0.0), (left + 0.3, 2.0, 2.4), dark)
    lamp = bpy.data.lights.new("Lamp", "POINT")
    lamp.energy, lamp.color, lamp.shadow_soft_size = 250.0, (1.0, 0.8, 0.55), 0.03
    add("Lamp", lamp, location=(0.2, 2.9, 1.5))
    air = inside("Fog", None, "VolumeScatter", Color=(0.9, 0.9, 0.9), Density=0.12, Anisotropy=0.3)
    add_cuboid("Fog", (-x - 1, -y - 4, -1), (x + 1, y + 1, z + 1), air)
    world(scene, (0, 0, 0))
    let_light_scatter(scene)
    camera(scene, (-1.6, -5.2, 1.5), (0.1, 2.0, 1.4), field_of_view=46, size=(640, 480))


def cloud(scene):
    """A ball as dense and as white as a cloud: light goes on straight at most droplets, and is scattered many times."""
    ground = material("Ground", "BsdfDiffuse", Color=(0.3, 0.35, 0.25))
    add_mesh("Ground", [(-30, -30, 0), (30, -30, 0), (30, 30, 0), (-30, 30, 0)], [(0, 1, 2, 3)], ground)
    droplets = inside("Droplets", None, "VolumeScatter", Color=(0.998, 0.998, 0.998), Density=8.0, Anisotropy=0.75)
    add_made("Cloud", ball_group(128), (0, 0, 1.7), 1.3, droplets).lambent.shape = "SPHERE"
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 4.0, math.radians(2.0)
    add("Sun", sun, rotation_euler=(math.radians(50), 0, math.radians(-60)))
    sky(scene)
    let_light_scatter(scene, 100)
    for settings in (scene.cycles, scene.lambent):
        settings.max_bounces = 100
    camera(scene, (0, -8.0, 1.6), (0, 0, 1.5), field_of_view=34, size=(512, 512))


def colored_glass(scene):
    """Glass with colour in it: what light loses on its way through, not where it enters; and a ball of milky glass."""
    white = material("White", "BsdfDiffuse", Color=(0.75, 0.73, 0.7))
    add_mesh("Ground", [(-20, -20, 0), (20, -20, 0), (20, 20, 0), (-20, 20, 0)], [(0, 1, 2, 3)], white)
    blue = inside("Blue glass", 1.5, "VolumeAbsorption", Color=(0.15, 0.45, 0.9), Density=1.6)
    amber = inside("Amber", 1.5, "VolumeAbsorption", Color=(0.95, 0.55, 0.1), Density=1.8)
    milk = inside("Milky glass", 1.5, "VolumeScatter", Color=(0.9, 0.85, 0.8), Density=5.0)
    add_made("Blue ball", ball_group(128), (-1.6, 0.2, 0.81), 0.8, blue).lambent.shape = "SPHERE"
    add_block("Amber", 1.5, [(-0.5, -0.1), (0.4, -0.4), (0.7, 0.5), (-0.2, 0.8)], amber).location.z = 0.01
    add_made("Milky ball", ball_group(128), (1.7, 0.1, 0.81), 0.8, milk).lambent.shape = "SPHERE"
    glow = material("Lamp", "Emission", Color=(1.0, 0.95, 0.85), Strength=9.0)
    add_mesh("Lamp", [(-2, -1, 5), (-2, 1.5, 5), (1, 1.5, 5), (1, -1, 5)], [(0, 1, 2, 3)], glow)
    world(scene, (0.25, 0.28, 0.35))
    let_light_scatter(scene)
    camera(scene, (0, -7.0, 3.0), (0, 0.1, 0.6), field_of_view=36, size=(640, 480))


def inside(name, ior, kind, **inputs):
    """A material with a volume of one shader node; its surface is smooth glass, or none if `ior` is None."""
    b_material, tree, surface = wired_material(name)
    volume = shader(tree, kind, **inputs)
    plug(tree, volume.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
    if ior is not None:
        plug(tree, shader(tree, "BsdfGlass", IOR=ior, Roughness=0.0).outputs[0], surface)
    arrange(tree)
    b_material.diffuse_color = (*inputs["Color"], 1.0)
    return b_material
