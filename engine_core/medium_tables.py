# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows about what fills space: media, how they scatter, and which of them a path is in. A part of the contract."""

from enum import IntEnum

import numpy as np


class PhaseKind(IntEnum):
    """Phase functions: where to a medium scatters; each has its file in `medium/`."""

    HENYEY_GREENSTEIN = 0
    RAYLEIGH = 1
    DRAINE = 2
    FOURNIER_FORAND = 3


PHASE = np.dtype(
    [
        ("kind", "i4"),  # PhaseKind
        ("weight", "f4", (3,)),  # 1/m, what it scatters; at a vertex: its share of all that is scattered there
        ("g", "f4"),  # HENYEY_GREENSTEIN, DRAINE: anisotropy, -1 to 1
        ("alpha", "f4"),  # DRAINE
        ("scale", "f4"),  # FOURNIER_FORAND: delta = scale (1 - cos) ...
        ("nu", "f4"),  # ... its exponent ...
        ("backward", "f4"),  # ... and the strength of its term for scattering backwards
        ("pmf", "f4"),  # at a vertex: probability that sampling chooses it
    ]
)
MEDIUM = np.dtype(
    [  # of constant density, the same everywhere; per metre of the world's space, by colour
        ("sigma_t", "f4", (3,)),  # extinction: what is scattered and what is absorbed
        ("sigma_s", "f4", (3,)),  # what is scattered, the sum of its phases' weights
        ("emission", "f4", (3,)),  # radiance that is added
        ("phases", "i4"),  # first row of PHASE
        ("phase_count", "i4"),
    ]
)
MAX_MEDIA = 16  # in one place; what is entered beyond is not seen
MEDIA = np.dtype(
    [  # the media that a path is in: they add up
        ("count", "i4"),
        ("instance", "i4", (MAX_MEDIA,)),  # row of INSTANCE whose surface it came in by; -1: the world
        ("medium", "i4", (MAX_MEDIA,)),  # row of MEDIUM
        ("sigma_t", "f4", (3,)),  # the sums
        ("sigma_s", "f4", (3,)),
        ("emission", "f4", (3,)),
        ("crossings", "i4"),  # of boundaries that have no surface
    ]
)
MAX_PHASES = 16
PHASES = np.dtype(
    [  # how light scatters at a point in media, made there: what a BSDF is on a surface
        ("count", "i4"),
        ("phases", PHASE, (MAX_PHASES,)),
    ]
)
