# SPDX-License-Identifier: GPL-3.0-or-later
"""Shading nodes become the closures they stand for."""

import bpy
import pytest

from addon.core import ProgramTables, SceneBuilder
from addon.core import materials as m
from blender_tests.helpers.shader_nodes import (
    COLOR,
    RGB,
    close,
    link,
    material_tree,
    node,
    numbers,
    output_node,
    socket,
    surface,
    translated,
)


@pytest.fixture(autouse=True)
def tree():
    return material_tree()


# ---- Each node by its constant values --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "inputs", "expected"),
    [
        ("BsdfDiffuse", {"Color": COLOR}, m.Diffuse(RGB)),
        ("BsdfTranslucent", {"Color": COLOR}, m.Translucent(RGB)),
        ("BsdfTransparent", {"Color": COLOR}, m.Transparent(RGB)),
        (
            "BsdfAnisotropic",
            {"Color": COLOR, "Roughness": 0.3, "Anisotropy": 0.6},
            m.Glossy(RGB, roughness=0.3, anisotropy=0.6, multiscatter=True),
        ),
        (
            "BsdfGlass",
            {"Color": COLOR, "Roughness": 0.3, "IOR": 1.3},
            m.Glass(RGB, 0.3, 1.3, multiscatter=True, loose=True),
        ),
        ("BsdfRefraction", {"Color": COLOR, "Roughness": 0.3, "IOR": 1.3}, m.Refraction(RGB, 0.3, 1.3, loose=True)),
        ("Emission", {"Color": COLOR, "Strength": 7.0}, m.Emission(RGB, 7.0)),
        ("Background", {"Color": COLOR, "Strength": 7.0}, m.Emission(RGB, 7.0)),
        (
            "BsdfMetallic",
            {"Base_Color": COLOR, "Edge_Tint": (0.9, 0.8, 0.7, 1), "Roughness": 0.3, "Anisotropy": -0.5},
            m.Metallic(RGB, (0.9, 0.8, 0.7), roughness=0.3, anisotropy=-0.5, multiscatter=True),
        ),
        (
            "BsdfPrincipled",
            {
                "Base_Color": COLOR, "Metallic": 0.1, "Roughness": 0.2, "IOR": 1.3, "Alpha": 0.4,
                "Specular_IOR_Level": 0.6, "Specular_Tint": (0.7, 0.8, 0.9, 1), "Anisotropic": 0.35,
                "Transmission_Weight": 0.45, "Coat_Weight": 0.55, "Coat_Roughness": 0.65, "Coat_IOR": 1.75,
                "Coat_Tint": (0.5, 0.4, 0.3, 1), "Emission_Color": (0.3, 0.2, 0.1, 1), "Emission_Strength": 5.0,
            },
            m.Principled(
                base_color=RGB, metallic=0.1, roughness=0.2, ior=1.3, alpha=0.4, specular_ior_level=0.6,
                specular_tint=(0.7, 0.8, 0.9), anisotropic=0.35, transmission=0.45, coat_weight=0.55,
                coat_roughness=0.65, coat_ior=1.75, coat_tint=(0.5, 0.4, 0.3), emission_color=(0.3, 0.2, 0.1),
                emission_strength=5.0, multiscatter=True, loose=True,
            ),
        ),
    ],
)  # fmt: skip
def test_a_node_becomes_its_closure(tree, kind, inputs, expected):
    b_node = node(tree, kind, **inputs)
    if hasattr(b_node, "distribution"):
        b_node.distribution = "GGX" if kind == "BsdfRefraction" else "MULTI_GGX"
    closure = surface(tree, b_node)
    assert type(closure) is type(expected)
    assert numbers(closure) == close(expected)


@pytest.mark.parametrize("method", ["RANDOM_WALK", "RANDOM_WALK_SKIN", "RANDOM_WALK_LEGACY"])
def test_subsurface_scattering_has_its_method_and_its_radius_in_metres(tree, method):
    """Blender 4 has but one random walk besides that for skin: the one that later became the legacy one."""
    b_node = node(tree, "SubsurfaceScattering", Color=COLOR, Radius=(1, 2, 3), Scale=0.1, Roughness=0.3)
    legacy = "RANDOM_WALK_LEGACY" in b_node.bl_rna.properties["falloff"].enum_items
    b_node.falloff = method if legacy else method.removesuffix("_LEGACY")
    kind = {"RANDOM_WALK_SKIN": "SKIN", "RANDOM_WALK": "RANDOM_WALK" if legacy else "LEGACY"}.get(method, "LEGACY")
    expected = m.Subsurface(RGB, (0.1, 0.2, 0.3), 0.3, kind=m.SubsurfaceKind[kind])
    assert numbers(surface(tree, b_node)) == close(expected)
    weighted = node(tree, "BsdfPrincipled", Subsurface_Weight=0.4, Subsurface_Radius=(1, 2, 3), Subsurface_Scale=0.1)
    weighted.subsurface_method = b_node.falloff
    closure = surface(tree, weighted)
    assert (closure.subsurface_weight, closure.subsurface_kind) == (pytest.approx(0.4), expected.kind)
    assert closure.subsurface_radius == pytest.approx(expected.radius)


def test_christensen_burley_is_told_to_be_a_random_walk(tree):
    b_node = node(tree, "SubsurfaceScattering")
    b_node.falloff = "BURLEY"
    link(tree, b_node, output_node(tree))
    closure, (warning,) = translated()
    assert closure.kind == m.SubsurfaceKind.LEGACY
    assert "Christensen-Burley is not rendered" in warning


def test_a_physical_metal_has_a_complex_index_of_refraction(tree):
    b_node = node(tree, "BsdfMetallic", IOR=(1.1, 1.2, 1.3), Extinction=(2.1, 2.2, 2.3))
    b_node.fresnel_type, b_node.distribution = "PHYSICAL_CONDUCTOR", "GGX"
    closure = surface(tree, b_node)
    assert closure.ior == pytest.approx((1.1, 1.2, 1.3))
    assert closure.extinction == pytest.approx((2.1, 2.2, 2.3))
    assert not closure.multiscatter


def test_every_closure_can_be_rendered(tree):
    """Whatever shader node there is in this Blender, its translation is a closure that the builder takes."""
    names = [n for n in dir(bpy.types) if n.startswith(("ShaderNodeBsdf", "ShaderNodeVolume", "ShaderNodeSubsurface"))]
    for name in [*names, "ShaderNodeEeveeSpecular", "ShaderNodeHoldout", "ShaderNodeEmission"]:
        b_node = tree.nodes.new(name)
        if b_node.outputs and b_node.outputs[0].type == "SHADER":
            link(tree, b_node, output_node(tree))
            closure, _ = translated()
            SceneBuilder().material(name, closure)


# ---- Combining -------------------------------------------------------------------------------------------------------


def test_mix_and_add_combine_their_shaders(tree):
    mix, add = node(tree, "MixShader", Fac=0.25), node(tree, "AddShader")
    link(tree, node(tree, "BsdfDiffuse", Color=COLOR), mix, "Shader")
    link(tree, add, mix, "Shader_001")
    link(tree, node(tree, "Emission", Strength=3.0), add, "Shader")
    link(tree, node(tree, "BsdfTransparent"), add, "Shader_001")
    closure = surface(tree, mix)
    assert closure == m.Mix(0.25, m.Diffuse(closure.a.color), m.Add(m.Emission(m.WHITE, 3.0), m.Transparent(m.WHITE)))
    assert closure.a.color == pytest.approx(RGB)


def test_a_mix_with_nothing_is_half_black(tree):
    mix = node(tree, "MixShader")
    link(tree, node(tree, "Emission"), mix, "Shader_001")
    assert surface(tree, mix) == m.Mix(0.5, m.Black(), m.Emission(m.WHITE, 1.0))


def test_nothing_linked_is_black(tree):
    assert translated() == (m.Black(), [])


def test_a_volume_without_a_surface_is_seen_through(tree):
    link(tree, node(tree, "VolumePrincipled"), output_node(tree), "Volume")
    assert translated() == (None, [])


def test_a_bare_colour_shines(tree):
    rgb = node(tree, "RGB")
    rgb.outputs[0].default_value = COLOR
    closure = surface(tree, rgb)
    assert (closure.color, closure.strength) == (pytest.approx(RGB), 1.0)


def test_the_active_output_for_cycles_counts(tree):
    link(tree, node(tree, "BsdfDiffuse", Color=COLOR), output_node(tree))
    output_node(tree).target = "EEVEE"
    other = tree.nodes.new("ShaderNodeOutputMaterial")
    other.target = "CYCLES"
    link(tree, node(tree, "Emission"), other)
    assert translated() == (m.Emission(m.WHITE, 1.0), [])


@pytest.mark.skipif(bpy.app.version >= (5, 0), reason="materials always have nodes since Blender 5.0")
def test_a_material_without_nodes_is_diffuse():
    b_material = bpy.data.materials.new("Plain")
    b_material.use_nodes, b_material.diffuse_color = False, COLOR
    closure, warnings = translated(b_material)
    assert closure.color == pytest.approx(RGB)
    assert warnings == []


def test_shaders_keep_normals_of_their_own(tree):
    mix, bump = node(tree, "MixShader"), node(tree, "Bump")
    tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs[0], bump.inputs["Height"])
    for kind, identifier in (("BsdfDiffuse", "Shader"), ("BsdfGlass", "Shader_001")):
        shader = node(tree, kind)
        link(tree, shader, mix, identifier)
        if kind == "BsdfGlass":
            link(tree, bump, shader, "Normal")
    link(tree, mix, output_node(tree))
    closure, warnings = translated()
    assert closure.a.normal is None
    assert closure.b.normal is not None
    assert warnings == []


@pytest.mark.parametrize("length", [40, 600])
def test_shaders_that_double_again_and_again_come_to_an_end(tree, length):
    last = node(tree, "BsdfDiffuse")
    for _ in range(length):
        mix = node(tree, "MixShader")
        link(tree, last, mix, "Shader")
        link(tree, last, mix, "Shader_001")
        last = mix
    link(tree, last, output_node(tree))
    _, warnings = translated()
    assert any("more than 1000 shaders" in w for w in warnings)


@pytest.mark.parametrize("length", [40, 600])
def test_values_that_double_again_and_again_come_to_an_end(tree, length):
    last = tree.nodes.new("ShaderNodeTexNoise")
    for _ in range(length):
        add = tree.nodes.new("ShaderNodeMath")
        for i in range(2):
            tree.links.new(last.outputs[0], add.inputs[i])
        last = add
    glass = node(tree, "BsdfGlass")
    link(tree, last, glass, "Roughness")
    link(tree, glass, output_node(tree))
    closure, warnings = translated()
    SceneBuilder().material("Doubled", closure)
    assert any("in a row" in w for w in warnings) == (length == 600)


# ---- Groups, reroutes, mute ------------------------------------------------------------------------------------------


def group_of_glass():
    """A group with a colour and a roughness; inside a group of its own, with inputs in another order, is the glass."""
    inner, outer = (bpy.data.node_groups.new(name, "ShaderNodeTree") for name in ("Inner", "Outer"))
    kinds = {"Color": "NodeSocketColor", "Roughness": "NodeSocketFloat"}
    for group, names in ((inner, ("Roughness", "Color")), (outer, ("Color", "Roughness"))):
        for name in names:
            group.interface.new_socket(name, in_out="INPUT", socket_type=kinds[name])
        group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    for group, kind in ((inner, "ShaderNodeBsdfGlass"), (outer, "ShaderNodeGroup")):
        start, middle, end = (group.nodes.new(name) for name in ("NodeGroupInput", kind, "NodeGroupOutput"))
        if group is outer:
            middle.node_tree = inner
        for name in kinds:
            group.links.new(start.outputs[name], middle.inputs[name])
        group.links.new(middle.outputs[0], end.inputs[0])
    return outer


def test_groups_in_groups_have_the_values_of_their_own_inputs(tree):
    group, mix = group_of_glass(), node(tree, "MixShader")
    for identifier, color, roughness in (("Shader", COLOR, 0.25), ("Shader_001", (1, 1, 0, 1), 0.5)):
        b_node = tree.nodes.new("ShaderNodeGroup")
        b_node.node_tree = group
        b_node.inputs[0].default_value, b_node.inputs[1].default_value = color, roughness
        link(tree, b_node, mix, identifier)
    closure = surface(tree, mix)
    assert (closure.a.color, closure.a.roughness) == (pytest.approx(RGB), 0.25)
    assert (closure.b.color, closure.b.roughness) == ((1, 1, 0), 0.5)


def test_a_linked_input_of_a_group_is_followed_out_of_it(tree):
    b_node = tree.nodes.new("ShaderNodeGroup")
    b_node.node_tree = group_of_glass()
    rgb = node(tree, "RGB")
    rgb.outputs[0].default_value = COLOR
    tree.links.new(rgb.outputs[0], b_node.inputs[0])
    assert surface(tree, b_node).color == pytest.approx(RGB)


def test_reroutes_are_followed(tree):
    first, second = tree.nodes.new("NodeReroute"), tree.nodes.new("NodeReroute")
    tree.links.new(node(tree, "BsdfDiffuse", Color=COLOR).outputs[0], first.inputs[0])
    tree.links.new(first.outputs[0], second.inputs[0])
    assert surface(tree, second).color == pytest.approx(RGB)


def test_a_reroute_that_comes_from_nowhere_leaves_the_value(tree):
    diffuse = node(tree, "BsdfDiffuse", Color=COLOR)
    tree.links.new(tree.nodes.new("NodeReroute").outputs[0], diffuse.inputs["Color"])
    assert surface(tree, diffuse).color == pytest.approx(RGB)


def test_a_muted_node_lets_its_input_through(tree):
    mix = node(tree, "MixShader")
    link(tree, node(tree, "BsdfDiffuse", Color=COLOR), mix, "Shader")
    link(tree, node(tree, "Emission"), mix, "Shader_001")
    mix.mute = True
    assert surface(tree, mix).color == pytest.approx(RGB)


def test_a_muted_link_is_none(tree):
    diffuse = node(tree, "BsdfDiffuse", Color=COLOR)
    tree.links.new(node(tree, "RGB").outputs[0], diffuse.inputs["Color"]).is_muted = True
    assert surface(tree, diffuse).color == pytest.approx(RGB)


# ---- Constant nodes are followed without a word ----------------------------------------------------------------------


def constant(value):
    """What the assembler makes of a value that depends on nothing."""
    return ProgramTables().constant(value)


def roughness_from(tree, b_node, output=0):
    glass = node(tree, "BsdfGlass")
    link(tree, b_node, glass, "Roughness", output)
    return constant(surface(tree, glass).roughness)


def test_value_nodes_are_followed(tree):
    value = node(tree, "Value")
    value.outputs[0].default_value = 0.375
    assert roughness_from(tree, value) == 0.375


@pytest.mark.parametrize(
    ("operation", "expected"),
    [("ADD", 0.75), ("SUBTRACT", 0.25), ("MULTIPLY", 0.125), ("DIVIDE", 2.0), ("MINIMUM", 0.25), ("POWER", 0.5**0.25)],
)
def test_arithmetic_on_constants_is_done(tree, operation, expected):
    b_node = tree.nodes.new("ShaderNodeMath")
    b_node.operation = operation
    b_node.inputs[0].default_value, b_node.inputs[1].default_value = 0.5, 0.25
    assert roughness_from(tree, b_node) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("blend_type", "expected"), [("MIX", (0.55, 0.2, 0.2)), ("MULTIPLY", (0.1, 0.12, 0.2)), ("ADD", (0.6, 0.3, 0.4))]
)
def test_mixing_of_constant_colours_is_done(tree, blend_type, expected):
    b_node = tree.nodes.new("ShaderNodeMix")
    b_node.data_type, b_node.blend_type = "RGBA", blend_type
    for identifier, value in (("Factor_Float", 0.5), ("A_Color", COLOR), ("B_Color", (1.0, 0.2, 0.0, 1))):
        socket(b_node, identifier).default_value = value
    diffuse = node(tree, "BsdfDiffuse")
    tree.links.new(next(o for o in b_node.outputs if o.type == "RGBA"), diffuse.inputs["Color"])
    assert constant(surface(tree, diffuse).color) == pytest.approx(expected)


def test_a_colour_for_a_number_counts_by_its_luminance(tree):
    rgb = node(tree, "RGB")
    rgb.outputs[0].default_value = (0.0, 1.0, 0.0, 1)
    assert roughness_from(tree, rgb) == pytest.approx(0.7152, abs=1e-3)


def test_blackbody_has_blenders_colour(tree):
    """Blender computes the same for lamps."""
    b_light = bpy.data.lights.new("Lamp", "POINT")
    b_light.use_temperature = True
    emission, blackbody = node(tree, "Emission"), node(tree, "Blackbody")
    link(tree, blackbody, emission, "Color")
    for kelvin in (2000, 3000, 6500, 10000):
        b_light.temperature = blackbody.inputs[0].default_value = kelvin
        color = constant(surface(tree, emission).color)
        assert color == pytest.approx(tuple(b_light.temperature_color), rel=0.02, abs=0.02)
