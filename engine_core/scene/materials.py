# SPDX-License-Identifier: GPL-3.0-or-later
"""What a surface is made of: closures as plain data. How they become rows of CLOSURE and LOBE says `flattening.py`.

    Mix(0.3, Diffuse((0.8, 0.2, 0.1)), Glossy((1, 1, 1), roughness=0.2))

The names and the meaning are those of Blender's shader nodes. Colours are linear, three numbers. `roughness` is the
artist's number, 0 to 1; the microfacet width is alpha = roughness ** 2. Any number or colour may be a value
that varies over the surface instead: a Node of `shader.graph`. `normal` is in world space, None for the surface's own.
"""

from dataclasses import dataclass

from ..tables import SubsurfaceKind

WHITE = (1.0, 1.0, 1.0)


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
    """Absorbs everything, and leaves the picture empty where the camera sees it: `color` says how much of it."""

    color: tuple = WHITE


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
