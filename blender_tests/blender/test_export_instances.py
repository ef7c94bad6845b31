# SPDX-License-Identifier: GPL-3.0-or-later
"""Every instance stands where Blender puts it, and every geometry is read once."""

import bpy
import numpy as np
import pytest

from blender_tests.helpers.exported import add, empty_scene, export, export_as_a_render, mesh, placement, square
from engine_core.tables import Visibility


@pytest.fixture(autouse=True)
def scene():
    return empty_scene()


def positions(builder):
    return np.array([np.asarray(p.to_world)[:3, 3] for p in builder.placements])


def material(name):
    return bpy.data.materials.get(name) or bpy.data.materials.new(name)


# ---- Instances -------------------------------------------------------------------------------------------------------


def test_objects_that_share_a_mesh_share_a_geometry():
    shared = square()
    for x in range(3):
        add(f"Copy {x}", shared, location=(x, 0, 0))
    add("Other", square("Other"))
    builder, _ = export()
    assert len(builder.placements) == 4
    assert len(builder.geometries) == 2


def test_a_modifier_makes_a_geometry_of_its_own():
    shared = square()
    add("Plain", shared)
    add("Changed", shared).modifiers.new("Array", "ARRAY")
    builder, _ = export()
    counts = {p.name: len(builder.geometries[p.geometry].triangles) for p in builder.placements}
    assert counts == {"Plain": 2, "Changed": 4}


def test_a_collection_is_instanced_with_all_its_objects():
    parts = bpy.data.collections.new("Parts")
    for x in range(2):
        parts.objects.link(bpy.data.objects.new(f"Part {x}", square(f"Part {x}")))
        parts.objects[-1].location = (x, 0, 0)
    for y in range(3):
        instancer = add(f"Instancer {y}", None, location=(0, 10 * y, 0))
        instancer.instance_type, instancer.instance_collection = "COLLECTION", parts
    builder, warnings = export()
    assert warnings == []
    assert len(builder.geometries) == 2
    assert sorted(map(tuple, positions(builder))) == sorted((x, 10 * y, 0) for x in range(2) for y in range(3))


def instance_on_points(b_object, instanced):
    """Let geometry nodes put `instanced` on every vertex of an object."""
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    names = ("NodeGroupInput", "GeometryNodeInstanceOnPoints", "GeometryNodeObjectInfo", "NodeGroupOutput")
    start, scatter, info, end = (tree.nodes.new(name) for name in names)
    info.inputs["Object"].default_value = instanced
    info.inputs["As Instance"].default_value = True
    tree.links.new(start.outputs[0], scatter.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], scatter.inputs["Instance"])
    tree.links.new(scatter.outputs[0], end.inputs[0])
    b_object.modifiers.new("Scatter", "NODES").node_group = tree
    return tree


def test_geometry_nodes_instance_by_the_thousand():
    instanced = add("Instanced", square("Instanced"), hide_viewport=True, hide_render=True)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=39, y_subdivisions=24, size=2)
    instance_on_points(bpy.context.object, instanced)
    grid = np.array([v.co for v in bpy.context.object.data.vertices])
    builder, warnings = export()
    assert warnings == []
    assert len(builder.placements) == 1000
    assert len(builder.geometries) == 1
    placed = positions(builder)
    assert placed[np.lexsort(placed.T)] == pytest.approx(grid[np.lexsort(grid.T)], abs=1e-6)


def test_geometry_nodes_may_pick_from_a_collection_of_looks():
    """One mesh, the materials by object; Blender hands all instances out in one temporary object."""
    looks, shared = bpy.data.collections.new("Looks"), square("Shared")
    shared.materials.append(None)
    for name in ("Red", "Green", "Blue"):
        b_object = bpy.data.objects.new(name, shared)
        b_object.material_slots[0].link = "OBJECT"
        b_object.material_slots[0].material = material(name)
        looks.objects.link(b_object)
    add("Points", mesh("Points", [(x, 0, 0) for x in range(6)], []))
    tree = instance_on_points(bpy.data.objects["Points"], None)
    scatter = tree.nodes["Instance on Points"]
    info = tree.nodes.new("GeometryNodeCollectionInfo")
    info.inputs["Collection"].default_value = looks
    info.inputs["Separate Children"].default_value = True
    scatter.inputs["Pick Instance"].default_value = True
    tree.links.new(tree.nodes.new("GeometryNodeInputIndex").outputs[0], scatter.inputs["Instance Index"])
    tree.links.new(info.outputs[0], scatter.inputs["Instance"])
    builder, warnings = export()
    assert warnings == []
    assert len(builder.geometries) == 1
    used = sorted(builder.materials[p.materials[0]].name for p in builder.placements)
    assert used == ["Blue", "Blue", "Green", "Green", "Red", "Red"]


def test_geometry_made_by_nodes_has_the_materials_that_nodes_gave_it():
    tree = bpy.data.node_groups.new("Make", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    names = ("GeometryNodeMeshCube", "GeometryNodeSetMaterial", "NodeGroupOutput")
    cube, paint, end = (tree.nodes.new(name) for name in names)
    paint.inputs["Material"].default_value = material("Paint")
    tree.links.new(cube.outputs[0], paint.inputs[0])
    tree.links.new(paint.outputs[0], end.inputs[0])
    add("Made", square()).modifiers.new("Make", "NODES").node_group = tree
    builder, _ = export()
    found, shape = placement(builder, "Made")
    used = {
        found.materials[min(slot, len(found.materials) - 1)]
        for slot in (shape.slots if shape.slots is not None else [0])
    }
    assert len(shape.triangles) == 12
    assert [builder.materials[i].name for i in used] == ["Paint"]


def test_particles_are_instances():
    add("Leaf", square("Leaf"), hide_viewport=True)
    emitter = add("Emitter", square("Emitter"))
    emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = emitter.particle_systems[0].settings
    settings.type, settings.count, settings.render_type = "HAIR", 50, "OBJECT"
    settings.use_advanced_hair = True
    settings.instance_object = bpy.data.objects["Leaf"]
    builder, warnings = export()
    assert warnings == []
    assert sum(p.name == "Leaf" for p in builder.placements) == 50
    assert len(builder.geometries) == 2


def hairy(**settings):
    """An object on which 20 hairs grow, two metres long; the settings of its particles."""
    emitter = add("Emitter", square(), **settings)
    emitter.location, emitter.scale = (1, 2, 3), (2, 2, 2)
    emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = emitter.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length, settings.render_step = "HAIR", 20, 2.0, 3
    settings.root_radius, settings.tip_radius, settings.radius_scale, settings.shape = 1.0, 0.5, 0.1, 0.0
    settings.use_close_tip = False
    return settings


def test_hair_particles_become_strands():
    hairy()
    builder, warnings, _ = export_as_a_render()
    assert warnings == []
    ((_, hair),) = (found for found in map(with_geometry(builder), builder.placements) if hasattr(found[1], "strands"))
    roots, tips = hair.strands["start"] == 0.0, np.isclose(hair.strands["end"], 1.0)
    assert roots.sum() == tips.sum() == 20
    assert np.abs(hair.rows["p"][roots][:, 2]).max() < 1e-5  # on the square, in its own space
    np.testing.assert_allclose(hair.rows["radius"][roots], 0.05, rtol=1e-5)
    np.testing.assert_allclose(hair.rows["radius_end"][tips], 0.025, rtol=1e-5)
    assert len(np.unique(hair.strands["random"])) == 20


def test_children_take_the_place_of_the_hairs_they_grow_around():
    settings = hairy()
    settings.child_type, settings.rendered_child_count, settings.child_percent = "SIMPLE", 5, 5
    settings.use_close_tip = True
    builder, _, _ = export_as_a_render()
    ((_, hair),) = (found for found in map(with_geometry(builder), builder.placements) if hasattr(found[1], "strands"))
    assert (hair.strands["start"] == 0.0).sum() == 100
    assert (hair.rows["radius_end"][np.isclose(hair.strands["end"], 1.0)] == 0.0).all()


def test_an_emitter_that_shows_only_its_hair_is_left_out():
    hairy(show_instancer_for_render=False)
    builder, _, _ = export_as_a_render()
    assert len(builder.placements) == 1
    assert hasattr(builder.geometries[builder.placements[0].geometry], "strands")


def with_geometry(builder):
    return lambda found: (found, builder.geometries[found.geometry])


def test_an_instancer_that_shows_only_its_instances_is_left_out():
    parent = add("Parent", square("Parent"), instance_type="VERTS", show_instancer_for_viewport=False)
    add("Child", square("Child"), parent=parent)
    builder, _ = export()
    assert [p.name for p in builder.placements] == ["Child"] * 5  # on four vertices, and the child itself


def test_lamps_are_instanced_too():
    lamps = bpy.data.collections.new("Lamps")
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamps.objects.link(lamp)
    for x in range(3):
        instancer = add(f"Instancer {x}", None, location=(x, 0, 0))
        instancer.instance_type, instancer.instance_collection = "COLLECTION", lamps
    builder, _ = export()
    assert [tuple(light["p"]) for light in builder.lights] == [(0, 0, 0), (1, 0, 0), (2, 0, 0)]


def test_random_numbers_are_different_and_stay():
    shared = square()
    parent = add("Parent", square("Parent"), instance_type="VERTS")
    for name in ("a", "b"):
        add(name, shared)
    add("Child", shared, parent=parent)
    numbers = [[p.random for p in export()[0].placements] for _ in range(2)]
    assert numbers[0] == numbers[1]
    assert len(set(numbers[0])) == len(numbers[0])
    assert 0 <= min(numbers[0]) < max(numbers[0]) < 1


# ---- Materials of instances ------------------------------------------------------------------------------------------


def names_of_materials(builder, name):
    return [builder.materials[m].name for m in placement(builder, name)[0].materials]


def test_a_slot_may_belong_to_the_object_or_to_the_mesh():
    shared = square()
    shared.materials.append(material("Of the mesh"))
    add("Plain", shared)
    own = add("Own", shared)
    own.material_slots[0].link = "OBJECT"
    own.material_slots[0].material = material("Of the object")
    builder, _ = export()
    assert names_of_materials(builder, "Plain") == ["Of the mesh"]
    assert names_of_materials(builder, "Own") == ["Of the object"]
    assert len(builder.geometries) == 1


def test_an_empty_slot_and_no_slot_are_the_default_grey():
    b_mesh = square()
    b_mesh.materials.append(None)
    b_mesh.materials.append(material("Real"))
    add("Empty slot", b_mesh)
    add("No slot", square("No slot"))
    builder, warnings = export()
    assert warnings == []
    assert names_of_materials(builder, "Empty slot") == ["(none)", "Real"]
    assert names_of_materials(builder, "No slot") == ["(none)"]


def test_the_view_layer_may_override_all_materials(scene):
    b_mesh = square()
    b_mesh.materials.append(material("Own"))
    add("Object", b_mesh)
    scene.view_layers[0].material_override = material("Clay")
    assert names_of_materials(export()[0], "Object") == ["Clay"]


def test_pass_indices_are_in():
    b_mesh = square()
    b_mesh.materials.append(material("Material"))
    material("Material").pass_index = 7
    add("Object", b_mesh).pass_index = 3
    builder, _ = export()
    found, _ = placement(builder, "Object")
    assert found.pass_index == 3
    assert builder.materials[found.materials[0]].pass_index == 7


# ---- What is seen by what --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("switch", "ray"),
    [
        ("visible_camera", Visibility.CAMERA),
        ("visible_diffuse", Visibility.DIFFUSE),
        ("visible_glossy", Visibility.GLOSSY),
        ("visible_transmission", Visibility.TRANSMISSION),
        ("visible_volume_scatter", Visibility.SCATTER),
        ("visible_shadow", Visibility.SHADOW),
    ],
)
def test_a_ray_switched_off_is_off_for_the_object_and_for_what_it_instances(switch, ray):
    parts = bpy.data.collections.new("Parts")
    parts.objects.link(bpy.data.objects.new("Part", square("Part")))
    setattr(add("Object", square("Object")), switch, False)
    instancer = add("Instancer", None, instance_type="COLLECTION", instance_collection=parts)
    setattr(instancer, switch, False)
    add("Free", square("Free"))
    builder, _ = export()
    seen = {p.name: p.visibility for p in builder.placements}
    assert seen == {"Object": Visibility.ALL & ~ray, "Part": Visibility.ALL & ~ray, "Free": Visibility.ALL}


def test_an_object_that_no_ray_sees_is_not_exported():
    hidden = add("Hidden", square())
    for switch in ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(hidden, f"visible_{switch}", False)
    assert export()[0].placements == []


def test_a_final_render_leaves_out_what_is_hidden_from_renders():
    add("Shown", square("Shown"))
    add("Hidden", square("Hidden"), hide_render=True)
    add("Hidden in the viewport", square("Viewport"), hide_viewport=True)
    builder, _, _ = export_as_a_render()
    assert sorted(p.name for p in builder.placements) == ["Hidden in the viewport", "Shown"]


def test_collections_of_the_view_layer_decide(scene):
    layers = scene.view_layers[0].layer_collection.children
    for name in ("Excluded", "Indirect", "Holdout"):
        collection = bpy.data.collections.new(name)
        scene.collection.children.link(collection)
        collection.objects.link(bpy.data.objects.new(name, square(name)))
    layers["Excluded"].exclude = True
    layers["Indirect"].indirect_only = True
    layers["Holdout"].holdout = True
    builder, warnings, _ = export_as_a_render()
    assert {p.name: p.visibility for p in builder.placements} == {
        "Indirect": Visibility.ALL & ~Visibility.CAMERA,
        "Holdout": Visibility.ALL,
    }
    assert warnings == []
    materials = {p.name: tuple(p.materials) for p in builder.placements}
    assert materials["Holdout"] != materials["Indirect"]


def test_shadow_catchers_are_named_as_missing():
    add("Catcher", square()).is_shadow_catcher = True
    assert any(w.startswith("Catcher: shadow catchers") for w in export()[1])


def test_the_scene_decides_whether_the_film_is_transparent(scene):
    for value in (True, False):
        scene.render.film_transparent = value
        assert export_as_a_render()[2] == {"transparent_background": int(value)}


# ---- What the mixture integrator aims at -----------------------------------------------------------------------------


@pytest.mark.parametrize("aim", ["AUTOMATIC", "ALWAYS", "NEVER"])
def test_it_is_told_whether_to_aim_at_an_object(registered, aim):
    """Each object has its own choice, instances too, though they share a mesh."""
    shared = square()
    add("Plain", shared)
    add("Chosen", shared).lambent.aim = aim
    parts = bpy.data.collections.new("Parts")
    parts.objects.link(bpy.data.objects.new("Part", shared))
    parts.objects[0].lambent.aim = aim
    add("Instancer", None, instance_type="COLLECTION", instance_collection=parts)
    builder, _ = export()

    aims = {p.name: p.aim.name for p in builder.placements}

    assert aims == {"Plain": "AUTOMATIC", "Chosen": aim, "Part": aim}


def test_a_lamp_can_be_left_out_of_aiming(registered):
    for name, kind in (("Point", "POINT"), ("Spot", "SPOT"), ("Sun", "SUN"), ("Area", "AREA")):
        lamp = bpy.data.lights.new(name, kind)
        lamp.energy = 10
        add(name, lamp)
        add(f"{name} left out", lamp).lambent.aim = "NEVER"
    builder, _ = export()

    assert sorted(int(light["aimed_at"]) for light in builder.lights) == [0, 0, 0, 0, 1, 1, 1, 1]
