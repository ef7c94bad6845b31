# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's shading nodes mean, in closures of engine_core/scene/materials.py.

A closure takes the values of its sockets: numbers, or graphs of what varies over the surface (`values.py`).
"""

import bpy

from ..core import ProgramTables, flatten, graph, opcodes
from ..core import materials as m
from .displacement import bumped_normal
from .graph import Graph, by_identifier, has_nodes, label, source
from .node_inputs import number_input, turned, vector_input
from .values import Values

InputNumber = opcodes.InputNumber
HAIR_SOCKETS = {"offset": "Offset", "roughness_u": "RoughnessU", "roughness_v": "RoughnessV"}
PRINCIPLED_HAIR_SOCKETS = {
    "roughness": "Roughness",
    "radial_roughness": "Radial Roughness",
    "coat": "Coat",
    "ior": "IOR",
    "offset": "Offset",
    "random_color": "Random Color",
    "random_roughness": "Random Roughness",
}
DEEPEST, MOST_CLOSURES = 100, 1000  # a tree may use a shader many times over, and so grow exponentially


def default_surface():
    """What Cycles gives to faces without a material."""
    return m.Principled() if bpy.app.version >= (5, 0) else m.Diffuse()


def material_surface(context, b_material):
    """The closure of a material's surface; None if it has none, only a volume."""
    if not has_nodes(b_material):
        return m.Diffuse(b_material.diffuse_color[:3])
    tree = Graph(b_material)
    output = tree.output
    if output is None:
        return m.Black()
    translation = Translation(context, b_material.name)
    surface, volume = output.inputs["Surface"], output.inputs.get("Volume")
    if b_material.displacement_method != "DISPLACEMENT":
        moved = _displacement(translation, output)
        if not graph.is_constant(moved):
            translation.values.bump = bumped_normal(moved)
    if source(volume, ()).node and source(surface, ()).node is None:
        return None
    return translation.closure(surface, ())


def seen_as_hole(surface):
    """The same closure for all rays but those of the camera, which see a hole in the picture; None stays None.

    What is transparent stays so for them, too: the hole is what is left.
    """
    if surface is None:
        return None
    through = flatten(surface).transparency
    hole = m.Holdout(graph.added(m.WHITE, graph.scaled(through, -1.0)))
    if not graph.is_constant(through) or any(through):
        hole = m.Add(hole, m.Transparent(through))
    return m.Mix(number_input(opcodes.InputNumber.IS_CAMERA), surface, hole)


def material_displacement(context, b_material):
    """(how far a material moves a mesh, three numbers or a value, world space; whether normals stay as they are).

    None if it does not. Where the surface is bumped as well, the bumps have all of the displacement in them.
    """
    if not has_nodes(b_material) or b_material.displacement_method == "BUMP":
        return None
    tree = Graph(b_material)
    if tree.output is None or source(tree.output.inputs.get("Displacement"), ()).node is None:
        return None
    moved = _displacement(Translation(context, b_material.name), tree.output)
    return moved, b_material.displacement_method == "BOTH"


def _displacement(translation, output):
    """What comes in by the output's Displacement; zeros if nothing does."""
    socket = output.inputs.get("Displacement")
    if source(socket, ()).node is None:
        return (0.0, 0.0, 0.0)
    values = Values(translation.context, translation.warn)  # apart from those of the surface, which get its normals
    return ProgramTables().constant(values.socket(socket, (), "VECTOR"))


def world_radiance(context, b_world):
    """Radiance of the world: three numbers, or a value by direction."""
    return _emitted(context, b_world, lambda: b_world.color[:], nothing=(0.0, 0.0, 0.0))


def light_factor(context, b_light):
    """What a lamp's own nodes multiply its strength by: three numbers, or a value that varies over the lamp."""
    emitted = _emitted(context, b_light, lambda: (1.0, 1.0, 1.0), nothing=(0.0, 0.0, 0.0))
    return ProgramTables().constant(emitted)


def _emitted(context, b_owner, without_nodes, nothing):
    if not has_nodes(b_owner):
        return tuple(without_nodes())
    tree = Graph(b_owner)
    output = tree.output
    if output is None:
        return nothing
    return flatten(Translation(context, b_owner.name).closure(output.inputs["Surface"], ())).emission


class Translation:
    """Turns one tree into a closure. Methods are called by the type of the node that they translate."""

    def __init__(self, context, owner):
        self.context, self.owner = context, owner
        self.values, self.inputs = Values(context, self.warn), Inputs
        self.depth = self.count = 0

    def warn(self, node, text):
        self.context.warn(self.owner, f"{label(node)}: {text}")

    def closure(self, socket, groups):
        """The closure that comes in by a shader socket; Black if nothing does."""
        node, output, groups = source(socket, groups)
        if node is None:
            return m.Black()
        self.count += 1
        if self.count > MOST_CLOSURES or self.depth >= DEEPEST:
            self.warn(node, f"more than {MOST_CLOSURES} shaders, or {DEEPEST} in a row; the rest is black")
            return m.Black()
        if output.type != "SHADER":  # Blender takes a bare colour for light
            return m.Emission(self.values.socket(socket, groups, "RGBA"), 1.0)
        translate = getattr(self, f"_{node.type.lower()}", None)
        if translate:
            self.depth += 1
            closure = translate(self.inputs(self, node, groups))
            self.depth -= 1
            return closure
        self.warn(node, f"{node.bl_label} is not rendered yet; black instead")
        return m.Black()

    # ---- Combining ----

    def _mix_shader(self, i):
        a, b = i.sockets("Shader", "Shader_001")
        factor = i.number("Fac")
        if graph.is_constant(factor) and factor <= 0.0:
            return self.closure(a, i.groups)
        if graph.is_constant(factor) and factor >= 1.0:
            return self.closure(b, i.groups)
        return m.Mix(factor, self.closure(a, i.groups), self.closure(b, i.groups))

    def _add_shader(self, i):
        a, b = i.sockets("Shader", "Shader_001")
        return m.Add(self.closure(a, i.groups), self.closure(b, i.groups))

    # ---- Emitting ----

    def _emission(self, i):
        return m.Emission(i.color("Color"), i.number("Strength"))

    _background = _emission

    # ---- Scattering ----

    def _bsdf_diffuse(self, i):
        return m.Diffuse(i.color("Color"), i.number("Roughness"), i.normal())

    def _bsdf_translucent(self, i):
        return m.Translucent(i.color("Color"), i.normal())

    def _bsdf_transparent(self, i):
        return m.Transparent(i.color("Color"))

    def _holdout(self, i):
        return m.Holdout()

    def _bsdf_glossy(self, i):
        anisotropy, tangent = i.anisotropy()
        is_ashikhmin = i.node.distribution == "ASHIKHMIN_SHIRLEY"
        return m.Glossy(
            i.color("Color"),
            i.number("Roughness"),
            anisotropy,
            normal=i.normal(),
            tangent=tangent,
            is_ashikhmin=is_ashikhmin,
            **i.distribution(),
        )

    def _bsdf_metallic(self, i):
        anisotropy, tangent = i.anisotropy()
        common = {
            "roughness": i.number("Roughness"),
            "anisotropy": anisotropy,
            "tangent": tangent,
            "normal": i.normal(),
            **i.distribution(),
            **i.film(),
        }
        if i.node.fresnel_type == "PHYSICAL_CONDUCTOR":
            return m.Metallic(ior=i.color("IOR"), extinction=i.color("Extinction"), **common)
        return m.Metallic(i.color("Base Color"), i.color("Edge Tint"), **common)

    def _bsdf_glass(self, i):
        values = {"normal": i.normal(), "loose": True, **i.distribution(), **i.film()}
        return m.Glass(i.color("Color"), i.number("Roughness"), i.number("IOR"), **values)

    def _bsdf_refraction(self, i):
        is_beckmann = i.distribution()["is_beckmann"]
        return m.Refraction(
            i.color("Color"), i.number("Roughness"), i.number("IOR"), i.normal(), is_beckmann, loose=True
        )

    def _bsdf_principled(self, i):
        anisotropy, tangent = i.anisotropy("Anisotropic", "Anisotropic Rotation")
        return m.Principled(
            base_color=i.color("Base Color"),
            metallic=i.number("Metallic"),
            roughness=i.number("Roughness"),
            ior=i.number("IOR"),
            alpha=i.number("Alpha"),
            specular_ior_level=i.number("Specular IOR Level"),
            specular_tint=i.color("Specular Tint"),
            anisotropic=anisotropy,
            tangent=tangent,
            transmission=i.number("Transmission Weight"),
            diffuse_roughness=i.number_or("Diffuse Roughness", 0.0),
            **self._subsurface(i),
            sheen_weight=i.number("Sheen Weight"),
            sheen_roughness=i.number("Sheen Roughness"),
            sheen_tint=i.color("Sheen Tint"),
            coat_weight=i.number("Coat Weight"),
            coat_roughness=i.number("Coat Roughness"),
            coat_ior=i.number("Coat IOR"),
            coat_tint=i.color("Coat Tint"),
            emission_color=i.color("Emission Color"),
            emission_strength=i.number("Emission Strength"),
            multiscatter=i.distribution()["multiscatter"],
            thin_wall=i.number_or("Thin Wall", 0.0),
            loose=True,
            **i.film(),
            normal=i.normal(),
            coat_normal=i.normal("Coat Normal"),
        )

    def _subsurface(self, i):
        """What a Principled BSDF has below its surface."""
        weight = i.number("Subsurface Weight")
        if graph.is_constant(weight) and weight <= 0.0:
            return {}
        return {
            "subsurface_weight": weight,
            "subsurface_radius": graph.scaled(i.color("Subsurface Radius"), i.number("Subsurface Scale")),
            "subsurface_ior": i.number("Subsurface IOR"),
            "subsurface_anisotropy": i.number("Subsurface Anisotropy"),
            "subsurface_kind": i.subsurface_kind("subsurface_method"),
        }

    def _subsurface_scattering(self, i):
        return m.Subsurface(
            i.color("Color"),
            graph.scaled(i.color("Radius"), i.number("Scale")),
            i.number("Roughness"),
            i.number("IOR"),
            i.number("Anisotropy"),
            i.subsurface_kind("falloff"),
            i.normal(),
        )

    def _bsdf_sheen(self, i):
        is_velvet = i.node.distribution == "ASHIKHMIN"
        return m.Sheen(i.color("Color"), i.number("Roughness"), is_velvet, i.normal())

    def _bsdf_toon(self, i):
        is_glossy = i.node.component == "GLOSSY"
        return m.Toon(i.color("Color"), i.number("Size"), i.number("Smooth"), is_glossy, i.normal())

    def _bsdf_hair(self, i):
        values = {name: i.number(socket) for name, socket in HAIR_SOCKETS.items()}
        tangent = i.normal("Tangent")
        return m.Hair(i.color("Color"), tangent=tangent, transmits=i.node.component == "Transmission", **values)

    def _bsdf_hair_principled(self, i):
        values = {name: i.number(socket) for name, socket in PRINCIPLED_HAIR_SOCKETS.items()}
        values["random"] = i.number("Random")
        if not i.is_linked("Random"):  # what is set there is for surfaces without strands
            of_others = graph.product(values["random"], graph.complement(number_input(InputNumber.IS_STRAND)))
            values["random"] = graph.sum_of(number_input(InputNumber.STRAND_RANDOM), of_others)
        if all(
            graph.is_constant(values[name]) and values[name] == 0.0 for name in ("random_color", "random_roughness")
        ):
            values["random"] = 0.0
        if i.node.model == "HUANG":
            values["radial_roughness"], values["coat"] = values["roughness"], 0.0
            shares = [i.number(f"{way} lobe") for way in ("R", "TT", "TRT")]
            is_fixed = all(map(graph.is_constant, shares))
            if is_fixed and max(shares) <= 0.0:
                return m.Black()
            values["shares"] = tuple(shares) if is_fixed else graph.node(opcodes.Op.COMBINE, *shares)
            if i.number("Aspect Ratio") != 1.0:
                self.warn(i.node, "cross-sections of hair are round, whatever their aspect ratio")
        if i.node.parametrization == "MELANIN":
            values["melanin"], values["melanin_redness"] = i.number("Melanin"), i.number("Melanin Redness")
            values["tint"] = i.color("Tint")
        elif i.node.parametrization == "ABSORPTION":
            values["absorption"] = i.color("Absorption Coefficient")
        else:
            values["color"] = i.color("Color")
        return m.PrincipledHair(**values)

    # ---- Not there yet: the nearest of the above ----

    def _instead(self, i, closure):
        self.warn(i.node, f"{i.node.bl_label} is not rendered yet; {type(closure).__name__} instead")
        return closure

    def _bsdf_ray_portal(self, i):
        return self._instead(i, m.Transparent(i.color("Color")))

    def _eevee_specular(self, i):
        specular = m.Principled(
            base_color=i.color("Base Color"),
            roughness=i.number("Roughness"),
            alpha=graph.complement(i.number("Transparency")),
            emission_color=i.color("Emissive Color"),
            emission_strength=1.0,
        )
        return self._instead(i, specular)


class Inputs:
    """The inputs of one node, by identifier."""

    def __init__(self, translation, node, groups):
        self.translation, self.node, self.groups = translation, node, groups

    def sockets(self, *names):
        return [by_identifier(self.node.inputs, name) for name in names]

    def color(self, name):
        """Three numbers; also for vector sockets."""
        return self.translation.values.color(self.node, self.groups, name)

    def number(self, name):
        return self.translation.values.number(self.node, self.groups, name)

    def normal(self, name="Normal"):
        """The normal that is linked, or None."""
        return self.translation.values.normal_or_none(self.node, self.groups, name)

    def is_linked(self, name):
        return self.translation.values.is_linked(self.node, self.groups, name)

    def number_or(self, name, otherwise):
        """A number that not every Blender has."""
        return self.number(name) if by_identifier(self.node.inputs, name) else otherwise

    def anisotropy(self, name="Anisotropy", rotation="Rotation"):
        """(strength of the anisotropy, tangent or None)"""
        value = self.number(name)
        if graph.is_constant(value) and value == 0.0:
            return value, None
        tangent = self.translation.values.normal_or_none(self.node, self.groups, "Tangent")
        if tangent is None:
            tangent = vector_input(opcodes.InputVector.RADIAL_TANGENT)
        turns = self.number(rotation)
        if graph.is_constant(turns) and turns == 0.0:
            return value, tangent
        normal = self.normal()
        if normal is None:
            normal = vector_input(opcodes.InputVector.NORMAL)
        return value, turned(tangent, normal, turns)

    def distribution(self):
        name = self.node.distribution
        return {"multiscatter": name == "MULTI_GGX", "is_beckmann": name == "BECKMANN"}

    def film(self):
        thickness = self.number_or("Thin Film Thickness", 0.0)
        if graph.is_constant(thickness) and thickness <= 0.0:
            return {}
        return {"film_thickness": thickness, "film_ior": self.number("Thin Film IOR")}

    def subsurface_kind(self, setting):
        """The SubsurfaceKind that a menu of the node says. What Blender 4 calls random walk, 5.2 calls legacy."""
        method = getattr(self.node, setting)
        if method == "BURLEY":  # its radius is that of the legacy walk
            self.translation.warn(self.node, "Christensen-Burley is not rendered; Random Walk (Legacy) instead")
            return m.SubsurfaceKind.LEGACY
        if method == "RANDOM_WALK" and "RANDOM_WALK_LEGACY" not in self.node.bl_rna.properties[setting].enum_items:
            return m.SubsurfaceKind.LEGACY
        return m.SubsurfaceKind[method.removeprefix("RANDOM_WALK_")]
