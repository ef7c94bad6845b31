# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scenes are made of: objects, materials and their nodes, node groups, the camera and the world."""

import math

import bpy
import numpy as np
from mathutils import Matrix, Vector

# ---- Things ----------------------------------------------------------------------------------------------------------


def add(name, data, **properties):
    b_object = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(b_object)
    for key, value in properties.items():
        setattr(b_object, key, value)
    return b_object


def smooth_suzanne(levels=1):
    """Suzanne, subdivided so many times. With an empty material slot."""
    bpy.ops.mesh.primitive_monkey_add()
    b_object = bpy.context.object
    if levels:
        b_object.modifiers.new("Subdivision", "SUBSURF").levels = levels
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
    """A block that stands on corners (x, y) of the floor."""
    n = len(corners)
    positions = [(x, y, z) for z in (0.0, height) for x, y in corners]
    sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return add_mesh(name, positions, [tuple(range(n))[::-1], tuple(range(n, 2 * n)), *sides], b_material)


def add_cuboid(name, low, high, b_material, location=(0, 0, 0), turn=0.0):
    """A block from corner to corner, then turned by radians about z and moved."""
    corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
    block = add_block(name, high[2] - low[2], corners, b_material)
    matrix = Matrix.Translation(location) @ Matrix.Rotation(turn, 4, "Z")
    block.data.transform(matrix @ Matrix.Translation((0, 0, low[2])))
    return block


def add_made(name, group, location, radius, b_material):
    """An object that a node group with a radius and a material makes."""
    b_object = add(name, bpy.data.meshes.new(name), location=location)
    modifier = b_object.modifiers.new(group.name, "NODES")
    modifier.node_group = group
    for item in group.interface.items_tree:
        if item.in_out == "INPUT":
            modifier[item.identifier] = {"Radius": radius, "Material": b_material}[item.name]
    return b_object


def made_of_points(name, positions, radii, group, **inputs):
    """An object that a node group makes at points with radii."""
    points = bpy.data.meshes.new(name)
    points.from_pydata(positions, [], [])
    attribute(points, "radius", "FLOAT", radii)
    b_object = add(name, points)
    modifier = b_object.modifiers.new(group.name, "NODES")
    modifier.node_group = group
    for item in group.interface.items_tree:
        if item.in_out == "INPUT" and item.name in inputs:
            modifier[item.identifier] = inputs[item.name]
    return b_object


def attribute(b_mesh, name, data_type, values):
    """A value for each vertex."""
    data = b_mesh.attributes.new(name, data_type, "POINT").data
    dtype = np.int32 if data_type == "INT" else np.float32
    key = "vector" if data_type == "FLOAT_VECTOR" else "value"
    data.foreach_set(key, np.ascontiguousarray(values, dtype).ravel())


def material(name, kind, **inputs):
    """A material of one shader node, with values for its inputs (blanks as underscores)."""
    b_material = bpy.data.materials.new(name)
    b_material.use_nodes = True
    tree = b_material.node_tree
    tree.nodes.clear()
    node, output = shader(tree, kind, **inputs), tree.nodes.new("ShaderNodeOutputMaterial")
    output.location.x = 300
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    if "Color" in inputs or "Base_Color" in inputs:  # in the viewport, too
        b_material.diffuse_color = (*inputs.get("Color", inputs.get("Base_Color")), 1.0)
    return b_material


def shader(tree, kind, **inputs):
    """A new shader node, with values for its inputs (blanks as underscores)."""
    node = tree.nodes.new(f"ShaderNode{kind}")
    if hasattr(node, "distribution") and kind not in ("BsdfPrincipled", "BsdfSheen"):
        node.distribution = "GGX"
    for key, value in inputs.items():
        is_color = isinstance(value, tuple)
        node.inputs[key.replace("_", " ")].default_value = (*value, 1.0) if is_color else value
    return node


def wired_material(name):
    """A material without nodes but for its output: (material, tree, the output's socket)."""
    b_material = bpy.data.materials.new(name)
    b_material.use_nodes = True
    tree = b_material.node_tree
    tree.nodes.clear()
    return b_material, tree, tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]


def calculate(tree, kind, operation, *values):
    """The output of a new node of maths, `kind` Math or VectorMath, of numbers or other outputs."""
    node = tree.nodes.new(f"ShaderNode{kind}")
    node.operation = operation
    for socket, value in zip(node.inputs, values, strict=False):
        plug(tree, value, socket)
    return next(socket for socket in node.outputs if socket.enabled)


def blend(tree, factor, low, high):
    """The output of a new node that goes from one colour to another, while the factor goes from 0 to 1."""
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type = "RGBA"
    factors, lows, highs = (node.inputs[number] for number in (0, 6, 7))
    for value, socket in ((factor, factors), (low, lows), (high, highs)):
        plug(tree, value, socket)
    return node.outputs[2]


def plug(tree, value, socket):
    """Put a number, a colour or vector, or the output of a node into a socket."""
    if isinstance(value, bpy.types.NodeSocket):
        tree.links.new(value, socket)
    elif isinstance(value, tuple):
        socket.default_value = (*value, 1.0)[: len(socket.default_value)]
    else:
        socket.default_value = value


def arrange(tree):
    """Nodes in columns, by how far they are from the output, so that the wires go from left to right."""
    column = dict.fromkeys(tree.nodes, 0)
    for _ in tree.nodes:
        for link in tree.links:
            column[link.from_node] = max(column[link.from_node], column[link.to_node] + 1)
    for node in tree.nodes:
        above = [other for other in tree.nodes if column[other] == column[node]].index(node)
        node.location = (-220 * column[node], -260 * above)


def image(name, picture, is_float=False):
    """A picture, (height, width, 3), lowest row first, in the file: OpenEXR if `is_float`, else PNG with 8 bits."""
    height, width = picture.shape[:2]
    b_image = bpy.data.images.new(name, width, height, float_buffer=is_float)
    b_image.file_format = "OPEN_EXR" if is_float else "PNG"
    pixels = np.dstack([picture, np.ones((height, width))]).astype(np.float32)
    b_image.pixels.foreach_set(pixels.ravel())
    b_image.pack()
    return b_image


def image_node(tree, b_image, kind):
    """A new texture node of this kind that shows an image."""
    node = tree.nodes.new(f"ShaderNode{kind}")
    node.image = b_image
    node.location.x = -400
    return node


def world(scene, color):
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)


def sky(scene):
    """White at the horizon, blue above, as behind the first pictures of P. Shirley, "Ray Tracing in One Weekend"."""
    world(scene, (1, 1, 1))
    tree = scene.world.node_tree
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    plug(tree, tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], split.inputs[0])  # the direction
    height = calculate(tree, "Math", "MULTIPLY_ADD", split.outputs["Z"], 0.5, 0.5)
    plug(tree, blend(tree, height, (1.0, 1.0, 1.0), (0.5, 0.7, 1.0)), tree.nodes["Background"].inputs["Color"])
    arrange(tree)


def camera(scene, location, target, field_of_view, size):
    """A camera that sees `field_of_view` degrees over the longer side of a picture of `size` pixels."""
    b_camera = bpy.data.cameras.new("Camera")
    b_camera.angle = math.radians(field_of_view)
    direction = Vector(target) - Vector(location)
    rotation = direction.to_track_quat("-Z", "Y").to_euler()
    scene.camera = add("Camera", b_camera, location=location, rotation_euler=rotation)
    scene.render.resolution_x, scene.render.resolution_y = size


def focus(scene, distance, lens_radius):
    """Depth of field; both in metres."""
    b_camera = scene.camera.data
    b_camera.dof.use_dof, b_camera.dof.focus_distance = True, distance
    b_camera.dof.aperture_fstop = b_camera.lens * 1e-3 / (2.0 * lens_radius)


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


def spheres_at_points_group():
    """A sphere on every vertex, by its attribute `radius`."""
    group = bpy.data.node_groups.new("Spheres", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    group.interface.new_socket("Material", in_out="INPUT", socket_type="NodeSocketMaterial")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    points, paint = group.nodes.new("GeometryNodeMeshToPoints"), group.nodes.new("GeometryNodeSetMaterial")
    group.links.new(start.outputs["Geometry"], points.inputs["Mesh"])
    read_attribute(group, "radius", "FLOAT", points.inputs["Radius"])
    group.links.new(points.outputs["Points"], paint.inputs["Geometry"])
    group.links.new(start.outputs["Material"], paint.inputs["Material"])
    group.links.new(paint.outputs["Geometry"], end.inputs["Geometry"])
    return group


def read_attribute(group, name, data_type, target):
    """Link a named attribute to an input of a node."""
    node = group.nodes.new("GeometryNodeInputNamedAttribute")
    node.data_type = data_type
    node.inputs["Name"].default_value = name
    group.links.new(next(o for o in node.outputs if o.enabled), target)


def ball_group(segments=512):
    """A sphere of so many faces that Cycles' picture of it is one of a sphere."""
    group, start, finish = sphere_group("Ball")
    ball, smooth = group.nodes.new("GeometryNodeMeshUVSphere"), group.nodes.new("GeometryNodeSetShadeSmooth")
    ball.inputs["Segments"].default_value, ball.inputs["Rings"].default_value = segments, segments // 2
    group.links.new(start.outputs["Radius"], ball.inputs["Radius"])
    group.links.new(ball.outputs["Mesh"], smooth.inputs["Geometry"])
    return finish(smooth.outputs["Geometry"])


def instances_group(collection, scale=0.42, has_radius=False):
    """One object of a collection on every vertex, by its attributes `kind` and `rotation`; or, if `has_radius`, the
    first one in the size of the attribute `radius`."""
    group = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    scatter, objects = group.nodes.new("GeometryNodeInstanceOnPoints"), group.nodes.new("GeometryNodeCollectionInfo")
    objects.inputs["Collection"].default_value = collection
    objects.inputs["Separate Children"].default_value = objects.inputs["Reset Children"].default_value = True
    scatter.inputs["Pick Instance"].default_value = True
    scatter.inputs["Scale"].default_value = (scale, scale, scale)
    if has_radius:
        read_attribute(group, "radius", "FLOAT", scatter.inputs["Scale"])
        scatter.inputs["Instance Index"].default_value = 0
    else:
        read_attribute(group, "kind", "INT", scatter.inputs["Instance Index"])
        read_attribute(group, "rotation", "FLOAT_VECTOR", scatter.inputs["Rotation"])
    group.links.new(start.outputs["Geometry"], scatter.inputs["Points"])
    group.links.new(objects.outputs["Instances"], scatter.inputs["Instance"])
    group.links.new(scatter.outputs["Instances"], end.inputs["Geometry"])
    return group
