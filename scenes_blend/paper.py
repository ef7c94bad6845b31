# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds of a few spheres, after A. Desai, "Ray Tracing in Python", 2021, and the books of P. Shirley that he follows.

All spheres are points of point clouds, which are perfect spheres in every engine.
"""

from kit import (
    add_cuboid,
    add_made,
    add_mesh,
    arrange,
    blend,
    calculate,
    camera,
    image,
    material,
    plug,
    points_group,
    shader,
    sky,
    wired_material,
    world,
)
from pictures import mountains, planet

WIDE = (800, 450)
# Shirley's fuzz of 1 adds a point in the unit ball to the mirrored direction, 33.8 degrees off on average: GGX of this
# roughness does the same where it is looked upon from above
FULL_FUZZ = 0.53


def normals_as_colors(scene):
    """Figure 2: x, y and z of the normal, from -1 to 1, are red, green and blue, from 0 to 1. As in the book y is what
    Blender calls z, so the ground, whose normals point up, is green; nothing else is needed to make it so."""
    paint, tree, surface = wired_material("Normals")
    split, join = tree.nodes.new("ShaderNodeSeparateXYZ"), tree.nodes.new("ShaderNodeCombineXYZ")
    plug(tree, tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"], split.inputs[0])
    towards_us = calculate(tree, "Math", "MULTIPLY", split.outputs["Y"], -1.0)
    for socket, value in zip(join.inputs, (split.outputs["X"], split.outputs["Z"], towards_us), strict=True):
        plug(tree, value, socket)
    color = calculate(tree, "VectorMath", "MULTIPLY_ADD", join.outputs[0], (0.5, 0.5, 0.5), (0.5, 0.5, 0.5))
    emission = shader(tree, "Emission")
    plug(tree, color, emission.inputs["Color"])
    plug(tree, emission.outputs[0], surface)
    arrange(tree)
    point = points_group()
    add_made("Ground", point, (0, 0, -100), 100.0, paint)
    add_made("Sphere", point, (0, 0, 0.5), 0.5, paint)
    sky(scene)
    camera(scene, (0, -3.2, 0.75), (0, 0, 0.5), field_of_view=40, size=WIDE)


def two_diffuse_spheres(scene):
    """Figure 3: one of them is the ground."""
    point, grey = points_group(), material("Grey", "BsdfDiffuse", Color=(0.5, 0.5, 0.5))
    add_made("Ground", point, (0, 0, -100), 100.0, grey)
    add_made("Sphere", point, (0, 0, 0.5), 0.5, grey)
    sky(scene)
    camera(scene, (0, -3.2, 0.75), (0, 0, 0.5), field_of_view=40, size=WIDE)


def metals_and_fuzz(scene):
    """Figure 4: the left metal without fuzz, the right one with as much as there is, and a diffuse sphere between."""
    point = points_group()
    add_made("Ground", point, (0, 0, -100), 100.0, material("Ground", "BsdfDiffuse", Color=(0.18, 0.42, 0.06)))
    clear = material("Clear metal", "BsdfGlossy", Color=(0.8, 0.8, 0.8), Roughness=0.0)
    fuzzy = material("Fuzzy metal", "BsdfGlossy", Color=(0.8, 0.6, 0.2), Roughness=FULL_FUZZ)
    add_made("Clear metal", point, (-1.05, 0, 0.5), 0.5, clear)
    add_made("Diffuse", point, (0, 0, 0.5), 0.5, material("Diffuse", "BsdfDiffuse", Color=(0.7, 0.3, 0.3)))
    add_made("Fuzzy metal", point, (1.05, 0, 0.5), 0.5, fuzzy)
    sky(scene)
    camera(scene, (0, -6.0, 1.3), (0, 0, 0.42), field_of_view=34, size=WIDE)


def checkered_spheres(scene):
    """Figure 6: one colour where sin 10x sin 10y sin 10z is positive, the other where it is negative."""
    paint, tree, surface = wired_material("Checker")
    place = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    plug(tree, calculate(tree, "VectorMath", "MULTIPLY", place, (10.0, 10.0, 10.0)), split.inputs[0])
    x, y, z = (calculate(tree, "Math", "SINE", socket) for socket in split.outputs)
    product = calculate(tree, "Math", "MULTIPLY", calculate(tree, "Math", "MULTIPLY", x, y), z)
    is_positive = calculate(tree, "Math", "GREATER_THAN", product, 0.0)
    diffuse = shader(tree, "BsdfDiffuse")
    plug(tree, blend(tree, is_positive, (0.2, 0.3, 0.1), (0.9, 0.9, 0.9)), diffuse.inputs["Color"])
    plug(tree, diffuse.outputs[0], surface)
    arrange(tree)
    point = points_group()
    add_made("Lower sphere", point, (0, 0, -10), 10.0, paint)
    add_made("Upper sphere", point, (0, 0, 10), 10.0, paint)
    sky(scene)
    camera(scene, (-13, 3, 2), (0, 0, 0), field_of_view=35, size=WIDE)


def turbulent_noise(scene):
    """Figure 7: Perlin's noise, seven times, each half as strong and half as large as the one before. What counts is
    how far the sum is from 0: that folds it, and the folds are the dark creases."""
    paint, tree, surface = wired_material("Turbulence")
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.noise_type, noise.normalize = "FBM", False
    for name, value in (("Scale", 2.0), ("Detail", 6.0), ("Roughness", 0.5), ("Lacunarity", 2.0)):
        noise.inputs[name].default_value = value
    plug(tree, tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"], noise.inputs["Vector"])
    diffuse = shader(tree, "BsdfDiffuse")
    plug(tree, calculate(tree, "Math", "ABSOLUTE", noise.outputs[0]), diffuse.inputs["Color"])
    plug(tree, diffuse.outputs[0], surface)
    arrange(tree)
    point = points_group()
    add_made("Ground", point, (0, 0, -300), 300.0, paint)
    add_made("Sphere", point, (0, 0, 2), 2.0, paint)
    sky(scene)
    camera(scene, (-13, 3, 2), (0, 0, 1.2), field_of_view=35, size=WIDE)


def picture_around_sphere(scene):
    """Figure 8."""
    painted = painted_material("Wallpaper", image("Mountains", mountains()))
    ball = add_made("Sphere", points_group(), (0, 0, 0), 2.0, painted)
    ball.rotation_euler.z = -2.0
    sky(scene)
    camera(scene, (0, -12, 0.6), (0, 0, 0), field_of_view=35, size=WIDE)


def light_in_the_world(scene):
    """Figure 10: black around, and a square that shines beside a sphere. The square is seen, too."""
    point = points_group()
    add_made("Ground", point, (0, 0, -300), 300.0, material("Ground", "BsdfDiffuse", Color=(0.5, 0.5, 0.5)))
    ball = add_made("Planet", point, (0, 0, 2), 2.0, painted_material("Planet", image("Planet", planet())))
    ball.rotation_euler.z = 2.6
    lamp = material("Lamp", "Emission", Color=(1.0, 1.0, 1.0), Strength=9.0)
    add_mesh("Lamp", [(2.2, -4.2, 1), (3.8, -3.0, 1), (3.8, -3.0, 3), (2.2, -4.2, 3)], [(0, 1, 2, 3)], lamp)
    world(scene, (0, 0, 0))
    camera(scene, (-1.0, -16, 3.4), (0.9, 0, 1.9), field_of_view=34, size=WIDE)


def picture_as_light(scene):
    """Figure 11: a picture shines on a sphere and a box that are covered with pictures, and on the floor."""
    wallpaper, map_of_planet = image("Mountains", mountains()), image("Planet", planet())
    shining = picture_material("Screen", wallpaper, shader_kind="Emission", Strength=14.0)
    corners = [(-3.6, -0.5, 0.2), (-1.2, 4.3, 0.2), (-1.2, 4.3, 3.0), (-3.6, -0.5, 3.0)]
    with_map(add_mesh("Screen", corners, [(0, 1, 2, 3)], shining))
    ball = add_made("Planet", points_group(), (0.2, 2.3, 1.1), 1.1, painted_material("Planet", map_of_planet))
    ball.rotation_euler.z = 1.0
    covered = picture_material("Picture", wallpaper, shader_kind="BsdfDiffuse")
    with_map(add_cuboid("Box", (-0.8, -0.8, 0), (0.8, 0.8, 1.6), covered, (1.9, -0.2, 0), 0.44))
    floor = [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)]
    add_mesh("Floor", floor, [(0, 1, 2, 3)], material("Floor", "BsdfDiffuse", Color=(0.6, 0.6, 0.6)))
    world(scene, (0, 0, 0))
    camera(scene, (1.0, -7.5, 2.6), (-0.2, 1.2, 1.2), field_of_view=46, size=WIDE)


def picture_material(name, b_image, shader_kind, **inputs):
    """A shader with a picture for its colour, by the object's UV map."""
    b_material, tree, surface = wired_material(name)
    texture, node = tree.nodes.new("ShaderNodeTexImage"), shader(tree, shader_kind, **inputs)
    texture.image = b_image
    plug(tree, texture.outputs["Color"], node.inputs["Color"])
    plug(tree, node.outputs[0], surface)
    arrange(tree)
    return b_material


def painted_material(name, b_image):
    """Diffuse, with a picture wrapped around the object's centre, from pole to pole.

    The node takes a picture of all directions as they are seen from inside; mirrored, it is right from outside.
    """
    b_material, tree, surface = wired_material(name)
    texture, diffuse = tree.nodes.new("ShaderNodeTexEnvironment"), shader(tree, "BsdfDiffuse")
    texture.image = b_image
    place = tree.nodes.new("ShaderNodeTexCoord").outputs["Object"]
    plug(tree, calculate(tree, "VectorMath", "MULTIPLY", place, (1.0, -1.0, 1.0)), texture.inputs["Vector"])
    plug(tree, texture.outputs["Color"], diffuse.inputs["Color"])
    plug(tree, diffuse.outputs[0], surface)
    arrange(tree)
    return b_material


def with_map(b_object):
    """The whole picture on each face."""
    layer = b_object.data.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1] * len(b_object.data.polygons))
