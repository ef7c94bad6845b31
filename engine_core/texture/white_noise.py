# SPDX-License-Identifier: GPL-3.0-or-later
"""The White Noise texture: a random number for each point, that has nothing to do with its neighbours'."""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import Vec3
from .hash import random_color


class WhiteNoiseSample(NamedTuple):
    value: np.float32
    color: Vec3  # red is `value`


@kernel
def white_noise(p, w, dimensions):
    """Numbers in 0 to 1. In one dimension `w` counts, in four p and `w`, else p."""
    color = random_color(w if dimensions == 1 else p.x, p.y, p.z, w, dimensions)
    return WhiteNoiseSample(color.x, color)
