# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths through media: what `vacuum.py` says nothing to, and the integrators as they are where there are media.

They are the same functions with other meanings for some names (`jit.variant`): compiled apart, when a scene that has
media is first rendered, so all other scenes are as fast, and start as fast, as if there were no media.

A path knows the media it is in (`medium.inside`). Before it gets to what its ray hit, it may be scattered; what its ray
runs into on the way, lamps and what lies beyond everything, is gathered at any rate, dimmed by what is between. At a
place in a medium phase functions stand for the BSDF (`phases.py`): light is sampled, MIS weighs it, as on a surface
that faces everywhere.
"""

import numpy as np

from ..accel.traverse import NO_FACE, Hit, intersect_closest, intersect_instances, intersect_moving
from ..jit import kernel, variant
from ..light import dispatch as light_dispatch
from ..light.select import select
from ..linalg.ray import offset_ray_origin
from ..linalg.records import copy_record, scratch_record
from ..linalg.vec3 import BLACK, WHITE, Vec3, dot, is_black, length, load3, max_component, store3
from ..medium import equiangular, homogeneous, inside
from ..medium.dispatch import gather_phases
from ..medium_tables import MEDIA, PHASES
from ..sampling.sobol import sample_1d, sample_2d
from ..sampling.sobol8 import DIMENSIONS_PER_VERTEX, sample_vertex
from ..shape.interaction import make_interaction, new_interaction
from ..tables import BOUNDARY_SHIFT, PLAIN_SHIFT, MaterialFlag, TreeKind, Visibility
from . import direct, mixture, path, phases, uniform, walk
from .direct import face_of, transparency
from .touching import find_touching, new_touching
from .walk import ABOVE, CAMERA, FAR, ZERO, dimension_of, gather, gather_direct, limit_of_found, survives

FLIGHTS = 1 << 16  # dimensions of a sample from here on are for how far it goes in media
MOST_CROSSINGS = 1024  # of boundaries, before a path is given up
MOST_PROBED = 128  # surfaces, or boundaries, above the camera that are asked whether it is inside
UP = Vec3(0.0, 0.0, 1.0)
ABOVE_US = CAMERA  # who sees what we look up to
NONE = np.int32(-1)
NO_TREE, NO_PRIM = int(TreeKind.TRIANGLES), -1  # as a Hit holds them
ONE = np.float32(1.0)
ONE_LOOK = 1  # at lights, from where a path is scattered by media

new_media, new_phases = scratch_record(MEDIA), scratch_record(PHASES)


def in_media(function, name="in_media", **meanings):
    """The kernel with other meanings for some names."""
    return kernel(variant(function.py_func, name, **meanings))


# ---- Which media are we in? ------------------------------------------------------------------------------------------


@kernel
def set_out(scene, path, ray, time):
    """Begin with a CameraRay, and find out what it begins in."""
    walk.set_out(scene, path, ray, time)
    path.volume_bounces = 0
    inside.nowhere(scene, path.media)
    if scene.world[0].camera_in_media != 0:
        look_up(scene, path.media, ray.o, time)
    if scene.world[0].camera_in_boundary != 0:
        look_up_among_boundaries(scene, path.media, ray.o, time)


@kernel
def surface_above(scene, o, time):
    return intersect_closest(scene, o, UP, ZERO, FAR, CAMERA, time, NO_FACE)


@kernel
def boundary_above(scene, o, time):
    """Boundaries are instances, all of them."""
    world, visibility = scene.world[0], CAMERA << BOUNDARY_SHIFT
    hit = Hit(FAR, NO_TREE, NO_PRIM, NO_PRIM, ZERO, ZERO)
    if world.instance_root >= 0:
        hit = intersect_instances(scene, world.instance_root, o, UP, ZERO, FAR, visibility, NO_FACE)
    if world.moving_root >= 0:
        found = intersect_moving(scene, world.moving_root, o, UP, ZERO, hit.t, visibility, time, NO_FACE)
        if found.prim >= 0:
            hit = found
    return hit


@kernel
def look_up(scene, media, o, time):
    """Enter all media that `o` is in: those whose surface is left before it was entered, on the way up.

    By those that have a surface. A box may reach to the ceiling, and only one of them would be met.
    """
    entered, found, it = new_media(), new_touching(), new_interaction()
    entered.count = 0
    for _ in range(MOST_PROBED):
        hit = surface_above(scene, o, time)
        if hit.prim < 0:
            return
        make_interaction(scene, it, hit, o, UP, time)
        find_touching(scene, it, ABOVE_US, found)
        for i in range(found.count):
            instance, medium = found.instance[i], found.medium[i]
            if found.leaves[i] == 0:
                inside.cross(scene, entered, instance, medium, False)
            elif not inside.contains(entered, instance, medium):
                inside.cross(scene, media, instance, medium, False)
        o = offset_ray_origin(load3(it, "p"), -load3(it, "ng"))


look_up_among_boundaries = in_media(
    look_up, "among_boundaries", surface_above=boundary_above, ABOVE_US=CAMERA << BOUNDARY_SHIFT
)


@kernel
def go_through(scene, media, it, visibility):
    """Cross what is at `it`, and all other boundaries that lie there."""
    found = new_touching()
    find_touching(scene, it, visibility | visibility << BOUNDARY_SHIFT, found)
    for i in range(found.count):
        inside.cross(scene, media, found.instance[i], found.medium[i], found.leaves[i] != 0)


@kernel
def is_no_surface(scene, path, it):
    if not scene.materials[it.material].flags & MaterialFlag.BOUNDARY.value:
        return False
    go_through(scene, path.media, it, path.visibility)
    path.media.crossings += 1
    pass_surface(path, it)
    if path.media.crossings >= MOST_CROSSINGS:
        path.t_max = ZERO
    return True


@kernel
def pass_surface(path, it):
    """As that of `vacuum`. The ray begins anew behind all that lies at `it`, which `go_through` has crossed."""
    path.distance += path.t
    path.t_max -= path.t
    store3(path, "o", offset_ray_origin(load3(it, "p"), -load3(it, "ng")))


@kernel
def dimension_of_media(path):
    """Boundaries have random numbers of their own, too: what comes behind them is decided anew."""
    return dimension_of(path) + DIMENSIONS_PER_VERTEX * path.media.crossings


# ---- What is met? ----------------------------------------------------------------------------------------------------


@kernel
def intersect_all(scene, o, d, t_min, t_max, visibility, time, left):
    """As `intersect_closest`, of surfaces and boundaries. Where they lie in one place it is either."""
    return intersect_closest(scene, o, d, t_min, t_max, visibility | visibility << BOUNDARY_SHIFT, time, left)


@kernel
def is_boundary(scene, hit):
    visibility = scene.instances[hit.instance].visibility if hit.instance >= 0 else 0
    return (visibility >> BOUNDARY_SHIFT) & Visibility.ALL.value != 0


@kernel
def is_plain(scene, hit):
    """Whether it is a surface of something that holds no medium."""
    return hit.instance < 0 or scene.instances[hit.instance].visibility >> PLAIN_SHIFT != 0


@kernel
def met_instead(scene, it, hit, visibility, time):
    """What else lies at `it`, where the Hit is, and is met before that: rather a surface than a boundary, and rather
    that of something that holds no medium. A Hit without a prim if there is nothing.

    A box of smoke, or a block of glass that is coloured inside, may stand on a floor. A path that goes through its
    bottom is moved off it, and would then be below the floor. Where the floor is met instead, it is scattered while it
    still is in the box.
    """
    wanted = visibility if is_boundary(scene, hit) else visibility << PLAIN_SHIFT
    found = surface_at(scene, it, hit.t, wanted, time)
    if found.prim >= 0 and not is_plain(scene, found):
        plain = surface_at(scene, it, hit.t, visibility << PLAIN_SHIFT, time)
        if plain.prim >= 0:
            return plain
    return found


@kernel
def surface_at(scene, it, t, visibility, time):
    """The surface that lies in one place with what is at `it`, a Hit at `t`."""
    p, ng = load3(it, "p"), load3(it, "ng")
    before, behind = offset_ray_origin(p, ng), offset_ray_origin(p, -ng)
    surface = intersect_closest(scene, before, behind - before, ZERO, ONE, visibility, time, NO_FACE)
    return Hit(t, surface.kind, surface.prim, surface.instance, surface.b1, surface.b2)


@kernel
def arrive(scene, settings, path, hit):
    """As that of `walk`. What is scattered before it never asks which of several things in one place was met."""
    if path.side == ABOVE and not is_plain(scene, hit):
        it = path.vertex
        make_interaction(scene, it, hit, load3(path, "o"), load3(path, "d"), path.time)
        other = met_instead(scene, it, hit, path.visibility, path.time)
        if other.prim >= 0:
            hit = other
        elif is_boundary(scene, hit):
            return it
    return walk.arrive(scene, settings, path, hit)


# ---- How far do we get? ----------------------------------------------------------------------------------------------


@kernel
def clearness(path, t):
    if path.media.count == 0:
        return WHITE
    return homogeneous.transmittance(load3(path.media, "sigma_t"), t)


@kernel
def aim_at_light(scene, path, sampler, t):
    """An Aim at one of the lights that shine on the path's ray."""
    if scene.world[0].light_count == 0:
        return equiangular.no_aim()
    o, d, sigma_t = load3(path, "o"), load3(path, "d"), load3(path.media, "sigma_t")
    near = 0.5 * min(t, 1.0 / max_component(sigma_t))
    u = sample_1d(sampler, FLIGHTS + 1 + dimension_of_media(path))
    chosen = select(scene, o + d * near, BLACK, True, u)
    if chosen.pmf <= 0.0:
        return equiangular.no_aim()
    light = scene.lights[chosen.light]
    if light.leaf < 0 and light.irradiance > 0.0:  # is far
        return equiangular.no_aim()
    return equiangular.aim_at(o, d, t, light_dispatch.centre(light), light_dispatch.size(light), sigma_t)


@kernel
def aim_at_nothing(scene, path, sampler, t):
    return equiangular.no_aim()


@kernel
def is_scattered(scene, settings, path, sampler, hit):
    """Gathers what media emit on the way, dims the path, and moves it to where it is scattered if it is."""
    media = path.media
    if media.count == 0 or path.side != ABOVE:
        return False
    sigma_t, sigma_s = load3(media, "sigma_t"), load3(media, "sigma_s")
    ends_in_nothing = hit.prim < 0
    t = FAR if ends_in_nothing else hit.t
    if not is_black(load3(media, "emission")):
        L = homogeneous.emitted(load3(media, "emission"), sigma_t, t)
        gather(path, L, limit_of_found(settings, path))
    beta = load3(path, "beta")
    if path.ends_here != 0 or is_black(sigma_s):
        store3(path, "beta", beta * homogeneous.transmittance(sigma_t, t))
        return False
    u_event, u_t = sample_2d(sampler, FLIGHTS + dimension_of_media(path))
    aim = aim_at_light(scene, path, sampler, t)
    flight = homogeneous.fly(sigma_t, sigma_s, beta, t, aim, ends_in_nothing, u_event, u_t)
    store3(path, "beta", beta * flight.weight)
    if not flight.scatters:
        return False
    store3(path, "o", load3(path, "o") + load3(path, "d") * flight.t)
    return True


@kernel
def shadow_transmittance(scene, settings, path, it, o, d, t_max):
    """As that of `direct`: what gets through media and their boundaries, too."""
    media, at = new_media(), new_interaction()
    copy_record(media, path.media)
    if dot(d, load3(it, "ng")) < 0.0:
        go_through(scene, media, it, Visibility.SHADOW.value)
    metres = length(d)
    clear, passed, left = WHITE, 0, face_of(it)
    for _ in range(MOST_CROSSINGS):
        hit = intersect_all(scene, o, d, ZERO, t_max, Visibility.SHADOW.value, path.time, left)
        if media.count > 0:
            clear = clear * homogeneous.transmittance(load3(media, "sigma_t"), hit.t * metres)
        if hit.prim < 0:
            return clear
        make_interaction(scene, at, hit, o, d, path.time)
        if not is_plain(scene, hit):
            other = met_instead(scene, at, hit, Visibility.SHADOW.value, path.time)
            if other.prim >= 0:
                hit = other
                make_interaction(scene, at, hit, o, d, path.time)
        if not scene.materials[at.material].flags & MaterialFlag.BOUNDARY.value:
            passed += 1
            clear = clear * transparency(scene, at, hit, d)
            if passed > settings.transparent_bounces - path.transparent_bounces:
                return BLACK
        if is_black(clear):
            return BLACK
        go_through(scene, media, at, Visibility.SHADOW.value)
        o, left = offset_ray_origin(load3(at, "p"), -load3(at, "ng")), face_of(at)
        t_max -= hit.t
    return BLACK


# ---- How does a place in a medium scatter? ---------------------------------------------------------------------------


@kernel
def arrive_in_media(scene, path, found):
    """The vertex: a row of INTERACTION that has no normal; `found` is set to its phase functions."""
    p, it = load3(path, "o"), path.vertex
    store3(it, "p", p)
    store3(it, "ng", BLACK)
    store3(it, "ns", BLACK)
    it.instance = it.material = it.light = it.kind = it.prim = it.through = NONE
    it.backfacing, it.time = 0, path.time
    gather_phases(scene, path.media, load3(path, "beta"), found)
    path.both_sides, path.prim = 1, NONE
    if path.first_hit == 0:
        albedo = homogeneous.albedo(load3(path.media, "sigma_t"), load3(path.media, "sigma_s"))
        store3(path, "first_p", p)
        store3(path, "first_albedo", albedo)
        path.first_hit = 1
    return it


@kernel
def count_scattering(settings, path, s):
    path.bounces += 1
    path.volume_bounces += 1
    path.visibility = Visibility.SCATTER.value
    path.ends_here = path.bounces > settings.max_bounces or path.volume_bounces > settings.volume_bounces


MEANINGS = {"bsdf_dispatch": phases, "guided_pdf": phases.guided_pdf, "shadow_transmittance": shadow_transmittance}
light_in_media = in_media(direct.light_of, "of_phases", **MEANINGS)
sample_direct_in_media = in_media(direct.sample_direct, "of_phases", light_of=light_in_media)
sample_delta_in_media = in_media(direct.sample_delta, "of_phases", light_of=light_in_media)
sample_mixture_in_media = in_media(mixture.sample_mixture, "of_phases", bsdf_dispatch=phases)
follow_in_media = in_media(walk.follow, "of_phases", count_bounce=count_scattering)


@kernel
def scatter_by_path(scene, settings, path, sampler):
    found = new_phases()
    it, wo = arrive_in_media(scene, path, found), -load3(path, "d")
    u = sample_vertex(sampler, dimension_of_media(path))
    if scene.world[0].light_count > 0:
        L = sample_direct_in_media(scene, settings, path, it, found, wo, ONE_LOOK, u.light, u.light_u0, u.light_u1)
        gather_direct(settings, path, L)
    s = phases.sample(found, wo, u.lobe, u.u0, u.u1)
    return follow_in_media(scene, settings, path, it, s, s.pdf) and survives(settings, path, u.roulette)


@kernel
def scatter_by_mixture(scene, settings, path, sampler):
    found = new_phases()
    it, wo = arrive_in_media(scene, path, found), -load3(path, "d")
    u = sample_vertex(sampler, dimension_of_media(path))
    if scene.world[0].delta_count > 0:
        gather_direct(settings, path, sample_delta_in_media(scene, settings, path, it, found, wo, u.light))
    s = sample_mixture_in_media(scene, load3(it, "p"), found, wo, u.lobe, u.light_u0, u.u0, u.u1)
    return follow_in_media(scene, settings, path, it, s, ZERO) and survives(settings, path, u.roulette)


@kernel
def scatter_uniformly(scene, settings, path, sampler):
    found = new_phases()
    it, wo = arrive_in_media(scene, path, found), -load3(path, "d")
    u = sample_vertex(sampler, dimension_of_media(path))
    if scene.world[0].delta_count > 0:
        gather_direct(settings, path, sample_delta_in_media(scene, settings, path, it, found, wo, u.light))
    s = phases.sample(found, wo, u.lobe, u.u0, u.u1)
    return follow_in_media(scene, settings, path, it, s, ZERO) and survives(settings, path, u.roulette)


# ---- The integrators -------------------------------------------------------------------------------------------------

lamp_radiance = in_media(direct.lamp_radiance, clearness=clearness)
light_of = in_media(direct.light_of, shadow_transmittance=shadow_transmittance)
COMMON = {
    "set_out": set_out,
    "advance": in_media(
        walk.advance, intersect_closest=intersect_all, lamp_radiance=lamp_radiance, clearness=clearness
    ),
    "arrive": arrive,
    "is_scattered": is_scattered,
    "is_no_surface": is_no_surface,
    "dimension_of": dimension_of_media,
    "follow": in_media(walk.follow, go_through=go_through, pass_surface=pass_surface),
}
sample_delta = in_media(direct.sample_delta, light_of=light_of)

trace_path = in_media(
    path.trace,
    sample_direct=in_media(direct.sample_direct, light_of=light_of),
    scatter_in_media=scatter_by_path,
    **COMMON,
)
trace_mixture = in_media(mixture.trace, sample_delta=sample_delta, scatter_in_media=scatter_by_mixture, **COMMON)
AIMLESS = {**COMMON, "is_scattered": in_media(is_scattered, "aimlessly", aim_at_light=aim_at_nothing)}
trace_uniform = in_media(uniform.trace, sample_delta=sample_delta, scatter_in_media=scatter_uniformly, **AIMLESS)
