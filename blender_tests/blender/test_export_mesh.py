# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry arrives as Blender has it: positions, normals, slots, UV maps, and spheres that stay spheres."""

import bpy
import numpy as np
import pytest

import addon
from blender_tests.helpers.exported import add, empty_scene, export, mesh, placement, square, world_triangles
from engine_core.tables import ShapeKind

RIDGE = [(-1, 0, 0), (0, 0, 1), (1, 0, 0), (-1, 2, 0), (0, 2, 1), (1, 2, 0)], [(0, 1, 4, 3), (1, 2, 5, 4)]
LEFT, RIGHT = np.array([-1, 0, 1]) / 2**0.5, np.array([1, 0, 1]) / 2**0.5  # normals of the ridge's faces


@pytest.fixture(autouse=True)
def _scene():
    return empty_scene()


def geometry(name):
    builder, warnings = export()
    assert warnings == []
    return placement(builder, name)[1]


def face_normals(triangles):
    n = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return n / np.linalg.norm(n, axis=1, keepdims=True)


# ---- Where it is -----------------------------------------------------------------------------------------------------


def test_faces_of_any_number_of_corners_become_triangles_of_the_same_surface():
    hexagon = [(np.cos(a), np.sin(a), 0) for a in np.arange(6) * np.pi / 3]
    add("Hexagon", mesh("Hexagon", hexagon, [(0, 1, 2, 3, 4, 5)]))
    triangles = world_triangles(export()[0], "Hexagon")

    area = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1) / 2
    assert len(triangles) == 4
    assert area.sum() == pytest.approx(1.5 * 3**0.5, rel=1e-6)
    assert face_normals(triangles) == pytest.approx(np.broadcast_to([0, 0, 1], (4, 3)))


def test_transforms_of_parents_and_constraints_are_in():
    parent = add("Parent", None, location=(0, 0, 5), scale=(2, 2, 2))
    child = add("Child", square(), location=(1, 0, 0), parent=parent)
    child.constraints.new("LIMIT_SCALE").use_max_y = True
    child.constraints[0].max_y = 1.0
    corners = world_triangles(export()[0], "Child").reshape(-1, 3)
    assert corners.min(axis=0) == pytest.approx([0, -1, 5], abs=1e-6)
    assert corners.max(axis=0) == pytest.approx([4, 1, 5], abs=1e-6)


def test_a_mirrored_object_keeps_its_mesh_and_gets_a_mirroring_transform():
    add("Mirrored", mesh("Ridge", *RIDGE), scale=(-1, 1, 2))
    builder, _ = export()
    found, shape = placement(builder, "Mirrored")
    assert np.linalg.det(np.asarray(found.to_world)[:3, :3]) == pytest.approx(-2)
    assert shape.positions == pytest.approx(np.array(RIDGE[0], np.float32))


def test_modifiers_are_in():
    b_object = add("Array", square())
    modifier = b_object.modifiers.new("Array", "ARRAY")
    modifier.count = 5
    assert len(geometry("Array").triangles) == 10


@pytest.mark.parametrize(
    ("operator", "options", "radius"),
    [
        ("curve.primitive_bezier_circle_add", {}, 1.0),
        ("object.text_add", {}, None),
        ("object.metaball_add", {"type": "BALL", "radius": 2.0}, None),
        ("surface.primitive_nurbs_surface_sphere_add", {}, 1.0),
    ],
)
def test_what_is_no_mesh_but_has_a_surface_is_exported_once(operator, options, radius):
    module, name = operator.split(".")
    getattr(getattr(bpy.ops, module), name)(**options)
    b_object = bpy.context.object
    if b_object.type == "CURVE":
        b_object.data.dimensions, b_object.data.fill_mode = "2D", "BOTH"
    builder, warnings = export()
    corners = world_triangles(builder, b_object.name).reshape(-1, 3)
    assert warnings == []
    assert len(corners) >= 30
    if radius:
        assert abs(corners).max() == pytest.approx(radius, rel=0.02)


def test_objects_without_a_surface_are_no_trouble():
    add("Empty", None)
    add("Nothing", bpy.data.meshes.new("Nothing"))
    add("Edge", bpy.data.meshes.new("Edge")).data.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    builder, warnings = export()
    assert builder.placements == []
    assert warnings == []


def test_broken_corners_cost_their_triangles_and_a_warning():
    b_mesh = mesh("Ridge", *RIDGE)
    b_mesh.vertices[0].co.x = float("nan")
    add("Broken", b_mesh)
    builder, warnings = export()
    assert np.isfinite(world_triangles(builder, "Broken")).all()
    assert len(placement(builder, "Broken")[1].triangles) in (2, 3)  # as the faces were cut in two
    assert any("Broken" in w and "not finite" in w for w in warnings)


def test_curves_become_strands():
    fur = bpy.data.hair_curves.new("Fur")
    fur.add_curves([2, 3])
    positions = np.random.default_rng(1).random((5, 3)).astype(np.float32)
    fur.attributes["position"].data.foreach_set("vector", positions.ravel())
    fur.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", np.full(5, 0.02, np.float32))
    fur.attributes.new("surface_uv_coordinate", "FLOAT2", "CURVE").data.foreach_set("vector", [0.1, 0.2, 0.3, 0.4])
    add("Fur", fur)
    builder, warnings = export()
    assert warnings == []
    _, hair = placement(builder, "Fur")
    np.testing.assert_allclose(hair.rows["p"][0], positions[0])
    np.testing.assert_allclose(hair.rows["p"][-1] + hair.rows["u"][-1], positions[4], rtol=1e-5)
    np.testing.assert_allclose(hair.rows["radius"], 0.02)
    uvs = {tuple(np.round(uv, 3)) for uv in hair.strands["uv"].tolist()}
    assert uvs == {(0.1, 0.2), (0.3, 0.4)}


def test_empty_curves_are_nothing():
    add("Fur", bpy.data.hair_curves.new("Fur"))
    builder, warnings = export()
    assert (builder.placements, warnings) == ([], [])


def test_volumes_are_named_as_missing():
    add("Smoke", bpy.data.volumes.new("Smoke"))
    builder, warnings = export()
    assert builder.placements == []
    assert any(w.startswith("Smoke: volume") for w in warnings)


# ---- Normals ---------------------------------------------------------------------------------------------------------


def test_flat_faces_need_no_normals():
    add("Flat", mesh("Ridge", *RIDGE))
    assert geometry("Flat").normals is None


def test_smooth_faces_share_the_normals_of_their_vertices():
    add("Smooth", mesh("Ridge", *RIDGE, smooth=True))
    shape = geometry("Smooth")
    crest = shape.normals[np.isclose(shape.positions[shape.triangles][..., 2], 1)]
    edge = shape.normals[np.isclose(shape.positions[shape.triangles][..., 0], -1)]
    assert crest == pytest.approx(np.broadcast_to([0, 0, 1], crest.shape), abs=1e-4)
    assert edge == pytest.approx(np.broadcast_to(LEFT, edge.shape), abs=1e-4)


def test_a_sharp_edge_between_smooth_faces_parts_their_normals():
    b_mesh = mesh("Ridge", *RIDGE, smooth=True)
    sharp = b_mesh.attributes.new("sharp_edge", "BOOLEAN", "EDGE")
    for edge, value in zip(b_mesh.edges, sharp.data, strict=True):
        value.value = set(edge.vertices) == {1, 4}
    add("Sharp", b_mesh)
    shape = geometry("Sharp")
    left = shape.positions[shape.triangles].mean(axis=1)[:, 0] < 0
    assert shape.normals[left] == pytest.approx(np.broadcast_to(LEFT, (2, 3, 3)), abs=1e-4)
    assert shape.normals[~left] == pytest.approx(np.broadcast_to(RIGHT, (2, 3, 3)), abs=1e-4)


def test_flat_and_smooth_faces_live_in_one_mesh():
    """A flat face beside two smooth ones: only the edge between the two is smoothed."""
    profile = [(x, y, z) for y in (0, 2) for x, z in ((-1, 0), (0, 1), (1, 0), (2, 1))]
    b_mesh = mesh("Zigzag", profile, [(i, i + 1, i + 5, i + 4) for i in range(3)], smooth=True)
    b_mesh.polygons[0].use_smooth = False
    add("Zigzag", b_mesh)
    shape = geometry("Zigzag")
    corners = shape.positions[shape.triangles]
    flat, valley = corners.mean(axis=1)[:, 0] < 0, np.isclose(corners[..., 0], 1)
    assert shape.normals[flat] == pytest.approx(np.broadcast_to(LEFT, (2, 3, 3)), abs=1e-4)
    assert shape.normals[valley] == pytest.approx(np.broadcast_to([0, 0, 1], (valley.sum(), 3)), abs=1e-4)


def test_custom_normals_are_taken():
    b_mesh = mesh("Ridge", *RIDGE, smooth=True)
    wanted = np.array([0.0, 0.6, 0.8])
    b_mesh.normals_split_custom_set([wanted] * len(b_mesh.loops))
    add("Custom", b_mesh)
    shape = geometry("Custom")
    assert shape.normals == pytest.approx(np.broadcast_to(wanted, shape.normals.shape), abs=1e-3)


# ---- What lies on it -------------------------------------------------------------------------------------------------


def test_each_triangle_has_the_slot_of_its_face():
    b_mesh = mesh("Ridge", *RIDGE)
    for i in range(3):
        b_mesh.materials.append(bpy.data.materials.new(f"Material {i}"))
    b_mesh.polygons[1].material_index = 2
    add("Slots", b_mesh)
    shape = geometry("Slots")
    right = shape.positions[shape.triangles].mean(axis=1)[:, 0] > 0
    assert (shape.slots == np.where(right, 2, 0)).all()


def test_the_uv_map_for_rendering_is_taken_at_each_corner():
    b_mesh = mesh("Ridge", *RIDGE)
    for name, scale in (("Other", 5.0), ("Wanted", 0.5)):
        layer = b_mesh.uv_layers.new(name=name)
        for loop, uv in zip(b_mesh.loops, layer.uv, strict=True):
            uv.vector = np.array(b_mesh.vertices[loop.vertex_index].co[:2]) * scale
    b_mesh.uv_layers["Wanted"].active_render = True
    b_mesh.uv_layers.active = b_mesh.uv_layers["Other"]
    add("Mapped", b_mesh)
    shape = geometry("Mapped")
    assert shape.uvs == pytest.approx(shape.positions[shape.triangles][..., :2] * 0.5)


# ---- Spheres ---------------------------------------------------------------------------------------------------------


def test_a_point_cloud_becomes_spheres():
    bpy.ops.object.pointcloud_random_add()
    cloud = bpy.context.object
    centres = np.array([p.co for p in cloud.data.points])
    for i, point in enumerate(cloud.data.points):
        point.radius = 0.001 * (i + 1)
    shape = geometry(cloud.name)
    assert shape.centres == pytest.approx(centres)
    assert shape.radii == pytest.approx(0.001 * (np.arange(len(centres)) + 1))


def test_a_sphere_made_by_nodes_has_the_material_that_nodes_gave_it():
    tree = bpy.data.node_groups.new("Point", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    names = ("GeometryNodePoints", "GeometryNodeSetMaterial", "NodeGroupOutput")
    points, paint, end = (tree.nodes.new(name) for name in names)
    points.inputs["Radius"].default_value = 2.5
    paint.inputs["Material"].default_value = bpy.data.materials.new("Paint")
    tree.links.new(points.outputs[0], paint.inputs[0])
    tree.links.new(paint.outputs[0], end.inputs[0])
    add("Made", square()).modifiers.new("Point", "NODES").node_group = tree
    builder, _ = export()
    found, shape = placement(builder, "Made")
    assert shape.radii == pytest.approx([2.5])
    assert [builder.materials[i].name for i in found.materials] == ["Paint"]


@pytest.fixture
def registered():
    addon.register()
    yield
    addon.unregister()


@pytest.mark.usefixtures("registered")
def test_an_object_marked_as_a_sphere_is_one_and_its_copies_too():
    empty_scene()
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.5, location=(0, 0, 1))
    ball = bpy.context.object
    ball.scale = (1, 1, 2)
    ball.lambent.shape = "SPHERE"
    for name in ("Unused", "Used"):
        ball.data.materials.append(bpy.data.materials.new(name))
    ball.data.polygons.foreach_set("material_index", [1] * len(ball.data.polygons))
    add("Plain", ball.data)
    builder, warnings = export()
    found, shape = placement(builder, ball.name)
    assert shape.centres == pytest.approx(np.zeros((1, 3)), abs=1e-6)
    assert shape.radii == pytest.approx([1.5])
    assert [builder.materials[i].name for i in found.materials] == ["Used"]
    assert np.diag(found.to_world) == pytest.approx([1, 1, 2, 1])
    assert len(placement(builder, "Plain")[1].triangles) > 500  # the mark is the object's, not the mesh's
    assert warnings == []


def marked(shape):
    """The mesh that is the active object, marked; exported: its geometry, and the warnings."""
    b_object = bpy.context.object
    b_object.lambent.shape = shape
    builder, warnings = export()
    return placement(builder, b_object.name)[1], warnings


@pytest.mark.usefixtures("registered")
def test_a_cube_marked_as_a_box_is_one():
    empty_scene()
    bpy.ops.mesh.primitive_cube_add(size=2, location=(1, 2, 3), rotation=(0.1, 0.2, 0.3), scale=(1, 2, 3))
    shape, warnings = marked("BOX")
    (row,) = shape.rows
    assert row["kind"] == ShapeKind.BOX
    np.testing.assert_allclose([row["p"], row["u"], row["v"]], [[0, 0, 0], [1, 0, 0], [0, 2, 0]], atol=1e-6)
    assert row["radius"] == pytest.approx(3.0)
    assert warnings == []


@pytest.mark.usefixtures("registered")
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("mark", ["QUAD", "BOX"])
def test_a_plane_marked_as_a_quad_or_a_box_is_a_quad_with_the_same_front(axis, side, mark):
    empty_scene()
    corners = np.roll([(-1, -2, 0.5), (1, -2, 0.5), (1, 2, 0.5), (-1, 2, 0.5)], axis, axis=1)[::side]
    add("Plane", mesh("Plane", corners.tolist(), [(0, 1, 2, 3)]))
    bpy.context.view_layer.objects.active = bpy.data.objects["Plane"]
    shape, warnings = marked(mark)
    (row,) = shape.rows
    assert row["kind"] == ShapeKind.QUAD
    np.testing.assert_allclose(row["p"], np.roll([0, 0, 0.5], axis), atol=1e-6)
    np.testing.assert_allclose(np.abs(row["u"]) + np.abs(row["v"]), np.roll([1, 2, 0], axis), atol=1e-6)
    np.testing.assert_allclose(np.cross(row["u"], row["v"]), np.roll([0, 0, 2 * side], axis), atol=1e-6)
    assert warnings == []


@pytest.mark.usefixtures("registered")
@pytest.mark.parametrize(("mark", "what"), [("QUAD", "flat rectangle"), ("BOX", "a box"), ("SPHERE", "a sphere")])
def test_a_mesh_far_from_the_shape_it_is_marked_as_is_named(mark, what):
    empty_scene()
    bpy.ops.mesh.primitive_cone_add()
    shape, (warning,) = marked(mark)
    assert len(shape.rows) == 1
    assert warning.startswith("Cone: is marked")
    assert what in warning
