# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's volume nodes mean, in closures of engine_core/scene/volumes.py.

Media are of constant density: where something that varies is linked, the socket's own value counts.
"""

from ..core import ProgramTables, graph
from ..core import materials as m
from ..core import volumes as v
from .graph import Graph, by_identifier, has_nodes, label, source
from .nodes import Inputs, Translation
from .values import own_value

KINDS = {
    *("MIX_SHADER", "ADD_SHADER", "EMISSION"),
    *("VOLUME_SCATTER", "VOLUME_ABSORPTION", "VOLUME_COEFFICIENTS", "PRINCIPLED_VOLUME"),
}
# attributes that Principled Volume asks for by default; meshes have none of them, and then they count as 1
USUAL_ATTRIBUTES = {"Density Attribute": "density", "Color Attribute": "", "Temperature Attribute": "temperature"}


def owned_volume(context, b_owner):
    """The closure of what fills a material's objects, or the world; None if nothing does."""
    if b_owner is None or not has_nodes(b_owner):
        return None
    tree = Graph(b_owner)
    if tree.output is None or source(tree.output.inputs.get("Volume"), ()).node is None:
        return None
    return VolumeTranslation(context, b_owner.name).closure(tree.output.inputs["Volume"], ())


class VolumeTranslation(Translation):
    """Turns the shaders of one tree that fill space into a closure."""

    def __init__(self, context, owner):
        super().__init__(context, owner)
        self.inputs = VolumeInputs

    def closure(self, socket, groups):
        node, output, _ = source(socket, groups)
        if node is not None and output.type == "SHADER" and node.type not in KINDS:
            self.warn(node, f"{node.bl_label} is no shader of volumes; left out")
            return m.Black()
        return super().closure(socket, groups)

    def _volume_scatter(self, i):
        return v.VolumeScatter(i.color("Color"), i.number("Density"), i.phase())

    def _volume_absorption(self, i):
        return v.VolumeAbsorption(i.color("Color"), i.number("Density"))

    def _volume_coefficients(self, i):
        absorption, scatter = i.color("Absorption Coefficients"), i.color("Scatter Coefficients")
        return v.VolumeCoefficients(absorption, scatter, i.color("Emission Coefficients"), i.phase())

    def _principled_volume(self, i):
        for name, usual in USUAL_ATTRIBUTES.items():
            found = by_identifier(i.node.inputs, name).default_value
            if found not in ("", usual):
                self.warn(i.node, f"attributes of volumes are not rendered yet; {found} is taken as 1")
        return v.PrincipledVolume(
            color=i.color("Color"),
            density=i.number("Density"),
            anisotropy=i.number("Anisotropy"),
            absorption_color=i.color("Absorption Color"),
            emission_strength=i.number("Emission Strength"),
            emission_color=i.color("Emission Color"),
            blackbody_intensity=i.number("Blackbody Intensity"),
            blackbody_tint=i.color("Blackbody Tint"),
            temperature=i.number("Temperature"),
        )


class VolumeInputs(Inputs):
    """The inputs of a node, which are constant."""

    def color(self, name):
        return tuple(self._constant(name, super().color(name), "RGBA"))

    def number(self, name):
        return float(self._constant(name, super().number(name), "VALUE"))

    def phase(self):
        kind = self.node.phase
        if kind == "FOURNIER_FORAND":
            return v.FournierForand(self.number("IOR"), self.number("Backscatter"))
        if kind == "DRAINE":
            return v.Draine(self.number("Anisotropy"), self.number("Alpha"))
        if kind == "RAYLEIGH":
            return v.Rayleigh()
        return v.Mie(self.number("Diameter")) if kind == "MIE" else v.HenyeyGreenstein(self.number("Anisotropy"))

    def _constant(self, name, value, kind):
        value = ProgramTables().constant(value)
        if graph.is_constant(value):
            return value
        socket = by_identifier(self.node.inputs, name)
        own = own_value(socket)
        text = f"{own:.3g}" if kind == "VALUE" else f"({', '.join(f'{c:.3g}' for c in own)})"
        culprit = label(source(socket, self.groups).node)
        self.translation.warn(
            self.node, f"{socket.name} varies by {culprit}; volumes are rendered with one density: using {text}"
        )
        return own
