# SPDX-License-Identifier: GPL-3.0-or-later
"""What a surface is made of: closures as plain data, and how they become rows of CLOSURE and LOBE.

    Mix(0.3, Diffuse((0.8, 0.2, 0.1)), Glossy((1, 1, 1), roughness=0.2))

The names and the meaning are those of Blender's shader nodes. Colours are linear, three numbers. `roughness` is the
artist's number, 0 to 1; the microfacet width is alpha = roughness ** 2. Any number or colour may be a value
that varies over the surface instead: a Node of `shader.graph`. `normal` is in world space, None for the surface's own.
"""

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from ..program_tables import CLOSURE, ClosureKind
from ..shader import graph
from ..shader.link import lobes_of
from ..shader.opcodes import Op, VectorMath
from ..tables import LOBE, MAX_LOBES, Facets, LobeKind, SubsurfaceKind

WHITE = (1.0, 1.0, 1.0)
SWITCHES = ("multiscatter", "is_beckmann", "loose")  # fields that no program can set


@dataclass(frozen=True)
class Black:
    """Absorbs everything."""


@dataclass(frozen=True)
class Diffuse:
    """Lambert, or with a roughness Oren and Nayar."""

    color: tuple = (0.8, 0.8, 0.8)
    roughness: float = 0.0
    normal: object = None


@dataclass(frozen=True)
class Translucent:
    color: tuple = (0.8, 0.8, 0.8)
    normal: object = None


@dataclass(frozen=True)
class Transparent:
    color: tuple = WHITE


@dataclass(frozen=True)
class Holdout:
    """Absorbs everything, and leaves the picture empty where the camera sees it."""


@dataclass(frozen=True)
class Glossy:
    """GGX reflection of one colour at every angle; or Ashikhmin and Shirley's."""

    color: tuple = (0.8, 0.8, 0.8)
    roughness: float = 0.5
    anisotropy: float = 0.0  # -1 to 1
    multiscatter: bool = False
    normal: object = None
    tangent: object = None
    is_ashikhmin: bool = False
    is_beckmann: bool = False


@dataclass(frozen=True)
class Toon:
    """A cone of light about the normal, or (glossy) about the mirrored view; `smooth` is the width of its edge."""

    color: tuple = (0.8, 0.8, 0.8)
    size: float = 0.5
    smooth: float = 0.0
    is_glossy: bool = False
    normal: object = None


@dataclass(frozen=True)
class Sheen:
    """Fine fibres, or Ashikhmin's velvet."""

    color: tuple = (0.8, 0.8, 0.8)
    roughness: float = 0.5
    is_velvet: bool = False
    normal: object = None


@dataclass(frozen=True)
class Metallic:
    """GGX reflection with the Fresnel reflectance of a metal.

    By colour, `base_color` seen head on and `edge_tint` at 82 degrees; or, if `ior` and `extinction` are given, by the
    complex index of refraction of each channel.
    """

    base_color: tuple = (0.617, 0.577, 0.540)
    edge_tint: tuple = (0.695, 0.726, 0.770)
    roughness: float = 0.5
    anisotropy: float = 0.0
    ior: tuple | None = None
    extinction: tuple | None = None
    multiscatter: bool = False
    normal: object = None
    tangent: object = None
    is_beckmann: bool = False
    film_thickness: float = 0.0  # of a thin film, nanometres
    film_ior: float = 1.33


@dataclass(frozen=True)
class Glass:
    color: tuple = WHITE
    roughness: float = 0.0
    ior: float = 1.5
    multiscatter: bool = False
    normal: object = None
    is_beckmann: bool = False
    loose: bool = False  # also refracts where no microfacet would, as in Cycles
    film_thickness: float = 0.0
    film_ior: float = 1.33


@dataclass(frozen=True)
class Refraction:
    color: tuple = WHITE
    roughness: float = 0.0
    ior: float = 1.45
    normal: object = None
    is_beckmann: bool = False
    loose: bool = False


@dataclass(frozen=True)
class Subsurface:
    """Light that walks below the surface, about `radius` metres far, and comes out elsewhere."""

    color: tuple = (0.8, 0.8, 0.8)
    radius: tuple = (0.005, 0.001, 0.0005)
    roughness: float = 1.0  # of the surface that it enters through
    ior: float = 1.4
    anisotropy: float = 0.0
    kind: SubsurfaceKind = SubsurfaceKind.RANDOM_WALK
    normal: object = None


@dataclass(frozen=True)
class Hair:
    """Light that strands reflect, or let pass: Blender's Hair node."""

    color: tuple = (0.8, 0.8, 0.8)
    offset: float = 0.0  # tilt of the scales, radians
    roughness_u: float = 0.1  # along the strand
    roughness_v: float = 1.0  # around it
    tangent: object = None  # None: that of the strand
    transmits: bool = False


@dataclass(frozen=True)
class PrincipledHair:
    """All that strands do with light, coloured by `color`, or by `absorption`, or by `melanin` if they are given."""

    color: tuple = (0.0175, 0.0058, 0.0021)
    melanin: object = None  # 0 to 1, by how dark it looks
    melanin_redness: float = 1.0
    tint: tuple = WHITE  # with melanin
    absorption: tuple | None = None  # in one radius
    roughness: float = 0.3
    radial_roughness: float = 0.3
    coat: float = 0.0
    ior: float = 1.55
    offset: float = 0.0349066  # tilt of the scales, radians
    random: float = 0.0  # 0 to 1
    random_color: float = 0.0
    random_roughness: float = 0.0
    shares: tuple | None = None  # of what is reflected, passes, is reflected inside: by Huang's model; None: Chiang's


@dataclass(frozen=True)
class Emission:
    """Radiance `color * strength`, W / (m2 sr), from both sides."""

    color: tuple = WHITE
    strength: float = 1.0


@dataclass(frozen=True)
class Principled:
    """Blender's Principled BSDF: the part of it that its base, metal, glass, specular and coat lobes carry."""

    base_color: tuple = (0.8, 0.8, 0.8)
    metallic: float = 0.0
    roughness: float = 0.5
    ior: float = 1.5
    alpha: float = 1.0
    specular_ior_level: float = 0.5
    specular_tint: tuple = WHITE
    anisotropic: float = 0.0
    transmission: float = 0.0
    diffuse_roughness: float = 0.0
    subsurface_weight: float = 0.0
    subsurface_radius: tuple = (0.005, 0.001, 0.0005)
    subsurface_ior: float = 1.4
    subsurface_anisotropy: float = 0.0
    subsurface_kind: SubsurfaceKind = SubsurfaceKind.RANDOM_WALK
    sheen_weight: float = 0.0
    sheen_roughness: float = 0.5
    sheen_tint: tuple = WHITE
    coat_weight: float = 0.0
    coat_roughness: float = 0.03
    coat_ior: float = 1.5
    coat_tint: tuple = WHITE
    emission_color: tuple = WHITE
    emission_strength: float = 0.0
    multiscatter: bool = True
    normal: object = None
    coat_normal: object = None  # None: `normal`
    film_thickness: float = 0.0
    film_ior: float = 1.33
    thin_wall: float = 0.0  # above 0.5: transmission is that of a pane
    loose: bool = False
    tangent: object = None


@dataclass(frozen=True)
class Mix:
    """`a` where factor is 0, `b` where it is 1."""

    factor: object
    a: object
    b: object


@dataclass(frozen=True)
class Add:
    a: object
    b: object


class Surface(NamedTuple):
    """A closure taken apart."""

    closures: list  # (row of CLOSURE, {field: value that varies})
    emission: object  # value: radiance
    transparency: object  # value: what light passes straight through
    holdout: object  # value: how much of the picture stays empty, three equal floats


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
    """Walks a closure and collects rows of CLOSURE, emission and transparency."""

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
        self.holdout = graph.added(self.holdout, graph.splat(weight))

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
