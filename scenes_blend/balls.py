# SPDX-License-Identifier: GPL-3.0-or-later
"""A field of balls, each of one shader: what light does on each of them, side by side."""

import math

import bpy
from kit import add, add_mesh, camera, material, plug, shader, sky, wired_material

ROWS, COLUMNS, RADIUS = 4, 6, 0.42


def materials(scene):
    """Rows from the front: matt and layered, metals, what lets light through, and shaders mixed or bent."""
    mesh = ball_mesh()
    for number, b_material in enumerate(looks()):
        row, column = divmod(number, COLUMNS)
        ball = add(b_material.name, mesh, location=(column - 0.5 * (COLUMNS - 1), 1.1 * row, RADIUS))
        ball.material_slots[0].link = "OBJECT"
        ball.material_slots[0].material = b_material
    ground = material("Ground", "BsdfDiffuse")
    plug(ground.node_tree, checks(ground.node_tree), ground.node_tree.nodes["Diffuse BSDF"].inputs["Color"])
    add_mesh("Ground", [(-40, -40, 0), (40, -40, 0), (40, 40, 0), (-40, 40, 0)], [(0, 1, 2, 3)], ground)
    lamp = add("Softbox", bpy.data.lights.new("Softbox", "AREA"), location=(-4, -3, 6))
    lamp.data.energy, lamp.data.size = 700.0, 2.5
    lamp.rotation_euler = (math.radians(42), 0, math.radians(-47))
    sky(scene)
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.35
    camera(scene, (0, -6.2, 4.6), (0, 1.45, 0.2), field_of_view=46, size=(960, 640))


def looks():
    """The materials, row by row."""
    yield principled("Clay", Base_Color=(0.6, 0.25, 0.12), Diffuse_Roughness=1.0, Specular_IOR_Level=0.0)
    yield principled("Plastic", Base_Color=(0.05, 0.2, 0.6), Roughness=0.25)
    yield principled("Lacquer", Base_Color=(0.5, 0.02, 0.02), Roughness=0.6, Coat_Weight=1.0, Coat_Roughness=0.02)
    yield principled("Sheen", Base_Color=(0.1, 0.03, 0.15), Roughness=0.9, Sheen_Weight=1.0, Sheen_Tint=(1.0, 0.6, 0.8))
    yield distributed("Velvet", "BsdfSheen", "ASHIKHMIN", Color=(0.5, 0.1, 0.1), Roughness=0.4)
    yield material("Toon", "BsdfToon", Color=(0.1, 0.5, 0.3), Size=0.6, Smooth=0.05)

    yield principled("Gold", Base_Color=(0.95, 0.64, 0.2), Metallic=1.0, Roughness=0.2)
    yield principled("Brushed steel", Base_Color=(0.6, 0.6, 0.62), Metallic=1.0, Roughness=0.35, Anisotropic=0.9)
    yield material("Copper", "BsdfMetallic", Base_Color=(0.93, 0.52, 0.38), Edge_Tint=(0.8, 0.9, 1.0), Roughness=0.3)
    yield distributed("Beckmann", "BsdfAnisotropic", "BECKMANN", Color=(0.7, 0.72, 0.8), Roughness=0.45)
    yield distributed("Ashikhmin-Shirley", "BsdfAnisotropic", "ASHIKHMIN_SHIRLEY", Color=(0.7, 0.7, 0.5), Roughness=0.5)
    yield principled(
        "Tempered", Base_Color=(0.6,) * 3, Metallic=1.0, Roughness=0.2, Thin_Film_Thickness=320.0, Thin_Film_IOR=1.9
    )

    yield material("Glass", "BsdfGlass", Roughness=0.0, IOR=1.5)
    yield distributed("Frosted glass", "BsdfGlass", "MULTI_GGX", Color=(0.8, 0.95, 0.9), Roughness=0.35, IOR=1.5)
    yield material("Refraction", "BsdfRefraction", Color=(1.0, 0.75, 0.4), Roughness=0.1, IOR=1.3)
    yield principled("Oil", Base_Color=(0.01,) * 3, Roughness=0.08, Thin_Film_Thickness=450.0, Thin_Film_IOR=1.4)
    yield mixed("Paper", ("BsdfTranslucent", (0.9, 0.8, 0.6)), ("BsdfDiffuse", (0.9, 0.8, 0.6)))
    yield mixed("Tinted film", ("BsdfTransparent", (0.3, 0.8, 0.9)), ("BsdfAnisotropic", (0.9, 0.9, 0.9)), 0.15)

    yield bumpy("Hammered", "Normal", Base_Color=(0.8, 0.8, 0.82), Metallic=1.0, Roughness=0.2)
    yield bumpy("Orange under varnish", "Normal", smooth_coat=True, Base_Color=(0.8, 0.25, 0.02), Coat_Weight=1.0)
    yield bumpy("Rippled varnish", "Coat Normal", Base_Color=(0.02, 0.15, 0.05), Coat_Weight=1.0, Coat_Roughness=0.02)
    yield principled("Wax", Base_Color=(0.85, 0.7, 0.5), Subsurface_Weight=1.0, Subsurface_Scale=0.15, Roughness=0.4)
    yield mixed("Half mirror", ("BsdfDiffuse", (0.1, 0.1, 0.5)), ("BsdfAnisotropic", (0.9, 0.9, 0.9)))
    yield principled("Alpha", Base_Color=(0.7, 0.1, 0.4), Alpha=0.45, Roughness=0.3)


# ---- Materials -------------------------------------------------------------------------------------------------------


def principled(name, **inputs):
    return material(name, "BsdfPrincipled", **inputs)


def distributed(name, kind, distribution, **inputs):
    b_material = material(name, kind, **inputs)
    node = next(node for node in b_material.node_tree.nodes if node.bl_idname == f"ShaderNode{kind}")
    node.distribution = distribution
    return b_material


def mixed(name, first, second, factor=0.5):
    """Half and half of two shaders, each a kind and a colour."""
    b_material, tree, output = wired_material(name)
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = factor
    for (kind, color), socket in zip((first, second), mix.inputs[1:], strict=True):
        node = shader(tree, kind, Color=color)
        if kind == "BsdfAnisotropic":
            node.inputs["Roughness"].default_value = 0.05
        tree.links.new(node.outputs[0], socket)
    tree.links.new(mix.outputs[0], output)
    return b_material


def bumpy(name, socket, smooth_coat=False, **inputs):
    """A Principled BSDF with bumps for one of its normals."""
    b_material = principled(name, **inputs)
    tree = b_material.node_tree
    node = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    noise, bump = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeBump")
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 7.0, 1.0
    bump.inputs["Distance"].default_value = 0.06
    plug(tree, tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], noise.inputs["Vector"])
    plug(tree, noise.outputs[0], bump.inputs["Height"])
    plug(tree, bump.outputs[0], node.inputs[socket])
    if smooth_coat:
        plug(tree, tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"], node.inputs["Coat Normal"])
    return b_material


def checks(tree):
    """The colours of the ground, so that glass has something to show."""
    node = tree.nodes.new("ShaderNodeTexChecker")
    node.inputs["Scale"].default_value = 2.0
    node.inputs["Color1"].default_value = (0.42, 0.42, 0.42, 1.0)
    node.inputs["Color2"].default_value = (0.25, 0.25, 0.25, 1.0)
    plug(tree, tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], node.inputs["Vector"])
    return node.outputs["Color"]


def ball_mesh():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=RADIUS)
    ball = bpy.context.object
    b_mesh = ball.data
    bpy.data.objects.remove(ball)
    b_mesh.name = "Ball"
    b_mesh.shade_smooth()
    b_mesh.materials.append(None)
    return b_mesh
