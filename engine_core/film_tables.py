# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the film, and `Film`, all that a kernel may write: a part of the contract of `tables`."""

import numpy as np

from .guide_tables import LESSON
from .linalg.records import Tables

PIXEL = np.dtype(
    [  # sums over samples
        ("radiance", "f4", (3,)),
        ("alpha", "f4"),
        ("depth", "f4"),  # of the first sample
        ("normal", "f4", (3,)),
        ("albedo", "f4", (3,)),
        ("position", "f4", (3,)),  # of the first sample
        ("scattered", "f4"),  # the part of radiance that guiding could find, the mean of colours ...
        ("scattered_square", "f4"),  # ... and its square
        ("samples", "i4"),  # that it has ...
        ("target", "i4"),  # ... and shall have
    ]
)
SHARE = np.dtype([("radiance", "f4", (3,)), ("alpha", "f4"), ("weight", "f4")])  # sums, for film.sharing
CONTROL = np.dtype([("cancel", "i4")])  # set to 1 by any thread: kernels stop at the next row of pixels


class Film(Tables):
    """Where radiance lands: `width * height` pixels, bottom row first, and the flag that stops kernels."""

    pixels = PIXEL
    shares = SHARE  # nine for each pixel: what it gives to those around it; none if samples count for one pixel
    control = CONTROL
    lessons = LESSON
