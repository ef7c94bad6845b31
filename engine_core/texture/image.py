# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels looked up at a point of the unit square, (0, 0) the lower left corner: a row of IMAGE.

Numbers are interpolated as they are kept; the curve of sRGB is undone after that, as in Cycles.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import inlined_kernel, kernel
from ..linalg.registers import bits_to_float
from ..linalg.simd import lane, lanes_of, lanes_of_bytes, splat4, vector_of
from ..linalg.simd_int import choose, square_roots
from ..linalg.vec3 import BLACK, Vec3
from ..program_tables import TexelFormat
from ..sampling.warp import angle_of

ZERO, ONE = np.float32(0.0), np.float32(1.0)
PER_BYTE = np.float32(1.0 / 255.0)
HALF_EXPONENT = np.float32(2.0**112)  # the biases of half and single differ by 112
LINEAR_BELOW, PER_LINEAR, OFFSET = np.float32(0.04045), np.float32(1.0 / 12.92), np.float32(0.055)  # sRGB's curve
# The 0.4th power of what sRGB's curve leaves to it, by powers of the root.
POWERS = np.array((0.03118231, 1.3884646, -1.040958, 1.3214367, -1.1546503, 0.57965744, -0.125135), np.float32)
LINEAR, CLOSEST, CUBIC = 0, 1, 2  # interpolation
REPEAT, EXTEND, CLIP, MIRROR = 0, 1, 2, 3  # what is beyond the unit square


class Rgba(NamedTuple):
    color: Vec3
    alpha: float


NOTHING = Rgba(BLACK, ZERO)


# ---- Single pixels ---------------------------------------------------------------------------------------------------


@kernel
def byte(scene, image, at):
    """Byte number `at` of the image, 0 to 1."""
    word = scene.texels[image.first + (at >> 2)].word
    return np.float32((word >> np.uint32(8 * (at & 3))) & np.uint32(255)) * PER_BYTE


@kernel
def half(scene, image, at):
    """Half float number `at` of the image. Moved into the place of a float32's bits; the exponent's bias is made good
    by a product, which is right for denormal numbers, too."""
    word = scene.texels[image.first + (at >> 1)].word
    bits = (word >> np.uint32(16 * (at & 1))) & np.uint32(0xFFFF)
    magnitude = bits_to_float(np.uint32((bits & np.uint32(0x7FFF)) << np.uint32(13))) * HALF_EXPONENT
    return -magnitude if bits & np.uint32(0x8000) else magnitude


@kernel
def single(scene, image, at):
    return bits_to_float(scene.texels[image.first + at].word)


@kernel
def component(scene, image, at):
    if image.format <= TexelFormat.SRGB:
        return byte(scene, image, at)
    if image.format == TexelFormat.HALF:
        return half(scene, image, at)
    return single(scene, image, at)


@kernel
def texel(scene, image, x, y):
    """The pixel at column x and row y, which have to be in range; black and clear at -1."""
    if x < 0 or y < 0:
        return NOTHING
    at = np.int64(y) * image.width + x
    if image.channels == 1:
        grey = component(scene, image, at)
        return Rgba(Vec3(grey, grey, grey), ONE)
    if image.format <= TexelFormat.SRGB:
        word = scene.texels[image.first + at].word
        red = np.float32(word & np.uint32(255)) * PER_BYTE
        green = np.float32((word >> np.uint32(8)) & np.uint32(255)) * PER_BYTE
        blue = np.float32((word >> np.uint32(16)) & np.uint32(255)) * PER_BYTE
        return Rgba(Vec3(red, green, blue), np.float32(word >> np.uint32(24)) * PER_BYTE)
    at *= 4
    red, green = component(scene, image, at), component(scene, image, at + 1)
    return Rgba(Vec3(red, green, component(scene, image, at + 2)), component(scene, image, at + 3))


@kernel
def inside(i, size, extension):
    """Column or row `i` brought into the image; -1: there is none."""
    if 0 <= i < size:
        return i
    if extension == REPEAT:
        i %= size
        return i + size if i < 0 else i
    if extension == EXTEND:
        return min(max(i, 0), size - 1)
    if extension == CLIP:
        return -1
    i %= 2 * size
    i = i + 2 * size if i < 0 else i
    return i if i < size else 2 * size - 1 - i


# ---- Lookup ----------------------------------------------------------------------------------------------------------


@kernel
def lookup(scene, image, u, v, interpolation, extension):
    """Rgba at (u, v), in the image's own encoding."""
    x, y = u * np.float32(image.width), v * np.float32(image.height)
    if not (abs(x) < 1e9 and abs(y) < 1e9):
        return NOTHING
    if interpolation == CLOSEST:
        column, row = np.int64(np.floor(x)), np.int64(np.floor(y))
        return texel(scene, image, inside(column, image.width, extension), inside(row, image.height, extension))
    x, y = x - 0.5, y - 0.5
    column, row = np.int64(np.floor(x)), np.int64(np.floor(y))
    fx, fy = x - np.floor(x), y - np.floor(y)
    if interpolation == LINEAR and image.format <= TexelFormat.SRGB and image.channels == 4:
        if 0 <= column < image.width - 1 and 0 <= row < image.height - 1:
            return between_four(scene, image, column, column + 1, row, row + 1, fx, fy)
        left, right = inside(column, image.width, extension), inside(column + 1, image.width, extension)
        low, high = inside(row, image.height, extension), inside(row + 1, image.height, extension)
        if min(left, right, low, high) >= 0:
            return between_four(scene, image, left, right, low, high, fx, fy)
    reach = 4 if interpolation == CUBIC else 2
    first = 1 if interpolation == CUBIC else 0
    color, alpha = BLACK, ZERO
    for j in range(reach):
        weight_y = weight(j, fy, interpolation)
        at_y = inside(row + j - first, image.height, extension)
        for i in range(reach):
            share = weight_y * weight(i, fx, interpolation)
            pixel = texel(scene, image, inside(column + i - first, image.width, extension), at_y)
            color = color + pixel.color * share
            alpha += pixel.alpha * share
    return Rgba(color, alpha)


@inlined_kernel
def between_four(scene, image, left, right, low, high, fx, fy):
    """Rgba of an image of four bytes a pixel, between two columns and two rows, in lanes: most pictures are such."""
    width, first = np.int64(image.width), image.first
    below, above = first + low * width, first + high * width
    share_x, share_y = splat4(fx), splat4(fy)
    start, end = lanes_of_bytes(scene.texels[below + left].word), lanes_of_bytes(scene.texels[below + right].word)
    lower = start + (end - start) * share_x
    start, end = lanes_of_bytes(scene.texels[above + left].word), lanes_of_bytes(scene.texels[above + right].word)
    upper = start + (end - start) * share_x
    rgba = (lower + (upper - lower) * share_y) * splat4(PER_BYTE)
    return Rgba(vector_of(rgba), lane(rgba, np.int32(3)))


@kernel
def tile_at(image, u, v):
    """Column and row of the tile at (u, v); -1: there is none. What is less than a tile below 0 belongs to the first,
    as in Cycles."""
    if not (-1.0 < u < np.float32(image.width) and -1.0 < v < np.float32(image.height)):
        return -1, -1
    return int(u), int(v)


@kernel
def weight(i, t, interpolation):
    """Of neighbour `i` at a place `t` between two pixels: a line, or a cubic B-spline."""
    if interpolation == LINEAR:
        return t if i == 1 else 1.0 - t
    sixth = np.float32(1.0 / 6.0)
    if i == 0:
        return ((-sixth * t + 0.5) * t - 0.5) * t + sixth
    if i == 1:
        return ((0.5 * t - 1.0) * t) * t + 4.0 * sixth
    if i == 2:
        return ((-0.5 * t + 0.5) * t + 0.5) * t + sixth
    return sixth * t * t * t


@kernel
def decoded(image, rgba, unassociate):
    """From the image's encoding to linear colours; `unassociate`: divided by alpha before."""
    color = rgba.color
    if unassociate and rgba.alpha != 0.0 and rgba.alpha != 1.0:
        color = color * (1.0 / rgba.alpha)
    if image.format == TexelFormat.SRGB and not (unassociate and rgba.alpha < 1.0):
        color = vector_of(bytes_to_linear(lanes_of(color, ZERO)))
    elif image.format == TexelFormat.SRGB or image.format == TexelFormat.SRGB_FLOAT:
        color = Vec3(srgb_to_linear(color.x), srgb_to_linear(color.y), srgb_to_linear(color.z))
    return Rgba(color, rgba.alpha)


@inlined_kernel
def bytes_to_linear(x):
    """IEC 61966-2-1 of numbers in 0 to 1, in lanes: ((x + 0.055) / 1.055) ** 2.4 by a polynomial in the root.

    Its relative error is 3e-6 at most, found by least squares, weighted anew until all maxima were alike.
    """
    y = (x + splat4(OFFSET)) * splat4(ONE / (ONE + OFFSET))
    root = square_roots(y)
    low = splat4(POWERS[0]) + splat4(POWERS[1]) * root + (splat4(POWERS[2]) + splat4(POWERS[3]) * root) * y
    high = splat4(POWERS[4]) + splat4(POWERS[5]) * root + splat4(POWERS[6]) * y
    power = low + high * (y * y)  # y ** 0.4; in halves, which need not wait for each other
    return choose(x < splat4(LINEAR_BELOW), x * splat4(PER_LINEAR), y * y * power)


@kernel
def srgb_to_linear(x):
    """IEC 61966-2-1."""
    if x < LINEAR_BELOW:
        return x * PER_LINEAR if x > 0.0 else ZERO
    return ((x + OFFSET) * (ONE / (ONE + OFFSET))) ** np.float32(2.4)


# ---- From points and directions to the square ------------------------------------------------------------------------

INV_PI = np.float32(1.0 / math.pi)
INV_TWO_PI = np.float32(0.5 / math.pi)


@kernel
def sphere_to_square(p):
    """(u, v) of a direction from the middle of a ball, as Blender's Sphere projection has it."""
    size = math.sqrt(p.x * p.x + p.y * p.y + p.z * p.z)
    if size == 0.0:
        return ZERO, ZERO
    u = ZERO if p.x == 0.0 and p.y == 0.0 else (1.0 - math.atan2(p.x, p.y) * INV_PI) * 0.5
    return u, 1.0 - math.acos(min(max(p.z / size, -1.0), 1.0)) * INV_PI


@kernel
def tube_to_square(p):
    if p.x == 0.0 and p.y == 0.0:
        return ZERO, ZERO
    return (1.0 - math.atan2(p.x, p.y) * INV_PI) * 0.5, (p.z + 1.0) * 0.5


@kernel
def equirectangular(w):
    """(u, v) of a unit direction on a map of the sky: -y in the middle, z up."""
    u = 0.5 - angle_of(w.y, w.x) * INV_TWO_PI
    return u, angle_of(w.z, math.sqrt(w.x * w.x + w.y * w.y)) * INV_PI + 0.5


@kernel
def mirror_ball(w):
    """(u, v) of a unit direction in the picture of a mirror ball seen along y."""
    y = w.y - 1.0
    divisor = 2.0 * math.sqrt(max(-0.5 * y, 0.0))
    scale = 1.0 / divisor if divisor > 0.0 else ONE
    return 0.5 * (w.x * scale + 1.0), 0.5 * (w.z * scale + 1.0)
