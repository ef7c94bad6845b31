# SPDX-License-Identifier: GPL-3.0-or-later
"""Which light to sample at a point: one of all, by what it may bring there.

Suns and beams, whose light does not fall off with distance, stand outside of the tree of lights. One of them, or the
tree, is chosen first: half of the probability goes by the irradiance to be expected, half evenly to all that can be
seen, since what stands in the way nobody knows. Constant background gets none: scattering by the material finds it
better, as it is everywhere.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import dot, is_black, load3
from ..tables import LightKind
from . import area, tree
from .bounds import clusters, intensity, irradiance, is_far, pairs
from .build import build_tree
from .light_sample import ONE, ZERO
from .tree import ONE_MINUS, SLACK, Selection

# The middle of the first of the 2^24 steps of random numbers: an interval that begins at 0 would have the whole step.
LEAST_U = np.float32(2.0**-25)
EDGE = np.float32(1.001)  # beams are looked for a little beyond their edge, whatever is rounded


@kernel
def select(scene, p, n, both_sides, u):
    """Choose a light for the point `p` with the unit normal `n`, or 0 in a medium.

    `both_sides`: whether light that comes from behind counts as well.
    """
    world = scene.world[0]
    if world.only_light >= 0:
        return within_leaf(scene, world.only_light, ONE, u)
    u = max(u, LEAST_U)
    importances = tree.new_importances()
    near = tree.weigh_root(scene, p, n, both_sides, importances)
    mine = ONE
    if world.far_count > 0:
        total, seen = expected(scene, near, p, n, both_sides)
        for row in range(world.far_count):
            mine = share(far_importance(scene.lights[row], p, n, both_sides), total, seen)
            if u < mine:
                return Selection(row, mine, min(u / mine, ONE_MINUS))
            u -= mine
        mine = share(near, total, seen)
        u = min(u / mine, ONE_MINUS)
    s = tree.sample(scene, p, n, both_sides, u, importances, near)
    return within_leaf(scene, s.light, mine * s.pmf, s.u) if s.pmf > 0.0 else s


@kernel
def pmf(scene, row, p, n, both_sides):
    """Probability that `select` chooses the row of LIGHT for that point."""
    world, light = scene.world[0], scene.lights[row]
    if world.only_light >= 0 or light.share == 0.0:
        return light.share
    mine = ONE
    if world.far_count > 0:
        near = tree.weigh_root(scene, p, n, both_sides, tree.new_importances())
        total, seen = expected(scene, near, p, n, both_sides)
        if row < world.far_count:
            return share(far_importance(light, p, n, both_sides), total, seen)
        mine = share(near, total, seen)
    return mine * light.share * tree.pmf(scene, light.leaf, p, n, both_sides)


@kernel
def within_leaf(scene, row, probability, u):
    """Choose the light `row`, the first of its leaf, or of a pair the next."""
    mine = scene.lights[row].share
    if u < mine:
        return Selection(row, probability * mine, min(u / mine, ONE_MINUS))
    return Selection(np.int32(row + 1), probability * (1.0 - mine), min((u - mine) / (1.0 - mine), ONE_MINUS))


@kernel
def expected(scene, near, p, n, both_sides):
    """Irradiance to be expected from all lights, `near` of it from the tree; and how many choices there are."""
    total = near
    seen = 1 if near > 0.0 else 0
    for row in range(scene.world[0].far_count):
        far = far_importance(scene.lights[row], p, n, both_sides)
        total += far
        seen += 1 if far > 0.0 else 0
    return total, seen


@kernel
def share(mine, total, seen):
    """Probability of one choice: half by its irradiance, half as much as all others."""
    return 0.5 * (mine / total + 1.0 / np.float32(seen)) if mine > 0.0 else ZERO


@kernel
def far_importance(light, p, n, both_sides):
    """Irradiance that a light outside of the tree may bring to `p`: 0 if it cannot."""
    if light.kind == LightKind.BACKGROUND:
        return light.irradiance
    cosine = -dot(n, load3(light, "n"))
    if both_sides:
        cosine = abs(cosine)
    if is_black(n):
        cosine = ONE
    if light.kind == LightKind.SUN:
        cosine += math.sqrt(light.height * (2.0 - light.height))  # sine of the angle of its disk
    else:
        view = area.view_from(light, p)
        if view.lit.z <= 0.0 or abs(view.x) > EDGE * view.half_x or abs(view.y) > EDGE * view.half_y:
            return ZERO
    cosine = min(cosine + SLACK, 1.0)
    return light.irradiance * cosine if cosine > 0.0 else ZERO


# ---- Preparation -----------------------------------------------------------------------------------------------------


def prepare_selection(lights, world):
    """Fill in what `select` reads of LIGHT and WORLD; returns rows of LIGHT_NODE. Far lights have to stand first."""
    far, is_pair = is_far(lights), pairs(lights)
    nodes = build_tree(clusters(lights, is_pair))
    child = nodes["child"].ravel()
    leaves = np.flatnonzero(child < 0)
    first, second = ~child[leaves], np.flatnonzero(is_pair) + 1
    lights["leaf"], lights["share"], lights["irradiance"] = -1, 0.0, np.where(far, irradiance(lights), 0.0)
    lights["leaf"][first], lights["share"][first], lights["share"][far] = leaves, 1.0, 1.0
    lights["leaf"][second] = lights["leaf"][second - 1]
    strength = intensity(lights)
    lights["share"][second] = strength[second] / (strength[second] + strength[second - 1])
    lights["share"][second - 1] = 1.0 - lights["share"][second]
    world["far_count"] = far.sum()
    world["light_root"] = 0 if len(nodes) else -1
    selected = np.append(np.flatnonzero(far), first)
    world["only_light"] = selected[0] if len(selected) == 1 else -1
    # What a picture of the sky lights is in the open, mostly: a path's first vertex sees most of the light directly.
    world["two_looks"] = len(selected) == 1 and lights["kind"][selected[0]] == LightKind.BACKGROUND
    return nodes
