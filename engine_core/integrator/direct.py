# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light, found both ways: by sampling an emitter, and by a scattered ray that runs into one."""

import numpy as np

from ..accel.traverse import intersect_closest, intersect_lamps, occluded
from ..bsdf import dispatch as bsdf_dispatch
from ..jit import kernel
from ..light import dispatch as light_dispatch
from ..light.select import select
from ..linalg.ray import offset_ray_origin
from ..linalg.vec3 import BLACK, WHITE, dot, is_black, load3
from ..sampling.mis import power_heuristic
from ..shape.interaction import make_interaction
from ..tables import MaterialFlag, Visibility

FAR = np.float32(np.inf)
ALMOST_ONE = np.float32(1.0 - 1e-4)  # shadow rays stop short: a lamp may lie in the surface of a ceiling


@kernel
def sample_direct(scene, settings, it, bsdf, wo, visibility, u_select, u0, u1):
    """Light from one emitter, chosen at random, that the surface at `it` scatters towards `wo`."""
    row, pmf, _ = select(scene, u_select)
    light = scene.lights[row]
    if pmf <= 0.0:
        return BLACK
    s = light_dispatch.sample(scene, light, it.p, u0, u1)
    if s.pdf <= 0.0 or is_black(s.radiance):
        return BLACK
    f, pdf_bsdf = bsdf_dispatch.evaluate_and_pdf(bsdf, wo, s.wi)
    if is_black(f):
        return BLACK
    pdf_light = s.pdf * pmf
    Ld = f * s.radiance * (1.0 / pdf_light)
    if not s.is_delta:
        Ld = Ld * power_heuristic(pdf_light, pdf_bsdf)
    o = offset_ray_origin(it.p, it.ng if dot(s.wi, it.ng) > 0.0 else -it.ng)
    if s.distance == FAR:
        return Ld * shadow_transmittance(scene, settings, o, s.wi, FAR)
    # To the very point that was sampled, moved off the emitter as `o` is off the surface: neither end blocks the way.
    q = it.p + s.wi * s.distance
    n = light_dispatch.surface_normal(light, q)
    q = offset_ray_origin(q, n if dot(s.wi, n) < 0.0 else -n)
    return Ld * shadow_transmittance(scene, settings, o, q - o, ALMOST_ONE)


@kernel
def shadow_transmittance(scene, settings, o, d, t_max):
    """The part of light that gets from o + t_max d to `o`: 0, 1, or a colour if something transparent is between.

    `d` need not be unit.
    """
    if scene.world[0].transparent_shadows == 0:
        return BLACK if occluded(scene, o, d, t_max) else WHITE
    transmittance = WHITE
    for _ in range(settings.transparent_bounces + 1):
        hit = intersect_closest(scene, o, d, t_max, Visibility.SHADOW.value)
        if hit.prim < 0:
            return transmittance
        it = make_interaction(scene, hit, o, d)
        material = scene.materials[it.material]
        if not material.flags & MaterialFlag.TRANSPARENT.value:
            return BLACK
        transmittance = transmittance * load3(material, "transparency")
        o = offset_ray_origin(it.p, -it.ng)
        t_max -= hit.t
    return BLACK


@kernel
def surface_emission(scene, it, d, p_last, pdf_last, distance):
    """Radiance that the surface at `it` emits against `d`, weighted against having sampled it from `p_last`."""
    material = scene.materials[it.material]
    if it.backfacing and material.flags & MaterialFlag.ONE_SIDED.value:
        return BLACK
    Le = load3(material, "emission")
    if pdf_last > 0.0 and it.light >= 0:
        light = scene.lights[it.light]
        pdf_light = light_dispatch.pdf(scene, light, p_last, d, distance) * light.pmf
        Le = Le * power_heuristic(pdf_last, pdf_light)
    return Le


@kernel
def lamp_radiance(scene, o, d, t_max, p_last, pdf_last, distance, visibility):
    """Radiance of all lamps that the ray passes before `t_max`. Lamps are in nobody's way, so there may be several."""
    L = BLACK
    t = np.float32(0.0)
    while True:
        hit = intersect_lamps(scene, o, d, t, t_max)
        if hit.prim < 0:
            return L
        t = hit.t
        row = scene.shapes[hit.prim].light
        light = scene.lights[row]
        if not light.visibility & visibility:
            continue
        Le = light_dispatch.emitted(scene, light, p_last, d, distance + t)
        if pdf_last > 0.0:
            pdf_light = light_dispatch.pdf(scene, light, p_last, d, distance + t) * light.pmf
            Le = Le * power_heuristic(pdf_last, pdf_light)
        L = L + Le


@kernel
def background_radiance(scene, d, p_last, pdf_last, visibility):
    """Radiance from beyond everything along `d`: the world, and the suns that stand there."""
    world = scene.world[0]
    L = BLACK
    if world.background_visibility & visibility:
        L = load3(world, "background")
        if pdf_last > 0.0 and world.background_light >= 0:
            light = scene.lights[world.background_light]
            L = L * power_heuristic(pdf_last, light_dispatch.pdf(scene, light, p_last, d, FAR) * light.pmf)
    for row in range(world.suns, world.suns + world.sun_count):
        light = scene.lights[row]
        if light.is_delta != 0 or not light.visibility & visibility:
            continue
        Le = light_dispatch.emitted(scene, light, p_last, d, FAR)
        if pdf_last > 0.0:
            Le = Le * power_heuristic(pdf_last, light_dispatch.pdf(scene, light, p_last, d, FAR) * light.pmf)
        L = L + Le
    return L
