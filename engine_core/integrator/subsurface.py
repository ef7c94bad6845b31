# SPDX-License-Identifier: GPL-3.0-or-later
"""The walk of light below a surface, from where it enters to where it comes out.

Chiang, Kutz and Burley, "Practical and Controllable Subsurface Scattering for Production Path Tracing" (2016): a random
walk in a medium that fills the object, and that nothing but the object itself bounds. Steps are guided outwards by the
zero-variance theory of slabs, and back to the far side where that is near:

[1] Krivanek and d'Eon, "A Zero-variance-based Sampling Scheme for Monte Carlo Subsurface Scattering" (2014)
[2] Meng, Hanika and Dachsbacher, "Improving the Dwivedi Sampling Scheme" (2016)
[3] d'Eon and Krivanek, "Zero-Variance Theory for Efficient Subsurface Scattering" (2020)

A step has one distance and one direction for three channels; all the ways that it could have come about (which channel,
guided outwards, guided back, unguided) are weighted by the balance heuristic.

The walk is an entry point of its own: kernels of scenes without it have none of it inside of them.
"""

import math

import numpy as np

from ..accel.traverse import NO_FACE, intersect_instance
from ..bsdf import dispatch as bsdf_dispatch
from ..jit import kernel
from ..linalg.registers import call
from ..linalg.vec3 import Vec3, dot, lerp, load3, max_component, store3
from ..medium.albedo_inversion import medium_of
from ..medium.phase import direction_around, henyey_greenstein, sample_henyey_greenstein
from ..motion import instance_at, new_instance
from ..sampling.rng import hash_combine, to_unit_float
from ..sampling.sobol import dimension_seed
from ..shader import link
from ..shader.opcodes import Entry

BELOW = np.dtype(
    [
        ("o", "f4", (3,)),  # in: where the walk begins and whereto; out: a ray from outside to where it ends
        ("d", "f4", (3,)),
        ("beta", "f4", (3,)),  # in and out: throughput, with the weight of the lobe
        ("entry", "f4", (3,)),  # the very place where it begins: `o` is moved a bit off the surface
        ("n", "f4", (3,)),  # shading normal where it begins, outwards
        ("kind", "i4"),  # SubsurfaceKind; what follows is as in LOBE
        ("color", "f4", (3,)),
        ("radius", "f4", (3,)),
        ("g", "f4"),
        ("ior", "f4"),
        ("instance", "i4"),  # row of INSTANCE
        ("time", "f4"),  # of the ray
        ("seed", "u4"),  # of its random numbers
        ("prim", "i4"),  # out: what the ray hits, as in a Hit; -1: the light was absorbed
        ("t", "f4"),
        ("b1", "f4"),
        ("b2", "f4"),
    ]
)
ENTRY = int(Entry.SUBSURFACE)
ZERO, ONE = np.float32(0.0), np.float32(1.0)
INV_TWO_PI = np.float32(0.5 / np.pi)
MOST_STEPS = 256
NEGLIGIBLE = np.float32(1e-6)  # throughput
# Where many steps have blurred directions, an isotropic medium with the mean of the cosines taken from its scattering
# does as well (similarity theory), and can be guided better.
STEPS_UNTIL_SIMILAR = 10
SHARE_GUIDED_IF_SIMILAR = np.float32(0.75)
MEAN_FREE_PATHS_TO_FAR_SIDE = np.float32(10.0)  # how far a far side is looked for


@kernel
def prepare_walk(below, it, bsdf, sampler, dimension, u_lobe):
    """What the walk has to know of the place and of the lobe that `u_lobe` chose."""
    lobe = bsdf.lobes[bsdf_dispatch.chosen_lobe(bsdf, u_lobe)]
    store3(below, "entry", load3(it, "p"))
    store3(below, "n", load3(it, "ns"))
    store3(below, "color", load3(lobe, "f0"))
    store3(below, "radius", load3(lobe, "f82"))
    below.kind, below.g, below.ior = lobe.fresnel, lobe.g, lobe.ior
    below.instance, below.time = it.instance, it.time
    below.seed = hash_combine(dimension_seed(sampler, dimension), sampler.reversed_index)


@kernel
def walk_below(scene, below, point):
    """Let the light at `o` walk on: sets `prim`, and if it came out, the ray and its throughput."""
    below.prim = -1
    address = scene.kernels[ENTRY].address
    if address != 0:
        call(address, scene, below, point, below)


def random_walk(scene, below, unused, again):
    """The walk itself; see `walk_below`."""
    instance = instance_at(scene, below.instance, below.time, new_instance())
    if instance.root < 0:
        return
    n, g = load3(below, "n"), below.g
    medium = medium_of(below.kind, load3(below, "color"), load3(below, "radius"), g, below.ior)
    sigma_t, sigma_s = medium.sigma_t, medium.sigma_t * medium.albedo
    beta = without(load3(below, "beta"), load3(below, "color")) * medium.dimmed
    nu = diffusion_length(max_component(medium.albedo))
    if nu <= 1.0:
        return
    log_nu = math.log((nu + 1.0) / (nu - 1.0))
    guided_share = 1.0 - max(0.5, math.sqrt(math.sqrt(math.sqrt(abs(g)))))
    entry = load3(below, "entry")
    o, d = load3(below, "o"), load3(below, "d")
    depth = -ONE  # of the far side below the tangent plane of the entry; negative: none is near
    cos = ZERO  # of the direction to the normal
    phase = ONE
    back_share = ZERO

    for step in range(MOST_STEPS):
        draw = 6 * step  # number of the first of its random numbers
        if step == STEPS_UNTIL_SIMILAR:
            sigma_t = sigma_t - sigma_s * g
            sigma_s = sigma_s * (1.0 - g)
            g, guided_share = ZERO, SHARE_GUIDED_IF_SIMILAR

        # ---- By which channel, and whereto? ----------------------------------------------------------------------
        share = shares(beta * medium.albedo)
        rate = of_channel(sigma_t, share, uniform(below, draw))
        u_distance = uniform(below, draw + 1)
        if step > 0:
            is_back = False
            if depth >= 0.0:
                x = min(max(dot(entry - o, n), 0.0), depth)
                back_share = 1.0 / (1.0 + math.exp((depth - 2.0 * x) / nu))
                is_back = uniform(below, draw + 2) < back_share
            u0, u1 = uniform(below, draw + 3), uniform(below, draw + 4)
            if uniform(below, draw + 5) < guided_share:
                cos = nu - (nu + 1.0) * math.exp(-u0 * log_nu)  # [2], equation 10
                cos = -cos if is_back else cos
                new_d = direction_around(n, cos, u1)
                rate *= 1.0 + cos / nu if is_back else 1.0 - cos / nu
            else:
                new_d = sample_henyey_greenstein(d, g, u0, u1)
                cos = dot(new_d, n)
            phase = henyey_greenstein(dot(d, new_d), g)
            d = new_d

        # ---- How far? --------------------------------------------------------------------------------------------
        t = -math.log(1.0 - u_distance) / rate
        sight = t if step > 0 else max(t, MEAN_FREE_PATHS_TO_FAR_SIDE / min(sigma_t.x, min(sigma_t.y, sigma_t.z)))
        hit = intersect_instance(scene, instance, o, d, ZERO, sight, NO_FACE.prim)
        comes_out = hit.prim >= 0 and hit.t < t
        if step == 0 and hit.prim >= 0:
            depth = -dot(d, n) * hit.t
        if comes_out:
            t = hit.t

        # ---- What is left? ---------------------------------------------------------------------------------------
        left = attenuation(sigma_t, t)
        density = left if comes_out else sigma_t * left
        if step > 0:
            stretch = 1.0 - cos / nu  # of the mean free path, by guiding: [2], equations 9 and 11
            guided = guided_density(sigma_t * stretch, t, comes_out) * (dwivedi(nu, log_nu, cos) / phase)
            if depth >= 0.0:
                stretch = 1.0 + cos / nu
                back = guided_density(sigma_t * stretch, t, comes_out) * (dwivedi(nu, log_nu, -cos) / phase)
                guided = lerp(guided, back, back_share)
            density = lerp(density, guided, guided_share)
        total = dot(share, density)
        if not total > 0.0:
            return
        beta = beta * (left if comes_out else sigma_s * left) * (1.0 / total)
        if comes_out:
            store3(below, "o", o + d * (2.0 * t))
            store3(below, "d", -d)
            store3(below, "beta", beta)
            below.prim, below.t, below.b1, below.b2 = hit.prim, t, hit.b1, hit.b2
            return
        if max_component(beta) < NEGLIGIBLE:
            return
        # not from `o` in the first step: it may lie further off than a mean free path
        o = (o if step > 0 else entry) + d * t


link.provide(Entry.SUBSURFACE, random_walk, BELOW, BELOW)


# ---- Sampling --------------------------------------------------------------------------------------------------------


@kernel
def uniform(below, number):
    """A random number in [0, 1) of this walk."""
    return to_unit_float(hash_combine(below.seed, np.uint32(number)))


@kernel
def shares(weights):
    """Probabilities of the channels, in proportion to weights."""
    total = weights.x + weights.y + weights.z
    if not total > 0.0:
        return Vec3(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0)
    return weights * (1.0 / total)


@kernel
def of_channel(values, share, u):
    """The value of the channel that `u` chooses."""
    if u < share.x:
        return values.x
    return values.y if u < share.x + share.y else values.z


@kernel
def attenuation(sigma_t, t):
    """What is left of each channel after the distance t (Beer)."""
    return Vec3(math.exp(-sigma_t.x * t), math.exp(-sigma_t.y * t), math.exp(-sigma_t.z * t))


@kernel
def guided_density(sigma_t, t, comes_out):
    """Density of the distance t; or if the light comes out there, the probability to get that far."""
    left = attenuation(sigma_t, t)
    return left if comes_out else sigma_t * left


@kernel
def diffusion_length(albedo):
    """nu, in mean free paths: by which light fades far below a surface. A fit, [3] equation 67."""
    return 1.0 / math.sqrt(1.0 - albedo ** (2.44294 - 0.0215813 * albedo + 0.578637 / albedo))


@kernel
def dwivedi(nu, log_nu, cos):
    """Density per solid angle of guided directions, `cos` to the normal: [2], equation 9."""
    return INV_TWO_PI / ((nu - cos) * log_nu)


@kernel
def without(beta, color):
    """`beta` with the colour taken out again that it was given: the walk itself makes the colour."""
    return Vec3(
        beta.x / color.x if color.x > 0.0 else ZERO,
        beta.y / color.y if color.y > 0.0 else ZERO,
        beta.z / color.z if color.z > 0.0 else ZERO,
    )
