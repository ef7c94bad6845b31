# SPDX-License-Identifier: GPL-3.0-or-later
"""Selection by the tree of lights (Conty Estevez and Kulla 2018): one light, by what it may bring to a point.

At each node one child is chosen, in proportion to its importance, down to a leaf. `p` is the point that is lit, `n`
its unit normal, or 0 in a medium, which has none; `both_sides`: whether light from behind counts as well.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import inlined_kernel, kernel
from ..linalg.records import scratch_record
from ..tables import LIGHT_WIDTH
from .light_sample import ONE, ZERO

new_importances = scratch_record(np.dtype([("of", "f4", (LIGHT_WIDTH,))]))

ONE_MINUS = np.float32(1.0 - 2.0**-24)  # the largest number below 1
# How far beyond its horizon a light is still taken for visible, as a cosine: rounding shall not make it invisible.
SLACK = np.float32(1e-4)
# The distance at which a point inside of a box is taken to be from its lights, of half the box's diagonal.
NEAREST = np.float32(0.4)
LEAST_DISTANCE = np.float32(1e-5)  # metres; nearer to a point light than this makes no difference


class Selection(NamedTuple):
    light: int  # row of LIGHT
    pmf: float  # 0: there is nothing to select
    u: float  # what is left of the random number: again in [0, 1), with as many bits less as the choice took


@kernel
def nothing(u):
    """What is selected if no light can be seen."""
    return Selection(np.int32(0), ZERO, u)


@inlined_kernel
def sample(scene, p, n, both_sides, u, importances, total):
    """Choose a leaf of the tree, whose root is weighed already, by `weigh_root`."""
    row, probability = scene.world[0].light_root, ONE
    while total > 0.0:
        u *= total
        chosen, mine, rest = 0, ONE, u
        for k in range(LIGHT_WIDTH):
            if importances.of[k] > 0.0:
                chosen, mine, rest = k, importances.of[k], u
                if u < mine:
                    break
                u -= mine
        probability *= mine / total
        u = min(rest / mine, ONE_MINUS)
        row = scene.light_nodes[row].child[chosen]
        if row < 0:
            return Selection(np.int32(~row), probability, u)
        total = weigh(scene.light_nodes[row], p, n, both_sides, importances)
    return nothing(u)  # which from above, where bounds are wider, was not to be known


@kernel
def pmf(scene, leaf, p, n, both_sides):
    """Probability that `sample` goes down to `leaf`, as it stands in a row of LIGHT: by the same steps, upwards."""
    importances = new_importances()
    probability = ONE
    while leaf >= 0:
        node = scene.light_nodes[leaf // LIGHT_WIDTH]
        total = weigh(node, p, n, both_sides, importances)
        mine = importances.of[leaf % LIGHT_WIDTH]
        if mine == 0.0:
            return ZERO
        probability *= mine / total
        leaf = node.parent
    return probability


@inlined_kernel
def weigh_root(scene, p, n, both_sides, importances):
    """Weigh the children of the root; the sum is what all lights of the tree are expected to bring."""
    root = scene.world[0].light_root
    return weigh(scene.light_nodes[root], p, n, both_sides, importances) if root >= 0 else ZERO


@inlined_kernel
def weigh(node, p, n, both_sides, importances):
    """Irradiance that the lights of each child are expected to bring to `p`, W/m2, and returned, their sum.

    It is 0 only if none of them can bring any; else as if all stood where the box's centre is, and faced `p` as well as
    their bounds allow. Without a branch, so that the compiler takes all children at once.
    """
    nx, ny, nz = abs(n.x), abs(n.y), abs(n.z)
    behind = ONE if both_sides else -ONE
    least_cosine = SLACK if nx + ny + nz > 0.0 else ONE
    for k in range(LIGHT_WIDTH):
        x, y, z = node.centre[0, k] - p.x, node.centre[1, k] - p.y, node.centre[2, k] - p.z
        half_x, half_y, half_z, radius = node.half[0, k], node.half[1, k], node.half[2, k], node.radius[k]
        distance = math.sqrt(x * x + y * y + z * z)
        inverse = 1.0 / max(distance, max(NEAREST * radius, LEAST_DISTANCE))
        closeness = min(inverse, node.closest[k])
        margin = SLACK * distance

        # The surface: is any point of the box above it?
        along = x * n.x + y * n.y + z * n.z
        along = max(along, behind * -along)
        reach = nx * half_x + ny * half_y + nz * half_z
        is_seen = along + reach + margin > 0.0
        importance = node.intensity[k] * closeness * closeness * max(usual_cosine(along, reach, inverse), least_cosine)

        # The lights: is p within theta_o + theta_e around the axis, for any point of the box?
        axis_x, axis_y, axis_z = node.axis[0, k], node.axis[1, k], node.axis[2, k]
        along = -(x * axis_x + y * axis_y + z * axis_z)
        along = max(along, node.two_sided[k] * -along)
        reach = abs(axis_x) * half_x + abs(axis_y) * half_y + abs(axis_z) * half_z
        cos_oe = node.cos_oe[k]
        is_lit = along + reach + margin >= cos_oe * distance - abs(cos_oe) * radius
        cosine = usual_cosine(along, radius, inverse)
        sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
        closer = max(cosine * node.cos_o[k] + sine * node.sin_o[k], SLACK)  # the cosine of an angle less by theta_o
        importance *= closer if cosine < node.cos_o[k] else ONE
        importances.of[k] = importance if is_seen and is_lit else ZERO
    w = importances.of
    return ((w[0] + w[1]) + (w[2] + w[3])) + ((w[4] + w[5]) + (w[6] + w[7]))


@inlined_kernel
def usual_cosine(along, reach, inverse):
    """Between the cosine of the box's centre, if it counts at all, and the largest that any of its points may have.

    The largest alone would prefer lights that are hardly seen; the centre's would forget those that are on the brink.
    """
    return 0.5 * (min((along + reach) * inverse, 1.0) + max(along * inverse, 0.0))
