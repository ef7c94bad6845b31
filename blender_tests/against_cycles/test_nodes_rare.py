# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of few materials: tilings, wires, properties of objects; pixel by pixel the same as in Cycles."""

import bpy
import numpy as np
import pytest

from blender_tests.helpers.engines import open_for_both, render_with
from blender_tests.helpers.exported import add as add_object
from blender_tests.helpers.exported import empty_scene, square
from blender_tests.helpers.node_sheet import add, compared, difference, position

CASES = {}
TOLERANCE = 1e-3  # of the value, or where that is below 1 of 1
NEW = bpy.app.version >= (5, 0)


def case(name):
    def keep(build):
        CASES[name] = build
        return build

    return keep


if NEW:
    for sides, roundness in ((5, 0.0), (5, 0.4), (2, 0.0), (3, 1.0), (4.3, 0.0), (4.3, 0.35), (6.7, 1.0), (2.4, 0.6)):
        for normalize in (False, True):
            for output in ("Segment Coordinates", "Segment Width", "Segment Rotation", "Segment ID"):

                @case(f"Radial Tiling {sides} {roundness} {normalize} {output}")
                def _(tree, inputs=(sides, roundness), normalize=normalize, output=output):
                    vector = position(tree, 1.1, (0.05, 0.03, 0.0))
                    node = add(tree, "RadialTiling", {0: vector, 1: inputs[0], 2: inputs[1]}, normalize=normalize)
                    return node.outputs[output]


for in_pixels, size in ((False, 0.3), (True, 2.5)):

    @case(f"Wireframe {in_pixels}")
    def _(tree, in_pixels=in_pixels, size=size):
        return add(tree, "Wireframe", {0: size}, use_pixel_size=in_pixels).outputs[0]


for kind, name in (
    ("OBJECT", "color"),
    ("OBJECT", "location"),
    ("OBJECT", "pass_index"),
    ("OBJECT", "nothing"),
    ("INSTANCER", "color"),
    ("VIEW_LAYER", "frame_current"),
    ("VIEW_LAYER", "color"),
    ("VIEW_LAYER", "nothing"),
):
    for output in ("Color", "Vector", "Fac", "Alpha"):
        case(f"Attribute {kind} {name} {output}")(
            lambda tree, kind=kind, name=name, output=output: add(
                tree, "Attribute", attribute_type=kind, attribute_name=name
            ).outputs[output]
        )


@pytest.fixture(scope="module")
def pictures():
    return compared(CASES)


@pytest.mark.parametrize("name", CASES)
def test_a_node_gives_what_it_gives_in_cycles(pictures, name):
    assert difference(*pictures[name]) <= TOLERANCE


# ---- Holdouts --------------------------------------------------------------------------------------------------------


def holdouts():
    """Squares before a bright one: all, a part and a varying part of each is a holdout; two stand behind each other."""
    scene = empty_scene()
    scene.render.film_transparent = True
    scene.camera.data.type, scene.camera.data.ortho_scale, scene.camera.location = "ORTHO", 8.0, (0.0, 0.0, 10.0)
    scene.lambent.filter_type, scene.lambent.filter_width, scene.lambent.use_adaptive = "BOX", 1.0, False
    factors = {"all": 1.0, "part": 0.3, "varying": None, "over": 0.6, "under": 0.5}
    places = {"all": (-3, 0, 1), "part": (-1, 0, 1), "varying": (1, 0, 1), "over": (3, 0.2, 2), "under": (3, 0, 1)}
    for name, factor in factors.items():
        b_object = add_object(name, square(), location=places[name], scale=(0.8, 0.8, 0.8))
        b_object.data.materials.append(held_out(name, factor, "Transparent" if name == "over" else "Emission"))
    wall = add_object("Wall", square(), location=(0.0, 1.0, 0.0), scale=(4.0, 1.0, 1.0))
    wall.data.materials.append(held_out("wall", 0.0, "Emission"))


def held_out(name, factor, kind):
    b_material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0):
        b_material.use_nodes = True
    tree = b_material.node_tree
    tree.nodes.clear()
    mix, holdout = add(tree, "MixShader"), add(tree, "Holdout")
    color = (0.9, 0.5, 0.2, 1.0)
    other = add(tree, "Emission", {0: color}) if kind == "Emission" else add(tree, "BsdfTransparent", {0: color})
    if factor is None:
        tree.links.new(add(tree, "TexGradient", {0: add(tree, "TexCoord").outputs["Object"]}).outputs[0], mix.inputs[0])
    else:
        mix.inputs[0].default_value = factor
    tree.links.new(other.outputs[0], mix.inputs[1])
    tree.links.new(holdout.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return b_material


@pytest.mark.parametrize("is_transparent", [True, False])
def test_holdouts_leave_empty_what_they_do_in_cycles(is_transparent):
    scene = open_for_both(holdouts, (64, 24))
    scene.render.film_transparent = is_transparent
    ours, theirs = (render_with(engine, scene, 64)[0] for engine in ("LAMBENT", "CYCLES"))
    assert len(np.unique(theirs[..., 3].round(2))) > (5 if is_transparent else 0)
    difference = np.abs(ours - theirs).max(axis=-1)
    assert np.mean(difference > 2e-3) < 0.15, "more than the pixels at outlines"
    assert difference.max() < 0.1


def objects_held_out():
    """As above, but holdouts are objects, by how much is transparent: nothing, parts, colours, glass; two in a row."""
    holdouts()
    for name, color, factor in (
        ("all", (0.0, 0.0, 0.0, 1.0), 0.5),
        ("part", (0.9, 0.5, 0.2, 1.0), 0.3),
        ("varying", (0.9, 0.5, 0.2, 1.0), None),
        ("under", (0.2, 0.6, 0.8, 1.0), 1.0),
    ):
        b_object = bpy.data.objects[name]
        b_object.is_holdout = True
        b_object.data.materials[0] = half_clear(name, color, factor)
    principled = bpy.data.materials.new("principled")
    if bpy.app.version < (5, 0):
        principled.use_nodes = True
    next(n for n in principled.node_tree.nodes if n.type == "BSDF_PRINCIPLED").inputs["Alpha"].default_value = 0.3
    above = add_object("Principled", square(), location=(1, -0.6, 3), scale=(0.5, 0.3, 0.5))
    above.data.materials.append(principled)
    above.is_holdout = True


def half_clear(name, color, factor):
    """Emission and Transparent of `color`, mixed by `factor`, or by a gradient."""
    b_material = held_out(f"clear {name}", factor, "Emission")
    tree = b_material.node_tree
    mix = next(n for n in tree.nodes if n.type == "MIX_SHADER")
    tree.links.new(add(tree, "BsdfTransparent", {0: color}).outputs[0], mix.inputs[2])
    return b_material


@pytest.mark.parametrize("is_transparent", [True, False])
def test_objects_that_are_holdouts_leave_holes_by_their_opacity(is_transparent):
    scene = open_for_both(objects_held_out, (64, 24))
    scene.render.film_transparent = is_transparent
    ours, theirs = (render_with(engine, scene, 64)[0] for engine in ("LAMBENT", "CYCLES"))
    if is_transparent:
        assert len(np.unique(theirs[..., 3].round(2))) > 5
    difference = np.abs(ours - theirs).max(axis=-1)
    assert np.mean(difference > 2e-3) < 0.15, "more than the pixels at outlines"
    assert difference.max() < 0.1
