# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light microfacets give back, from tables, and how to make up for what single scattering loses.

Light that hits a second microfacet is lost to the model. Turquin (2019, "Practical multiple scattering compensation for
microfacet models") gives it back by scaling the lobe with one over its albedo; the bounces that metals colour darken it
(Kulla and Conty 2017). The tables are made by `make_tables.py`, all for isotropic widths; a stretched lobe asks with
alpha = sqrt(alpha_x alpha_y), as in Cycles, and its albedo is then an estimate.
"""

import math
from pathlib import Path

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import WHITE, lerp
from ..tables import Facets
from .fresnel import fresnel_dielectric
from .lobe import ONE

# Coordinates, all 0 to 1: roughness = sqrt(alpha); view = cos (1 + alpha) / (cos + alpha), as albedos change where cos
# is like alpha; index = sqrt |(ior - 1) / (ior + 1)|. Small enough to be constants in the machine code.
_TABLES = np.load(Path(__file__).with_name("energy_tables.npz"))
PLANES, GGX_AVERAGE = _TABLES["planes"], _TABLES["ggx_average"]
VOLUMES, GLASS_AVERAGE = _TABLES["volumes"], _TABLES["glass_average"]

# PLANES[_, roughness, cos], whose coordinates are those of Cycles: so what is between entries is the same, too
GGX = 0  # albedo of a mirror without Fresnel; GGX_AVERAGE[roughness] is its mean over views, 2 cos d cos
SCHLICK = 1  # mean of (1 - cos)^5 over the light that such a mirror reflects
SCHLICK_F82 = 2  # mean of cos (1 - cos)^6
# VOLUMES[_, index, roughness, view]
GLASS = 0  # albedo of glass, reflection and refraction, seen from outside: ior above 1
GLASS_INSIDE = 1  # ... from inside; GLASS_AVERAGE[0 or 1, index, roughness] are their means
FRESNEL = 2  # mean reflectance of a dielectric, from outside, over that of a smooth surface
VARNISH = 3  # [.., .., cos]: how far a varnish seems on the way from its reflectance at normal incidence to 1

# ---- Where tables are asked: once for all questions of a hit ---------------------------------------------------------


@kernel
def look_at_glass(lobe, cos):
    """Make a lobe that refracts by microfacets ready to be asked what follows, seen at that cosine."""
    alpha = math.sqrt(lobe.alpha_x * lobe.alpha_y)
    lobe.roughness, lobe.angle = math.sqrt(alpha), _view(cos, alpha)


@kernel
def look_at_mirror(lobe, cos):
    """The same of one that does nothing but reflect."""
    lobe.roughness = math.sqrt(math.sqrt(lobe.alpha_x * lobe.alpha_y))
    lobe.share, lobe.mean_share = ggx_albedo(lobe, cos), _line(lobe.roughness)


@kernel
def look_as_at(lobe, other):
    """The same where another has equal microfacets."""
    lobe.roughness, lobe.share, lobe.mean_share = other.roughness, other.share, other.mean_share


# ---- Single scattering, by the cosine of wo --------------------------------------------------------------------------


@kernel
def ggx_albedo(lobe, cos):
    """Share of light that a rough mirror without Fresnel gives back by single scattering."""
    return _plane(GGX, lobe.roughness, cos)


@kernel
def mirror_share(lobe):
    """The same with what `compensate` makes up for, which is all. Of Beckmann facets, which lose less, an estimate."""
    if lobe.multiscatter:
        return ONE
    return math.sqrt(lobe.share) if lobe.facets == Facets.BECKMANN else lobe.share


@kernel
def mean_f82(lobe, cos, f0, b):
    """Mean reflectance of the microfacets of a metal, for the curve f0 + (1 - f0) (1 - cos)^5 - b cos (1 - cos)^6."""
    roughness = lobe.roughness
    return lerp(f0, WHITE, _plane(SCHLICK, roughness, cos)) - b * _plane(SCHLICK_F82, roughness, cos)


@kernel
def mean_dielectric(lobe, cos):
    """Mean reflectance of the microfacets of a dielectric. From inside (ior < 1) an estimate: as if smooth."""
    smooth, _ = fresnel_dielectric(cos, lobe.ior)
    if lobe.ior <= 1.0:
        return smooth
    return smooth * _volume(FRESNEL, _index(lobe.ior), lobe.roughness, lobe.angle)


@kernel
def seeming_rise(lobe, cos):
    """How far the mean reflectance of a varnish seems on the way from F0 to 1, in Cycles, whose table this is.

    By it Cycles decides how much of what lies below is seen, so that pictures look alike at grazing angles. It is an
    estimate: facets that are seen but reflect down count as black ones, shadowing does not, and between the few cosines
    of the table the curve is straight.
    """
    return _volume(VARNISH, _index(lobe.ior), lobe.roughness, cos)


@kernel
def glass_albedo(lobe):
    """Share of light that white glass gives back by single scattering, reflected and refracted."""
    side = GLASS_INSIDE if lobe.ior < 1.0 else GLASS
    return _volume(side, _index(lobe.ior), lobe.roughness, lobe.angle)


@kernel
def glass_share(ior, alpha, cos):
    """The same of glass with GGX facets of that width, whatever it is part of."""
    return _volume(GLASS_INSIDE if ior < 1.0 else GLASS, _index(ior), math.sqrt(alpha), _view(cos, alpha))


# ---- Compensation ----------------------------------------------------------------------------------------------------


@kernel
def compensate_reflection(lobe, reflectance):
    """Set `energy_scale` of a rough mirror whose mean Fresnel reflectance is `reflectance`; see `_compensate`."""
    return _compensate(lobe, lobe.share, lobe.mean_share, reflectance)


@kernel
def compensate_glass(lobe, tint):
    """Set `energy_scale` of rough glass whose further bounces take the colour `tint`; see `_compensate`."""
    side = GLASS_INSIDE if lobe.ior < 1.0 else GLASS
    average = _glass_average(side, _index(lobe.ior), lobe.roughness)
    return _compensate(lobe, glass_albedo(lobe), average, tint)


@kernel
def _compensate(lobe, albedo, average, reflectance):
    """Scale the lobe up to albedo 1, as if it lost nothing; gives the colour that it then loses by its further bounces.

    A share `albedo` leaves at once. The rest bounces on, each time reflected by `reflectance` and out with probability
    `average`: in sum reflectance average / (1 - reflectance (1 - average)), with the first bounce's colour left out,
    which is in the lobe already (Kulla and Conty 2017, as Cycles has it).
    """
    lobe.energy_scale = 1.0 / albedo
    further = reflectance * average / (WHITE - reflectance * (1.0 - average))
    return lerp(further, WHITE, albedo)


# ---- Tables ----------------------------------------------------------------------------------------------------------


@kernel
def _view(cos, alpha):
    return cos * (1.0 + alpha) / (cos + alpha)


@kernel
def _index(ior):
    return math.sqrt(abs((ior - 1.0) / (ior + 1.0)))


@kernel
def _cell(x, size):
    """(i, t): x of 0 to 1 lies between the entries i and i + 1 of a table, at t."""
    x = min(max(x, 0.0), 1.0) * np.float32(size - 1)
    i = min(int(x), size - 2)
    return i, x - np.float32(i)


@kernel
def _line(x):
    i, t = _cell(x, GGX_AVERAGE.shape[0])
    return lerp(GGX_AVERAGE[i], GGX_AVERAGE[i + 1], t)


@kernel
def _plane(which, x, y):
    i, s = _cell(x, PLANES.shape[1])
    j, t = _cell(y, PLANES.shape[2])
    low = lerp(PLANES[which, i, j], PLANES[which, i, j + 1], t)
    high = lerp(PLANES[which, i + 1, j], PLANES[which, i + 1, j + 1], t)
    return lerp(low, high, s)


@kernel
def _glass_average(side, x, y):
    i, s = _cell(x, GLASS_AVERAGE.shape[1])
    j, t = _cell(y, GLASS_AVERAGE.shape[2])
    low = lerp(GLASS_AVERAGE[side, i, j], GLASS_AVERAGE[side, i, j + 1], t)
    high = lerp(GLASS_AVERAGE[side, i + 1, j], GLASS_AVERAGE[side, i + 1, j + 1], t)
    return lerp(low, high, s)


@kernel
def _volume(which, x, y, z):
    i, r = _cell(x, VOLUMES.shape[1])
    j, s = _cell(y, VOLUMES.shape[2])
    k, t = _cell(z, VOLUMES.shape[3])
    return lerp(
        lerp(_edge(which, i, j, k, t), _edge(which, i, j + 1, k, t), s),
        lerp(_edge(which, i + 1, j, k, t), _edge(which, i + 1, j + 1, k, t), s),
        r,
    )


@kernel
def _edge(which, i, j, k, t):
    return lerp(VOLUMES[which, i, j, k], VOLUMES[which, i, j, k + 1], t)
