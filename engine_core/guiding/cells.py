# SPDX-License-Identifier: GPL-3.0-or-later
"""Which cell a place belongs to: by the direction that its face looks into, and then by an octree over the scene.

Faces that look up and those that look to the left receive light from other halves of space, though they may meet in an
edge; so there is an octree for each of the six sides of a cube. Its first levels are a grid.
"""

import numpy as np

from ..guide_tables import GUIDE_GRID
from ..jit import kernel
from ..linalg.vec3 import load3

SIDE = np.float32(GUIDE_GRID)


@kernel
def cell_at(scene, p, n):
    """The row of GUIDE_CELL for the point `p` with the unit normal `n`."""
    guide = scene.guide[0]
    q = (p - load3(guide, "corner")) * guide.grid_per_m
    x, y, z = within(q.x), within(q.y), within(q.z)
    i, j, k = np.int32(x), np.int32(y), np.int32(z)
    branch = ((side_of(n) * GUIDE_GRID + k) * GUIDE_GRID + j) * GUIDE_GRID + i
    target = scene.guide_branches[branch].target
    x, y, z = x - np.float32(i), y - np.float32(j), z - np.float32(k)
    while target < 0:
        x, y, z = 2.0 * x, 2.0 * y, 2.0 * z
        octant = 0
        if x >= 1.0:
            x, octant = x - 1.0, 1
        if y >= 1.0:
            y, octant = y - 1.0, octant | 2
        if z >= 1.0:
            z, octant = z - 1.0, octant | 4
        target = scene.guide_branches[~target + octant].target
    return target


@kernel
def within(x):
    """A coordinate that rounding has carried out of the grid, back in it."""
    return min(max(x, 0.0), SIDE * (1.0 - 2.0**-20))


@kernel
def side_of(n):
    """0 to 5: which side of a cube the unit vector `n` points through."""
    ax, ay, az = abs(n.x), abs(n.y), abs(n.z)
    if ax >= ay and ax >= az:
        return 0 if n.x > 0.0 else 1
    if ay >= az:
        return 2 if n.y > 0.0 else 3
    return 4 if n.z > 0.0 else 5
