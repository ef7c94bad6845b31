# SPDX-License-Identifier: GPL-3.0-or-later
"""A path in the making: what every integrator does at each vertex, so that its own file holds only what is its own.

An integrator is a loop over vertices (`uniform.py` is the shortest): advance, arrive, scatter, and follow the new
direction. The state of the path is a row of WALK on the stack of that loop.
"""

import math
from typing import NamedTuple

import numpy as np

from ..accel.traverse import Hit, intersect_closest
from ..bsdf import dispatch as bsdf_dispatch
from ..bsdf.lobe import is_matt
from ..jit import kernel
from ..linalg.ray import offset_ray_origin
from ..linalg.records import scratch_record
from ..linalg.vec3 import BLACK, WHITE, Vec3, average, dot, is_black, load3, max_component, store3
from ..medium_tables import MEDIA
from ..program_tables import POINT
from ..sampling.sobol8 import DIMENSIONS_PER_VERTEX
from ..shader.evaluate import emission, fill_bsdf, has_program, holdout
from ..shader.frames import lay_along
from ..shader.opcodes import FOOTPRINT
from ..shader.point import set_surface
from ..shape.interaction import INTERACTION, make_interaction
from ..tables import BSDF, CameraKind, LobeKind, MaterialFlag, TreeKind, Visibility
from .direct import Origin, background_radiance, face_of, lamp_radiance, surface_emission
from .layers import open_panes
from .subsurface import BELOW, prepare_walk, walk_below
from .vacuum import clearness, go_through, pass_surface

# Dimensions of a sample, in pairs: 0 the pixel filter, 1 the lens, 2 the time, then four for each vertex of the path:
# two choices (which light, which lobe), a point on a light or two more choices, a direction, Russian roulette.
FIRST_DIMENSION = 3
FAR, ZERO, ONE, NONE = np.float32(np.inf), np.float32(0.0), np.float32(1.0), np.int64(-1)
PIXELS = np.float32(FOOTPRINT)
CAMERA = Visibility.CAMERA.value
ABOVE, DESCENDING, EMERGING = 0, 1, 2  # of the path to the surface: scattered by it; about to walk below; coming out

WALK = np.dtype(
    [
        ("o", "f4", (3,)),  # the ray that comes next; it sees from t_min to t_max
        ("d", "f4", (3,)),
        ("t_min", "f4"),
        ("t_max", "f4"),
        ("time", "f4"),  # of the shutter, 0 to 1
        ("visibility", "i4"),  # Visibility: by what scattering it came about
        ("beta", "f4", (3,)),  # throughput
        ("beta_first", "f4"),  # its largest component after the first bounce
        ("L", "f4", (3,)),  # radiance gathered so far
        ("alpha", "f4"),
        ("p_last", "f4", (3,)),  # the last place that scattered, an Origin
        ("n_last", "f4", (3,)),
        ("both_sides_last", "i4"),
        ("pdf_last", "f4"),
        ("distance", "f4"),  # from there to `o`; more than 0 after passing through something transparent in media
        ("t", "f4"),  # where on the ray the vertex is
        ("vertex", INTERACTION),
        ("prim", "i4"),  # what it is on: row of TRIANGLE, or -1 ...
        ("b1", "f4"),  # ... and where
        ("b2", "f4"),
        ("both_sides", "i4"),  # 1: the vertex scatters light from behind, too
        ("bounces", "i4"),
        ("diffuse_bounces", "i4"),
        ("glossy_bounces", "i4"),
        ("transmission_bounces", "i4"),
        ("transparent_bounces", "i4"),
        ("side", "i4"),  # ABOVE, DESCENDING or EMERGING
        ("descents", "i4"),  # walks below surfaces so far
        ("below", BELOW),
        ("ends_here", "i4"),  # 1: the limits allow no more scattering: gather emission and stop
        ("first_p", "f4", (3,)),  # the first vertex, for the passes
        ("first_normal", "f4", (3,)),
        ("first_albedo", "f4", (3,)),
        ("first_hit", "i4"),
        ("direct", "f4"),  # mean of L when it went on from the first place that may be guided; infinite: none yet
        ("volume_bounces", "i4"),  # this and the following only in scenes that have media
        ("media", MEDIA),  # that the ray is in
        ("point", POINT),  # the vertex, for shader programs: set if its material has any
    ]
)
new_walk, new_bsdf = scratch_record(WALK), scratch_record(BSDF)


class PathSample(NamedTuple):
    """What one path brought, and what its first vertex was."""

    L: Vec3
    alpha: float  # 0 where the camera sees the background
    p: Vec3
    normal: Vec3
    albedo: Vec3
    hit: bool
    scattered: float  # mean of the part of L that was found beyond the first place that may be guided


@kernel
def set_out(scene, walk, ray, time):
    """Begin with a CameraRay, at a time of the shutter."""
    o, d = ray.o, ray.d
    store3(walk, "o", o)
    store3(walk, "d", d)
    store3(walk, "beta", WHITE)
    store3(walk, "L", BLACK)
    store3(walk, "p_last", o)
    store3(walk, "n_last", d)
    store3(walk, "first_p", BLACK)
    store3(walk, "first_normal", BLACK)
    store3(walk, "first_albedo", WHITE)
    walk.t_min, walk.t_max, walk.time, walk.visibility, walk.alpha = ZERO, ray.t_max, time, CAMERA, ONE
    walk.direct = FAR
    walk.pdf_last = walk.distance = walk.t = ZERO
    walk.both_sides = walk.both_sides_last = walk.descents = 0
    walk.side = ABOVE
    walk.vertex.kind = walk.vertex.through = NONE
    walk.bounces = walk.diffuse_bounces = walk.glossy_bounces = walk.transmission_bounces = 0
    walk.transparent_bounces = walk.ends_here = walk.first_hit = 0


@kernel
def origin_of(walk):
    """Where the ray was sent from, for MIS."""
    return Origin(load3(walk, "p_last"), load3(walk, "n_last"), walk.both_sides_last != 0, walk.pdf_last)


@kernel
def advance(scene, settings, walk):
    """Follow the ray to what it hits, a Hit with a prim of -1 if nothing; gather what shines on the way."""
    if walk.side == DESCENDING:
        return emerge(scene, walk)
    o, d, visibility = load3(walk, "o"), load3(walk, "d"), walk.visibility
    origin = origin_of(walk)
    hit = intersect_closest(scene, o, d, walk.t_min, walk.t_max, visibility, walk.time, face_of(walk.vertex))
    walk.t = hit.t
    if scene.world[0].lamp_root >= 0:
        L = lamp_radiance(scene, walk, o, d, walk.t_min, hit.t, origin, walk.distance, visibility)
        gather(walk, L, limit_of_found(settings, walk))
    if hit.prim < 0:
        if visibility == CAMERA and settings.transparent_background != 0:
            walk.alpha -= average(load3(walk, "beta") * clearness(walk, FAR))
        else:
            L = background_radiance(scene, d, origin, visibility, walk.point)
            gather(walk, L * clearness(walk, FAR), limit_of_found(settings, walk))
    return hit


@kernel
def emerge(scene, walk):
    """Where the light comes out that went below a surface, as hit from outside; a prim of -1 if nowhere."""
    below = walk.below
    store3(below, "o", load3(walk, "o"))
    store3(below, "d", load3(walk, "d"))
    store3(below, "beta", load3(walk, "beta"))
    walk_below(scene, below, walk.point)
    store3(walk, "o", load3(below, "o"))
    store3(walk, "d", load3(below, "d"))
    store3(walk, "beta", load3(below, "beta"))
    walk.t, walk.side = below.t, EMERGING
    kind = np.int64(scene.instances[below.instance].kind)
    return Hit(below.t, kind, np.int64(below.prim), np.int64(below.instance), below.b1, below.b2)


@kernel
def arrive(scene, settings, walk, hit):
    """The vertex: a row of INTERACTION with what was hit; gather what shines there."""
    d, it = load3(walk, "d"), walk.vertex
    make_interaction(scene, it, hit, load3(walk, "o"), d, walk.time)
    walk.prim, walk.b1, walk.b2 = hit.prim if hit.kind == TreeKind.TRIANGLES else NONE, hit.b1, hit.b2
    material = scene.materials[it.material]
    if has_program(material):
        set_point(scene, settings, walk, it, hit)
    if material.flags & MaterialFlag.EMISSIVE.value and walk.side == ABOVE:
        Le = emission(scene, material, walk.point)
        L = surface_emission(scene, it, Le, d, origin_of(walk), walk.distance + hit.t)
        gather(walk, L, limit_of_found(settings, walk))
    if material.flags & MaterialFlag.HOLDOUT.value and walk.visibility == CAMERA:
        walk.alpha -= average(load3(walk, "beta") * holdout(scene, material, walk.point))
    return it


@kernel
def set_point(scene, settings, walk, it, hit):
    """Tell shader programs where they are."""
    point, camera = walk.point, scene.camera[0]
    pixel = (camera.screen[1] - camera.screen[0]) / np.float32(settings.width)
    size = pixel * (walk.distance + hit.t) if camera.kind == CameraKind.PERSPECTIVE else pixel
    set_surface(scene, point, it, hit, -load3(walk, "d"), walk.visibility, PIXELS * size)
    point.ray_length = walk.distance + hit.t
    point.bounces = walk.bounces
    point.diffuse_bounces, point.glossy_bounces = walk.diffuse_bounces, walk.glossy_bounces
    point.transmission_bounces = walk.transmission_bounces
    point.transparent_bounces = walk.transparent_bounces


@kernel
def is_last(scene, walk, it):
    """Whether the limits let nothing scatter here; what is transparent has limits of its own."""
    return walk.ends_here != 0 and not scene.materials[it.material].flags & MaterialFlag.TRANSPARENT.value


@kernel
def gather(walk, L, limit):
    """Add the radiance `L`, as much of it as gets to the camera; its largest component there is limited unless 0."""
    L = load3(walk, "beta") * L
    largest = max_component(L)
    if limit > 0.0 and largest > limit:
        L = L * (limit / largest)
    store3(walk, "L", load3(walk, "L") + L)


@kernel
def limit_of_found(settings, walk):
    """Limit of light that a ray ran into: direct light until it has scattered twice."""
    return settings.clamp_direct if walk.bounces <= 1 else settings.clamp_indirect


@kernel
def gather_direct(settings, walk, L):
    """Add light that was sampled at the vertex."""
    gather(walk, L, settings.clamp_direct if walk.bounces == 0 else settings.clamp_indirect)


@kernel
def make_bsdf(scene, settings, walk, it, bsdf):
    """How the vertex scatters; `wo` is against the ray."""
    wo = -load3(walk, "d")
    spreads = walk.diffuse_bounces > 0
    material = scene.materials[it.material]
    fill_bsdf(
        scene,
        material,
        load3(it, "ng"),
        load3(it, "ns"),
        wo,
        walk.point,
        bsdf,
        not spreads or settings.reflective_caustics != 0,
        not spreads or settings.refractive_caustics != 0,
    )
    if material.flags & MaterialFlag.HAIR.value:
        lay_along(scene, bsdf, it, wo)
    if walk.side == EMERGING:
        walk.side = ABOVE
        bsdf_dispatch.become_matt(bsdf)
    bsdf_dispatch.prepare(bsdf, wo, it.backfacing != 0)
    if material.flags & MaterialFlag.PANE.value and walk.visibility != CAMERA:
        open_panes(bsdf)
    bsdf.shadow_stretch = scene.objects[it.instance].shadow_stretch if scene.world[0].stretches_shadows != 0 else ONE
    bsdf.cell, bsdf.guided = np.int32(-1), ZERO
    walk.both_sides = material.flags & MaterialFlag.TRANSMITS.value != 0
    if walk.first_hit == 0:
        store3(walk, "first_p", load3(it, "p"))
        store3(walk, "first_normal", load3(it, "ns"))
        store3(walk, "first_albedo", bsdf_dispatch.albedo(bsdf, wo))
        walk.first_hit = 1
    return wo


@kernel
def dimension_of(walk):
    """The first of the vertex' dimensions of the sampler."""
    return FIRST_DIMENSION + DIMENSIONS_PER_VERTEX * (walk.bounces + walk.transparent_bounces + walk.descents)


@kernel
def go_below(walk, sampler, it, bsdf, u_lobe):
    """Tell the walk below the surface where it begins, and by which lobe. No bounce; there is one where it ends."""
    prepare_walk(walk.below, it, bsdf, sampler, dimension_of(walk), u_lobe)
    walk.side = DESCENDING
    walk.descents += 1


@kernel
def follow(scene, settings, walk, it, s, pdf):
    """Let the path go on along the BsdfSample `s`; False if it ends. `pdf`: for MIS, as Origin has it."""
    ng = load3(it, "ng")
    if s.pdf <= 0.0:
        return False
    beta = load3(walk, "beta") * s.weight
    if is_black(beta):
        return False
    if s.kind == LobeKind.TRANSPARENT:
        walk.transparent_bounces += 1
        if walk.transparent_bounces > settings.transparent_bounces:
            return False
        pass_surface(walk, it)
    else:
        if walk.ends_here != 0:
            return False
        if s.kind != LobeKind.SUBSURFACE:
            count_bounce(settings, walk, s)
            store3(walk, "p_last", load3(it, "p"))
            store3(walk, "n_last", load3(it, "ns"))
            walk.both_sides_last, walk.pdf_last, walk.distance, walk.t_max = walk.both_sides, pdf, ZERO, FAR
        walk.t_min = ZERO
        store3(walk, "o", offset_ray_origin(load3(it, "p"), ng if dot(s.wi, ng) > 0.0 else -ng))
        store3(walk, "d", s.wi)
    store3(walk, "beta", beta)
    if dot(s.wi, ng) < 0.0 and s.kind != LobeKind.SUBSURFACE:
        go_through(scene, walk.media, it, walk.visibility)
    return True


@kernel
def count_bounce(settings, walk, s):
    walk.bounces += 1
    if s.is_transmission:
        walk.transmission_bounces += 1
        walk.visibility = Visibility.TRANSMISSION.value
    elif is_matt(s.kind):
        walk.diffuse_bounces += 1
        walk.visibility = Visibility.DIFFUSE.value
    else:
        walk.glossy_bounces += 1
        walk.visibility = Visibility.GLOSSY.value
    walk.ends_here = (
        walk.bounces > settings.max_bounces
        or walk.diffuse_bounces > settings.diffuse_bounces
        or walk.glossy_bounces > settings.glossy_bounces
        or walk.transmission_bounces > settings.transmission_bounces
    )


@kernel
def survives(settings, walk, u):
    """Russian roulette by the random number `u`: whether it is worth to go on.

    By the throughput beside that of the first bounce: a dark surface is dark by whatever path, and its noise is seen
    beside that. The root keeps paths longer than their throughput says, since they may still find a bright light.
    """
    beta = load3(walk, "beta")
    if walk.bounces <= 1:
        walk.beta_first = max_component(beta)
    if walk.bounces <= settings.min_bounces:
        return True
    survival = min(1.0, math.sqrt(2.0 * max_component(beta) / walk.beta_first))
    if u >= survival:
        return False
    store3(walk, "beta", beta * (1.0 / survival))
    return True


@kernel
def outcome(walk):
    """What the path brought, at its end."""
    return PathSample(
        load3(walk, "L"),
        walk.alpha,
        load3(walk, "first_p"),
        load3(walk, "first_normal"),
        load3(walk, "first_albedo"),
        walk.first_hit != 0,
        max(average(load3(walk, "L")) - walk.direct, 0.0),
    )
