# SPDX-License-Identifier: GPL-3.0-or-later
"""What the mixture integrator aims at: lights, and objects that an artist wants sampled more.

Any set of targets gives the same picture, as the integrator weighs a ray by the density with which it aims there. So
what cannot be aimed at exactly has a stand-in: the box around it.
"""

from enum import IntEnum

import numpy as np

from ..accel.build import build_boxes
from ..light.bounds import boxes, intensity, irradiance, is_far
from ..shape.dispatch import bounds
from ..tables import NODE, TARGET, LightKind
from . import shapes
from .triangles import from_corners, triangle_lights

LARGEST_MESH = 2**16  # triangles; of larger meshes the box is aimed at
MOST_TARGETS = 2**20  # beyond them the faintest are not aimed at
QUANTA = 2**24  # probabilities are whole multiples of 1 / QUANTA: exact in float32, as are the sums of them
BOX_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
BOX_TRIANGLES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
     [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)  # fmt: skip


class Aim(IntEnum):
    """Whether the mixture integrator sends rays at an object."""

    AUTOMATIC = 0  # where it emits
    ALWAYS = 1
    NEVER = 2


def dark_lights(placements, matrices, geometries, first_lights):
    """Tables of LIGHT, without emission, for what is aimed at and has no rows among the lights.

    `matrices`: (n, 3, 4), where they stand; `first_lights`: for each the row of LIGHT of its first emitter, or -1.
    """
    tables = []
    for number, (placement, geometry, first) in enumerate(zip(placements, geometries, first_lights, strict=True)):
        has_lights = first >= 0 and len(geometry.emitters)
        if placement.aim == Aim.ALWAYS:
            everything = np.arange(len(geometry.light_ranks))
            wanted = np.setdiff1d(everything, geometry.emitters) if has_lights else everything
        elif placement.aim == Aim.AUTOMATIC and not has_lights:
            wanted = geometry.emitters
        else:
            continue
        if len(wanted):
            rows = _rows(geometry, wanted, matrices[number])
            rows["instance"], rows["prim"], rows["two_sided"], rows["aimed_at"] = number, -1, 1, 1
            rows["spread"], rows["leaf"] = np.inf, -1
            tables.append(rows)
    return tables


def _rows(geometry, numbers, matrix):
    if isinstance(geometry, shapes.Shapes):
        rows = geometry.rows[numbers]
        if shapes.stay_themselves(rows, matrix).all():
            return shapes.lights(shapes.moved(rows, matrix))
        return _boxes_around(*bounds(rows), matrix)
    if len(numbers) > LARGEST_MESH:
        corners = geometry.positions[geometry.triangles[numbers]].reshape(1, -1, 3)
        return _boxes_around(corners.min(axis=1), corners.max(axis=1), matrix)
    return triangle_lights(geometry, numbers, matrix)


def _boxes_around(low, high, matrix):
    """Triangles of the boxes from `low` to `high`, (n, 3), moved by `matrix`."""
    corners = low[:, None] + BOX_CORNERS * (high - low)[:, None]
    return from_corners((corners @ matrix[:, :3].T + matrix[:, 3])[:, BOX_TRIANGLES].reshape(-1, 3, 3), matrix)


def make(lights, world):
    """(TARGET, NODE): all that is aimed at, behind it the lights that cannot be hit; and the tree over the first.

    Fills in what WORLD says of targets. A light of the world that is constant is none: scattering finds it as well.
    """
    shines = np.arange(len(lights)) < world["light_count"][0]
    is_delta = lights["is_delta"] != 0
    is_world = (lights["kind"] == LightKind.BACKGROUND) & (lights["share"] > 0.0)
    has_extent = (lights["area"] > 0.0) | (lights["kind"] == LightKind.SUN)
    is_target = ((lights["aimed_at"] != 0) & has_extent & ~is_delta) | is_world
    strength = np.where(shines, _power(lights, float(world["radius"][0])), 0.0)
    is_distant = np.isin(lights["kind"], (LightKind.SUN, LightKind.BACKGROUND))
    near = _strongest(np.flatnonzero(is_target & ~is_distant), lights, strength)
    nodes, order = build_boxes(*boxes(lights[near])) if len(near) else (np.zeros(0, NODE), [])
    near = near[order]
    aimed = np.concatenate([near, np.flatnonzero(is_target & is_distant)]).astype(np.int64)
    deltas = np.flatnonzero(is_delta & shines)
    world["target_count"], world["far_targets"], world["delta_count"] = len(aimed), len(near), len(deltas)
    parts = [_targets(lights, aimed, strength), _targets(lights, deltas, strength)]
    return np.concatenate(parts), nodes


def _targets(lights, rows, strength):
    """Rows of TARGET for rows of LIGHT.

    Each object that does not shine gets the same share. What shines gets as much for each together, half of it evenly,
    half by power: the even half for a faint lamp that is near, the other one for a bright one among many faint. Within
    an object the parts get theirs by power, or by area.
    """
    result = np.zeros(len(rows), TARGET)
    if not len(rows):
        return result
    lights, strength = lights[rows], strength[rows]
    shines = strength > 0.0
    owner = np.where(lights["instance"] >= 0, lights["instance"], -1 - np.arange(len(rows)))
    _, group = np.unique(np.stack([owner, shines]), axis=1, return_inverse=True)
    group = group.ravel()
    within = np.where(shines, strength, np.where(strength.any(), lights["area"], 1.0))
    total = np.bincount(group, within)
    count = len(total)
    lit = np.bincount(group, shines) > 0
    power = np.where(lit, total, 0.0)
    share = np.where(lit, 0.5 + 0.5 * lit.sum() * power / max(power.sum(), 1e-300), 1.0) / count
    parts = np.where(total > 0.0, 1.0 / np.maximum(total, 1e-300), 0.0)[group] * within
    counts = _whole(share[group] * parts)
    result["light"], result["pmf"], result["cdf"] = rows, counts / QUANTA, np.cumsum(counts) / QUANTA
    return result


def _whole(probabilities):
    """Whole numbers, at least 1, in proportion to `probabilities`, with the sum QUANTA."""
    counts = np.maximum(np.rint(probabilities / probabilities.sum() * QUANTA), 1.0).astype(np.int64)
    counts[np.argmax(counts)] += QUANTA - counts.sum()
    return counts


def _strongest(rows, lights, strength):
    if len(rows) <= MOST_TARGETS:
        return rows
    order = np.lexsort([lights["area"][rows], strength[rows]])
    return np.sort(rows[order[-MOST_TARGETS:]])


def _power(lights, radius):
    """About what lights send out, W: of suns, what enters the ball of `radius` around the scene."""
    is_flat = np.isin(lights["kind"], (LightKind.TRIANGLE, LightKind.QUAD, LightKind.DISK))
    solid_angle = np.pi * np.where(is_flat, np.where(lights["two_sided"] != 0, 2.0, 1.0), 4.0)
    return np.where(is_far(lights), irradiance(lights) * np.pi * radius**2, intensity(lights) * solid_angle)
