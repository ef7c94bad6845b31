# SPDX-License-Identifier: GPL-3.0-or-later
"""What the models of `bsdf/` give back; all in the local frame and without the lobe's weight."""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, Vec3
from ..tables import LobeKind

ZERO = np.float32(0.0)
ONE = np.float32(1.0)
UP = Vec3(0.0, 0.0, 1.0)  # the normal


class LobeValue(NamedTuple):
    """How much a lobe scatters from one direction to another. Delta parts count as zero."""

    f: Vec3  # BSDF times |cos(wi)|
    pdf: np.float32  # per solid angle, with which `sample` chooses wi


class LobeSample(NamedTuple):
    """A direction chosen by a lobe."""

    wi: Vec3
    weight: Vec3  # f |cos| / pdf
    pdf: np.float32  # per solid angle; of a delta: the probability; 0: there is no direction
    is_delta: bool  # only `sample` finds this direction


@kernel
def is_matt(kind):
    """Whether paths that a LobeKind sends on count as diffuse."""
    return (
        kind == LobeKind.DIFFUSE
        or kind == LobeKind.ROUGH_DIFFUSE
        or kind == LobeKind.TOON_DIFFUSE
        or kind == LobeKind.SHEEN
        or kind == LobeKind.VELVET
    )


@kernel
def is_fibre(kind):
    """Whether a LobeKind scatters about the direction of a strand."""
    return LobeKind.HAIR <= kind <= LobeKind.HAIR_FACETS


@kernel
def has_no_sides(kind):
    """Whether a LobeKind does not ask on which side of the face a direction is."""
    return kind == LobeKind.HAIR or kind == LobeKind.HAIR_FACETS or kind == LobeKind.TRANSPARENT


@kernel
def nothing():
    """The value of a pair of directions that does not scatter."""
    return LobeValue(BLACK, ZERO)


@kernel
def no_direction():
    return LobeSample(BLACK, BLACK, ZERO, False)


@kernel
def mirror_direction(wo):
    return Vec3(-wo.x, -wo.y, wo.z)
