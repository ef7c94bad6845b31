# SPDX-License-Identifier: GPL-3.0-or-later
"""What fills an object or the world: closures as plain data, and the medium that they make together.

    Mix(0.3, VolumeScatter((0.8, 0.8, 0.8), density=2.0), VolumeAbsorption((1.0, 0.5, 0.2), density=1.0))

The names and the meaning are those of Blender's shader nodes; Mix, Add, Emission and Black are those of `materials`.
All values are constant. Densities are per metre of the world, however the object is scaled.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from ..linalg.color import blackbody
from ..medium_tables import PHASE, PhaseKind
from . import checks
from .materials import WHITE

LEAST_ANISOTROPY = 1e-3  # |g| below it is isotropic: the formulas would lose their digits
MOST_ANISOTROPY = 1.0 - 1e-3
STEFAN_BOLTZMANN = 5.670373e-8 * 1e-6 / math.pi  # as Cycles scales it, which makes fires no brighter than lamps


# ---- Phase functions -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class HenyeyGreenstein:
    anisotropy: float = 0.0


@dataclass(frozen=True)
class Rayleigh:
    """Particles much smaller than a wavelength."""


@dataclass(frozen=True)
class Draine:
    """Dust between the stars, or with an `alpha` of 1 Cornette and Shanks' function."""

    anisotropy: float = 0.0
    alpha: float = 0.5


@dataclass(frozen=True)
class FournierForand:
    """Sea water: `ior` of what floats in it, and the share of light that it scatters backwards."""

    ior: float = 1.33
    backscatter: float = 0.1


@dataclass(frozen=True)
class Mie:
    """Droplets of water, of a `diameter` in micrometres: fog and clouds."""

    diameter: float = 20.0


# ---- Closures --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class VolumeScatter:
    color: tuple = (0.8, 0.8, 0.8)
    density: float = 1.0
    phase: object = HenyeyGreenstein()


@dataclass(frozen=True)
class VolumeAbsorption:
    """Takes away what `color` is not."""

    color: tuple = (0.8, 0.8, 0.8)
    density: float = 1.0


@dataclass(frozen=True)
class VolumeCoefficients:
    """By physical coefficients, each 1/m by colour; `emission` is radiance per metre."""

    absorption: tuple = WHITE
    scatter: tuple = WHITE
    emission: tuple = (0.0, 0.0, 0.0)
    phase: object = HenyeyGreenstein()


@dataclass(frozen=True)
class PrincipledVolume:
    """Smoke and fire."""

    color: tuple = (0.5, 0.5, 0.5)
    density: float = 1.0
    anisotropy: float = 0.0
    absorption_color: tuple = (0.0, 0.0, 0.0)
    emission_strength: float = 0.0
    emission_color: tuple = WHITE
    blackbody_intensity: float = 0.0
    blackbody_tint: tuple = WHITE
    temperature: float = 1000.0  # kelvin


# ---- What they come to -----------------------------------------------------------------------------------------------


@dataclass
class Medium:
    """Coefficients by colour, 1/m; `phases` are rows of PHASE, whose weights are what is scattered."""

    absorption: np.ndarray = field(default_factory=lambda: np.zeros(3))
    emission: np.ndarray = field(default_factory=lambda: np.zeros(3))
    phases: list = field(default_factory=list)

    @property
    def scattering(self):
        return sum((row["weight"].astype(np.float64) for row in self.phases), np.zeros(3))

    @property
    def is_empty(self):
        return not (self.absorption.any() or self.emission.any() or self.scattering.any())


def medium_of(name, volume, endless=False):
    """The Medium that a closure is, None if there is none, or none to be seen.

    `endless`: it fills the world, so what emits and holds nothing back would be infinitely bright; left black.
    """
    if volume is None:
        return None
    flattening = _Flattening(name)
    flattening.add(volume, 1.0)
    medium = flattening.medium
    if endless:
        medium.emission[medium.absorption + medium.scattering <= 0.0] = 0.0
    return None if medium.is_empty else medium


class _Flattening:
    """Walks a closure and adds up what it says, mix factors multiplied out."""

    def __init__(self, name):
        self.name, self.medium = name, Medium()

    def add(self, closure, weight):
        if weight > 0.0:
            getattr(self, f"_{type(closure).__name__.lower()}")(closure, weight)

    def _color(self, what, value):
        return checks.color(self.name, what, value)

    def _scatter(self, sigma_s, phase):
        for share, row in _phase_rows(phase):
            row["weight"] = sigma_s * share
            if row["weight"].any():
                self.medium.phases.append(row)

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
        self.medium.emission += self._color("emission", c.color) * max(c.strength, 0.0) * weight

    def _volumescatter(self, c, weight):
        self._scatter(self._color("volume colour", c.color) * max(c.density, 0.0) * weight, c.phase)

    def _volumeabsorption(self, c, weight):
        kept = np.minimum(self._color("volume colour", c.color), 1.0)
        self.medium.absorption += (1.0 - kept) * max(c.density, 0.0) * weight

    def _volumecoefficients(self, c, weight):
        self.medium.absorption += self._color("absorption", c.absorption) * weight
        self.medium.emission += self._color("emission", c.emission) * weight
        self._scatter(self._color("scattering", c.scatter) * weight, c.phase)

    def _principledvolume(self, c, weight):
        color, density = self._color("volume colour", c.color), max(c.density, 0.0) * weight
        self._scatter(color * density, HenyeyGreenstein(c.anisotropy))
        kept = np.sqrt(self._color("absorption colour", c.absorption_color))
        self.medium.absorption += np.maximum(1.0 - color, 0.0) * np.maximum(1.0 - kept, 0.0) * density
        self.medium.emission += self._color("emission", c.emission_color) * max(c.emission_strength, 0.0) * weight
        if c.blackbody_intensity > 0.0:
            kelvins = max(c.temperature, 0.0)
            power = STEFAN_BOLTZMANN * (1.0 + (kelvins**4 - 1.0) * c.blackbody_intensity)
            glow = np.array(list(blackbody(np.float32(kelvins))))  # below 1900 K of negative blue, as in Cycles
            self.medium.emission += self._color("blackbody tint", c.blackbody_tint) * glow * max(power, 0.0) * weight


def _phase_rows(phase):
    """[(share, row of PHASE)]"""
    row = np.zeros(1, PHASE)[0]
    if isinstance(phase, Mie):
        return _mie(max(phase.diameter, 0.0))
    if isinstance(phase, Rayleigh):
        row["kind"] = PhaseKind.RAYLEIGH
    elif isinstance(phase, FournierForand):
        row["kind"] = PhaseKind.FOURNIER_FORAND
        ior, backscatter = max(phase.ior, 1.001), min(abs(phase.backscatter), 0.499)
        scale = 2.0 / (3.0 * (ior - 1.0) ** 2)  # delta at 90 degrees, half of that at 180
        scale *= 1.0 + 1e-6 * (abs(scale - 1.0) < 1e-6)
        nu = -math.log(max(2.0 * backscatter * (scale - 1.0) + 1.0, 1e-12)) / math.log(scale)
        backward = ((2.0 * scale) ** -nu - 1.0) / (2.0 * scale - 1.0)
        row["scale"], row["nu"], row["backward"] = scale, nu, backward
    else:
        g = min(max(phase.anisotropy, -MOST_ANISOTROPY), MOST_ANISOTROPY)
        row["g"] = g if abs(g) >= LEAST_ANISOTROPY else 0.0
        row["kind"] = PhaseKind.HENYEY_GREENSTEIN
        if isinstance(phase, Draine) and phase.alpha > 0.0:
            row["kind"], row["alpha"] = PhaseKind.DRAINE, phase.alpha
    return [(1.0, row)]


def _mie(d):
    """Henyey and Greenstein's function with Draine's, fitted to droplets of `d` micrometres.

    J. Jendersie and E. d'Eon, "An Approximate Mie Scattering Function for Fog and Cloud Rendering" (2023), equations 7
    to 22 of its supplement: anisotropies of both, Draine's alpha, and Draine's share.
    """
    if d <= 0.1:
        g, g_draine, alpha = 13.8 * d * d, 1.1456 * d * math.sin(9.29044 * d), 250.0
        share = 0.252977 - 312.983 * d**4.3
    elif d < 1.5:
        log = math.log(d)
        angle = 1.19692 * math.cos((log - 0.238604) * (log + 1.00667) / (0.507522 - 0.15677 * log))
        g = 0.862 - 0.143 * log * log
        g_draine, alpha = 0.379685 * math.cos(angle + 1.37932 * log + 0.0625835) + 0.344213, 250.0
        share = 0.146209 * math.cos(3.38707 * log + 2.11193) + 0.316072 + 0.0778917 * log
    elif d < 5.0:
        log = math.log(d)
        g = 0.0604931 * math.log(log) + 0.940256
        g_draine = 0.500411 - 0.081287 / (-2.0 * log + math.tan(log) + 1.27551)
        alpha = 7.30354 * log + 6.31675
        share = 0.026914 * (log - math.cos(5.68947 * (math.log(log) - 0.0292149))) + 0.3764
    else:
        g = math.exp(-0.0990567 / (d - 1.67154))
        g_draine = math.exp(-2.20679 / (d + 3.91029) - 0.428934)
        alpha = math.exp(3.62489 - 8.29288 / (d + 5.52825))
        share = math.exp(-0.599085 / (d - 0.641583) - 0.665888)
    share = min(max(share, 0.0), 1.0)
    both = (1.0 - share, HenyeyGreenstein(g)), (share, Draine(g_draine, alpha))
    return [(part, _phase_rows(phase)[0][1]) for part, phase in both]
