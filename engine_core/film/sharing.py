# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples that count for every pixel whose filter reaches them: half the error, or less, of what the same samples leave
when each counts for one pixel alone (see `filter`).

A pixel's filter f reaches over the pixels around it. The pixel's value is the sum over these of the integral of f L
over each, and such a part is the mean of f L over that pixel's own samples, however many they are: so it does not
matter that adaptive sampling gives some pixels more. It is divided by the same sum of f alone, as a flat picture has to
be flat. What noise is left is as smooth as the filter, where denoisers want that of each pixel to be its own.

Each pixel keeps apart what it gives to each of the nine, and `develop` adds up what a pixel was given. So no thread
writes where another does, and numbers are added in the same order on any number of threads. Pixels at the border stand
for those beyond it as well: they place their samples there, too.
"""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.simd import lanes4, load4, splat4, store4, xyz
from ..linalg.vec3 import BLACK, load3
from ..settings import FilterKind
from .filter import CELLS, GAUSSIAN_REACH, REACH, blackman_harris, gaussian

NEIGHBOURS = 9  # a pixel and those around it: number 3 (y + 1) + x + 1 is the one at (x, y) from it
FARTHEST = 1.5  # pixels, that a filter may reach
LEAST_REACH = 1.25  # of a narrower one nothing would be gained: samples would lie where no filter has much weight
CUT_OFF = 2.0 / 3.0  # of the reach of a Gaussian: what lies beyond is 10^-4 of it
SMALLEST = 4  # pixels: of smaller films the border is too large a part
WEIGHTS_BLACKMAN_HARRIS, WEIGHTS_GAUSSIAN = (
    np.append(shape(np.linspace(0.0, 1.0, CELLS + 1)), 0.0).astype(np.float32) for shape in (blackman_harris, gaussian)
)
ZERO = np.float32(0.0)


class Area(NamedTuple):
    """Where a pixel places its samples, in pixels from its lower left corner."""

    x: float
    y: float
    width: float
    height: float


def can_share(settings):
    """Whether samples of these settings may count for several pixels: by the filter, and by the size of the film."""
    reach = REACH[settings.filter_kind] * settings.filter_width
    if settings.filter_kind == FilterKind.GAUSSIAN:
        reach *= CUT_OFF
    large_enough = min(settings.crop_width, settings.crop_height) >= SMALLEST
    return large_enough and settings.filter_kind != FilterKind.BOX and LEAST_REACH <= reach <= FARTHEST + 1e-6


@kernel
def area_of(settings, x, y):
    """The Area of the film's pixel (x, y): itself, and at the border what lies beyond."""
    left, low = np.float32(x == 0), np.float32(y == 0)
    right, high = np.float32(x == settings.crop_width - 1), np.float32(y == settings.crop_height - 1)
    return Area(-left, -low, 1.0 + left + right, 1.0 + low + high)


@kernel
def give(film, settings, number, area, dx, dy, L, alpha):
    """Add a sample of pixel `number` to what it gives. `dx`, `dy`: where it lies, from the pixel's centre."""
    reach = np.float32(settings.filter_width)
    if settings.filter_kind == FilterKind.GAUSSIAN:
        reach = reach * GAUSSIAN_REACH
    scale = np.float32(CELLS) / reach
    size, first = area.width * area.height, number * NEIGHBOURS
    opaque = splat4(alpha)
    light = lanes4(L.x, L.y, L.z) + (opaque - xyz(opaque))
    left, middle, right = (
        weight(settings, abs(dx + 1.0) * scale),
        weight(settings, abs(dx) * scale),
        weight(settings, abs(dx - 1.0) * scale),
    )
    for row in range(3):
        w = size * weight(settings, abs(dy - np.float32(row - 1)) * scale)
        add(film.shares[first + 3 * row], light, w * left)
        add(film.shares[first + 3 * row + 1], light, w * middle)
        add(film.shares[first + 3 * row + 2], light, w * right)


@kernel
def add(share, light, w):
    """Add `light`, an f32x4 of radiance and alpha, to a row of SHARE with weight `w`."""
    store4(share, "radiance", 0, load4(share, "radiance", 0) + light * splat4(w))  # and alpha, which is next to it
    share.weight += w


@kernel
def weight(settings, distance):
    """The filter along one axis; `distance` from its centre in units of its reach / CELLS."""
    cell = min(np.int32(distance), np.int32(CELLS))
    rest = min(distance - np.float32(cell), np.float32(1.0))
    if settings.filter_kind == FilterKind.GAUSSIAN:
        return WEIGHTS_GAUSSIAN[cell] + rest * (WEIGHTS_GAUSSIAN[cell + 1] - WEIGHTS_GAUSSIAN[cell])
    low = WEIGHTS_BLACKMAN_HARRIS[cell]
    return low + rest * (WEIGHTS_BLACKMAN_HARRIS[cell + 1] - low)


@kernel
def develop(film, width, height, x0, y0, picture):
    """Write the part of a film of `width` x `height` pixels that begins at (x0, y0) into `picture`, float32 (h, w, 4).

    Colours are premultiplied by alpha. Pixels that have no samples give nothing, and get nothing if all are such.
    """
    for row in range(picture.shape[0]):
        for column in range(picture.shape[1]):
            L, alpha, weights = BLACK, ZERO, ZERO
            for k in range(NEIGHBOURS):
                x, y = x0 + column + k % 3 - 1, y0 + row + k // 3 - 1
                if x < 0 or y < 0 or x >= width or y >= height:
                    continue
                number = y * width + x
                samples = film.pixels[number].samples
                if samples == 0:
                    continue
                scale = 1.0 / np.float32(samples)
                share = film.shares[number * NEIGHBOURS + NEIGHBOURS - 1 - k]  # it sees me where I do not see it
                L = L + load3(share, "radiance") * scale
                alpha += share.alpha * scale
                weights += share.weight * scale
            if weights == 0.0:
                picture[row, column, :] = ZERO
                continue
            scale = 1.0 / weights
            L = L * scale
            picture[row, column, 0], picture[row, column, 1], picture[row, column, 2] = L.x, L.y, L.z
            picture[row, column, 3] = alpha * scale if alpha < weights else np.float32(1.0)
