# SPDX-License-Identifier: GPL-3.0-or-later
"""A density over directions that aims at chosen targets: rows of TARGET, which may overlap and hide each other.

The density of a direction is the sum over all targets that its line crosses, whether it gets that far or not; a tree
finds them. A mesh is the sum of its triangles: a line that crosses it five times counts five.
"""

from typing import NamedTuple

import numpy as np

from ..accel.boxes import NO_LEAF, any_leaf, make_slabs, stack_scratch, start_any
from ..jit import kernel
from ..light import dispatch as light_dispatch
from ..linalg.vec3 import BLACK, Vec3, cross, dot, length, load3
from ..shape import box, disk, quad, sphere
from ..tables import LightKind

ZERO, FAR = np.float32(0.0), np.float32(np.inf)
IN_PLANE = np.float32(2.0**-20)  # of the numbers that go into a point's height over a plane: the rest is rounding
NO_TARGET = -1


class Aimed(NamedTuple):
    """A direction towards a target."""

    wi: Vec3
    pdf: np.float32  # per solid angle, of all targets together; 0: no direction


@kernel
def choose(scene, first, count, u):
    """One of `count` rows of TARGET from `first` on, with probability `pmf`: the first whose `cdf` is above `u`."""
    last = first + count - 1
    while first < last:
        middle = (first + last) >> 1
        if u < scene.targets[middle].cdf:
            last = middle
        else:
            first = middle + 1
    return first


@kernel
def sample(scene, p, u_target, u0, u1):
    """A direction from `p` towards a target."""
    row = choose(scene, 0, scene.world[0].target_count, u_target)
    target = scene.targets[row]
    light = scene.lights[target.light]
    if lies_in_plane(light, p):
        return Aimed(BLACK, ZERO)
    s = light_dispatch.sample(scene, light, p, u0, u1)
    if s.pdf <= 0.0:
        return Aimed(BLACK, ZERO)
    # The target itself by what its sample says: at its edge, rounding may let the line miss it.
    return Aimed(s.wi, target.pmf * s.pdf + pdf(scene, p, s.wi, row))


@kernel
def pdf(scene, p, wi, but):
    """Density per solid angle with which `sample` finds `wi` by any target, without that in the row `but`."""
    world = scene.world[0]
    density = ZERO
    if world.target_root >= 0:
        stack, slabs = stack_scratch(), make_slabs(p, wi)
        top = start_any(scene, stack, slabs, world.target_root, FAR)
        while True:
            leaf, top = any_leaf(scene, scene.targets, slabs, stack, top, FAR)
            if leaf == NO_LEAF:
                break
            row = ~leaf
            if row != but:
                density += pdf_of(scene, scene.targets[row], p, wi)
    for row in range(world.far_targets, world.target_count):
        if row != but:
            target = scene.targets[row]
            density += target.pmf * light_dispatch.pdf(scene, scene.lights[target.light], p, wi, FAR)
    return density


@kernel
def pdf_of(scene, target, p, wi):
    """What one target adds."""
    light = scene.lights[target.light]
    t = intersect(light, p, wi)
    if t == FAR or lies_in_plane(light, p):
        return ZERO
    return target.pmf * light_dispatch.pdf(scene, light, p, wi, t)


@kernel
def lies_in_plane(light, p):
    """Whether `p` lies in the plane of a flat target, which then covers no direction: its own triangle, for example."""
    if light.kind == LightKind.TRIANGLE or light.kind == LightKind.QUAD or light.kind == LightKind.DISK:
        h = p - load3(light, "p")
        return abs(dot(h, load3(light, "n"))) <= IN_PLANE * (length(h) + length(p))
    return False


@kernel
def intersect(light, o, d):
    """Where a ray meets a target, infinite if it does not."""
    kind = light.kind
    if kind == LightKind.TRIANGLE:
        return intersect_triangle(light, o, d)
    if kind == LightKind.QUAD:
        return quad.intersect(light, o, d, ZERO, FAR).t
    if kind == LightKind.BOX:
        return box.intersect(light, o, d, ZERO, FAR).t
    if kind == LightKind.DISK:
        return disk.intersect(light, o, d, ZERO, FAR).t
    if light.soft != 0:
        return disk.intersect_facing(light, o, d, ZERO, FAR).t
    return sphere.intersect(light, o, d, ZERO, FAR).t


@kernel
def intersect_triangle(light, o, d):
    """As shape.triangle, of a corner and two edges (Moeller and Trumbore 1997)."""
    e1, e2 = load3(light, "u"), load3(light, "v")
    h = cross(d, e2)
    s = o - load3(light, "p")
    q = cross(s, e1)
    scale = 1.0 / dot(e1, h)
    b1, b2, t = dot(s, h) * scale, dot(d, q) * scale, dot(e2, q) * scale
    return t if b1 >= 0.0 and b2 >= 0.0 and b1 + b2 <= 1.0 and t > 0.0 else FAR
