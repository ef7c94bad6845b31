# SPDX-License-Identifier: GPL-3.0-or-later
"""What nodes say of strands: pixel by pixel the same as in Cycles."""

import bpy
import numpy as np
import pytest

from blender_tests.helpers.engines import cells_in_both
from blender_tests.helpers.exported import add, empty_scene, square
from blender_tests.helpers.node_sheet import shine

CELL, COLUMNS = 24, 5


def curves(where, b_material, kind="CATMULL_ROM"):
    """Seven strands that bend in the plane, of five points each, with attributes."""
    b_curves = bpy.data.hair_curves.new("Strands")
    b_curves.add_curves([5] * 7)
    along, across = np.meshgrid(np.linspace(-0.45, 0.45, 5), np.linspace(-0.4, 0.4, 7))
    places = np.stack([along, across + 0.06 * np.array([0, 1, 1, 0, 1]), np.zeros_like(along)], axis=2)
    b_curves.attributes["position"].data.foreach_set("vector", places.astype(np.float32).ravel())
    b_curves.set_types(type=kind)
    random = np.random.default_rng(8)
    for name, kind, domain, key, count, size in (
        ("radius", "FLOAT", "POINT", "value", 35, 1),
        ("Heat", "FLOAT", "POINT", "value", 35, 1),
        ("Flow", "FLOAT_VECTOR", "POINT", "vector", 35, 3),
        ("Paint", "FLOAT_COLOR", "CURVE", "color", 7, 4),
        ("surface_uv_coordinate", "FLOAT2", "CURVE", "vector", 7, 2),
        ("Other", "FLOAT2", "CURVE", "vector", 7, 2),
        ("Number", "INT", "CURVE", "value", 7, 1),
    ):
        values = np.full(count * size, 0.04) if name == "radius" else random.random(count * size)
        values = (values * 5).astype(np.int32) if kind == "INT" else values.astype(np.float32)
        b_curves.attributes.new(name, kind, domain).data.foreach_set(key, values)
    b_curves.materials.append(b_material)
    add("Strands", b_curves, location=where)


def straight_curves(where, b_material):
    curves(where, b_material, "POLY")


def curves_with_handles(where, b_material):
    curves(where, b_material, "BEZIER")


def particles(where, b_material):
    """Hair that stands on a square with two UV maps and a colour."""
    b_mesh = square()
    for name, scale in (("First", 0.3), ("Second", 0.5)):
        uvs = np.array([v.co[:2] for v in b_mesh.vertices], np.float32) * scale + 0.5
        b_mesh.uv_layers.new(name=name).uv.foreach_set("vector", uvs.ravel())
    colors = b_mesh.color_attributes.new("Paint", "BYTE_COLOR", "CORNER")
    colors.data.foreach_set("color", np.array([(1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1), (1, 1, 0, 1)], "f4").ravel())
    b_mesh.materials.append(b_material)
    emitter = add("Emitter", b_mesh, location=where, scale=(0.4, 0.4, 0.4), show_instancer_for_render=False)
    emitter.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = emitter.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length, settings.render_step = "HAIR", 60, 0.1, 2
    settings.radius_scale, settings.root_radius, settings.tip_radius = 0.1, 1.0, 1.0
    settings.use_close_tip, settings.normal_factor, settings.tangent_factor = False, 0.02, 0.05


def _attribute(name, output="Color"):
    return (output, "Attribute", 0.3, 0.1), {"attribute_name": name}


CASES = {
    "number at points": (curves, *_attribute("Heat", "Fac")),
    "vector at points": (curves, *_attribute("Flow")),
    "colour of curves": (curves, *_attribute("Paint")),
    "alpha of curves": (curves, *_attribute("Paint", "Alpha")),
    "integer of curves": (curves, *_attribute("Number", "Fac")),
    "colour attribute": (curves, ("Color", "VertexColor", 0.5, 0.1), {"layer_name": "Paint"}),
    "second UV map": (curves, ("UV", "UVMap", 0.5, 0.1), {"uv_map": "Other"}),
    "UV map": (curves, ("UV", "TexCoord", 0.5, 0.1), {}),
    "generated": (curves, ("Generated", "TexCoord", 0.5, 0.1), {}),
    "intercept": (curves, ("Intercept", "HairInfo"), {}),
    "attribute that is not there": (curves, *_attribute("Nowhere")),
    "points of straight curves": (straight_curves, *_attribute("Heat")),
    "curves with handles": (curves_with_handles, *_attribute("Paint")),
    "UV of hair": (particles, ("UV", "TexCoord", 0.5, 0.1), {}),
    "second UV map of hair": (particles, ("UV", "UVMap", 0.5, 0.1), {"uv_map": "Second"}),
    "colour of hair": (particles, *_attribute("Paint")),
    "generated of hair": (particles, ("Generated", "TexCoord", 0.5, 0.1), {}),
}


def strands():
    scene = empty_scene()
    rows = -(-len(CASES) // COLUMNS)
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", COLUMNS * 1.2
    scene.camera.location = (COLUMNS * 0.6, rows * 0.6, 10)
    scene.cycles_curves.shape = "THICK"
    scene.lambent.use_adaptive, scene.lambent.filter_type, scene.lambent.filter_width = False, "BOX", 0.01
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
    for number, (make, arguments, properties) in enumerate(CASES.values()):
        where = (number % COLUMNS * 1.2 + 0.6, number // COLUMNS * 1.2 + 0.6, 0.0)
        make(where, shine(*arguments, **properties))


@pytest.fixture(scope="module")
def pictures():
    """(ours, theirs) by case."""
    return cells_in_both(strands, CASES, COLUMNS, CELL)


@pytest.mark.parametrize("name", CASES)
def test_nodes_say_of_strands_what_they_say_in_cycles(pictures, name):
    """But for a few pixels at outlines, and ends of straight strands, which are round in Cycles."""
    ours, theirs = pictures[name]
    shines = theirs.any(axis=-1)
    assert shines.mean() > 0.1
    difference = np.abs(ours - theirs).max(axis=-1)[shines]
    assert np.mean(difference > 1e-2) < 0.1, f"{np.median(difference):.2g}"
