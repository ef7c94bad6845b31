# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays that shader programs send: Ambient Occlusion, Bevel and Raycast.

A family of operations like those of the shader room, but it stands here, where trees may be asked: it is handed to the
machine through its address, as walks below surfaces are, and compiled when the first material needs it.

Its random numbers are made of the place itself, which differs from sample to sample: a program may run anywhere, for a
camera's ray as for a shadow, and gets what it needs without a sampler. Of the rays of one place each takes another part
of the square (a lattice of rank one, shifted at random).
"""

import math

import numpy as np

from ..accel.traverse import NO_FACE, Hit, intersect_closest, intersect_instance, occluded
from ..jit import kernel
from ..linalg.frame import frame_from_normal, from_local
from ..linalg.ray import float_bits, offset_ray_origin
from ..linalg.registers import store_float, store_vector
from ..linalg.vec3 import BLACK, dot, length, load3, normalize
from ..linalg.vector_math import safe_normalize
from ..motion import instance_at, new_instance
from ..sampling.rng import hash_combine, to_unit_float
from ..sampling.warp import square_to_cosine_hemisphere
from ..shader import link
from ..shader.graph import nodes_below
from ..shader.opcodes import INSIDE, ONLY_LOCAL, Entry, Op
from ..shader.operands import give_number, give_vector, number, vector
from ..shape.interaction import make_interaction, new_interaction
from ..tables import Visibility

ZERO, ONE = np.float32(0.0), np.float32(1.0)
TAU = np.float32(2.0 * math.pi)
GOLDEN = np.float32(0.6180339887)
TEN_OVER_PI = np.float32(10.0 / math.pi)
ALL = int(Visibility.ALL)
MOST_HITS = 16  # of one ray of a bevel
MOST_SAMPLES = np.float32(128.0)  # the most that a node can be set to


def run(scene, op, point, registers):
    """One step: see `opcodes.SIGNATURES`."""
    if op.code == Op.OCCLUSION:
        n = vector(op, registers, 1)
        open_share = ambient(scene, point, number(op, registers, 0), n, op.mode, samples_of(op, registers))
        give_number(op, registers, open_share)
    elif op.code == Op.BEVEL:
        n = vector(op, registers, 1)
        bevelled = bevel(scene, point, number(op, registers, 0), samples_of(op, registers))
        if dot(n, n) > 0.0:
            bevelled = normalize(n + bevelled - load3(point, "ns"))
        give_vector(op, registers, bevelled)
    else:
        raycast(scene, op, point, registers)


link.provide_family(Entry.PROBES, run)


def ask_the_object(values):
    """Whether programs that give `values` send rays for the object itself: it needs a tree of its own."""
    return any(
        n.op == Op.BEVEL or (n.op in (Op.OCCLUSION, Op.RAYCAST) and n.mode & ONLY_LOCAL) for n in nodes_below(values)
    )


@kernel
def samples_of(op, registers):
    return int(min(max(number(op, registers, 2), ZERO), MOST_SAMPLES))


@kernel
def seed_of(point):
    """32 random bits of the place and of the view of it."""
    seed = hash_combine(np.uint32(float_bits(point.p[0])), np.uint32(float_bits(point.p[1])))
    seed = hash_combine(seed, np.uint32(float_bits(point.p[2])))
    seed = hash_combine(seed, np.uint32(float_bits(point.wo[0])))
    return hash_combine(seed, np.uint32(float_bits(point.wo[1])))


@kernel
def fraction(x):
    return x - np.float32(math.floor(x))


@kernel
def is_surface(scene, point):
    """Whether there is a surface, and trees to ask: not in the world, nor on a lamp, nor before they are built."""
    world = scene.world[0]
    has_trees = world.triangle_root >= 0 or world.shape_root >= 0 or world.instance_root >= 0 or world.moving_root >= 0
    return has_trees and point.kind >= 0 and point.instance >= 0


@kernel
def ambient(scene, point, distance, normal, mode, samples):
    """The share of the hemisphere about `normal`, weighted by the cosine, in which nothing is within `distance`."""
    if not (distance > 0.0 and samples > 0 and is_surface(scene, point)):
        return ONE
    n = load3(point, "ns") if dot(normal, normal) == 0.0 else safe_normalize(normal)
    if mode & INSIDE:
        n = -n
    s, t = frame_from_normal(n)
    p, ng = load3(point, "p"), load3(point, "ng")
    seed = seed_of(point)
    r0, r1 = to_unit_float(seed), to_unit_float(hash_combine(seed, np.uint32(1)))
    count = 0
    for i in range(samples):
        u0 = (np.float32(i) + r0) / np.float32(samples)
        d = from_local(s, t, n, square_to_cosine_hemisphere(u0, fraction(np.float32(i) * GOLDEN + r1)))
        o = offset_ray_origin(p, ng if dot(d, ng) > 0.0 else -ng)
        if mode & ONLY_LOCAL:
            instance = instance_at(scene, point.instance, point.time, new_instance())
            is_open = (
                instance.root < 0 or intersect_instance(scene, instance, o, d, ZERO, distance, NO_FACE.prim).prim < 0
            )
        else:
            is_open = not occluded(scene, o, d, distance, point.time, NO_FACE)
        count += 1 if is_open else 0
    return np.float32(count) / np.float32(samples)


# ---- Bevel -----------------------------------------------------------------------------------------------------------


@kernel
def bevel(scene, point, radius, samples):
    """The mean normal of the object's surface around the place, by a kernel that falls to 0 at `radius`.

    Places are found by rays across a disk that lies along the surface or stands on it, one of three axes, weighted by
    the power heuristic (King, Kulla, Conty and Fajardo 2013, "BSSRDF Importance Sampling"), as Cycles does.
    """
    own = load3(point, "ns")
    if not (radius > 0.0 and samples > 0 and is_surface(scene, point)):
        return own
    instance = instance_at(scene, point.instance, point.time, new_instance())
    if instance.root < 0 or point.diffuse_bounces > 0:  # the eye does not see it by light that has spread
        return own
    p, n = load3(point, "p"), load3(point, "ng")
    s, t = frame_from_normal(n)
    seed = seed_of(point)
    r0, r1 = to_unit_float(seed), to_unit_float(hash_combine(seed, np.uint32(1)))
    total, it = BLACK, new_interaction()
    for i in range(samples):
        u0, u1 = (np.float32(i) + r0) / np.float32(samples), fraction(np.float32(i) * GOLDEN + r1)
        axis, a, b, phi = n, s, t, 2.0 * u0  # of which the normal is taken twice as often as a tangent
        if u0 >= 0.75:
            axis, a, b, phi = t, n, s, 4.0 * u0 - 3.0
        elif u0 >= 0.5:
            axis, a, b, phi = s, n, t, 4.0 * u0 - 2.0
        share = 0.5 if u0 < 0.5 else 0.25
        distance = radius * sample_falloff(u1)
        height = math.sqrt(max(radius * radius - distance * distance, ZERO))
        on_disk = (a * math.cos(TAU * phi) + b * math.sin(TAU * phi)) * distance
        o, left = p + axis * height + on_disk, 2.0 * height
        pdf_disk = falloff(distance / radius)
        for _ in range(MOST_HITS):
            hit = intersect_instance(scene, instance, o, -axis, ZERO, left, NO_FACE.prim)
            if hit.prim < 0 or pdf_disk <= 0.0:
                break
            found = Hit(hit.t, np.int64(instance.kind), hit.prim, np.int64(point.instance), hit.b1, hit.b2)
            make_interaction(scene, it, found, o, -axis, point.time)
            ng, ns = load3(it, "ng"), load3(it, "ns")
            through, along = share * abs(dot(axis, ng)), (0.75 - share) * abs(dot(a, ng))
            across = 0.25 * abs(dot(b, ng))
            w = through / (through * through + along * along + across * across)
            w *= falloff(length(load3(it, "p") - p) / radius) / pdf_disk
            total = total + (-ns if it.backfacing else ns) * w
            o, left = offset_ray_origin(load3(it, "p"), -ng), left - hit.t
    if dot(total, total) == 0.0:
        return own
    total = normalize(total)
    return -total if point.backfacing != 0 else total


@kernel
def falloff(r):
    """How much a place at the distance r counts, in units of the radius: a cubic, normalized over the disk."""
    return TEN_OVER_PI * (1.0 - r) * (1.0 - r) * (1.0 - r) if r < 1.0 else ZERO


@kernel
def sample_falloff(u):
    """A distance in 0 to 1 with that density over the disk: the root of its integral, by Newton's method."""
    x = np.float32(0.25)
    for _ in range(10):
        x2 = x * x
        error = 10.0 * x2 - 20.0 * x2 * x + 15.0 * x2 * x2 - 4.0 * x2 * x2 * x - u
        slope = 20.0 * x * (1.0 - x) * (1.0 - x) * (1.0 - x)
        if abs(error) < 1e-6 or slope == 0.0:
            break
        x = min(max(x - error / slope, ZERO), ONE)
    return x


# ---- Raycast ---------------------------------------------------------------------------------------------------------


@kernel
def raycast(scene, op, point, registers):
    """What a ray meets first, and where."""
    o, d, reach = vector(op, registers, 0), vector(op, registers, 1), number(op, registers, 2)
    is_hit, is_self, distance, place, normal = ZERO, ZERO, reach, BLACK, BLACK
    if reach > 0.0 and dot(d, d) > 0.0 and is_surface(scene, point):
        p, ng = load3(point, "p"), load3(point, "ng")
        start = o
        if o.x == p.x and o.y == p.y and o.z == p.z:
            start = offset_ray_origin(p, ng if dot(d, ng) > 0.0 else -ng)
        if op.mode & ONLY_LOCAL:
            hit = hit_itself(scene, point, start, d, reach)
        else:
            hit = intersect_closest(scene, start, d, ZERO, reach, ALL, point.time, NO_FACE)
        if hit.prim >= 0:
            it = new_interaction()
            make_interaction(scene, it, hit, start, d, point.time)
            is_hit, distance, normal = ONE, hit.t, load3(it, "ns")
            is_self = ONE if it.instance == point.instance else ZERO
            place = o + d * hit.t
    store_float(registers, op.out, is_hit)
    store_float(registers, op.out + 1, is_self)
    store_float(registers, op.out + 2, distance)
    store_vector(registers, op.out + 3, place)
    store_vector(registers, op.out + 6, normal)


@kernel
def hit_itself(scene, point, o, d, reach):
    """The Hit with the object that the place belongs to."""
    instance = instance_at(scene, point.instance, point.time, new_instance())
    kind, row = np.int64(instance.kind), np.int64(point.instance)
    if instance.root < 0:
        return Hit(reach, kind, np.int64(-1), row, ZERO, ZERO)
    found = intersect_instance(scene, instance, o, d, ZERO, reach, NO_FACE.prim)
    return Hit(found.t, kind, np.int64(found.prim), row, found.b1, found.b2)
