# SPDX-License-Identifier: GPL-3.0-or-later
"""What a path teaches: from which directions light came to the places that it was at.

While a path is traced, nobody knows yet what its last directions will have brought. So it leaves a trail, and the
lessons are drawn at its end. They are sums of whole numbers, added atomically: the same in whatever order threads come.
"""

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.extending import intrinsic

from ..guide_tables import GUIDE_BINS
from ..jit import kernel
from ..linalg.records import scratch_record
from ..linalg.vec3 import average
from .histogram import bin_of

LONGEST = 8  # vertices of a path that teach
STEP = np.float32(2.0**-24)  # of radiance, in which sums are counted; what is above MOST counts as MOST, so that
MOST = np.float32(2.0**14)  # a bin has room for 2^25 such
STEPS_PER_UNIT = np.float32(1.0 / STEP)
TRAIL = np.dtype(
    [
        ("count", "i4"),
        ("cell", "i4", (LONGEST,)),  # row of LESSON
        ("bin", "i4", (LONGEST,)),
        ("beta", "f4", (LONGEST,)),  # throughput up to the vertex, the mean of colours ...
        ("L", "f4", (LONGEST,)),  # ... and what the path had gathered before it went on from there
    ]
)
new_trail = scratch_record(TRAIL)


@kernel
def remember(trail, cell, wi, beta, L):
    """The path, with throughput `beta` and having gathered `L`, goes on along `wi` from a place in the cell."""
    i = trail.count
    if i < LONGEST:
        trail.cell[i], trail.bin[i] = cell, bin_of(wi)
        trail.beta[i], trail.L[i] = average(beta), average(L)
        trail.count = i + 1


@kernel
def teach(film, trail, L):
    """The path ends with radiance `L`: what came later than a vertex came to it along the direction it took.

    What is added is the sample's estimate of the integral of f |cos| Li, which is what the bin shall have a share of.
    """
    L = average(L)
    for i in range(trail.count):
        lesson = film.lessons[trail.cell[i]]
        brought = max((L - trail.L[i]) / trail.beta[i], 0.0)
        add(lesson, GUIDE_BINS, 1)
        if brought > 0.0:
            add(lesson, trail.bin[i], np.int64(min(brought, MOST) * STEPS_PER_UNIT))


@intrinsic
def _add(typing_context, lesson, index, value):
    """Add to one of the sums of a row of LESSON, the last of which is its count."""

    def lower(context, builder, sig, args):
        sums = builder.bitcast(args[0], ir.IntType(64).as_pointer())
        index = context.cast(builder, args[1], sig.args[1], types.int64)
        value = context.cast(builder, args[2], sig.args[2], types.int64)
        builder.atomic_rmw("add", builder.gep(sums, [index]), value, "monotonic")
        return context.get_dummy_value()

    return types.void(lesson, index, value), lower


if config.DISABLE_JIT:  # kernels as plain Python, for a debugger

    def add(lesson, index, value):
        if index == GUIDE_BINS:
            lesson.count += value
        else:
            lesson.sums[index] += value
else:
    add = _add
