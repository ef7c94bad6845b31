# SPDX-License-Identifier: GPL-3.0-or-later
"""What an object's settings do to the picture is what they do in Cycles."""

from functools import partial

import bpy
import numpy as np
import pytest

from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with

SIZE, SAMPLES, BLOCK = (64, 64), 512, 4


def stage():
    """A floor without a material, a soft sun, a plain sky."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    use_nodes(scene.world)
    sky = next(n for n in scene.world.node_tree.nodes if n.type == "BACKGROUND")
    sky.inputs["Color"].default_value = (0.3, 0.4, 0.5, 1)
    bpy.ops.mesh.primitive_plane_add(size=10, location=(0, 0, -1))
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.rotation_euler, sun.data.energy, sun.data.angle = (0.6, 0, 0.6), 3, 0.2
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0, -6, 1), (1.4, 0, 0)
    for new in (sun, camera):
        scene.collection.objects.link(new)
    scene.camera = camera


def use_nodes(b_owner):
    if bpy.app.version < (5, 0):  # later ones always do
        b_owner.use_nodes = True


def suzanne(smooth=False, **properties):
    """Suzanne on the stage. Cycles shall not move shadows off smooth faces, which is a look, not light."""
    bpy.ops.mesh.primitive_monkey_add()
    b_object = bpy.context.object
    if smooth:
        b_object.data.shade_smooth()
    b_object.shadow_terminator_geometry_offset = 0.0
    for name, value in properties.items():
        setattr(b_object, name, value)
    return b_object


def give(b_object, kind, **inputs):
    material = bpy.data.materials.new(kind)
    use_nodes(material)
    tree = material.node_tree
    shader = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    b_object.data.materials.append(material)


def without_material():
    suzanne()


def smooth_and_mirrored():
    give(suzanne(smooth=True, scale=(-1, 1.3, 0.8)), "BsdfDiffuse", Color=(0.8, 0.3, 0.2, 1))


def shining_and_mirrored():
    give(suzanne(scale=(1, -1, 1)), "Emission", Strength=2.0)


def two_instances():
    """One of them mirrored, so that neither is the mesh as it is."""
    first = suzanne(location=(-1.2, 0, 0), rotation_euler=(0.3, 0, 0.5))
    give(first, "BsdfTranslucent")
    second = bpy.data.objects.new("Second", first.data)
    second.location, second.scale = (1.2, 0, 0), (-0.9, 0.7, 1.2)
    bpy.context.scene.collection.objects.link(second)


def two_materials():
    b_object = suzanne()
    give(b_object, "BsdfDiffuse", Color=(0.8, 0.1, 0.1, 1))
    give(b_object, "BsdfDiffuse", Color=(0.1, 0.1, 0.8, 1))
    faces = b_object.data.polygons
    faces.foreach_set("material_index", [int(face.center.z > 0.2) for face in faces])


def switched_off(name):
    give(suzanne(**{name: False}), "BsdfDiffuse", Color=(0.8, 0.3, 0.2, 1))


def points():
    bpy.ops.object.pointcloud_random_add()
    for point in bpy.context.object.data.points:
        point.radius = 0.15


def dark_world_for_the_camera():
    suzanne()
    bpy.context.scene.world.cycles_visibility.camera = False


SCENES = {
    f.__name__: f
    for f in (without_material, smooth_and_mirrored, shining_and_mirrored, two_instances, two_materials, points)
}
SCENES.update({n: partial(switched_off, n) for n in ("visible_camera", "visible_shadow", "visible_diffuse")})
SCENES["dark_world_for_the_camera"] = dark_world_for_the_camera


def build(name):
    stage()
    SCENES[name]()


@pytest.mark.parametrize("name", SCENES)
def test_it_looks_as_in_cycles(name):
    source = partial(build, name)
    scene = open_for_both(source, SIZE)
    ours, _ = render_with("LAMBENT", scene, SAMPLES)
    theirs = cycles_picture(source, SAMPLES, SIZE)
    ours, theirs = (
        picture[..., :3].reshape(SIZE[1] // BLOCK, BLOCK, SIZE[0] // BLOCK, BLOCK, 3).mean(axis=(1, 3), dtype=float)
        for picture in (ours, theirs)
    )
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.005)
    assert abs(ours - theirs).max() < 0.03 * theirs.max()
    assert np.isfinite(ours).all()


def hole():
    """A holdout above the floor, which has its colour and casts a shadow; both are seen in a mirror, too."""
    stage()
    give(suzanne(is_holdout=True), "BsdfDiffuse", Color=(0.8, 0.2, 0.1, 1))
    bpy.ops.mesh.primitive_plane_add(size=4, location=(0, 2, 0), rotation=(1.2, 0, 0))
    give(bpy.context.object, "BsdfGlossy", Roughness=0.0)
    bpy.context.scene.render.film_transparent = True


def test_a_holdout_leaves_a_hole_for_the_camera_alone():
    scene = open_for_both(hole, SIZE)
    ours, _ = render_with("LAMBENT", scene, SAMPLES)
    theirs = cycles_picture(hole, SAMPLES, SIZE)
    assert 0.1 < (theirs[..., 3] < 0.5).mean() < 0.9
    assert np.abs(ours[..., 3] - theirs[..., 3]).mean() < 0.003
    assert ours[..., :3].mean((0, 1)) == pytest.approx(theirs[..., :3].mean((0, 1)), rel=0.005)
