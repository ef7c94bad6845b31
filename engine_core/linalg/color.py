# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours: other coordinates for them, and the adjustments of Blender's colour nodes.

A colour is a Vec3, linear and scene-referred; it may exceed 1. HSV and HSL are hue, saturation and value or lightness;
hue is 0 to 1, red at both ends.
"""

import math
from enum import IntEnum

import numpy as np

from ..jit import kernel
from .vec3 import BLACK, WHITE, Vec3, dot, lerp

SIXTH = np.float32(1.0 / 6.0)


class ColorModel(IntEnum):
    """What the channels of Separate and Combine Color are; names and numbers are Blender's."""

    RGB = 0
    HSV = 1
    HSL = 2


@kernel
def separate(model, color):
    """The channels of an RGB colour in another model."""
    if model == ColorModel.HSV:
        return rgb_to_hsv(color)
    if model == ColorModel.HSL:
        return rgb_to_hsl(color)
    return color


@kernel
def combine(model, channels):
    """The RGB colour with these channels."""
    if model == ColorModel.HSV:
        return hsv_to_rgb(channels)
    if model == ColorModel.HSL:
        return hsl_to_rgb(channels)
    return channels


@kernel
def _hue(rgb, top, range_):
    """0 to 1 around the hexagon of colours (Smith 1978); `range_`, the greatest channel less the least, is not 0."""
    if rgb.x == top:
        h = (rgb.y - rgb.z) / range_
    elif rgb.y == top:
        h = 2.0 + (rgb.z - rgb.x) / range_
    else:
        h = 4.0 + (rgb.x - rgb.y) / range_
    return h * SIXTH + 1.0 if h < 0.0 else h * SIXTH


@kernel
def rgb_to_hsv(rgb):
    top = max(rgb.x, max(rgb.y, rgb.z))
    range_ = top - min(rgb.x, min(rgb.y, rgb.z))
    if range_ == 0.0 or top == 0.0:
        return Vec3(0.0, 0.0, top)
    return Vec3(_hue(rgb, top, range_), range_ / top, top)


@kernel
def rgb_to_hsl(rgb):
    top = max(rgb.x, max(rgb.y, rgb.z))
    bottom = min(rgb.x, min(rgb.y, rgb.z))
    lightness = min(1.0, 0.5 * (top + bottom))
    range_ = top - bottom
    if range_ == 0.0:
        return Vec3(0.0, 0.0, lightness)
    saturation = range_ / (2.0 - top - bottom) if lightness > 0.5 else range_ / (top + bottom)
    return Vec3(_hue(rgb, top, range_), saturation, lightness)


@kernel
def hsv_to_rgb(hsv):
    """Hues beyond 0 to 1 are taken for that of the last sextant, as Cycles does."""
    if hsv.y == 0.0:
        return Vec3(hsv.z, hsv.z, hsv.z)
    h = 6.0 * hsv.x if hsv.x != 1.0 else np.float32(0.0)
    sextant = np.floor(h)
    f = h - sextant
    v = hsv.z
    p, q, t = v * (1.0 - hsv.y), v * (1.0 - hsv.y * f), v * (1.0 - hsv.y * (1.0 - f))
    if sextant == 0.0:
        return Vec3(v, t, p)
    if sextant == 1.0:
        return Vec3(q, v, p)
    if sextant == 2.0:
        return Vec3(p, v, t)
    if sextant == 3.0:
        return Vec3(p, q, v)
    if sextant == 4.0:
        return Vec3(t, p, v)
    return Vec3(v, p, q)


@kernel
def hsl_to_rgb(hsl):
    h = 6.0 * hsl.x
    chroma = (1.0 - abs(2.0 * hsl.z - 1.0)) * hsl.y
    pure = saturate(Vec3(abs(h - 3.0) - 1.0, 2.0 - abs(h - 2.0), 2.0 - abs(h - 4.0)))
    return Vec3((pure.x - 0.5) * chroma + hsl.z, (pure.y - 0.5) * chroma + hsl.z, (pure.z - 0.5) * chroma + hsl.z)


@kernel
def saturate(c):
    """Each channel held in 0 to 1."""
    return Vec3(min(max(c.x, 0.0), 1.0), min(max(c.y, 0.0), 1.0), min(max(c.z, 0.0), 1.0))


@kernel
def not_negative(c):
    return Vec3(max(c.x, 0.0), max(c.y, 0.0), max(c.z, 0.0))


# ---- Adjustments -----------------------------------------------------------------------------------------------------


@kernel
def hue_saturation(color, hue, saturation, value, fac):
    """Hue/Saturation/Value: the hue turned by `hue` - 1/2, the others scaled; mixed in by `fac`, and not negative."""
    hsv = rgb_to_hsv(color)
    turned = hsv.x + hue + 0.5
    changed = hsv_to_rgb(Vec3(turned - np.floor(turned), min(max(hsv.y * saturation, 0.0), 1.0), hsv.z * value))
    return not_negative(lerp(color, changed, fac))


@kernel
def bright_contrast(color, bright, contrast):
    """Brightness added, and the distance from 1/2 scaled by 1 + contrast; not negative."""
    a, b = 1.0 + contrast, bright - 0.5 * contrast
    return not_negative(Vec3(a * color.x + b, a * color.y + b, a * color.z + b))


@kernel
def gamma(color, exponent):
    """Each positive channel to a power."""
    if exponent == 0.0:
        return WHITE
    return Vec3(_gamma(color.x, exponent), _gamma(color.y, exponent), _gamma(color.z, exponent))


@kernel
def _gamma(x, exponent):
    return math.pow(x, exponent) if x > 0.0 else x


@kernel
def invert(color, fac):
    """1 - color, mixed in by `fac`."""
    return lerp(color, WHITE - color, fac)


# ---- Spectra ---------------------------------------------------------------------------------------------------------

# Temperatures in kelvins at which one fit of the next table takes over from the one before.
BLACKBODY_FROM = np.array([965.0, 1167.0, 1449.0, 1902.0, 3315.0, 6365.0], np.float32)
# The colour of a glowing body at T kelvins in linear Rec.709, scaled to luminance 1: red and green are a / T + b T + c,
# blue is ((a T + b) T + c) T + d. The coefficients are those that define Blender's node (Cycles, kernel/tables.h).
BLACKBODY_RED = np.array(
    [
        (1.61919106e3, -2.05010916e-3, 5.02995757),
        (2.48845471e3, -1.11330907e-3, 3.22621544),
        (3.34143193e3, -4.86551192e-4, 1.76486769),
        (4.09461742e3, -1.27446582e-4, 7.25731635e-1),
        (4.67028036e3, 2.91258199e-5, 1.26703442e-1),
        (4.59509185e3, 2.87495649e-5, 1.50345020e-1),
        (3.78717450e3, 9.35907826e-6, 3.99075871e-1),
    ],
    np.float32,
)
BLACKBODY_GREEN = np.array(
    [
        (-4.88999748e2, 6.04330754e-4, -7.55807526e-2),
        (-7.55994277e2, 3.16730098e-4, 4.78306139e-1),
        (-1.02363977e3, 1.20223470e-4, 9.36662319e-1),
        (-1.26571316e3, 4.87340896e-6, 1.27054498),
        (-1.42529332e3, -4.01150431e-5, 1.43972784),
        (-1.17554822e3, -2.16378048e-5, 1.30408023),
        (-5.00799571e2, -4.59832026e-6, 1.09098763),
    ],
    np.float32,
)
BLACKBODY_BLUE = np.array(
    [
        (5.96945309e-11, -4.85742887e-8, -9.70622247e-5, -4.07936148e-3),
        (2.40430366e-11, 5.55021075e-8, -1.98503712e-4, 2.89312858e-2),
        (-1.40949732e-11, 1.89878968e-7, -3.56632824e-4, 9.10767778e-2),
        (-3.61460868e-11, 2.84822009e-7, -4.93211319e-4, 1.56723440e-1),
        (-1.97075738e-11, 1.75359352e-7, -2.50542825e-4, -2.22783266e-2),
        (-1.61997957e-13, -1.64216008e-8, 3.86216271e-4, -7.38077418e-1),
        (6.72650283e-13, -2.73078809e-8, 4.24098264e-4, -7.52335691e-1),
    ],
    np.float32,
)
BLACKBODY_COLDEST = Vec3(5.413294490189271, -0.20319390035873933, -0.0822535242887164)  # below 800 K
BLACKBODY_HOTTEST = Vec3(0.8262954810464208, 0.9945080501520986, 1.566307710274283)  # from 12,000 K on


@kernel
def blackbody(kelvins):
    """The colour of a glowing body, linear Rec.709, of luminance 1; may be negative, where it lies outside of that."""
    if kelvins >= 12000.0:
        return BLACKBODY_HOTTEST
    if kelvins < 800.0:
        return BLACKBODY_COLDEST
    i = 0
    while i < 6 and kelvins >= BLACKBODY_FROM[i]:
        i += 1
    r, g, b = BLACKBODY_RED, BLACKBODY_GREEN, BLACKBODY_BLUE
    return Vec3(
        r[i, 0] / kelvins + r[i, 1] * kelvins + r[i, 2],
        g[i, 0] / kelvins + g[i, 1] * kelvins + g[i, 2],
        ((b[i, 0] * kelvins + b[i, 1]) * kelvins + b[i, 2]) * kelvins + b[i, 3],
    )


# Colour matching functions x, y, z of the standard observer (CIE 1931, 2 degrees), at 380, 385 ... 780 nm.
CIE_1931 = np.array(
    [
        row.split()
        for row in (
            (
                "14 22 42 76 143 232 435 776 1344 2148 2839 3285 3483 3481 3362 3187 2908 2511 1954 1421 956 580 "
                "320 147 49 24 93 291 633 1096 1655 2257 2904 3597 4334 5121 5945 6784 7621 8425 9163 9786 10263 "
                "10567 10622 10456 10026 9384 8544 7514 6424 5419 4479 3608 2835 2187 1649 1212 874 636 468 329 227 "
                "158 114 81 58 41 29 20 14 10 7 5 3 2 2 1 1 1 0 "
            ),
            (
                "0 1 1 2 4 6 12 22 40 73 116 168 230 298 380 480 600 739 910 1126 1390 1693 2080 2586 3230 4073 "
                "5030 6082 7100 7932 8620 9149 9540 9803 9950 10000 9950 9786 9520 9154 8700 8163 7570 6949 6310 "
                "5668 5030 4412 3810 3210 2650 2170 1750 1382 1070 816 610 446 320 232 170 119 82 57 41 29 21 15 10 "
                "7 5 4 2 2 1 1 1 0 0 0 0 "
            ),
            (
                "65 105 201 362 679 1102 2074 3713 6456 10391 13856 16230 17471 17826 17721 17441 16692 15281 12876 "
                "10419 8130 6162 4652 3533 2720 2123 1582 1117 782 573 422 298 203 134 87 57 39 27 21 18 17 14 11 "
                "10 8 6 3 2 2 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 "
            ),
        )
    ],
    np.float32,
) * np.float32(1e-4)
# Linear Rec.709 of CIE XYZ, white is D65 at x 0.3127, y 0.3290 (ITU-R BT.709).
XYZ_TO_RED = Vec3(3.2409699, -1.5373832, -0.4986108)
XYZ_TO_GREEN = Vec3(-0.9692436, 1.8759675, 0.0415551)
XYZ_TO_BLUE = Vec3(0.0556301, -0.2039770, 1.0569715)


@kernel
def xyz_to_rgb(xyz):
    """Linear Rec.709; negative where a colour lies outside of that."""
    return Vec3(dot(XYZ_TO_RED, xyz), dot(XYZ_TO_GREEN, xyz), dot(XYZ_TO_BLUE, xyz))


@kernel
def wavelength_xyz(nanometres):
    """CIE XYZ of monochromatic light; black outside of 380 to 780 nm."""
    at = (nanometres - 380.0) * 0.2
    if not 0.0 <= at < 80.0:
        return BLACK
    i = int(at)
    c = CIE_1931
    return lerp(Vec3(c[0, i], c[1, i], c[2, i]), Vec3(c[0, i + 1], c[1, i + 1], c[2, i + 1]), at - np.floor(at))


@kernel
def wavelength(nanometres):
    """The Wavelength node: linear Rec.709, not negative, scaled so that no channel exceeds 1."""
    xyz = wavelength_xyz(nanometres) * np.float32(1.0 / 2.52)
    return not_negative(xyz_to_rgb(xyz))
