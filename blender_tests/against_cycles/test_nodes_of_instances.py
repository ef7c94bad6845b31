# SPDX-License-Identifier: GPL-3.0-or-later
"""What nodes say of instances, particles, points and meshes as a whole: pixel by pixel the same as in Cycles."""

import bpy
import numpy as np
import pytest
from mathutils import Vector

from blender_tests.helpers.engines import cells_in_both
from blender_tests.helpers.exported import add, empty_scene, square
from blender_tests.helpers.node_sheet import shine

CELL = 24
FRAME = 6


def child(b_material, **properties):
    """A small tilted square, hidden but where something makes instances of it."""
    b_object = add("Child", square(), scale=(0.09, 0.09, 0.09), rotation_euler=(0.2, 0.1, 0.3), **properties)
    b_object.data.materials.append(b_material)
    return b_object


def on_faces(where, b_material):
    """An instance of a square on each of four faces, which have UVs."""
    points = [(x / 2 - 0.5, y / 2 - 0.5, 0.0) for y in range(3) for x in range(3)]
    b_mesh = bpy.data.meshes.new("Faces")
    b_mesh.from_pydata(points, [], [(i, i + 1, i + 4, i + 3) for i in (0, 1, 3, 4)])
    corners = np.array([points[loop.vertex_index][:2] for loop in b_mesh.loops], np.float32) + 0.6
    b_mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", corners.ravel())
    parent = add("Faces", b_mesh, location=where, instance_type="FACES", show_instancer_for_render=False)
    parent.scale, parent["glow"] = (0.9, 0.9, 0.9), [0.3, 0.6, 0.1]
    parent.color = (0.7, 0.5, 0.1, 0.9)
    b_child = child(b_material, parent=parent)
    b_child["glow"] = 0.8


def as_particles(where, b_material):
    """Instances of a square by particles that fly and turn."""
    emitter = add("Emitter", square(), location=where, scale=(0.4, 0.4, 0.4), show_instancer_for_render=False)
    emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = emitter.particle_systems[0].settings
    settings.count, settings.frame_start, settings.frame_end, settings.lifetime = 7, -1, 4, 40
    settings.lifetime_random, settings.particle_size, settings.size_random = 0.5, 0.9, 0.4
    settings.normal_factor, settings.tangent_factor, settings.effector_weights.gravity = 0.3, 0.4, 0.0
    settings.use_rotations, settings.angular_velocity_mode, settings.angular_velocity_factor = True, "GLOBAL_Z", 0.7
    settings.render_type, settings.instance_object = "OBJECT", child(b_material, location=(where[0], where[1], -9.0))
    settings["glow"] = 0.4


def by_geometry_nodes(where, b_material):
    """Instances of a square that geometry nodes gave a colour each."""
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    kinds = ("MeshGrid", "InstanceOnPoints", "ObjectInfo", "StoreNamedAttribute", "InputIndex")
    grid, scatter, info, store, index = (tree.nodes.new(f"GeometryNode{kind}") for kind in kinds)
    end, noise = tree.nodes.new("NodeGroupOutput"), tree.nodes.new("ShaderNodeTexWhiteNoise")
    info.inputs["Object"].default_value = child(b_material, location=(where[0], where[1], -9.0))
    scatter.inputs["Scale"].default_value = (0.1, 0.1, 0.1)
    store.domain, store.data_type = "INSTANCE", "FLOAT_COLOR"
    store.inputs["Name"].default_value = "tint"
    noise.noise_dimensions = "1D"
    tree.links.new(index.outputs[0], next(s for s in noise.inputs if s.identifier == "W"))
    tree.links.new(noise.outputs["Color"], next(s for s in store.inputs if s.name == "Value" and s.enabled))
    tree.links.new(grid.outputs[0], scatter.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], scatter.inputs["Instance"])
    tree.links.new(scatter.outputs[0], store.inputs["Geometry"])
    tree.links.new(store.outputs[0], end.inputs[0])
    parent = add("Scatterer", square(), location=where, scale=(0.8, 0.8, 0.8))
    parent.modifiers.new("Scatter", "NODES").node_group = tree


def as_points(where, b_material):
    """Points of a cloud, stretched."""
    tree = bpy.data.node_groups.new("Points", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    kinds = ("MeshGrid", "MeshToPoints", "SetMaterial")
    grid, points, shade = (tree.nodes.new(f"GeometryNode{kind}") for kind in kinds)
    end = tree.nodes.new("NodeGroupOutput")
    points.inputs["Radius"].default_value = 0.15
    shade.inputs["Material"].default_value = b_material
    tree.links.new(grid.outputs[0], points.inputs[0])
    tree.links.new(points.outputs[0], shade.inputs[0])
    tree.links.new(shade.outputs[0], end.inputs[0])
    parent = add("Points", square(), location=where, scale=(0.8, 0.8, 0.8))
    parent.modifiers.new("Points", "NODES").node_group = tree


def as_a_rough_ball(where, b_material):
    """A ball with a dent and a spike, of two halves that share their places."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.4, location=where)
    ball = bpy.context.object
    ball.data.vertices[0].co *= 1.3
    ball.data.vertices[9].co *= 0.6
    ball.data.shade_smooth()
    ball.rotation_euler = (1.0, 0.3, 0.0)
    split = ball.modifiers.new("Split", "EDGE_SPLIT")
    split.split_angle = 0.2
    ball.data.materials.append(b_material)


def as_a_drum(where, b_material):
    """Smooth and flat faces of seven and of four corners, with a UV map that is torn and turned."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=7, radius=0.4, depth=0.5, location=where)
    drum = bpy.context.object
    uvs = drum.data.uv_layers.active.uv
    for number, corner in enumerate(uvs):
        corner.vector += Vector((0.07 * (number % 5), 0.11 * (number % 3)))
    drum.rotation_euler, drum.scale = (0.7, 0.4, 0.2), (1.2, 0.8, 1.0)
    for polygon in drum.data.polygons:
        polygon.use_smooth = polygon.index % 3 > 0
    drum.data.materials.append(b_material)


INSTANCER = {"attribute_type": "INSTANCER"}
CASES = {
    "Texture Coordinate Generated of the instancer": (
        on_faces,
        ("Generated", "TexCoord", 1.0, 1.0),
        {"from_instancer": True},
    ),
    "Texture Coordinate UV of the instancer": (on_faces, ("UV", "TexCoord"), {"from_instancer": True}),
    "Attribute of the instancer": (on_faces, ("Color", "Attribute"), {"attribute_name": "glow"} | INSTANCER),
    "Attribute of the instance": (
        on_faces,
        ("Color", "Attribute"),
        {"attribute_name": "glow", "attribute_type": "OBJECT"},
    ),
    "Object Info Random of instances": (on_faces, ("Random", "ObjectInfo"), {}),
    "Object Info Location of instances": (on_faces, ("Location", "ObjectInfo", 0.1), {}),
    "Attribute of particles": (as_particles, ("Color", "Attribute"), {"attribute_name": "glow"} | INSTANCER),
    "Particle Info Index": (as_particles, ("Index", "ParticleInfo", 0.1), {}),
    "Particle Info Random": (as_particles, ("Random", "ParticleInfo"), {}),
    "Particle Info Age": (as_particles, ("Age", "ParticleInfo", 0.1), {}),
    "Particle Info Lifetime": (as_particles, ("Lifetime", "ParticleInfo", 0.02), {}),
    "Particle Info Location": (as_particles, ("Location", "ParticleInfo", 0.1), {}),
    "Particle Info Size": (as_particles, ("Size", "ParticleInfo"), {}),
    "Particle Info Velocity": (as_particles, ("Velocity", "ParticleInfo", 1.0, 1.0), {}),
    "Particle Info Angular Velocity": (as_particles, ("Angular Velocity", "ParticleInfo"), {}),
    "Attribute of instances by geometry nodes": (
        by_geometry_nodes,
        ("Color", "Attribute"),
        {"attribute_name": "tint"} | INSTANCER,
    ),
    "Attribute Alpha of instances by geometry nodes": (
        by_geometry_nodes,
        ("Alpha", "Attribute"),
        {"attribute_name": "tint"} | INSTANCER,
    ),
    "Point Info Position": (as_points, ("Position", "PointInfo", 0.1), {}),
    "Point Info Radius": (as_points, ("Radius", "PointInfo", 3.0), {}),
    "Point Info Random": (as_points, ("Random", "PointInfo"), {}),
    "Tangent of a stretched drum": (as_a_drum, ("Tangent", "Tangent", 0.5, 0.5), {"direction_type": "UV_MAP"}),
    "Normal Map of a stretched drum": (
        as_a_drum,
        ("Normal", "NormalMap", 0.5, 0.5),
        {"inputs": {"Color": (0.8, 0.6, 0.9, 1.0)}},
    ),
    "Geometry Pointiness": (as_a_rough_ball, ("Pointiness", "NewGeometry"), {}),
}
COLUMNS = 6
ROWS = -(-len(CASES) // COLUMNS)


def instancers():
    scene = empty_scene()
    scene.frame_start, scene.frame_end = -1, FRAME
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", COLUMNS * 1.2
    scene.camera.location = (COLUMNS * 0.6, ROWS * 0.6, 10)
    scene.lambent.use_adaptive, scene.lambent.filter_type, scene.lambent.filter_width = False, "BOX", 0.01
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
    for number, (make, arguments, properties) in enumerate(CASES.values()):
        where = (number % COLUMNS * 1.2 + 0.6, number // COLUMNS * 1.2 + 0.6, 0.0)
        make(where, shine(*arguments, **properties))
    for frame in range(-1, FRAME + 1):  # particles move from frame to frame
        scene.frame_set(frame)


def cells():
    """{case: (ours, theirs)}"""
    return cells_in_both(instancers, CASES, COLUMNS, CELL)


@pytest.fixture(scope="module")
def pictures():
    return cells()


def difference(ours, theirs):
    """Of all but a twentieth of the pixels: a few at outlines are decided by rounding."""
    shines = theirs.any(axis=-1)
    return np.quantile(np.abs(ours - theirs).max(axis=-1)[shines], 0.95)


@pytest.mark.parametrize("name", CASES)
def test_nodes_say_of_instances_what_they_say_in_cycles(pictures, name):
    ours, theirs = pictures[name]
    assert theirs.any(axis=-1).mean() > 0.03
    assert difference(ours, theirs) <= 1e-3
