# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume nodes become the closures they stand for."""

import bpy
import pytest

from addon.core import SceneBuilder
from addon.core import materials as m
from addon.core import volumes as v
from addon.export import Report
from addon.export.context import Context
from addon.export.volumes import owned_volume
from blender_tests.helpers.exported import export
from blender_tests.helpers.shader_nodes import COLOR, RGB, link, material_tree, node, output_node, socket


@pytest.fixture(autouse=True)
def tree():
    return material_tree()


def volume(tree, b_node):
    """(closure, warnings) of a node that is linked to the output's volume."""
    link(tree, b_node, output_node(tree), "Volume")
    report = Report()
    context = Context(bpy.context.evaluated_depsgraph_get(), report, SceneBuilder(), 64, 48)
    return owned_volume(context, bpy.data.materials["Material"]), report.warnings


PHASES = [
    ("HENYEY_GREENSTEIN", v.HenyeyGreenstein(0.25)),
    ("FOURNIER_FORAND", v.FournierForand(1.5, 0.25)),
    ("DRAINE", v.Draine(0.25, 0.75)),
    ("RAYLEIGH", v.Rayleigh()),
    ("MIE", v.Mie(8.0)),
]


@pytest.mark.parametrize(("phase", "expected"), PHASES)
def test_scattering_has_its_phase_function(tree, phase, expected):
    b_node = node(tree, "VolumeScatter", Color=COLOR, Density=2.0)
    b_node.phase = phase
    for name, value in {"Anisotropy": 0.25, "IOR": 1.5, "Backscatter": 0.25, "Alpha": 0.75, "Diameter": 8.0}.items():
        socket(b_node, name).default_value = value
    closure, warnings = volume(tree, b_node)
    assert (closure.color, closure.density, warnings) == (pytest.approx(RGB), 2.0, [])
    assert closure.phase == expected


def test_smoke_and_fire(tree):
    inputs = {"Color": COLOR, "Density": 0.5, "Emission_Strength": 2.0, "Blackbody_Intensity": 1.0}
    closure, warnings = volume(tree, node(tree, "VolumePrincipled", **inputs, Temperature=1500.0))
    assert warnings == []
    assert closure.color == pytest.approx(RGB)
    values = closure.density, closure.emission_strength, closure.blackbody_intensity, closure.temperature
    assert values == (0.5, 2.0, 1.0, 1500.0)


def test_volumes_are_mixed_and_added(tree):
    mix = node(tree, "MixShader", Fac=0.25)
    link(tree, node(tree, "VolumeAbsorption", Density=3.0), mix, "Shader")
    link(tree, node(tree, "Emission", Strength=3.0), mix, "Shader_001")
    closure, _ = volume(tree, mix)
    assert isinstance(closure, m.Mix)
    assert (closure.factor, closure.a.density, closure.b) == (0.25, 3.0, m.Emission(m.WHITE, 3.0))


def test_density_that_varies_is_named_with_what_is_used_instead(tree):
    b_node = node(tree, "VolumeScatter", Density=1.5)
    tree.links.new(node(tree, "TexNoise").outputs[0], b_node.inputs["Density"])
    closure, warnings = volume(tree, b_node)
    assert closure.density == 1.5
    assert len(warnings) == 1
    assert "Density" in warnings[0]
    assert "1.5" in warnings[0]


def test_a_surface_shader_fills_nothing(tree):
    closure, warnings = volume(tree, node(tree, "BsdfDiffuse"))
    assert closure == m.Black()
    assert len(warnings) == 1


def test_the_world_has_a_volume():
    world = bpy.context.scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    scatter = world.node_tree.nodes.new("ShaderNodeVolumeScatter")
    output = next((n for n in world.node_tree.nodes if n.type == "OUTPUT_WORLD"), None)
    output = output or world.node_tree.nodes.new("ShaderNodeOutputWorld")
    world.node_tree.links.new(scatter.outputs[0], output.inputs["Volume"])
    builder, _ = export()
    assert builder.world_medium.scattering == pytest.approx(scatter.inputs["Color"].default_value[:3])
