# SPDX-License-Identifier: GPL-3.0-or-later
"""What is not rendered yet has a stand-in, and is named with material, node and socket."""

import bpy
import numpy as np
import pytest

from addon.core import materials as m
from addon.export import Report
from addon.export.stand_in import average_fresnel, image_average
from blender_tests.helpers.shader_nodes import (
    COLOR,
    RGB,
    link,
    material_tree,
    node,
    output_node,
    translated,
)


@pytest.fixture(autouse=True)
def tree():
    return material_tree()


# ---- Stand-ins, by name ----------------------------------------------------------------------------------------------


def with_warning(tree, b_node):
    link(tree, b_node, output_node(tree))
    closure, (warning,) = translated()
    return closure, warning


def test_an_unknown_node_leaves_the_sockets_own_value(tree):
    diffuse = node(tree, "BsdfDiffuse", Color=COLOR)
    link(tree, node(tree, "NewGeometry"), diffuse, "Color")
    closure, warning = with_warning(tree, diffuse)
    assert closure.color == pytest.approx(RGB)
    assert warning.startswith("Material: Diffuse BSDF: Color is linked to Geometry")
    assert warning.endswith("using (0.1, 0.2, 0.4)")


def test_the_culprit_behind_arithmetic_is_named(tree):
    b_node, glass = tree.nodes.new("ShaderNodeMath"), node(tree, "BsdfGlass")
    b_node.operation = "MULTIPLY"
    tree.links.new(node(tree, "TexNoise").outputs[0], b_node.inputs[0])
    b_node.inputs[1].default_value = 0.5
    link(tree, b_node, glass, "Roughness")
    closure, warning = with_warning(tree, glass)
    assert closure.roughness == pytest.approx(0.25)  # half of a noise that is 0.5 on average
    assert "Noise Texture" in warning


def test_a_texture_stands_for_its_average_colour(tree):
    image = bpy.data.images.new("Checks", 2, 2, alpha=True, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    pixels = [(1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 0), (1, 1, 1, 0)]  # the last two are not there
    image.pixels.foreach_set(np.array(pixels, np.float32).ravel())
    diffuse, texture = node(tree, "BsdfDiffuse"), tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    link(tree, texture, diffuse, "Color")
    closure, warning = with_warning(tree, diffuse)
    assert closure.color == pytest.approx((0.5, 0.5, 0))
    assert "Image Texture" in warning


def test_an_image_in_srgb_is_averaged_in_linear_light():
    image = bpy.data.images.new("Grey", 2, 1)
    image.pixels.foreach_set(np.array([0, 0, 0, 1, 1, 1, 1, 1], np.float32))
    assert image_average(image, is_panorama=False) == pytest.approx((0.5, 0.5, 0.5, 1))
    image.pixels.foreach_set(np.array([0.5, 0.5, 0.5, 1] * 2, np.float32))
    assert image_average(image, is_panorama=False)[0] == pytest.approx(0.2140, abs=2e-3)  # 8 bits


def test_fresnel_stands_for_its_average():
    """Diffuse reflectance of a smooth surface of index 1.5 (Duntley 1942): 0.0918; and from inside, by reciprocity."""
    assert average_fresnel(1.5) == pytest.approx(0.0918, abs=1e-4)
    assert average_fresnel(1.0) == pytest.approx(0, abs=1e-6)
    assert average_fresnel(1 / 1.5) == pytest.approx(1 - (1 - average_fresnel(1.5)) / 1.5**2, rel=1e-3)


@pytest.mark.parametrize(
    ("kind", "identifier"),
    [("BsdfDiffuse", "Normal"), ("BsdfAnisotropic", "Normal"), ("BsdfPrincipled", "Normal"), ("BsdfGlass", "Normal")],
)
def test_bump_maps_are_named(tree, kind, identifier):
    b_node = node(tree, kind)
    link(tree, tree.nodes.new("ShaderNodeBump"), b_node, identifier)
    _, warning = with_warning(tree, b_node)
    assert warning == f"Material: {b_node.name}: Normal is linked to Bump, which is not rendered yet; left out"


@pytest.mark.parametrize(
    ("kind", "identifier", "value"),
    [
        ("BsdfDiffuse", "Roughness", 0.5),
        ("BsdfPrincipled", "Subsurface_Weight", 0.5),
        ("BsdfPrincipled", "Sheen_Weight", 0.5),
        ("BsdfPrincipled", "Diffuse_Roughness", 0.5),
        ("BsdfPrincipled", "Thin_Film_Thickness", 100.0),
    ],
)
def test_values_that_are_not_rendered_are_named(tree, kind, identifier, value):
    _, warning = with_warning(tree, node(tree, kind, **{identifier: value}))
    assert f"{identifier.replace('_', ' ')} is not rendered yet; taken as 0" in warning


def test_values_that_are_not_rendered_are_named_when_linked(tree):
    principled = node(tree, "BsdfPrincipled")
    link(tree, tree.nodes.new("ShaderNodeVertexColor"), principled, "Sheen Weight")
    _, warning = with_warning(tree, principled)
    assert "Sheen Weight is not rendered yet" in warning


def test_another_distribution_is_named(tree):
    b_node = node(tree, "BsdfAnisotropic")
    b_node.distribution = "BECKMANN"
    closure, warning = with_warning(tree, b_node)
    assert not closure.multiscatter
    assert "Beckmann" in warning


@pytest.mark.parametrize(
    ("kind", "stand_in"),
    [
        ("SubsurfaceScattering", m.Diffuse),
        ("BsdfSheen", m.Diffuse),
        ("BsdfToon", m.Diffuse),
        ("BsdfHair", m.Glossy),
        ("BsdfHairPrincipled", m.Diffuse),
        ("BsdfRayPortal", m.Transparent),
        ("EeveeSpecular", m.Principled),
        ("Holdout", m.Black),
    ],
)
def test_the_nearest_closure_stands_in(tree, kind, stand_in):
    b_node = node(tree, kind)
    closure, warning = with_warning(tree, b_node)
    assert isinstance(closure, stand_in)
    assert warning.startswith(f"Material: {b_node.name}: {b_node.bl_label} is not rendered yet")


def test_displacement_is_named(tree):
    link(tree, tree.nodes.new("ShaderNodeDisplacement"), output_node(tree), "Displacement")
    _, warning = with_warning(tree, node(tree, "BsdfDiffuse"))
    assert "displacement" in warning


def test_the_same_warning_comes_once():
    report = Report()
    for _ in range(3):
        report.warn("Ball", "is round")
    report.warn("Box", "is round")
    assert report.warnings == ["Ball: is round", "Box: is round"]
