# SPDX-License-Identifier: GPL-3.0-or-later
"""What sampling a light returns."""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, Vec3

INFINITY = np.float32(np.inf)
ZERO, ONE = np.float32(0.0), np.float32(1.0)


class LightSample(NamedTuple):
    """A direction from which light may come. Light that arrives per unit of cosine: radiance / pdf."""

    wi: Vec3  # unit
    distance: float  # to the light: what stands nearer is in its way; infinite for the sun and the world
    radiance: Vec3  # is_delta: irradiance across `wi`
    pdf: float  # per solid angle; 0: no light from here; is_delta: 1
    is_delta: bool


@kernel
def no_light():
    """The sample of a light that does not reach the point."""
    return LightSample(BLACK, ZERO, BLACK, ZERO, False)


@kernel
def area_pdf(area, distance, cosine):
    """Density per solid angle of points uniform on `area`: dA cos = distance^2 dw. `cosine`: at the light, positive."""
    return distance * distance / (area * cosine)
