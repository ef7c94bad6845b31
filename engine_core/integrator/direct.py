# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light, found both ways: by sampling an emitter, and by a scattered ray that runs into one."""

from typing import NamedTuple

import numpy as np

from ..accel.traverse import NO_FACE, Face, intersect_closest, intersect_lamps, occluded
from ..bsdf import dispatch as bsdf_dispatch
from ..jit import kernel
from ..light import dispatch as light_dispatch
from ..light.background import is_in_disk
from ..light.select import pmf, select
from ..light.triangle import row_at
from ..linalg.ray import offset_ray_origin
from ..linalg.registers import call
from ..linalg.vec3 import BLACK, WHITE, Vec3, dot, is_black, load3, normalize
from ..sampling.mis import power_heuristic
from ..shader.evaluate import light_radiance, run_program
from ..shader.opcodes import Entry
from ..shader.point import new_point, set_surface, set_world
from ..shape.interaction import make_interaction, new_interaction
from ..tables import MaterialFlag, TreeKind, Visibility
from .guided import guided_pdf
from .targets import choose
from .terminator import lift_below, lifted
from .vacuum import clearness

PANE = int(Entry.PANE)
FAR, ZERO, ONE = np.float32(np.inf), np.float32(0.0), np.float32(1.0)
SCATTERED = (Visibility.DIFFUSE | Visibility.GLOSSY | Visibility.TRANSMISSION).value
PASSABLE = (MaterialFlag.TRANSPARENT | MaterialFlag.OPAQUE_SHADOW).value
ALMOST_ONE = np.float32(1.0 - 1e-4)  # shadow rays stop short: a lamp may lie in the surface of a ceiling


class Origin(NamedTuple):
    """The place that sent a ray: how light sampling would have found there what the ray runs into, for MIS."""

    p: Vec3
    n: Vec3  # unit shading normal
    both_sides: bool  # light from behind counts as well
    pdf: float  # density of the ray's direction, over the samples taken of lights; 0: light sampling had no chance


@kernel
def sample_direct(scene, settings, walk, it, bsdf, wo, looks, u_select, u0, u1):
    """Light from one emitter, chosen at random, that the surface at `it` scatters towards `wo`.

    `looks`: how many such samples are taken, and added; each is weighed so that together they count as one.
    """
    row, pmf_light, _ = select(scene, load3(it, "p"), load3(it, "ns"), walk.both_sides != 0, u_select)
    if pmf_light <= 0.0:
        return BLACK
    return light_of(scene, settings, walk, it, bsdf, wo, row, np.float32(looks) * pmf_light, u0, u1)


@kernel
def sample_delta(scene, settings, walk, it, bsdf, wo, u_select):
    """As `sample_direct`, of those lights alone that no ray hits by chance: for integrators that rely on chance."""
    world = scene.world[0]
    chosen = scene.targets[choose(scene, world.target_count, world.delta_count, u_select)]
    return light_of(scene, settings, walk, it, bsdf, wo, chosen.light, chosen.pmf, ZERO, ZERO)


@kernel
def light_of(scene, settings, walk, it, bsdf, wo, row, pmf_light, u0, u1):
    """Light from the row of LIGHT, which was chosen with the probability `pmf_light`, or so often by several tries."""
    light, at, ng = scene.lights[row], load3(it, "p"), load3(it, "ng")
    s = light_dispatch.sample(scene, light, at, u0, u1)
    if s.pdf <= 0.0 or (is_black(s.radiance) and (light.program == 0 or light.gain > 0.0)):
        return BLACK
    below = lift_below(scene, walk, it, s.wi)
    f, pdf_bsdf = bsdf_dispatch.evaluate_lit(bsdf, wo, s.wi, load3(it, "ns") if below > 0.0 else ng)
    if light.visibility & SCATTERED != SCATTERED:
        f = f * bsdf_dispatch.share_seeing(bsdf, wo, s.wi, light.visibility)
    if is_black(f):
        return BLACK
    pdf_light = s.pdf * pmf_light
    f = f * (1.0 / pdf_light)
    o = offset_ray_origin(at, ng if dot(s.wi, ng) > 0.0 else -ng)
    if below > 0.0:
        o = lifted(scene, walk, it, s.wi, below)
    if s.distance == FAR:
        f = f * shadow_transmittance(scene, settings, walk, it, o, s.wi, FAR)
    else:
        # To the very point that was sampled, moved off the emitter as `o` is off the surface: neither blocks the way.
        q = at + s.wi * s.distance
        n = light_dispatch.surface_normal(light, q)
        q = offset_ray_origin(q, n if dot(s.wi, n) < 0.0 else -n)
        f = f * shadow_transmittance(scene, settings, walk, it, o, q - o, ALMOST_ONE)
    if is_black(f):
        return BLACK
    if not s.is_delta:
        f = f * power_heuristic(pdf_light, guided_pdf(scene, bsdf, s.wi, pdf_bsdf))
    if light.program > 0:  # after the shadow: a program costs more than a ray
        L = light_radiance(scene, light, new_point(), at + s.wi * s.distance, s.wi, s.distance, walk.visibility)
        return f * L * s.radiance if light.gain > 0.0 else f * L
    return f * s.radiance


@kernel
def shadow_transmittance(scene, settings, walk, it, o, d, t_max):
    """The part of light that gets from o + t_max d to `o`, beside `it`: 0, 1, or a colour if something transparent is
    between. `d` need not be unit. The limit of transparent surfaces is one for the path and the shadow ray together.
    """
    if scene.world[0].transparent_shadows == 0:
        return BLACK if occluded(scene, o, d, t_max, walk.time, face_of(it)) else WHITE
    transmittance, at, t_min, left = WHITE, new_interaction(), ZERO, face_of(it)
    for _ in range(settings.transparent_bounces - walk.transparent_bounces + 1):
        hit = intersect_closest(scene, o, d, t_min, t_max, Visibility.SHADOW.value, walk.time, left)
        if hit.prim < 0:
            return transmittance
        make_interaction(scene, at, hit, o, d, walk.time)
        transmittance = transmittance * transparency(scene, at, hit, d)
        if is_black(transmittance):
            return BLACK
        t_min = hit.t
    return BLACK


@kernel
def face_of(it):
    """The Face that a ray from `it`, a row of INTERACTION, leaves."""
    return Face(np.int64(it.prim) if it.kind == TreeKind.TRIANGLES else NO_FACE.prim, np.int64(it.through))


@kernel
def transparency(scene, it, hit, d):
    """What the surface at `it` lets pass of light against `d`."""
    material = scene.materials[it.material]
    if material.flags & PASSABLE != MaterialFlag.TRANSPARENT.value:
        return BLACK
    if material.flags & MaterialFlag.PANE.value:
        point = new_point()
        set_surface(scene, point, it, hit, -normalize(d), Visibility.SHADOW.value, np.float32(0.0))
        call(scene.kernels[PANE].address, scene, material, point, point)
        return load3(point, "result")
    if material.transparency_program > 0:
        point = new_point()
        set_surface(scene, point, it, hit, -normalize(d), Visibility.SHADOW.value, np.float32(0.0))
        return run_program(scene, material.transparency_program, point)
    return load3(material, "transparency")


@kernel
def surface_emission(scene, it, Le, d, origin, distance):
    """Radiance `Le` that the surface at `it` emits against `d`, weighted against having sampled it from the origin."""
    material = scene.materials[it.material]
    if it.backfacing and material.flags & MaterialFlag.ONE_SIDED.value:
        return BLACK
    if it.light < 0:
        return Le
    return Le * mis_weight(scene, row_at(scene, it.light, load3(it, "p")), d, origin, distance)


@kernel
def lamp_radiance(scene, walk, o, d, t_min, t_max, origin, distance, visibility):
    """Radiance of all lamps between `t_min` and `t_max`. Lamps are in nobody's way, so there may be several."""
    L = BLACK
    t = t_min
    while True:
        hit = intersect_lamps(scene, o, d, t, t_max)
        if hit.prim < 0:
            return L
        t = hit.t
        row = scene.shapes[hit.prim].light
        light = scene.lights[row]
        if not light.visibility & visibility:
            continue
        Le = light_dispatch.emitted(scene, light, origin.p, d, distance + t)
        if light.program > 0 and not is_black(Le):
            Le = Le * light_radiance(scene, light, walk.point, o + d * t, d, distance + t, visibility)
        L = L + Le * clearness(walk, t) * mis_weight(scene, row, d, origin, distance + t)


@kernel
def background_radiance(scene, d, origin, visibility, point):
    """Radiance from beyond everything along `d`: the world, and the suns that stand there. `point` is scratch."""
    world = scene.world[0]
    L = BLACK
    if world.background_visibility & visibility:
        if world.background_program > 0:
            set_world(point, d, visibility)
            L = run_program(scene, world.background_program, point)
        else:
            L = load3(world, "background")
        row = world.disk_light if is_in_disk(scene, d) else world.background_light
        if row >= 0:
            L = L * mis_weight(scene, row, d, origin, FAR)
    for row in range(world.suns, world.suns + world.sun_count):
        light = scene.lights[row]
        if light.is_delta != 0 or not light.visibility & visibility:
            continue
        Le = light_dispatch.emitted(scene, light, origin.p, d, FAR)
        if not is_black(Le):
            if light.program > 0:
                Le = Le * light_radiance(scene, light, point, d, d, FAR, visibility)
            L = L + Le * mis_weight(scene, row, d, origin, FAR)
    return L


@kernel
def mis_weight(scene, row, d, origin, t):
    """Weight of a ray from the origin along `d` that runs into the row of LIGHT at distance `t`."""
    if origin.pdf <= 0.0:
        return ONE
    pdf_light = light_dispatch.pdf(scene, scene.lights[row], origin.p, d, t)
    if pdf_light > 0.0:
        pdf_light *= pmf(scene, row, origin.p, origin.n, origin.both_sides)
    return power_heuristic(origin.pdf, pdf_light)
