# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, the world, lamps and attributes as tables: what is constant as rows, what varies as programs."""

import numpy as np

from ..bsdf.microfacet import SMOOTH
from ..integrator.probes import ask_the_object
from ..program_tables import ATTRIBUTE, ATTRIBUTE_MAP, INSTANCE_VALUE, ClosureKind
from ..shader import graph
from ..shader.closures import pane_width
from ..shader.graph import GraphError
from ..shader.program import ProgramTables
from ..tables import LOBE, MATERIAL, TRANSMITTING, LobeKind, MaterialFlag
from .displace import undisplaced
from .flattening import flatten, lower
from .materials import Diffuse

GREY = Diffuse((0.5, 0.5, 0.5))
FIBRES = (LobeKind.HAIR, LobeKind.HAIR_REFLECTION, LobeKind.HAIR_TRANSMISSION, LobeKind.HAIR_FACETS)
HAIR_CLOSURES = (ClosureKind.HAIR_COLOR, ClosureKind.HAIR_MELANIN, ClosureKind.HAIR_ABSORPTION)
HAIR_CLOSURES += (ClosureKind.HAIR_REFLECTION, ClosureKind.HAIR_TRANSMISSION)
TRANSMITTING_CLOSURES = (ClosureKind.GLASS, ClosureKind.REFRACTION, ClosureKind.TRANSLUCENT, ClosureKind.PRINCIPLED)
TRANSMITTING_CLOSURES += HAIR_CLOSURES


class Shading:
    """Fills the tables of materials and programs of a scene."""

    def __init__(self, warn):
        self.programs, self._warn = ProgramTables(), warn
        self.displacements = {}  # number of a material: (row of PROGRAM, whether normals stay)

    # ---- Materials ----

    def materials(self, materials):
        """Tables MATERIAL and LOBE."""
        rows, lobes, first = np.zeros(len(materials), MATERIAL), [], 0
        for row, material in zip(rows, materials, strict=True):
            surface = material.surface if material.displacement is None else undisplaced(material.surface)
            try:
                own = self._material(row, material, surface)
            except GraphError as error:
                self._warn(material.name, f"its nodes are too much for one shader: {error}; grey instead")
                own = self._material(row, material, flatten(GREY))
            row["lobes"], row["lobe_count"], row["pass_index"] = first, len(own), material.pass_index
            lobes.append(own)
            first += len(own)
        self._displacements(materials)
        return rows, np.concatenate(lobes) if lobes else np.zeros(0, LOBE)

    def _displacements(self, materials):
        for number, material in enumerate(materials):
            if material.displacement is not None:
                try:
                    self.displacements[number] = self.programs.add(material.displacement), material.keeps_normals
                except GraphError as error:
                    self._warn(material.name, f"its displacement is too much for one program: {error}; left out")

    def _material(self, row, material, surface):
        """Fill a row of MATERIAL; returns its lobes, none if a program makes them."""
        row["flags"] = MaterialFlag.BOUNDARY if material.is_boundary else 0
        row["flags"] |= MaterialFlag.FILLED if material.medium is not None else 0
        closures = [
            (closure, {field: self.programs.constant(value) for field, value in varying.items()})
            for closure, varying in surface.closures
        ]
        values = [v for _, varying in closures for v in varying.values()]
        if ask_the_object([*values, *surface[1:]]):
            row["flags"] |= MaterialFlag.LOCAL
        lobes = np.zeros(0, LOBE)
        bent = any(row[name].any() for row, _ in closures for name in ("normal", "coat_normal", "tangent"))
        bent |= any(name in varying for _, varying in closures for name in ("normal", "coat_normal", "tangent"))
        if bent or any(not graph.is_constant(value) for value in values):
            row["program"] = self.programs.add(closures=closures)
            if any(closure["kind"] in TRANSMITTING_CLOSURES for closure, _ in closures):
                row["flags"] |= MaterialFlag.TRANSMITS
            if any(closure["kind"] in HAIR_CLOSURES for closure, _ in closures):
                row["flags"] |= MaterialFlag.HAIR
            if any(_scatters_below(closure, values) for closure, values in closures):
                row["flags"] |= MaterialFlag.SUBSURFACE
        else:
            lobes, dropped = lower([_with(closure, values) for closure, values in closures])
            if dropped:
                text = f"has more than {len(lobes)} ways to scatter; left out the faintest: {', '.join(dropped)}"
                self._warn(material.name, text)
            if np.isin(lobes["kind"], TRANSMITTING).any():
                row["flags"] |= MaterialFlag.TRANSMITS
            if np.isin(lobes["kind"], FIBRES).any():
                row["flags"] |= MaterialFlag.HAIR
            if (lobes["kind"] == LobeKind.SUBSURFACE).any():
                row["flags"] |= MaterialFlag.SUBSURFACE
        row["emission"], row["emission_program"] = self._value(surface.emission)
        if row["emission"].any():
            row["flags"] |= MaterialFlag.EMISSIVE | (MaterialFlag.ONE_SIDED if material.one_sided else 0)
        transparency, row["transparency_program"] = self._value(surface.transparency)
        row["transparency"] = np.minimum(transparency, 1.0)
        row["holdout"], row["holdout_program"] = self._value(surface.holdout)
        row["flags"] |= MaterialFlag.HOLDOUT if row["holdout"].any() else 0
        row["flags"] |= 0 if material.transparent_shadows else MaterialFlag.OPAQUE_SHADOW
        if any(_may_be_clear(closure, values) for closure, values in closures):
            row["flags"] |= MaterialFlag.PANE | MaterialFlag.TRANSPARENT
        if row["transparency"].any() or (lobes["kind"] == LobeKind.TRANSPARENT).any():
            row["flags"] |= MaterialFlag.TRANSPARENT
        return lobes

    def _value(self, value):
        """(constant, 0) or (ones, row of PROGRAM) of a value of three floats."""
        value = self.programs.constant(value)
        if graph.is_constant(value):
            return np.maximum(value, 0.0), 0
        return np.ones(3), self.programs.add(value)

    # ---- The world ----

    def world(self, world, radiance, materials):
        """Set the world's radiance, a value, and what it says of the table MATERIAL."""
        world["background"], world["background_program"] = self._value(radiance)
        world["transparent_shadows"] = int((materials["flags"] & MaterialFlag.TRANSPARENT).any())

    # ---- Lamps ----

    def lamp(self, factor):
        """Row of PROGRAM of what a lamp's radiance is multiplied by."""
        return self.programs.add(factor)

    # ---- Attributes ----

    def attributes(self, geometries):
        """Tables ATTRIBUTE_MAP and ATTRIBUTE, and {number of a geometry: its row of ATTRIBUTE_MAP}."""
        names, maps, rows, firsts = self.programs.attributes, [], [], {}
        count = 0
        for number, geometry in enumerate(geometries):
            own = getattr(geometry, "attributes", {})
            if not any(name in own for name in names):
                continue
            firsts[number] = len(maps)
            for name in names:
                maps.append(count if name in own else -1)
                if name in own:
                    values = np.zeros(len(own[name]), ATTRIBUTE)
                    values["value"] = own[name]
                    rows.append(values)
                    count += len(values)
        table = np.zeros(len(maps), ATTRIBUTE_MAP)
        table["first"] = maps
        return {"attribute_maps": table, "attributes": np.concatenate(rows) if rows else np.zeros(0, ATTRIBUTE)}, firsts

    def instance_values(self, owners):
        """Table INSTANCE_VALUE: `owners` are all instances and lamps with programs, by the number of their OBJECT."""
        names = self.programs.instance_values
        table = np.zeros(len(names) * len(owners), INSTANCE_VALUE)
        for block, name in enumerate(names):
            for number, owner in enumerate(owners):
                value = owner.values.get(name)
                if value is not None:
                    table["value"][block * len(owners) + number, : len(value)] = value
        return {"instance_values": table}


def _with(row, values):
    row = row.copy()
    for field, value in values.items():
        row[field] = value
    return row


def asks_itself(materials, numbers):
    """Whether one of these materials sends rays that ask for the object alone, or lets them walk below its surface."""
    return any(materials["flags"][number] & (MaterialFlag.SUBSURFACE | MaterialFlag.LOCAL) for number in numbers)


def has_no_surface(materials, numbers):
    """Whether an object of these materials is nothing but the boundary of a medium."""
    return len(numbers) > 0 and bool((materials["flags"][list(numbers)] & MaterialFlag.BOUNDARY).all())


def holds_media(materials, numbers):
    """Whether there is a medium inside an object of these materials."""
    return bool((materials["flags"][list(numbers)] & MaterialFlag.FILLED).any())


def needs_own_tree(materials, numbers):
    """Whether an object of these materials keeps its tree though it stands in the world once: some rays ask no other,
    and those that look for surfaces pass by objects that have none, or hold media."""
    return asks_itself(materials, numbers) or has_no_surface(materials, numbers) or holds_media(materials, numbers)


def _may_be_clear(closure, varying):
    """Whether it may be a smooth thin wall somewhere."""
    values = {name: varying.get(name, closure[name]) for name in ("thin_wall", "transmission", "roughness", "ior")}
    constant = {name: float(value) if graph.is_constant(value) else None for name, value in values.items()}
    if closure["kind"] != ClosureKind.PRINCIPLED or constant["thin_wall"] == 0.0 or constant["transmission"] == 0.0:
        return False
    if constant["roughness"] is None or constant["ior"] is None:
        return True
    return pane_width.py_func(constant["roughness"] ** 2, max(constant["ior"], 1e-5)) ** 2 < SMOOTH


def _scatters_below(closure, varying):
    if closure["kind"] == ClosureKind.PRINCIPLED:
        thin = varying.get("thin_wall", closure["thin_wall"])
        if graph.is_constant(thin) and thin > 0.5:
            return False
        weight = varying.get("subsurface_weight", closure["subsurface_weight"])
        return not (graph.is_constant(weight) and weight <= 0.0)
    return closure["kind"] == ClosureKind.SUBSURFACE
