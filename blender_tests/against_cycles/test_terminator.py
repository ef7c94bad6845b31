# SPDX-License-Identifier: GPL-3.0-or-later
"""The edge of the shadow on smooth meshes of few faces, pixel by pixel: where Cycles has it.

A sheet of objects under a sun without size, seen with every sample in the middle of its pixel: there is no noise.
"""

import tempfile
from pathlib import Path

import bpy
import numpy as np
import pytest

from blender_tests.helpers.cycles import set_up_cycles
from blender_tests.helpers.engines import enable_engines
from blender_tests.helpers.exported import add, empty_scene
from blender_tests.helpers.small_blend import render

CELL, COLUMNS = 40, 4
SQUEEZED = (0.45, 0.3, 0.6)
# {name: (geometry offset, shading offset, shader, scale)}
BALLS = {
    "by default": (0.1, 0.0, "Diffuse", (1, 1, 1)),
    "as it is": (0.0, 0.0, "Diffuse", (1, 1, 1)),
    "far": (0.6, 0.0, "Diffuse", (1, 1, 1)),
    "squeezed": (0.3, 0.0, "Diffuse", SQUEEZED),
    "large": (0.3, 0.0, "Diffuse", (2, 2, 2)),
    "inside out": (0.3, 0.0, "Diffuse", (-1, 1, 1)),
    "glossy": (0.3, 0.0, "Glossy", (1, 1, 1)),
    "open and inside out": (0.3, 0.0, "Diffuse", (1, -1, 1)),
    "drawn over": (0.0, 0.5, "Diffuse", (1, 1, 1)),
    "drawn over all": (0.2, 1.0, "Diffuse", (1, 1, 1)),
    "glossy and drawn over": (0.1, 0.7, "Glossy", (1, 1, 1)),
    "open": (0.3, 0.0, "Diffuse", (1, 1, 1)),
}


def balls():
    """Each has a cell of its own, so that none is in another's shadow."""
    scene = empty_scene()
    rows = len(BALLS) // COLUMNS
    scene.render.resolution_x, scene.render.resolution_y = COLUMNS * CELL, rows * CELL
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", COLUMNS
    scene.camera.location = (COLUMNS / 2, rows / 2, 10)
    sun = add("Sun", bpy.data.lights.new("Sun", "SUN"), rotation_euler=(0.9, 0.5, 0.0))
    sun.data.energy, sun.data.angle = 3.0, 0.0
    for number, (name, (geometry, shading, shader, scale)) in enumerate(BALLS.items()):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.45 / max(map(abs, scale)))
        ball = bpy.context.object
        ball.name = name
        ball.data.shade_smooth()
        if "open" in name:
            cut_in_half(ball.data)
        ball.scale, ball.rotation_euler = scale, (0.3, 0.2, 0.1)
        ball.location = (number % COLUMNS + 0.5, number // COLUMNS + 0.5, 0.0)
        ball.shadow_terminator_geometry_offset, ball.shadow_terminator_shading_offset = geometry, shading
        material = bpy.data.materials.new(name)
        if bpy.app.version < (5, 0):
            material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        closure, output = tree.nodes.new(f"ShaderNodeBsdf{shader}"), tree.nodes.new("ShaderNodeOutputMaterial")
        closure.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1.0)
        if shader == "Glossy":
            closure.inputs["Roughness"].default_value = 0.7
        tree.links.new(closure.outputs[0], output.inputs["Surface"])
        ball.data.materials.append(material)
    return scene


def cut_in_half(b_mesh):
    """Leave the faces that look at the camera."""
    import bmesh

    faces = bmesh.new()
    faces.from_mesh(b_mesh)
    below = [face for face in faces.faces if face.calc_center_median().z < 0.0]
    bmesh.ops.delete(faces, geom=below, context="FACES")
    faces.to_mesh(b_mesh)


@pytest.fixture(scope="module")
def pictures():
    """{name: (Lambent's pixels, Cycles')}"""
    enable_engines()
    scene = balls()
    set_up_cycles(scene, samples=1)
    scene.cycles.max_bounces = scene.lambent.max_bounces = 0
    for ours in (scene.lambent, scene.cycles):
        ours.filter_width = 0.01
    scene.lambent.samples, scene.lambent.filter_type, scene.cycles.pixel_filter_type = 16, "BOX", "BOX"
    with tempfile.TemporaryDirectory() as folder:
        theirs = render(Path(folder, "cycles.exr"), scene)
        scene.render.engine = "LAMBENT"
        ours = render(Path(folder, "lambent.exr"), scene)
    cells = {}
    for number, name in enumerate(BALLS):
        x, y = number % COLUMNS * CELL, number // COLUMNS * CELL
        cells[name] = tuple(picture[y : y + CELL, x : x + CELL, 0].astype(float) for picture in (ours, theirs))
    return cells


@pytest.mark.parametrize("name", BALLS)
def test_shadows_set_in_where_they_do_in_cycles(pictures, name):
    ours, theirs = pictures[name]
    assert (theirs > 0.01).mean() > 0.05
    different = np.abs(ours - theirs) > 0.003 + 0.01 * theirs
    assert different.mean() < 0.006  # single pixels, at outlines and where a ray just passes an edge
    assert ours.sum() == pytest.approx(theirs.sum(), rel=0.003)
