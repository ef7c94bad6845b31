# SPDX-License-Identifier: GPL-3.0-or-later
"""The light of the sky and of the sun's disk, integrated through the atmosphere: tables for `sky`.

Two models, with the numbers that Blender's Sky Texture has: what the sun's light becomes when it is scattered once, at
21 wavelengths (Nishita et al. 1993, "Display of the Earth taking into account atmospheric scattering"), and with all
further scattering by a fit, at four wavelengths (F. García Liñán 2024, "A spectral approach to sky rendering"; stepped
as in Hillaire 2016, "Physically based sky, atmosphere and cloud rendering in Frostbite").

The sun stands in the plane y = 0 of the model, and a table is symmetrical about that plane. Rows of a table go from the
nadir to the zenith, dense at the horizon: `elevations`. Its values, and those of the disk, are in linear Rec.709, and
may be negative where a colour is too saturated for that.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..linalg.color import XYZ_TO_BLUE, XYZ_TO_GREEN, XYZ_TO_RED

WIDTH, HEIGHT = 512, 256
OLD_HEIGHT = 128  # Blender 4 has the upper half only
XYZ_TO_RGB = np.array([tuple(row) for row in (XYZ_TO_RED, XYZ_TO_GREEN, XYZ_TO_BLUE)], np.float64)


class Air(NamedTuple):
    """How much there is of what, 1 on a clear day; metres above the sea."""

    altitude: float = 100.0
    molecules: float = 1.0
    aerosols: float = 1.0
    ozone: float = 1.0


class Disk(NamedTuple):
    """Radiance (3,) at the lowest and at the highest point of the sun's disk."""

    bottom: np.ndarray
    top: np.ndarray


def to_rgb(xyz):
    return xyz @ XYZ_TO_RGB.T


def _chord(height_from_centre, cosine, radius):
    """Way through a ball from within it, at an angle to the vertical of a given cosine."""
    along = height_from_centre * cosine
    return -along + np.sqrt(np.maximum(along**2 - height_from_centre**2 + radius**2, 0.0))


# ---- Scattered once --------------------------------------------------------------------------------------------------

EARTH, ATMOSPHERE = 6360e3, 6420e3  # radii, m
SCALES = np.array([8e3, 1.2e3])  # heights over which molecules and aerosols thin out by e, m
MIE, MIE_EXTINCTION, MIE_G = 2e-5, 1.11 * 2e-5, 0.76
STEPS = 32
WAVELENGTH_STEP = 20.0  # nm, from 380 to 780
IRRADIANCE = np.array(  # of the sun above the atmosphere, W / (m2 nm)
    [1.457568299, 1.565963056, 1.651484491, 1.714962427, 1.757979838, 1.782564079, 1.790951085, 1.785415501,
     1.768155549, 1.741220696, 1.706471272, 1.665560875, 1.619934372, 1.570835974, 1.519323351, 1.466284950,
     1.412458527, 1.358449620, 1.304749138, 1.251749633, 1.199759988]
)  # fmt: skip
RAYLEIGH = 1e-6 * np.array(  # scattering by molecules at sea level, 1 / m
    [54.24820088, 44.18549867, 36.35151910, 30.17929012, 25.26320227, 21.30859311, 18.09838025, 15.47057129,
     13.30284977, 11.50184784, 9.99557430, 8.72799973, 7.65513701, 6.74217204, 5.96134126, 5.29034598,
     4.71115688, 4.20910481, 3.77218381, 3.39051255, 3.05591532]
)  # fmt: skip
OZONE = 1e-6 * np.array(  # absorption, 1 / m
    [0.003251268, 0.005853954, 0.019771912, 0.073095688, 0.200845615, 0.403839581, 0.635513359, 0.967070412,
     1.547974004, 2.090386472, 2.461280562, 2.735512995, 2.151258631, 1.590518408, 1.123561980, 0.735275515,
     0.464501304, 0.330960799, 0.225126123, 0.148791293, 0.168286234]
)  # fmt: skip
CIE_1931 = np.array(  # colour matching functions, x y z
    [[0.001368, 0.000039, 0.006450001], [0.01431, 0.000396, 0.06785001], [0.13438, 0.004, 0.6456],
     [0.34828, 0.023, 1.74706], [0.2908, 0.06, 1.6692], [0.09564, 0.13902, 0.8129501], [0.0049, 0.323, 0.272],
     [0.06327, 0.71, 0.07824999], [0.2904, 0.954, 0.0203], [0.5945, 0.995, 0.0039], [0.9163, 0.87, 0.001650001],
     [1.0622, 0.631, 0.0008], [0.8544499, 0.381, 0.00019], [0.4479, 0.175, 0.00002], [0.1649, 0.061, 0.0],
     [0.04677, 0.017, 0.0], [0.01135916, 0.004102, 0.0], [0.002899327, 0.001047, 0.0],
     [0.0006900786, 0.0002492, 0.0], [0.0001661505, 0.00006, 0.0], [0.00004150994, 0.00001499, 0.0]]
)  # fmt: skip
SPECTRUM_TO_RGB = (WAVELENGTH_STEP * IRRADIANCE)[:, None] * to_rgb(CIE_1931)
EXTINCTION = np.stack([RAYLEIGH, np.full(21, MIE_EXTINCTION), OZONE])  # of molecules, aerosols, ozone: (3, 21)
# Gauss-Laguerre quadrature of 8 nodes, the last of the exponential's 25 mean lengths being the end of the way
NODES, _WEIGHTS = np.polynomial.laguerre.laggauss(8)
WEIGHTS = _WEIGHTS * np.exp(NODES) / 25.0
NODES = NODES / 25.0


def _densities(height):
    """Of molecules, aerosols and ozone over those at sea level (ozone: over the greatest), (..., 3)."""
    ozone = np.maximum(0.0, 1.0 - np.abs(height - 25e3) / 15e3)
    return np.stack([np.exp(-height / SCALES[0]), np.exp(-height / SCALES[1]), ozone], axis=-1)


def _depths_to_space(from_centre, cosine):
    """Integrals of the densities along ways out of the atmosphere, m: (..., 3)."""
    length = _chord(from_centre, cosine, ATMOSPHERE)
    total = np.zeros((*np.shape(length), 3))
    for node, weight in zip(NODES, WEIGHTS, strict=True):
        t = node * length
        height = np.sqrt(from_centre**2 + t * (t + 2.0 * from_centre * cosine)) - EARTH
        total += weight * _densities(height)
    return total * length[..., None]


def _single_phases(cosine):
    """Of molecules, and of aerosols (Cornette and Shanks 1992)."""
    g2 = MIE_G**2
    mie = 3.0 * (1.0 - g2) * (1.0 + cosine**2) / (8.0 * np.pi * (2.0 + g2))
    return 3.0 / (16.0 * np.pi) * (1.0 + cosine**2), mie / (1.0 + g2 - 2.0 * MIE_G * cosine) ** 1.5


def _once(elevation, azimuth, sun, air):
    """Radiance of the sky, (rows, columns, 3), at elevations and at angles from the sun; the sun's elevation `sun`."""
    start = EARTH + air.altitude
    amounts = np.array([air.molecules, air.aerosols, air.ozone])
    up, flat = np.sin(elevation)[:, None], np.cos(elevation)[:, None]
    across = np.cos(azimuth)[None]  # the part of the horizontal that leads towards the sun
    phases = _single_phases(up * math.sin(sun) + flat * across * math.cos(sun))
    step = _chord(start, up, ATMOSPHERE) / STEPS
    result = np.zeros((len(elevation), len(azimuth), 3))
    depth = np.zeros((len(elevation), 1, 3))
    for i in range(STEPS):
        t = (i + 0.5) * step
        from_centre = np.sqrt(start**2 + t * (t + 2.0 * start * up))
        density = amounts * _densities(from_centre - EARTH)
        depth = depth + step[..., None] * density
        to_sun = (t * flat * across * math.cos(sun) + (start + t * up) * math.sin(sun)) / from_centre
        light = amounts * _depths_to_space(from_centre, to_sun) + depth
        arrives = np.exp(-light @ EXTINCTION)
        if sun < 0.0:
            in_shadow = from_centre * np.sqrt(np.maximum(1.0 - to_sun**2, 0.0)) <= EARTH
            arrives[in_shadow] = 0.0
        molecules = phases[0] * density[..., 0] * step
        aerosols = phases[1] * density[..., 1] * (MIE * step)
        result += molecules[..., None] * (arrives @ (RAYLEIGH[:, None] * SPECTRUM_TO_RGB))
        result += aerosols[..., None] * (arrives @ SPECTRUM_TO_RGB)
    return result


def _disk_once(sun, size, air):
    start = np.float64(EARTH + air.altitude)
    amounts = np.array([air.molecules, air.aerosols, 0.0])  # Blender leaves ozone out here
    ends = []
    for elevation in (sun - size / 2.0, sun + size / 2.0):
        light = amounts * _depths_to_space(start, math.sin(max(elevation, 0.0)))
        ends.append(np.exp(-light @ EXTINCTION) @ SPECTRUM_TO_RGB / _solid_angle(size))
    return Disk(*ends) if sun + size / 2.0 > 0.0 else Disk(np.zeros(3), np.zeros(3))


def _solid_angle(size):
    return 2.0 * math.pi * 2.0 * math.sin(size / 4.0) ** 2


# ---- ... and again ---------------------------------------------------------------------------------------------------

GLOBE, THICKNESS = 6371.0, 100.0  # km
G = 0.8
MANY_STEPS = 64
GROUND_ALBEDO = 0.3
LOOKUP_SHAPE = (64, 256)  # by height, and by the cosine of the sun's angle to the vertical
# At 630, 560, 490 and 430 nm: the sun, W / (m2 nm); molecules at sea level, 1 / km; cross sections of ozone and of
# aerosols of a city, m2; and what those four stand for in XYZ
SUN = np.array([1.679, 1.828, 1.986, 1.307])
MOLECULES = np.array([6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2])
OZONE_SECTIONS, DOBSON = np.array([3.472e-25, 3.914e-25, 1.349e-25, 11.03e-27]), 334.5
AEROSOL_ABSORPTION = np.array([2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23])
AEROSOL_SCATTERING = np.array([1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22])
AEROSOLS, AEROSOLS_ABOVE, AEROSOL_SCALE = 1.3681e20, 2e6, 0.73  # 1 / km3 at the ground and high up; km
FOUR_TO_RGB = to_rgb(
    np.array(
        [[53.386917738564668, 22.981337506691025, 0.0], [43.904844466369358, 71.347795700053394, 0.1025068679657413],
         [1.6137278251608962, 18.422960591455485, 31.742921188390806],
         [20.762668673810577, 2.3614213523314369, 110.48009643252140]]
    )
)  # fmt: skip
FARTHER = 0.02 * np.array([0.217, 0.347, 0.594, 1.0])  # the fit of what comes from elsewhere in the air


class _Coefficients(NamedTuple):
    molecules: np.ndarray  # scattering, 1 / km: (..., 4)
    aerosols: np.ndarray
    extinction: np.ndarray


def _coefficients(height, air):
    h = np.maximum(height, 0.0)[..., None]
    aerosols = AEROSOLS * (np.exp(-h / AEROSOL_SCALE) + AEROSOLS_ABOVE / AEROSOLS) * air.aerosols
    log_h = np.log(np.maximum(h, 1e-4))
    ozone = 3.78547397e20 * np.exp(-((log_h - 3.22261) ** 2) * 5.55555555 - log_h) * DOBSON * air.ozone
    molecules = MOLECULES * np.exp(-0.07771971 * h**1.16364243) * air.molecules
    scattering = AEROSOL_SCATTERING * aerosols
    return _Coefficients(
        molecules, scattering, molecules + scattering + AEROSOL_ABSORPTION * aerosols + OZONE_SECTIONS * ozone
    )


def _transmittance(cosine, height, air):
    """From a height in km out of the atmosphere, through the Earth if need be, (..., 4)."""
    start = GLOBE + height
    step = _chord(start, cosine, GLOBE + THICKNESS) / MANY_STEPS
    depth = np.zeros((*np.shape(step), 4))
    for i in range(MANY_STEPS):
        t = (i + 0.5) * step
        depth += _coefficients(np.sqrt(start**2 + t * (t + 2.0 * start * cosine)) - GLOBE, air).extinction
    return np.exp(-depth * step[..., None])


class _Lookup:
    """Transmittance to the sun, by interpolation."""

    def __init__(self, air):
        rows, columns = LOOKUP_SHAPE
        height = np.linspace(0.0, THICKNESS, rows)[:, None]
        self.table = _transmittance(np.linspace(-1.0, 1.0, columns)[None], height, air)

    def at(self, cosine, height):
        rows, columns = LOOKUP_SHAPE
        x = np.clip(cosine * 0.5 + 0.5, 0.0, 1.0) * (columns - 1)
        y = np.broadcast_to(np.clip(height / THICKNESS, 0.0, 1.0) * (rows - 1), x.shape)
        x0, y0 = np.minimum(x.astype(np.int64), columns - 2), np.minimum(y.astype(np.int64), rows - 2)
        fx, fy = (x - x0)[..., None], (y - y0)[..., None]
        table = self.table
        below = table[y0, x0] * (1.0 - fx) + table[y0, x0 + 1] * fx
        return below * (1.0 - fy) + (table[y0 + 1, x0] * (1.0 - fx) + table[y0 + 1, x0 + 1] * fx) * fy


def _again(lookup, cosine, height):
    """What has been scattered before, by the ground or by air elsewhere, and arrives at a height, (..., 4)."""
    omega = 2.0 * np.pi * (1.0 - np.sqrt(1.0 - (GLOBE / (GLOBE + height)) ** 2))[..., None]
    one = np.ones(np.shape(height))
    from_ground = lookup.table[0, -1] / lookup.at(one, height)
    ground = lookup.at(cosine, np.zeros(())) * cosine[..., None]
    ground = ground * (GROUND_ALBEDO / (4.0 * np.pi**2)) * omega * from_ground
    return ground + FARTHER / (1.0 + 5.0 * np.exp(-17.92 * cosine))[..., None]


def _many(elevation, azimuth, sun, air):
    """As `_once`."""
    lookup = _Lookup(air)
    start = GLOBE + air.altitude / 1000.0
    up, flat = np.sin(elevation)[:, None], np.cos(elevation)[:, None]
    across = np.cos(azimuth)[None]
    cosine = up * math.sin(sun) + flat * across * math.cos(sun)
    phases = (3.0 / (16.0 * np.pi) * (1.0 + cosine**2))[..., None], _henyey_greenstein(cosine)[..., None]
    below = (start * up) ** 2 - start**2 + GLOBE**2
    hits = (up < 0.0) & (below >= 0.0)
    length = np.where(hits, -start * up - np.sqrt(np.maximum(below, 0.0)), _chord(start, up, GLOBE + THICKNESS))
    step = length / MANY_STEPS
    result, clear = np.zeros((len(elevation), len(azimuth), 4)), np.ones((len(elevation), 1, 4))
    for i in range(MANY_STEPS):
        t = (i + 0.5) * step
        from_centre = np.sqrt(start**2 + t * (t + 2.0 * start * up))
        height = np.maximum(from_centre - GLOBE, 0.0)
        c = _coefficients(height, air)
        to_sun = (t * flat * across * math.cos(sun) + (start + t * up) * math.sin(sun)) / from_centre
        arrives, again = lookup.at(to_sun, height), _again(lookup, to_sun, height)
        source = c.molecules * (phases[0] * arrives + again) + c.aerosols * (phases[1] * arrives + again)
        passes = np.exp(-step[..., None] * c.extinction)
        result += source * (clear * (1.0 - passes) / np.maximum(c.extinction, 1e-7))
        clear = clear * passes
    return result @ (SUN[:, None] * FOUR_TO_RGB)


def _henyey_greenstein(cosine):
    return (1.0 - G**2) / (4.0 * np.pi) / (1.0 + G**2 - 2.0 * G * cosine) ** 1.5


def _disk_many(sun, size, air):
    height = np.float64(air.altitude / 1000.0)
    ends = [_transmittance(np.sin(sun + side * size / 2.0), height, air) for side in (-1.0, 1.0)]
    return Disk(*(end @ (SUN[:, None] * FOUR_TO_RGB) / _solid_angle(size) for end in ends))


# ---- Tables ----------------------------------------------------------------------------------------------------------


def clamped(air, multiple):
    """As high as a model reaches."""
    return air._replace(altitude=min(max(air.altitude, 1.0), 99999.0 if multiple else 59999.0))


@lru_cache(8)
def table(sun, air, multiple):
    """Radiance of the sky, float32 (HEIGHT, WIDTH, 4), by elevation and by the angle to the sun from -pi on.

    `sun`: its elevation, -pi / 2 to pi / 2; `multiple`: light may be scattered more than once.
    """
    air = clamped(air, multiple)
    if multiple:
        place = (np.arange(HEIGHT) + 0.5) / HEIGHT * 2.0 - 1.0
        azimuth = (np.arange(WIDTH // 2) + 0.5) / WIDTH * 2.0 * np.pi + np.pi
        half = _many(np.sign(place) * place**2 * (np.pi / 2.0), azimuth, sun, air)
    else:
        place = np.arange(HEIGHT) / (HEIGHT / 2) - 1.0
        elevation = place[HEIGHT // 2 :] ** 2 * (np.pi / 2.0)
        upper = _once(elevation, np.arange(WIDTH // 2) / WIDTH * 2.0 * np.pi - np.pi, sun, air)
        below = np.sin(place[: HEIGHT // 2] ** 2 * (np.pi / 2.0))  # where Blender lets the horizon fade to black
        half = np.concatenate([np.maximum(1.0 - 2.5 * below, 0.0)[:, None, None] ** 3 * upper[:1], upper])
    return _mirrored(half)


@lru_cache(8)
def old_table(sun, air):
    """The same for Blender 4: (OLD_HEIGHT, WIDTH, 4), the upper half of the sky, scattered once."""
    row = np.arange(OLD_HEIGHT) / OLD_HEIGHT
    elevation = (np.pi / 2.0 + np.pi / 4.0 / OLD_HEIGHT) * row**2
    return _mirrored(_once(elevation, np.arange(WIDTH // 2) / WIDTH * 2.0 * np.pi - np.pi, sun, air))


def _mirrored(half):
    both = np.concatenate([half, half[:, ::-1]], axis=1).astype(np.float32)
    return np.concatenate([both, np.ones((*both.shape[:2], 1), np.float32)], axis=-1)


def disk(sun, size, air, multiple):
    """The Disk of a sun of full angle `size`."""
    return (_disk_many if multiple else _disk_once)(sun, size, clamped(air, multiple))


def horizon(altitude):
    """Elevation of the edge of the Earth, seen from so many metres above it."""
    return math.asin(GLOBE / (GLOBE + altitude / 1000.0)) - math.pi / 2.0
