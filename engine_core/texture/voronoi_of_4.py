# SPDX-License-Identifier: GPL-3.0-or-later
"""The Voronoi texture as Blender 4 has it: `voronoi.py` with other points in the cells.

From two dimensions on they come of Jenkins' hash of the cell's floats. Blender 5 hashes its integers by PCG, so there
every pattern is another one; what a file shows in one of the two, it has to show here, too.
"""

import numpy as np

from ..jit import inlined_kernel, kernel, variant
from ..linalg.simd import splat8
from ..linalg.simd_int import bits_of_floats, splat_int8
from . import cells, hash8, voronoi
from .hash import Random4, random_color, random_of_4

ZERO, ONE, TWO = np.float32(0.0), np.float32(1.0), np.float32(2.0)


@kernel
def place_in(n, at):
    """`cells.place_in`: where in its cell the point is."""
    if n == 4:
        x, y, z, w = at.x, at.y, at.z, at.w
        return Random4(
            random_of_4(x, y, z, w), random_of_4(w, x, y, z), random_of_4(z, w, x, y), random_of_4(y, z, w, x)
        )
    u = random_color(at.x, at.y, at.z, at.w, n)
    return Random4(u.x, u.y if n > 1 else ZERO, u.z if n > 2 else ZERO, ZERO)


@inlined_kernel
def places_in(n, at):
    """The same of eight cells, in lanes."""
    x, y, z, w = bits_of_floats(at.x), bits_of_floats(at.y), bits_of_floats(at.z), bits_of_floats(at.w)
    none, one, two = splat_int8(np.int32(0)), bits_of_floats(splat8(ONE)), bits_of_floats(splat8(TWO))
    zero = splat8(ZERO)
    if n == 1:
        u, v, s, t = hash8.lookup3(x, none, none, 1), none, none, none
    elif n == 2:
        u, v, s, t = hash8.lookup3(x, y, none, 2), hash8.lookup3(x, y, one, 3), none, none
    elif n == 3:
        u, v, s = hash8.lookup3(x, y, z, 3), hash8.lookup3_of_4(x, y, z, one), hash8.lookup3_of_4(x, y, z, two)
        t = none
    else:
        u, v = hash8.lookup3_of_4(x, y, z, w), hash8.lookup3_of_4(w, x, y, z)
        s, t = hash8.lookup3_of_4(z, w, x, y), hash8.lookup3_of_4(y, z, w, x)
    return hash8.Random4Lanes(
        hash8.unit_floats(u),
        hash8.unit_floats(v) if n > 1 else zero,
        hash8.unit_floats(s) if n > 2 else zero,
        hash8.unit_floats(t) if n > 3 else zero,
    )


@kernel
def color_of(lattice, cell, offset):
    at = cells.added(cell, offset)
    return random_color(at.x, at.y, at.z, at.w, lattice.dimensions)


def py_func(function):
    """What a kernel is made of, or the function itself in plain Python."""
    return getattr(function, "py_func", function)


MEANINGS = {"place_in": place_in, "places_in": places_in, "color_of": color_of}
for function in (cells.point_of, cells.points_of, cells.squares_to):
    MEANINGS[function.__name__] = inlined_kernel(variant(py_func(function), "of_blender_4", **MEANINGS))
for function in (
    cells.nearest_in_space,
    voronoi.nearest,
    voronoi.smooth_nearest,
    voronoi.edge_distance,
    voronoi.sphere_radius,
    voronoi.octave_of,
    voronoi.octaves,
    voronoi.octaves_of_edges,
    voronoi.voronoi,
):  # each is made of those before it
    MEANINGS[function.__name__] = kernel(variant(py_func(function), "of_blender_4", **MEANINGS))
voronoi_of_4 = MEANINGS["voronoi"]
