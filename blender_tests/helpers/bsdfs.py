# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters for every kind of lobe, and many samples or values of a BSDF at once."""

import math

import numpy as np

from engine_core.bsdf import dispatch
from engine_core.jit import kernel
from engine_core.linalg.vec3 import Vec3
from engine_core.tables import BSDF, MAX_LOBES, Facets, FresnelKind, LobeKind, SubsurfaceKind

FILM = {"film_thickness": 400.0, "film_ior": 1.33}
GOLD = {"f0": (0.18, 0.42, 1.37), "f82": (3.42, 2.35, 1.77)}  # n and k at 650, 550 and 450 nm


HAIR = {"alpha_x": 0.085, "alpha_y": 0.117, "alpha_r": 0.085, "ior": 1.55, "g": 0.035}  # as Blender's node has it


def _widths(alpha_x, alpha_y=None):
    return {"alpha_x": alpha_x, "alpha_y": alpha_y or alpha_x}


# {kind: {name: fields of LOBE}}: every kind of lobe has to be here, or the tests over all kinds fail.
CASES = {
    LobeKind.DIFFUSE: {"": {}},
    LobeKind.TRANSLUCENT: {"": {}},
    LobeKind.TRANSPARENT: {"": {}},
    LobeKind.ROUGH_DIFFUSE: {
        "slightly": {"alpha_x": 0.1},
        "roughest": {"alpha_x": 1.0},
        "coloured": {"alpha_x": 0.8, "f0": (0.9, 0.4, 0.1)},
        "as Lambert": {"alpha_x": 0.0},
    },
    LobeKind.TOON_DIFFUSE: {"": _widths(0.5, 0.2), "sharp": {"alpha_x": 0.3}, "widest": _widths(0.9, 0.5)},
    LobeKind.TOON_GLOSSY: {"": _widths(0.3, 0.2), "sharp": {"alpha_x": 0.2871}},
    LobeKind.SHEEN: {"": {"alpha_x": 0.5}, "soft": {"alpha_x": 1.0}, "sharp": {"alpha_x": 0.15}},
    LobeKind.ASHIKHMIN_SHIRLEY: {"": _widths(0.3), "sharp": _widths(0.02), "stretched": _widths(0.5, 0.1)},
    LobeKind.SUBSURFACE: {
        "smooth": {"ior": 1.4},
        "blurred": {**_widths(0.5), "ior": 1.8},
        "skin": {**_widths(1.0), "ior": 1.4, "fresnel": SubsurfaceKind.SKIN},
    },
    LobeKind.VELVET: {"": {"alpha_x": 0.4}, "soft": {"alpha_x": 1.0}, "sharp": {"alpha_x": 0.1}},
    LobeKind.CONDUCTOR: {
        "mirror": {},
        "sharp": _widths(0.02),
        "rough": _widths(0.4),
        "roughest": _widths(1.0),
        "stretched": _widths(0.5, 0.1),
        "compensated": {**_widths(0.4), "multiscatter": 1},
        "Beckmann": {**_widths(0.3), "facets": Facets.BECKMANN},
        "Beckmann roughest": {**_widths(1.0), "facets": Facets.BECKMANN},
        "Beckmann stretched": {**_widths(0.5, 0.1), "facets": Facets.BECKMANN},
        "film": {**_widths(0.2), "fresnel": FresnelKind.F82, "f0": (0.9, 0.6, 0.2), "f82": (0.8, 0.9, 1.0), **FILM},
        "gold film": {**_widths(0.2), "fresnel": FresnelKind.CONDUCTOR, **GOLD, **FILM},
        "pane": {**_widths(0.2), "fresnel": FresnelKind.THIN_WALL, "ior": 1.5, "multiscatter": 1},
        "coloured": {**_widths(0.2), "fresnel": FresnelKind.F82, "f0": (0.9, 0.6, 0.2), "f82": (0.8, 0.9, 1.0)},
        "gold": {**_widths(0.2), "fresnel": FresnelKind.CONDUCTOR, **GOLD},
    },
    LobeKind.DIELECTRIC: {
        "smooth": {"ior": 1.5},
        "smooth from inside": {"ior": 1 / 1.5},
        "sharp": {**_widths(0.03), "ior": 1.5},
        "rough": {**_widths(0.3), "ior": 1.5},
        "rough from inside": {**_widths(0.3), "ior": 1 / 1.5},
        "stretched": {**_widths(0.4, 0.1), "ior": 1.33},
        "compensated": {**_widths(0.5), "ior": 1.5, "multiscatter": 1},
        "tinted": {**_widths(0.2), "ior": 1.8, "reflect_tint": (0.2, 0.5, 1.0), "refract_tint": (0.9, 0.5, 0.1)},
        "index of the air": {**_widths(0.3), "ior": 1.0},
        "Beckmann": {**_widths(0.3), "ior": 1.5, "facets": Facets.BECKMANN},
        "film": {**_widths(0.2), "ior": 1.5, **FILM},
        "film from inside": {**_widths(0.2), "ior": 1 / 1.5, "film_thickness": 400.0, "film_ior": 1.33 / 1.5},
    },
    LobeKind.THIN_WALL: {
        "smooth": {"ior": 1.5, "multiscatter": 1},
        "rough": {**_widths(0.3), "ior": 1.5, "multiscatter": 1, "refract_tint": (0.9, 0.6, 0.3)},
    },
    LobeKind.HAIR: {
        "brown": {**HAIR, "f82": (0.3, 0.6, 1.4)},
        "white": {**HAIR, "f82": (0.0, 0.0, 0.0)},
        "smooth": {**HAIR, "alpha_x": 0.0064, "alpha_y": 0.024, "alpha_r": 0.0014, "f82": (0.1, 0.2, 0.1)},
        "roughest": {**HAIR, "alpha_x": 27.0, "alpha_y": 4.2, "alpha_r": 1.0, "g": 0.3, "f82": (0.1, 0.2, 0.1)},
    },
    LobeKind.HAIR_FACETS: {
        "brown": {**_widths(0.3), "ior": 1.55, "g": 0.035, "f82": (0.3, 0.6, 1.4)},
        "white": {**_widths(0.3), "ior": 1.55, "g": 0.035, "f82": (0.0, 0.0, 0.0)},
        "smooth": {**_widths(0.08), "ior": 1.55, "f82": (0.1, 0.2, 0.1)},
        "rough": {**_widths(0.8), "ior": 1.4, "g": 0.2, "f82": (0.1, 0.2, 0.1)},
        "without R": {**_widths(0.3), "ior": 1.55, "g": 0.035, "f82": (0.1, 0.2, 0.4), "f0": (0.0, 1.0, 2.0)},
    },
    LobeKind.HAIR_REFLECTION: {"": _widths(0.2, 0.4), "wide": {**_widths(0.9, 1.0), "g": -0.2}},
    LobeKind.HAIR_TRANSMISSION: {"": _widths(0.2, 0.4), "wide": {**_widths(0.9, 1.0), "g": -0.2}},
    LobeKind.REFRACTION: {
        "Beckmann": {**_widths(0.3), "ior": 1.45, "facets": Facets.BECKMANN},
        "smooth": {"ior": 1.45},
        "rough": {**_widths(0.3), "ior": 1.45},
        "rough from inside": {**_widths(0.3), "ior": 1 / 1.45},
    },
    LobeKind.COATING: {
        "smooth": {"ior": 1.5},
        "sharp": {**_widths(0.03), "ior": 1.5},
        "rough": {**_widths(0.5), "ior": 1.5},
        "stretched": {**_widths(0.5, 0.1), "ior": 1.5},
        "tinted": {**_widths(0.2), "ior": 1.8, "f0": (0.2, 0.5, 1.0)},
        "compensated": {**_widths(0.5), "ior": 2.5, "multiscatter": 1},
        "film": {**_widths(0.2), "ior": 1.5, **FILM},
    },
}
ALL_CASES = {
    f"{kind.name} {name}".strip(): (kind, fields) for kind, named in CASES.items() for name, fields in named.items()
}

WORLD = np.eye(3)
TILTED = np.array([[math.cos(0.4), 0.0, -math.sin(0.4)], [0.0, 1.0, 0.0], [math.sin(0.4), 0.0, math.cos(0.4)]])
# Those that scatter in single directions only
DELTAS = ["TRANSPARENT", "CONDUCTOR mirror", "COATING smooth", "REFRACTION smooth"]
DELTAS += ["THIN_WALL smooth"]
DELTAS += ["DIELECTRIC smooth", "DIELECTRIC smooth from inside", "DIELECTRIC index of the air"]
DELTAS += ["SUBSURFACE smooth", "SUBSURFACE blurred", "SUBSURFACE skin"]


def lobe(kind, **fields):
    """Fields of a white lobe of this kind."""
    one = (1.0, 1.0, 1.0)
    defaults = {
        "weight": one,
        "alpha_r": 0.1,
        "ior": 1.0,
        "f0": one,
        "f82": one,
        "reflect_tint": one,
        "refract_tint": one,
    }
    return {"kind": kind, **defaults, **fields}


def make_bsdf(*lobes, wo=None, frame=WORLD, ng=None, backfacing=False):
    """A row of BSDF with these lobes. Rows of `frame`: tangents s and t, and normal n. With `wo`: prepared for it.

    Lobes whose field `frame` is 1 have a normal that is TILTED from that.
    """
    bsdf = np.zeros(1, BSDF).view(np.recarray)[0]
    bsdf.count = len(lobes)
    assert len(lobes) <= MAX_LOBES
    bsdf.frame_count = 2
    for row, axes in zip(bsdf.frames, (frame, TILTED @ frame), strict=False):
        row.s, row.t, row.n = axes
    bsdf.ng = frame[2] if ng is None else ng
    for row, fields in zip(bsdf.lobes, lobes, strict=False):
        for name, value in fields.items():
            row[name] = value
    if wo is not None:
        dispatch.prepare(bsdf, Vec3(*wo), backfacing)
    return bsdf


def direction(theta, phi=0.3):
    """Unit vector at `theta` degrees from z and `phi` radians from x."""
    theta = np.radians(theta)
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


SAMPLE = np.dtype(
    [
        ("wi", "f4", (3,)),  # NaN: no direction
        ("weight", "f4", (3,)),
        ("pdf", "f4"),
        ("kind", "i4"),
        ("is_delta", "i4"),
        ("is_transmission", "i4"),
    ]
)


def sample_many(bsdf, wo, n, seed=1, u=None):
    """n samples of the BSDF, by random numbers or by `u`, (n, 3): a recarray of SAMPLE."""
    out = np.zeros(n, SAMPLE)
    wi, weight = np.empty((n, 3), np.float32), np.empty((n, 3), np.float32)
    if u is None:
        u = np.random.default_rng(seed).random((n, 3), dtype=np.float32)
    numbers, flags = np.empty(n, np.float32), np.empty((n, 3), np.int32)
    _sample_many(bsdf, Vec3(*wo), u, wi, weight, numbers, flags)
    out["wi"], out["weight"], out["pdf"] = wi, weight, numbers
    out["kind"], out["is_delta"], out["is_transmission"] = flags.T
    return out.view(np.recarray)


def evaluate_many(bsdf, wo, wi):
    """(f |cos|, (n, 3); pdf, (n,)) for directions wi, (n, 3)."""
    wi = np.ascontiguousarray(wi, np.float32)
    f, density = np.empty((len(wi), 3), np.float32), np.empty(len(wi), np.float32)
    _evaluate_many(bsdf, Vec3(*wo), wi, f, density)
    return f, density


@kernel
def _sample_many(bsdf, wo, u, wi, weight, pdf, flags):
    for i in range(len(u)):
        s = dispatch.sample(bsdf, wo, u[i, 0], u[i, 1], u[i, 2])
        wi[i, 0], wi[i, 1], wi[i, 2] = s.wi.x, s.wi.y, s.wi.z
        if s.pdf == 0.0:
            wi[i, :] = np.float32(np.nan)
        weight[i, 0], weight[i, 1], weight[i, 2] = s.weight.x, s.weight.y, s.weight.z
        pdf[i] = s.pdf
        flags[i, 0], flags[i, 1], flags[i, 2] = s.kind, s.is_delta, s.is_transmission


@kernel
def _evaluate_many(bsdf, wo, wi, f, density):
    for i in range(len(wi)):
        value, density[i] = dispatch.evaluate_and_pdf(bsdf, wo, Vec3(wi[i, 0], wi[i, 1], wi[i, 2]))
        f[i, 0], f[i, 1], f[i, 2] = value.x, value.y, value.z
