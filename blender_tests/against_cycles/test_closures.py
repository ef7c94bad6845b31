# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's shader nodes scatter, with all their sockets: the same as in Cycles, for pairs of directions.

From the node to the pixel, in one sheet of squares: each is seen at a few angles and lit by a sun without size, so
there is no noise, and what is left are tables of energy that both engines measured for themselves.
"""

import bpy
import numpy as np
import pytest

import addon
from blender_tests.helpers.lobe_values import around, node, values_of_engines

COLOR, TINT = (0.9, 0.5, 0.2, 1.0), (0.2, 0.7, 1.0, 1.0)
COSINES = (1.0, 0.83, 0.5, 0.21)
DIRECTIONS = around((0.95, 0.6, 0.2), 3) + around((-0.5, -0.95), 3)


def principled(**inputs):
    return node("Principled", **{name.replace("_", " "): v for name, v in {"Base_Color": COLOR, **inputs}.items()})


def bent(closure, socket="Normal", normal=(0.3, -0.2, 0.93)):
    """The closure with a normal of its own."""

    def add(tree):
        output = closure(tree)
        vector = tree.nodes.new("ShaderNodeCombineXYZ")
        for value, slot in zip(normal, vector.inputs, strict=True):
            slot.default_value = value
        tree.links.new(vector.outputs[0], output.node.inputs[socket])
        return output

    return add


def mixed(a, b, factor=0.4):
    def add(tree):
        mix = tree.nodes.new("ShaderNodeMixShader")
        mix.inputs[0].default_value = factor
        for closure, slot in ((a, 1), (b, 2)):
            tree.links.new(closure(tree), mix.inputs[slot])
        return mix.outputs[0]

    return add


def all_of(kind, distributions, **inputs):
    return {
        f"{kind} {distribution} {r}": node(kind, {"distribution": distribution}, Color=COLOR, Roughness=r, **inputs)
        for distribution in distributions
        for r in (0.3, 0.6, 1.0)
    }


CASES = {
    **all_of("Glossy", ("GGX", "MULTI_GGX", "BECKMANN")),
    "Glossy Beckmann stretched": node(
        "Glossy", {"distribution": "BECKMANN"}, Color=COLOR, Roughness=0.6, Anisotropy=0.5
    ),
    "Glossy stretched": node("Glossy", Color=COLOR, Roughness=0.5, Anisotropy=0.6, Rotation=0.1),
    "Glossy squeezed": node("Glossy", Color=COLOR, Roughness=0.5, Anisotropy=-0.6),
    **all_of("Glass", ("GGX", "MULTI_GGX", "BECKMANN"), IOR=1.4),
    **all_of("Refraction", ("GGX",), IOR=1.4),
    "Refraction BECKMANN": node("Refraction", {"distribution": "BECKMANN"}, Color=COLOR, Roughness=0.8, IOR=1.4),
    "Metallic": node("Metallic", Roughness=0.4),
    "Metallic tinted": node("Metallic", **{"Base Color": COLOR, "Edge Tint": TINT, "Roughness": 0.4}),
    "Metallic stretched": node("Metallic", Roughness=0.4, Anisotropy=0.7, Rotation=0.3),
    "Metallic by index": node("Metallic", {"fresnel_type": "PHYSICAL_CONDUCTOR"}, Roughness=0.4),
    "Principled": principled(),
    "Principled sharp": principled(Roughness=0.2),
    "Principled metal": principled(Metallic=1.0, Roughness=0.4),
    "Principled metal tinted": principled(Metallic=1.0, Roughness=0.4, Specular_Tint=TINT),
    "Principled half metal": principled(Metallic=0.5),
    "Principled index": principled(IOR=2.2),
    "Principled low index": principled(IOR=0.8),
    "Principled specular level": principled(Specular_IOR_Level=0.9),
    "Principled no specular": principled(Specular_IOR_Level=0.0),
    "Principled specular tint": principled(Specular_Tint=TINT, IOR=2.0),
    "Principled diffuse roughness": principled(Diffuse_Roughness=0.7),
    "Principled stretched": principled(Anisotropic=0.8, Anisotropic_Rotation=0.2, Metallic=1.0),
    "Principled coat": principled(Coat_Weight=1.0, Coat_Roughness=0.3),
    "Principled coat tinted": principled(Coat_Weight=0.7, Coat_Roughness=0.2, Coat_IOR=1.9, Coat_Tint=TINT),
    "Principled sheen": principled(Sheen_Weight=1.0, Sheen_Roughness=0.4, Sheen_Tint=TINT),
    "Principled sheen and coat": principled(Sheen_Weight=0.6, Coat_Weight=0.8, Coat_Roughness=0.4),
    "Principled glass": principled(Transmission_Weight=1.0, Roughness=0.4),
    "Principled glass tinted": principled(Transmission_Weight=0.8, Roughness=0.4, Specular_Tint=TINT, IOR=1.8),
    "Principled alpha": principled(Alpha=0.6),
    "Diffuse bent": bent(node("Diffuse", Color=COLOR)),
    "Diffuse rough bent": bent(node("Diffuse", Color=COLOR, Roughness=0.8)),
    "Glossy bent": bent(node("Glossy", Color=COLOR, Roughness=0.5)),
    "Glass bent": bent(node("Glass", Color=COLOR, Roughness=0.5)),
    "Translucent bent": bent(node("Translucent", Color=COLOR)),
    "Sheen bent": bent(node("Sheen", Color=COLOR, Roughness=0.5)),
    "Toon bent": bent(node("Toon", Color=COLOR, Size=0.7, Smooth=0.3)),
    "Glossy bent away": bent(node("Glossy", Color=COLOR, Roughness=0.5), normal=(0.1, 0.9, -0.3)),
    "Diffuse bent away": bent(node("Diffuse", Color=COLOR), normal=(0.1, 0.9, -0.3)),
    "Two normals": mixed(bent(node("Diffuse", Color=COLOR)), node("Glossy", Color=TINT, Roughness=0.4)),
    "Principled bent": bent(principled(Roughness=0.4)),
    "Principled coat bent": bent(principled(Coat_Weight=1.0, Coat_Roughness=0.3), "Coat Normal"),
    "Principled sheen under a bent coat": bent(principled(Coat_Weight=0.5, Sheen_Weight=1.0), "Coat Normal"),
}
FILM = {"Thin Film Thickness": 420.0, "Thin Film IOR": 1.4}
if bpy.app.version >= (5, 0):  # earlier ones have other tables for films, no panes, and velvet that shines from below
    PHYSICAL = {"fresnel_type": "PHYSICAL_CONDUCTOR"}
    CASES |= {
        "Velvet bent": bent(node("Sheen", {"distribution": "ASHIKHMIN"}, Color=COLOR, Roughness=0.5)),
        "Metallic film": node("Metallic", **{"Base Color": COLOR, "Edge Tint": TINT, "Roughness": 0.4, **FILM}),
        "Metallic film by index": node("Metallic", PHYSICAL, Roughness=0.4, **FILM),
        "Glass film": node("Glass", {"distribution": "GGX"}, Roughness=0.4, **FILM),
        "Principled film": principled(Roughness=0.4, Thin_Film_Thickness=350.0),
        "Principled thick film": principled(Roughness=0.3, Thin_Film_Thickness=2500.0, Thin_Film_IOR=1.7),
        "Principled metal film": principled(Metallic=1.0, Roughness=0.4, Thin_Film_Thickness=700.0),
        "Principled glass film": principled(Transmission_Weight=1.0, Roughness=0.4, Thin_Film_Thickness=500.0),
        "Principled film tinted": principled(Specular_Tint=TINT, Thin_Film_Thickness=300.0, IOR=2.0),
        "Principled leaf": principled(Subsurface_Weight=0.8, Thin_Wall=True, Subsurface_Anisotropy=0.4),
        "Principled rough leaf": principled(Subsurface_Weight=1.0, Thin_Wall=True, Diffuse_Roughness=0.7),
        "Principled pane": principled(Transmission_Weight=1.0, Roughness=0.5, Thin_Wall=True),
        "Principled pane tinted": principled(
            Transmission_Weight=0.7, Roughness=0.6, Thin_Wall=True, Specular_Tint=TINT
        ),
        "Principled pane film": principled(
            Transmission_Weight=1.0, Roughness=0.5, Thin_Wall=True, Thin_Film_Thickness=400.0
        ),
    }


@pytest.fixture(scope="module")
def values():
    """{name: (values of Lambent, of Cycles), (directions, cosines, 3)}"""
    registered = hasattr(bpy.types.Scene, "lambent")
    if not registered:
        addon.register()
    ours, theirs = values_of_engines(list(CASES.values()), COSINES, DIRECTIONS, ["LAMBENT", "CYCLES"])
    return {name: (ours[:, row], theirs[:, row]) for row, name in enumerate(CASES)}


@pytest.mark.parametrize("name", CASES)
def test_a_node_scatters_as_in_cycles(name, values):
    ours, theirs = values[name]
    assert theirs.max() > 1e-3
    np.testing.assert_allclose(ours, theirs, rtol=0.01, atol=1e-3 * theirs.max())
