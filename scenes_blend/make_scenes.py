# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the scenes beside this file.

    python3 scenes_blend/make_scenes.py [NAME ...]

Run it with the Python of the oldest supported Blender (`build.py setup --blender-version 4.5`), so that every Blender
can open the files. Each shows one idea:

cornell_box     diffuse light between coloured walls: the box of Cornell University, lit by an emissive square
three_spheres   glass, diffuse and metal on a great sphere under a plain sky; all of them perfect spheres
instances       10,000 instances of one mesh in five materials, under a sun
"""

import math
import os
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

FOLDER = Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent))
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


# ---- The scenes ------------------------------------------------------------------------------------------------------


def cornell_box(scene):
    """Sizes as measured at Cornell University (www.graphics.cornell.edu/online/box/data.html), in decimetres; colours
    as in P. Shirley, "Ray Tracing: The Rest of Your Life"."""
    white, red, green = (
        material(name, "BsdfDiffuse", Color=color)
        for name, color in (("White", (0.73, 0.73, 0.73)), ("Red", (0.65, 0.05, 0.05)), ("Green", (0.12, 0.45, 0.15)))
    )
    light = material("Light", "Emission", Color=(1.0, 0.82, 0.6), Strength=24.0)
    w, d, h = 5.5, 5.6, 5.5  # width, depth, height
    left, right = -w / 2, w / 2
    box = [
        ("Floor", [(left, 0, 0), (right, 0, 0), (right, d, 0), (left, d, 0)], white),
        ("Back wall", [(left, d, 0), (right, d, 0), (right, d, h), (left, d, h)], white),
        ("Left wall", [(left, 0, 0), (left, d, 0), (left, d, h), (left, 0, h)], red),
        ("Right wall", [(right, 0, 0), (right, 0, h), (right, d, h), (right, d, 0)], green),
    ]
    for name, corners, b_material in box:
        add_mesh(name, corners, [(0, 1, 2, 3)], b_material)
    # the ceiling leaves a hole for the light, whose back therefore shines on nothing
    ceiling = [(left, 0, h), (left, d, h), (right, d, h), (right, 0, h)]
    hole = [(-0.65, 2.27, h), (-0.65, 3.32, h), (0.65, 3.32, h), (0.65, 2.27, h)]
    around = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    add_mesh("Ceiling", [*ceiling, *hole], around, white)
    add_mesh("Light", hole, [(0, 1, 2, 3)], light)
    add_block("Tall block", 3.3, [(-1.455, 2.47), (0.125, 2.96), (-0.365, 4.56), (-1.945, 4.06)], white)
    add_block("Short block", 1.65, [(1.475, 0.65), (1.955, 2.25), (0.375, 2.72), (-0.125, 1.14)], white)
    world(scene, (0, 0, 0))
    camera(scene, (0, -8.0, h / 2), (0, 0, h / 2), field_of_view=38, size=(512, 512))


def three_spheres(scene):
    """After figure 5 of A. Desai, "Ray Tracing in Python", 2021, and P. Shirley, "Ray Tracing in One Weekend".

    Points of a point cloud are spheres in every engine. Cycles gives them no inside, though, so the glass is a fine
    mesh that is marked as a sphere for Lambent.
    """
    point, ball = points_group(), ball_group()
    ground = material("Ground", "BsdfDiffuse", Color=(0.18, 0.42, 0.06))
    matte = material("Matte", "BsdfDiffuse", Color=(0.12, 0.2, 0.5))
    metal = material("Metal", "BsdfMetallic", Base_Color=(0.8, 0.6, 0.2), Edge_Tint=(1, 0.9, 0.7), Roughness=0.0)
    glass = material("Glass", "BsdfGlass", IOR=1.5, Roughness=0.0)
    add_made("Ground", point, (0, 0, -100), 100.0, ground)
    add_made("Matte sphere", point, (0, 0, 0.5), 0.5, matte)
    add_made("Metal sphere", point, (1.05, 0, 0.5), 0.5, metal)
    add_made("Glass sphere", ball, (-1.05, 0, 0.5), 0.5, glass).lambent.shape = "SPHERE"
    world(scene, (0.5, 0.7, 1.0))
    camera(scene, (0, -6.0, 1.3), (0, 0, 0.42), field_of_view=34, size=(800, 450))


def instances(scene):
    """Suzannes on the spiral of a sunflower (H. Vogel 1979): one mesh, materials by object."""
    looks = {
        "Ivory": {"Base_Color": (0.8, 0.72, 0.55), "Roughness": 0.45},
        "Coral": {"Base_Color": (0.75, 0.16, 0.08), "Roughness": 0.3, "Coat_Weight": 0.6, "Coat_Roughness": 0.2},
        "Petrol": {"Base_Color": (0.02, 0.2, 0.25), "Roughness": 0.35},
        "Gold": {"Base_Color": (0.9, 0.6, 0.2), "Metallic": 1.0, "Roughness": 0.25},
        "Steel": {"Base_Color": (0.55, 0.57, 0.6), "Metallic": 1.0, "Roughness": 0.4},
    }
    suzanne = smooth_suzanne()
    kinds = bpy.data.collections.new("Suzannes")
    for name, look in looks.items():
        b_object = bpy.data.objects.new(f"Suzanne {name}", suzanne)
        b_object.material_slots[0].link = "OBJECT"
        b_object.material_slots[0].material = material(name, "BsdfPrincipled", **look)
        kinds.objects.link(b_object)

    count, random = 10_000, np.random.default_rng(7)
    i = np.arange(count) + 0.5
    radius, angle = 0.62 * np.sqrt(i), GOLDEN_ANGLE * i
    height = 0.4 + 5.0 * np.exp(-((radius / 16.0) ** 2))
    positions = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height])
    tilt = random.normal(0.0, 0.2, (count, 2)) - (0.4, 0.0)
    turn = angle + math.pi / 2 + random.normal(0.0, 0.2, count)  # outwards
    spiral = bpy.data.meshes.new("Spiral")
    spiral.from_pydata(positions, [], [])
    rotations = spiral.attributes.new("rotation", "FLOAT_VECTOR", "POINT")
    rotations.data.foreach_set("vector", np.column_stack([tilt, turn]).astype(np.float32).ravel())
    kind = spiral.attributes.new("kind", "INT", "POINT")
    kind.data.foreach_set("value", (i.astype(np.int32) % 55) // 11)
    add("Spiral", spiral).modifiers.new("Instances", "NODES").node_group = instances_group(kinds)

    side = 200
    ground = material("Ground", "BsdfDiffuse", Color=(0.35, 0.33, 0.3))
    add_mesh("Ground", [(-side, -side, 0), (side, -side, 0), (side, side, 0), (-side, side, 0)], [(0, 1, 2, 3)], ground)
    sun = add("Sun", bpy.data.lights.new("Sun", "SUN"), rotation_euler=(math.radians(50), 0, math.radians(-35)))
    sun.data.energy, sun.data.angle, sun.data.color = 3.5, math.radians(2.0), (1.0, 0.9, 0.75)
    world(scene, (0.22, 0.32, 0.5))
    camera(scene, (0, -44, 24), (0, -8, 1.5), field_of_view=46, size=(960, 540))


# ---- Things ----------------------------------------------------------------------------------------------------------


def add(name, data, **properties):
    b_object = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(b_object)
    for key, value in properties.items():
        setattr(b_object, key, value)
    return b_object


def smooth_suzanne():
    """Suzanne, subdivided once. With an empty material slot."""
    bpy.ops.mesh.primitive_monkey_add()
    b_object = bpy.context.object
    b_object.modifiers.new("Subdivision", "SUBSURF").levels = 1
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    suzanne = b_object.data
    bpy.data.objects.remove(b_object)
    suzanne.name = "Suzanne"
    suzanne.shade_smooth()
    suzanne.uv_layers.remove(suzanne.uv_layers[0])
    suzanne.materials.append(None)
    return suzanne


def add_mesh(name, positions, faces, b_material):
    """A mesh object with flat faces, counter-clockwise seen from the front."""
    b_mesh = bpy.data.meshes.new(name)
    b_mesh.from_pydata(positions, [], faces)
    b_mesh.materials.append(b_material)
    return add(name, b_mesh)


def add_block(name, height, corners, b_material):
    """A block that stands on four corners (x, y) of the floor."""
    positions = [(x, y, z) for z in (0.0, height) for x, y in corners]
    sides = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    return add_mesh(name, positions, [(3, 2, 1, 0), (4, 5, 6, 7), *sides], b_material)


def add_made(name, group, location, radius, b_material):
    """An object that a node group with a radius and a material makes."""
    b_object = add(name, bpy.data.meshes.new(name), location=location)
    modifier = b_object.modifiers.new(group.name, "NODES")
    modifier.node_group = group
    for item in group.interface.items_tree:
        if item.in_out == "INPUT":
            modifier[item.identifier] = {"Radius": radius, "Material": b_material}[item.name]
    return b_object


def material(name, kind, **inputs):
    """A material of one shader node, with values for its inputs (blanks as underscores)."""
    b_material = bpy.data.materials.new(name)
    b_material.use_nodes = True
    tree = b_material.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new(f"ShaderNode{kind}"), tree.nodes.new("ShaderNodeOutputMaterial")
    output.location.x = 300
    if hasattr(shader, "distribution") and kind != "BsdfPrincipled":
        shader.distribution = "GGX"
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    for key, value in inputs.items():
        is_color = isinstance(value, tuple)
        shader.inputs[key.replace("_", " ")].default_value = (*value, 1.0) if is_color else value
    if "Color" in inputs or "Base_Color" in inputs:  # in the viewport, too
        b_material.diffuse_color = (*inputs.get("Color", inputs.get("Base_Color")), 1.0)
    return b_material


def world(scene, color):
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)


def camera(scene, location, target, field_of_view, size):
    """A camera that sees `field_of_view` degrees over the longer side of a picture of `size` pixels."""
    b_camera = bpy.data.cameras.new("Camera")
    b_camera.angle = math.radians(field_of_view)
    direction = Vector(target) - Vector(location)
    rotation = direction.to_track_quat("-Z", "Y").to_euler()
    scene.camera = add("Camera", b_camera, location=location, rotation_euler=rotation)
    scene.render.resolution_x, scene.render.resolution_y = size


# ---- Node groups -----------------------------------------------------------------------------------------------------


def sphere_group(name):
    """A geometry node group with a radius and a material: (group, input node, function that adds the output)."""
    group = bpy.data.node_groups.new(name, "GeometryNodeTree")
    group.interface.new_socket("Radius", in_out="INPUT", socket_type="NodeSocketFloat")
    group.interface.new_socket("Material", in_out="INPUT", socket_type="NodeSocketMaterial")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    start = group.nodes.new("NodeGroupInput")

    def finish(geometry):
        paint, end = group.nodes.new("GeometryNodeSetMaterial"), group.nodes.new("NodeGroupOutput")
        group.links.new(geometry, paint.inputs["Geometry"])
        group.links.new(start.outputs["Material"], paint.inputs["Material"])
        group.links.new(paint.outputs["Geometry"], end.inputs["Geometry"])
        return group

    return group, start, finish


def points_group():
    """One point with a radius."""
    group, start, finish = sphere_group("Point")
    points = group.nodes.new("GeometryNodePoints")
    group.links.new(start.outputs["Radius"], points.inputs["Radius"])
    return finish(points.outputs["Geometry"])


def ball_group():
    """A sphere of so many faces that Cycles' picture of it is one of a sphere."""
    group, start, finish = sphere_group("Ball")
    ball, smooth = group.nodes.new("GeometryNodeMeshUVSphere"), group.nodes.new("GeometryNodeSetShadeSmooth")
    ball.inputs["Segments"].default_value, ball.inputs["Rings"].default_value = 512, 256
    group.links.new(start.outputs["Radius"], ball.inputs["Radius"])
    group.links.new(ball.outputs["Mesh"], smooth.inputs["Geometry"])
    return finish(smooth.outputs["Geometry"])


def instances_group(collection):
    """One object of a collection on every vertex, by its attributes `kind` and `rotation`."""
    group = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    scatter, objects = group.nodes.new("GeometryNodeInstanceOnPoints"), group.nodes.new("GeometryNodeCollectionInfo")
    objects.inputs["Collection"].default_value = collection
    objects.inputs["Separate Children"].default_value = objects.inputs["Reset Children"].default_value = True
    scatter.inputs["Pick Instance"].default_value = True
    scatter.inputs["Scale"].default_value = (0.42, 0.42, 0.42)
    for name, data_type, target in (("kind", "INT", "Instance Index"), ("rotation", "FLOAT_VECTOR", "Rotation")):
        attribute = group.nodes.new("GeometryNodeInputNamedAttribute")
        attribute.data_type = data_type
        attribute.inputs["Name"].default_value = name
        group.links.new(next(o for o in attribute.outputs if o.enabled), scatter.inputs[target])
    group.links.new(start.outputs["Geometry"], scatter.inputs["Points"])
    group.links.new(objects.outputs["Instances"], scatter.inputs["Instance"])
    group.links.new(scatter.outputs["Instances"], end.inputs["Geometry"])
    return group


# ---- Files -----------------------------------------------------------------------------------------------------------

CYCLES = {  # what makes its pictures comparable: no short cuts
    "sample_clamp_direct": 0.0,
    "sample_clamp_indirect": 0.0,
    "blur_glossy": 0.0,
    "light_sampling_threshold": 0.0,
    "use_fast_gi": False,
    "caustics_reflective": True,
    "caustics_refractive": True,
    "use_adaptive_sampling": False,
    "use_denoising": False,
}


def make(fill):
    """Make the scene of a function of this file, and save it under the function's name."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    fill(scene)
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = f"//{fill.__name__}"
    for name, value in CYCLES.items():
        setattr(scene.cycles, name, value)
    for b_object in bpy.data.objects:
        b_object.shadow_terminator_geometry_offset = 0.0
    scene.cycles.samples = scene.lambent.samples = 256
    scene.render.engine = "LAMBENT"
    path = FOLDER / f"{fill.__name__}.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)
    path.with_suffix(".blend1").unlink(missing_ok=True)
    print(f"{path}: {path.stat().st_size / 1024:.0f} KiB", flush=True)


def main(names):
    import addon_utils  # where bpy puts it

    import addon

    addon_utils.enable("cycles")
    addon.register()
    scenes = {fill.__name__: fill for fill in (cornell_box, three_spheres, instances)}
    for name in names or scenes:
        make(scenes[name])


if __name__ == "__main__":
    main(sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)  # bpy 4.5 hangs when it is unloaded
