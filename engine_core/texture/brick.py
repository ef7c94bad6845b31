# SPDX-License-Identifier: GPL-3.0-or-later
"""The Brick texture: a wall in the plane z = 0."""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.scalar_math import clamp, smoothstep
from ..linalg.vec3 import Vec3, lerp

MASK_31 = np.uint32(0x7FFFFFFF)
TO_UNIT_FLOAT = np.float32(2.0**-31)


class BrickSample(NamedTuple):
    color: Vec3
    mortar: np.float32  # the node's factor: 0 in a brick, 1 between


@kernel
def brick(
    p,
    color_1,
    color_2,
    mortar_color,
    mortar_size,
    mortar_smooth,
    bias,
    width,
    height,
    offset,
    every,
    squash,
    squash_every,
):
    """At a point that is scaled already.

    Each row `every` is moved by `offset` of a width; in each row `squash_every` bricks are `squash` times as wide.
    A brick has a colour between the two at random, towards the second with `bias` above 0. `mortar_smooth`, 0 to 1, is
    the share of the mortar that blends into the brick.
    """
    row = int(np.floor(p.y / height))
    shift = np.float32(0.0)
    if every != 0 and squash_every != 0:
        width *= squash if row % squash_every == 0 else np.float32(1.0)
        shift = width * offset if row % every == 0 else np.float32(0.0)
    number = int(np.floor((p.x + shift) / width))
    x = p.x + shift - width * np.float32(number)
    y = p.y - height * np.float32(row)
    mortar = _mortar(min(min(x, y), min(width - x, height - y)), mortar_size, mortar_smooth)
    tint = clamp(_random(np.uint32((row << 16) + (number & 0xFFFF))) + bias, 0.0, 1.0)
    return BrickSample(lerp(lerp(color_1, color_2, tint), mortar_color, mortar), mortar)


@kernel
def _mortar(distance, size, smooth):
    """How much mortar there is, at a distance from the edge of a brick."""
    if distance >= size:
        return np.float32(0.0)
    return smoothstep((1.0 - distance / size) / smooth) if smooth != 0.0 else np.float32(1.0)


@kernel
def _random(n):
    """A number in 0 to 1 for each brick: the integer noise that Blender has had since its first days."""
    n = np.uint32(np.uint32(n + 1013) & MASK_31)
    n = np.uint32((n >> 13) ^ n)
    square = np.uint32(np.uint32(n * n) * np.uint32(60493))
    bits = np.uint32(np.uint32(n * np.uint32(square + 19990303)) + 1376312589)
    return np.float32(np.uint32(bits & MASK_31)) * TO_UNIT_FLOAT
