# SPDX-License-Identifier: GPL-3.0-or-later
"""What a surface is made of: closures as plain data, and how they become rows of LOBE.

    Mix(0.3, Diffuse((0.8, 0.2, 0.1)), Glossy((1, 1, 1), roughness=0.2))

The names and the meaning are those of Blender's shader nodes. Colours are linear, three numbers. `roughness` is the
artist's number, 0 to 1; the microfacet width is alpha = roughness ** 2.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..tables import LOBE, MAX_LOBES, FresnelKind, LobeKind

WHITE = (1.0, 1.0, 1.0)
NEGLIGIBLE = 1e-5  # weights below this are dropped, as Cycles does


@dataclass(frozen=True)
class Black:
    """Absorbs everything."""


@dataclass(frozen=True)
class Diffuse:
    color: tuple = (0.8, 0.8, 0.8)


@dataclass(frozen=True)
class Translucent:
    color: tuple = (0.8, 0.8, 0.8)


@dataclass(frozen=True)
class Transparent:
    color: tuple = WHITE


@dataclass(frozen=True)
class Glossy:
    """GGX reflection of one colour at every angle."""

    color: tuple = (0.8, 0.8, 0.8)
    roughness: float = 0.5
    anisotropy: float = 0.0  # -1 to 1
    multiscatter: bool = False


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


@dataclass(frozen=True)
class Glass:
    color: tuple = WHITE
    roughness: float = 0.0
    ior: float = 1.5
    multiscatter: bool = False


@dataclass(frozen=True)
class Refraction:
    color: tuple = WHITE
    roughness: float = 0.0
    ior: float = 1.45


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
    coat_weight: float = 0.0
    coat_roughness: float = 0.03
    coat_ior: float = 1.5
    coat_tint: tuple = WHITE
    emission_color: tuple = WHITE
    emission_strength: float = 0.0
    multiscatter: bool = True


@dataclass(frozen=True)
class Mix:
    """`a` where factor is 0, `b` where it is 1."""

    factor: float
    a: object
    b: object


@dataclass(frozen=True)
class Add:
    a: object
    b: object


def lower(surface):
    """Turn a closure into what the tables hold.

    Returns
    -------
    lobes : recarray of LOBE, at most MAX_LOBES
    emission : float32 (3,), radiance
    dropped : list of str, names of lobes for which there was no room
    """
    lowering = _Lowering()
    lowering.add(surface, np.ones(3))
    rows, dropped = _merge_equal(lowering.rows), []
    if len(rows) > MAX_LOBES:
        # the faintest go; the others keep their order, which layers depend on
        rank = np.argsort([-np.mean(row["weight"] * np.minimum(row["f0"], 1.0)) for row in rows], kind="stable")
        dropped = [LobeKind(rows[i]["kind"]).name.lower() for i in rank[MAX_LOBES:]]
        rows = [rows[i] for i in sorted(rank[:MAX_LOBES])]
    lobes = np.zeros(len(rows), LOBE)
    for lobe, row in zip(lobes, rows, strict=True):
        for name, value in row.items():
            lobe[name] = value
    return lobes.view(np.recarray), lowering.emission.astype(np.float32), dropped


class _Lowering:
    """Walks a closure and collects lobes (as dicts of LOBE's fields) and emission."""

    def __init__(self):
        self.rows, self.emission, self.layers = [], np.zeros(3), 0

    def add(self, closure, weight):
        """Add `closure`, mixed in with `weight` (3,)."""
        getattr(self, f"_{type(closure).__name__.lower()}")(closure, weight)

    def _lobe(self, kind, weight, **fields):
        weight = np.maximum(weight, 0.0)
        if weight.max() > NEGLIGIBLE:
            defaults = {
                "ior": 1.0,
                "f0": WHITE,
                "f82": WHITE,
                "reflect_tint": WHITE,
                "refract_tint": WHITE,
                "energy_scale": 1.0,
            }
            self.rows.append({"kind": kind, "weight": weight, **defaults, **fields})

    def _black(self, c, weight):
        pass

    def _mix(self, c, weight):
        factor = min(max(c.factor, 0.0), 1.0)
        self.add(c.a, weight * (1.0 - factor))
        self.add(c.b, weight * factor)

    def _add(self, c, weight):
        self.add(c.a, weight)
        self.add(c.b, weight)

    def _emission(self, c, weight):
        self.emission += weight * np.array(c.color) * c.strength

    def _diffuse(self, c, weight):
        self._lobe(LobeKind.DIFFUSE, weight * c.color)

    def _translucent(self, c, weight):
        self._lobe(LobeKind.TRANSLUCENT, weight * c.color)

    def _transparent(self, c, weight):
        self._lobe(LobeKind.TRANSPARENT, weight * c.color)

    def _glossy(self, c, weight):
        self._lobe(
            LobeKind.CONDUCTOR,
            weight,
            fresnel=FresnelKind.CONSTANT,
            f0=c.color,
            multiscatter=c.multiscatter,
            **glossy_node_alphas(c.roughness, c.anisotropy),
        )

    def _metallic(self, c, weight):
        by_ior = c.ior is not None
        self._lobe(
            LobeKind.CONDUCTOR,
            weight,
            fresnel=FresnelKind.CONDUCTOR if by_ior else FresnelKind.F82,
            f0=c.ior if by_ior else c.base_color,
            f82=c.extinction if by_ior else c.edge_tint,
            multiscatter=c.multiscatter,
            **glossy_node_alphas(c.roughness, c.anisotropy),
        )

    def _glass(self, c, weight):
        self._lobe(
            LobeKind.DIELECTRIC,
            weight,
            reflect_tint=c.color,
            refract_tint=c.color,
            ior=max(c.ior, 1e-5),
            multiscatter=c.multiscatter,
            **alphas(c.roughness),
        )

    def _refraction(self, c, weight):
        self._lobe(LobeKind.REFRACTION, weight * c.color, ior=max(c.ior, 1e-5), **alphas(c.roughness))

    def _principled(self, c, weight):
        """The order of the layers is that of Cycles: see-through, coat, metal, glass, specular, base."""
        self.layers += 1
        layer = {"layer": self.layers}
        base_color = np.clip(c.base_color, 0.0, None)
        widths = principled_alphas(c.roughness, c.anisotropic)

        self._lobe(LobeKind.TRANSPARENT, weight * (1.0 - c.alpha))
        weight = weight * c.alpha
        if c.coat_weight > NEGLIGIBLE:
            coat = {"ior": max(c.coat_ior, 1.0), "multiscatter": 1, **alphas(c.coat_roughness)}
            cover = {"covers": c.coat_weight, "refract_tint": c.coat_tint}
            self._lobe(LobeKind.COATING, weight * c.coat_weight, **cover, **coat, **layer)
        self.emission += weight * np.array(c.emission_color) * c.emission_strength

        metal = {"fresnel": FresnelKind.F82, "f0": np.clip(base_color, 0, 1), "f82": c.specular_tint}
        self._lobe(LobeKind.CONDUCTOR, weight * c.metallic, multiscatter=c.multiscatter, **metal, **widths, **layer)
        weight = weight * (1.0 - c.metallic)
        # a ray passes the glass going in and coming out: each time half of the colour
        self._lobe(
            LobeKind.DIELECTRIC,
            weight * c.transmission,
            reflect_tint=c.specular_tint,
            refract_tint=np.sqrt(base_color),
            ior=max(c.ior, 1e-5),
            multiscatter=c.multiscatter,
            **alphas(c.roughness),
            **layer,
        )
        weight = weight * (1.0 - c.transmission)
        ior = specular_ior(c.ior, c.specular_ior_level)
        if ior != 1.0:
            self._lobe(
                LobeKind.COATING,
                weight,
                covers=1.0,
                ior=ior,
                f0=c.specular_tint,
                multiscatter=c.multiscatter,
                **widths,
                **layer,
            )
        self._lobe(LobeKind.DIFFUSE, weight * base_color, **layer)


def alphas(roughness):
    """Fields alpha_x, alpha_y of an isotropic lobe."""
    alpha = min(max(roughness, 0.0), 1.0) ** 2
    return {"alpha_x": alpha, "alpha_y": alpha}


def glossy_node_alphas(roughness, anisotropy):
    """Widths as Blender's Glossy and Metallic nodes stretch them."""
    alpha = min(max(roughness, 0.0), 1.0) ** 2
    anisotropy = min(max(anisotropy, -0.99), 0.99)
    if anisotropy < 0.0:
        return {"alpha_x": alpha / (1.0 + anisotropy), "alpha_y": alpha * (1.0 + anisotropy)}
    return {"alpha_x": alpha * (1.0 - anisotropy), "alpha_y": alpha / (1.0 - anisotropy)}


def principled_alphas(roughness, anisotropic):
    """Widths as the Principled BSDF stretches them (Burley 2012, section 5.4)."""
    alpha = min(max(roughness, 0.0), 1.0) ** 2
    aspect = math.sqrt(1.0 - 0.9 * min(max(anisotropic, 0.0), 1.0))
    return {"alpha_x": alpha / aspect, "alpha_y": alpha * aspect}


def specular_ior(ior, level):
    """Index of refraction whose reflectance at normal incidence is that of `ior` times 2 `level`."""
    f0 = min(((ior - 1.0) / (ior + 1.0)) ** 2 * 2.0 * max(level, 0.0), 0.99)
    adjusted = (1.0 + math.sqrt(f0)) / (1.0 - math.sqrt(f0))
    return 1.0 / adjusted if ior < 1.0 else adjusted


def _merge_equal(rows):
    """Add the weights of lobes that are alike in all else."""
    merged = {}
    for row in rows:
        key = tuple((k, tuple(np.ravel(v))) for k, v in sorted(row.items()) if k != "weight")
        if key in merged:
            merged[key]["weight"] = merged[key]["weight"] + row["weight"]
        else:
            merged[key] = dict(row)
    return list(merged.values())
