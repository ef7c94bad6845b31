# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures of `materials.py` taken apart: to rows of CLOSURE, what of them varies, and what they emit and let through.

Where nothing varies, rows of CLOSURE become rows of LOBE here, once.
"""

from dataclasses import fields
from typing import NamedTuple

import numpy as np

from ..program_tables import CLOSURE, ClosureKind
from ..shader import graph
from ..shader.link import lobes_of
from ..shader.opcodes import Op, VectorMath
from ..tables import LOBE, MAX_LOBES, Facets, LobeKind
from .materials import WHITE

SWITCHES = ("multiscatter", "is_beckmann", "loose")  # fields that no program can set


class Surface(NamedTuple):
    """A closure taken apart."""

    closures: list  # (row of CLOSURE, {field: value that varies})
    emission: object  # value: radiance
    transparency: object  # value: what light passes straight through
    holdout: object  # value: how much of the picture stays empty, by channel


def flatten(surface):
    """The Surface that a closure is: a flat list of what scatters, with mix factors multiplied out."""
    flattening = _Flattening()
    flattening.add(surface, 1.0)
    return Surface(flattening.closures, flattening.emission, flattening.transparency, flattening.holdout)


def lower(closures):
    """Turn rows of CLOSURE into what the tables hold.

    Returns
    -------
    lobes : recarray of LOBE, at most MAX_LOBES
    dropped : list of str, names of lobes for which there was no room
    """
    rows = _merge_equal([lobe for row in closures for lobe in lobes_of(row)])
    dropped = []
    if len(rows) > MAX_LOBES:
        # the faintest go; the others keep their order, which layers depend on
        rank = np.argsort([-np.mean(row["weight"] * np.minimum(row["f0"], 1.0)) for row in rows], kind="stable")
        dropped = [LobeKind(rows[i]["kind"]).name.lower() for i in rank[MAX_LOBES:]]
        rows = [rows[i] for i in sorted(rank[:MAX_LOBES])]
    return np.array(rows, LOBE).view(np.recarray), dropped


class _Flattening:
    """Walks a closure and collects rows of CLOSURE, emission and transparency: a method for each class of closures."""

    def __init__(self):
        self.closures, self.layers = [], 0
        self.emission = self.transparency = self.holdout = (0.0, 0.0, 0.0)

    def add(self, closure, weight):
        """Add `closure`, mixed in with `weight`, a number."""
        if not (graph.is_constant(weight) and weight <= 0.0):
            getattr(self, f"_{type(closure).__name__.lower()}")(closure, weight)

    def _row(self, kind, weight, values, multiscatter=False, layer=0, subsurface=0, is_beckmann=False, loose=False):
        """A row of CLOSURE. `values`: by field; None where nothing is set."""
        row, varying = np.zeros(1, CLOSURE)[0], {}
        row["kind"], row["multiscatter"], row["layer"] = kind, multiscatter, layer
        row["subsurface"], row["facets"] = subsurface, Facets.BECKMANN if is_beckmann else Facets.GGX
        row["loose"] = loose
        for field, value in {"weight": weight, **values}.items():
            if value is None:
                continue
            if graph.is_constant(value):
                row[field] = value
            else:
                varying[field] = value
        self.closures.append((row, varying))

    def _same(self, kind, c, weight, **renamed):
        """A closure whose fields have the names of CLOSURE, but for those that are renamed."""
        names = {f.name: renamed.get(f.name, f.name) for f in fields(c) if f.name not in SWITCHES}
        values = {field: getattr(c, name) for name, field in names.items()}
        switches = {name: getattr(c, name) for name in SWITCHES if hasattr(c, name)}
        self._row(kind, weight, values, **switches)

    def _black(self, c, weight):
        pass

    def _holdout(self, c, weight):
        self.holdout = graph.added(self.holdout, graph.scaled(c.color, weight))

    def _mix(self, c, weight):
        factor = graph.clamped(c.factor)
        self.add(c.a, graph.product(weight, graph.complement(factor)))
        self.add(c.b, graph.product(weight, factor))

    def _add(self, c, weight):
        self.add(c.a, weight)
        self.add(c.b, weight)

    def _emission(self, c, weight):
        light = graph.scaled(c.color, graph.product(weight, c.strength))
        self.emission = graph.added(self.emission, light)

    def _diffuse(self, c, weight):
        self._same(ClosureKind.DIFFUSE, c, weight)

    def _toon(self, c, weight):
        kind = ClosureKind.TOON_GLOSSY if c.is_glossy else ClosureKind.TOON_DIFFUSE
        values = {"color": c.color, "roughness": c.size, "smooth": c.smooth, "normal": c.normal}
        self._row(kind, weight, values)

    def _sheen(self, c, weight):
        kind = ClosureKind.VELVET if c.is_velvet else ClosureKind.SHEEN
        self._row(kind, weight, {"color": c.color, "roughness": c.roughness, "normal": c.normal})

    def _translucent(self, c, weight):
        self._same(ClosureKind.TRANSLUCENT, c, weight)

    def _transparent(self, c, weight):
        self._same(ClosureKind.TRANSPARENT, c, weight)
        self.transparency = graph.added(self.transparency, graph.scaled(c.color, weight))

    def _glossy(self, c, weight):
        kind = ClosureKind.ASHIKHMIN_SHIRLEY if c.is_ashikhmin else ClosureKind.GLOSSY
        values = {name: getattr(c, name) for name in ("color", "roughness", "anisotropy", "normal", "tangent")}
        self._row(kind, weight, values, c.multiscatter, is_beckmann=c.is_beckmann)

    def _metallic(self, c, weight):
        values = {"roughness": c.roughness, "anisotropy": c.anisotropy, "normal": c.normal}
        values |= {"tangent": c.tangent, "film_thickness": c.film_thickness, "film_ior": c.film_ior}
        if c.ior is not None:
            values |= {"color": c.ior, "edge_tint": c.extinction}
            self._row(ClosureKind.CONDUCTOR, weight, values, c.multiscatter, is_beckmann=c.is_beckmann)
        else:
            values |= {"color": c.base_color, "edge_tint": c.edge_tint}
            self._row(ClosureKind.METALLIC, weight, values, c.multiscatter, is_beckmann=c.is_beckmann)

    def _glass(self, c, weight):
        self._same(ClosureKind.GLASS, c, weight)

    def _refraction(self, c, weight):
        self._same(ClosureKind.REFRACTION, c, weight)

    def _subsurface(self, c, weight):
        values = {"subsurface_radius": c.radius, "subsurface_anisotropy": c.anisotropy}
        for name in ("color", "roughness", "ior", "normal"):
            values[name] = getattr(c, name)
        self._row(ClosureKind.SUBSURFACE, weight, values, subsurface=c.kind)

    def _hair(self, c, weight):
        kind = ClosureKind.HAIR_TRANSMISSION if c.transmits else ClosureKind.HAIR_REFLECTION
        values = {"color": c.color, "roughness": c.roughness_u, "smooth": c.roughness_v, "tilt": c.offset}
        self._row(kind, weight, {**values, "tangent": c.tangent})

    def _principledhair(self, c, weight):
        values = {"smooth": c.radial_roughness, "tilt": c.offset, "redness": c.melanin_redness, "melanin": c.melanin}
        values["edge_tint"] = c.shares
        for name in ("roughness", "coat", "ior", "random", "random_color", "random_roughness"):
            values[name] = getattr(c, name)
        kind, color = ClosureKind.HAIR_COLOR, c.color
        if c.melanin is not None:
            kind, color = ClosureKind.HAIR_MELANIN, c.tint
        elif c.absorption is not None:
            kind, color = ClosureKind.HAIR_ABSORPTION, c.absorption
        self._row(kind, weight, {**values, "color": color})

    def _principled(self, c, weight):
        self.layers += 1
        alpha = graph.clamped(c.alpha)
        light = graph.product(graph.product(weight, alpha), c.emission_strength)
        emitted = _covered(c, graph.scaled(c.emission_color, light))
        self.emission = graph.added(self.emission, emitted)
        clear = graph.product(weight, graph.complement(alpha))
        self.transparency = graph.added(self.transparency, graph.scaled(WHITE, clear))
        values = {
            "color": c.base_color,
            "edge_tint": c.specular_tint,
            "specular_level": c.specular_ior_level,
            "anisotropy": c.anisotropic,
        }
        for name in ("metallic", "roughness", "ior", "alpha", "transmission", "normal"):
            values[name] = getattr(c, name)
        for name in ("coat_weight", "coat_roughness", "coat_ior", "coat_tint", "diffuse_roughness", "tangent"):
            values[name] = getattr(c, name)
        for name in ("subsurface_weight", "subsurface_radius", "subsurface_ior", "subsurface_anisotropy"):
            values[name] = getattr(c, name)
        for name in ("sheen_weight", "sheen_roughness", "sheen_tint", "coat_normal"):
            values[name] = getattr(c, name)
        for name in ("film_thickness", "film_ior", "thin_wall"):
            values[name] = getattr(c, name)
        self._row(ClosureKind.PRINCIPLED, weight, values, c.multiscatter, self.layers, c.subsurface_kind, loose=c.loose)


def _covered(c, light):
    """What of the light of a Principled closure gets through the sheen and the coat above it."""
    is_dark = graph.is_constant(light) and not any(light)
    if is_dark or not any(map(_may_be_positive, (c.sheen_weight, c.coat_weight))):
        return light
    normal, coat_normal = ((0.0, 0.0, 0.0) if n is None else n for n in (c.normal, c.coat_normal))
    sheen = c.sheen_weight, c.sheen_roughness, c.sheen_tint
    coat = c.coat_weight, c.coat_roughness, c.coat_ior, c.coat_tint
    left = graph.node(Op.LEFT_BELOW, *sheen, *coat, normal, coat_normal)
    zero = (0.0, 0.0, 0.0)
    return graph.part(graph.node(Op.VECTOR_MATH, light, left, zero, 0.0, mode=VectorMath.MULTIPLY), 0, 3)


def _may_be_positive(value):
    return not graph.is_constant(value) or value > 0.0


def _merge_equal(rows):
    """Add the weights of lobes that are alike in all else."""
    merged = {}
    for row in rows:
        rest = row.copy()
        rest["weight"] = 0.0
        key = rest.tobytes()
        if key in merged:
            merged[key]["weight"] += row["weight"]
        else:
            merged[key] = row.copy()
    return list(merged.values())
