# SPDX-License-Identifier: GPL-3.0-or-later
"""A hair as a cylinder of glass with rough, tilted scales; the fibre is along x, its surface's normal z.

Huang, Hullin and Hanika, "A Microfacet-based Hair Scattering Model" (2022), of round cross-sections. At each of three
places where light meets the surface there is a GGX microfacet: it is reflected (R), or goes through (TT), or is
reflected once inside (TRT); what is reflected more often leaves as in `hair`. Cycles integrates over the breadth of
the hair and over the microfacets on the way; here the view tells where across the hair it is, and the microfacets that
light meets before the last one are drawn by the bits of the view's direction. So each view has a sum of four plain
densities, which are sampled exactly; and a pixel, whose rays all hit elsewhere, has the model's.

Of the lobe, alpha_x = alpha_y is the roughness, f0 how much of R, TT and TRT there is, f82 what is absorbed in one
radius, g the sine of the tilt. Light counts by angles, without a cosine.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.frame import frame_from_normal
from ..linalg.vec3 import BLACK, WHITE, Vec3, average, dot, load3, normalize, reflect
from ..sampling.rng import hash_float
from ..sampling.warp import cos_sin_turn
from . import energy, hair, microfacet
from .fresnel import fresnel_dielectric
from .lobe import ONE, ZERO, LobeSample, LobeValue, no_direction

REST = 3  # number of the last way
INV_TWO_PI = np.float32(0.5 / np.pi)
LEAST_ESCAPE = np.float32(0.35)  # of what meets the surface from inside, for sampling alone: rough scales let some pass
STEPS = np.float32(2.0**20)  # of components of directions
LEAST_THROUGH = np.float32(1e-5)


class Wall(NamedTuple):
    """A place where light meets the surface, from the side that it comes from."""

    v: Vec3  # back along the light's way
    n: Vec3  # normals of the cylinder and ...
    m: Vec3  # ... of the scale, on that side
    s: Vec3  # at right angles to the scale's
    t: Vec3
    ior: float  # far side over near side
    scale: float  # what makes up for the energy that single scattering loses
    color: Vec3  # what arrives


# ---- The trio --------------------------------------------------------------------------------------------------------


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    first, second, third, rest = _walls(lobe, wo)
    return _scattered(lobe, wo, wi, first, second, third, rest)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    first, second, third, rest = _walls(lobe, wo)
    way, u = _choose_way(lobe, first, second, third, rest, u_choice)
    if way < 0:
        return no_direction()
    if way == REST:
        wi = _spread(lobe, wo, u, u0, u1)
    else:
        wall = first if way == 0 else (second if way == 1 else third)
        v = _into(wall, wall.v)
        h = _out_of(wall, microfacet.sample_visible_normal(lobe, v, microfacet.stretched_length(lobe, v), u0, u1))
        cos_h = dot(wall.v, h)
        _, cos_t = fresnel_dielectric(cos_h, wall.ior)
        if way == 0:
            wi = reflect(wall.v, h)
        else:
            wi = microfacet.refract(wall.v, h, cos_h, cos_t, wall.ior)
            if cos_t == 0.0:
                return no_direction()
        if _last(lobe, wall, wi, ONE if way == 0 else wall.ior)[1] <= 0.0:  # on a side where its facet does not lead
            return no_direction()
    value = _scattered(lobe, wo, wi, first, second, third, rest)
    if not value.pdf > 0.0:
        return no_direction()
    return LobeSample(wi, value.f * (1.0 / value.pdf), value.pdf, False)


@kernel
def albedo(lobe, wo):
    """An estimate: as if the last microfacet on each way were as its scale."""
    first, second, third, rest = _walls(lobe, wo)
    shares = load3(lobe, "f0")
    R = _reflected(first) if first.color.x > 0.0 else ZERO
    once, twice = second.color * (1.0 - _reflected(second)), third.color * (1.0 - _reflected(third))
    return WHITE * (shares.x * R) + once * shares.y + (twice + rest) * shares.z


@kernel
def goes_through(lobe, wo, u_choice):
    """Whether the direction that `sample` gives for `u_choice` has been inside of the hair."""
    first, second, third, rest = _walls(lobe, wo)
    return _choose_way(lobe, first, second, third, rest, u_choice)[0] > 0


# ---- The way of the light --------------------------------------------------------------------------------------------


@kernel
def _walls(lobe, wo):
    """(first, second, third Wall, colour of what is reflected more than once inside), by the bits of wo."""
    n = Vec3(0.0, 0.0, 1.0)
    first = _wall(lobe, wo, n, -lobe.g, lobe.ior, WHITE)
    t, color = _through(lobe, first, wo, 0)
    n, depth = _across(n, t)
    color = color * _passing(lobe, t, depth)
    inside = 1.0 / lobe.ior
    second = _wall(lobe, -t, -n, lobe.g, inside, color)
    p, color = _back(lobe, second, wo, 2)
    n, depth = _across(n, p)
    color = color * _passing(lobe, p, depth)
    third = _wall(lobe, -p, -n, lobe.g, inside, color)
    _, color = _back(lobe, third, wo, 4)
    return first, second, third, color * _series(third, _passing(lobe, p, depth))


@kernel
def _wall(lobe, v, n, tilt, ior, color):
    """`tilt`: how far the scale's normal leans towards the tip, as a sine. Nothing arrives from behind."""
    m = n * math.sqrt(max(1.0 - tilt * tilt, ZERO)) + Vec3(tilt, ZERO, ZERO)
    s, t = frame_from_normal(m)
    cos = dot(v, m)
    if cos <= 0.0 or dot(v, n) <= 0.0:
        return Wall(v, n, m, s, t, ior, ONE, BLACK)
    share = energy.glass_share(ior, lobe.alpha_x, cos)
    return Wall(v, n, m, s, t, ior, 1.0 / share, color)


@kernel
def _through(lobe, wall, wo, number):
    """(direction, colour) of what a microfacet refracts that is drawn by wo."""
    v = _into(wall, wall.v)
    so = microfacet.stretched_length(lobe, v)
    h = microfacet.sample_visible_normal(lobe, v, so, _random(wo, number), _random(wo, number + 1))
    cos_h = dot(v, h)
    F, cos_t = fresnel_dielectric(cos_h, wall.ior)
    t = microfacet.refract(v, h, cos_h, cos_t, wall.ior)
    out = _out_of(wall, t)
    if cos_t == 0.0 or t.z >= 0.0 or dot(out, wall.n) >= 0.0:
        return out, BLACK
    return out, wall.color * ((1.0 - F) * wall.scale * microfacet.unshadowed(lobe, v, so, t))


@kernel
def _back(lobe, wall, wo, number):
    """The same of what it reflects."""
    v = _into(wall, wall.v)
    so = microfacet.stretched_length(lobe, v)
    h = microfacet.sample_visible_normal(lobe, v, so, _random(wo, number), _random(wo, number + 1))
    F, _ = fresnel_dielectric(dot(v, h), wall.ior)
    p = reflect(v, h)
    out = _out_of(wall, p)
    if p.z <= 0.0 or dot(out, wall.n) <= 0.0:
        return out, BLACK
    return out, wall.color * (F * wall.scale * microfacet.unshadowed(lobe, v, so, p))


@kernel
def _across(n, d):
    """(outer normal where a ray leaves the cylinder that begins at the normal n, how far that is in radii)."""
    y, z = d.y, d.z
    cos = n.y * y + n.z * z
    size2 = max(y * y + z * z, LEAST_THROUGH)
    far = -2.0 * cos / size2
    return Vec3(ZERO, n.y + far * y, n.z + far * z), max(far, ZERO)


@kernel
def _passing(lobe, d, far):
    depth = load3(lobe, "f82") * -far
    return Vec3(math.exp(depth.x), math.exp(depth.y), math.exp(depth.z))


@kernel
def _series(wall, passing):
    """How much gets out some time of what is reflected here, if always as much does as here: a geometric series."""
    out = max(1.0 - _reflected(wall), LEAST_THROUGH)
    return Vec3(
        passing.x * out / (1.0 - passing.x * (1.0 - out)),
        passing.y * out / (1.0 - passing.y * (1.0 - out)),
        passing.z * out / (1.0 - passing.z * (1.0 - out)),
    )


@kernel
def _random(wo, number):
    """By rounded components, which do not depend on the order in which they were computed."""
    return hash_float(np.uint32(_steps(wo.y)), np.uint32(_steps(wo.x)), np.uint32(number))


@kernel
def _steps(x):
    return np.int32(math.floor(x * STEPS))


# ---- Four densities --------------------------------------------------------------------------------------------------


@kernel
def _choose_way(lobe, first, second, third, rest, u):
    """(number of the way, u as good as new); -1 if there is none."""
    shares = load3(lobe, "f0")
    R, TT, TRT, more = _energies(shares, first, second, third, rest)
    total = R + TT + TRT + more
    if not total > 0.0:
        return -1, ZERO
    left = u * total
    if left < R:
        return 0, left / R
    left -= R
    if left < TT:
        return 1, left / TT
    left -= TT
    if left < TRT or more <= 0.0:
        return 2, min(left / TRT, ONE) if TRT > 0.0 else ZERO
    return REST, min((left - TRT) / more, ONE)


@kernel
def _energies(shares, first, second, third, rest):
    """How often each way is chosen: about as much light as it brings."""
    R = shares.x * _reflected(first) if first.color.x > 0.0 else ZERO
    TT = shares.y * average(second.color) * _escape(second)
    TRT = shares.z * average(third.color) * _escape(third)
    return R, TT, TRT, shares.z * average(rest)


@kernel
def _escape(wall):
    return max(1.0 - _reflected(wall), LEAST_ESCAPE)


@kernel
def _reflected(wall):
    """Share that a smooth scale reflects."""
    return fresnel_dielectric(max(dot(wall.v, wall.m), ZERO), wall.ior)[0]


@kernel
def _scattered(lobe, wo, wi, first, second, third, rest):
    shares = load3(lobe, "f0")
    R, TT, TRT, more = _energies(shares, first, second, third, rest)
    total = R + TT + TRT + more
    if not total > 0.0:
        return LobeValue(BLACK, ZERO)
    f, density = BLACK, ZERO
    if R > 0.0:
        scale, p = _last(lobe, first, wi, ONE)
        f, density = f + WHITE * (shares.x * scale), density + R * p
    if TT > 0.0:
        scale, p = _last(lobe, second, wi, second.ior)
        f, density = f + second.color * (shares.y * scale), density + TT * p
    if TRT > 0.0:
        scale, p = _last(lobe, third, wi, third.ior)
        f, density = f + third.color * (shares.z * scale), density + TRT * p
    if more > 0.0:
        cos_i, cos_o = math.sqrt(max(1.0 - wi.x * wi.x, ZERO)), math.sqrt(max(1.0 - wo.x * wo.x, ZERO))
        p = INV_TWO_PI * hair.along(wi.x, cos_i, wo.x, cos_o, 4.0 * lobe.alpha_x)
        f, density = f + rest * (shares.z * p), density + more * p
    return LobeValue(f, density / total)


@kernel
def _last(lobe, wall, wi, ior):
    """(share of what arrives that a microfacet sends to wi, density to sample it); `ior` 1: by reflection."""
    side = ONE if ior == 1.0 else -ONE
    v, w = _into(wall, wall.v), _into(wall, wi)
    if side * w.z <= 0.0 or side * dot(wi, wall.n) <= 0.0:
        return ZERO, ZERO
    h, cos_h, jacobian = microfacet.half_vector(lobe, v, w, ior)
    if jacobian == 0.0 or dot(_out_of(wall, h), wall.n) <= 0.0:
        return ZERO, ZERO
    F, _ = fresnel_dielectric(cos_h, wall.ior)
    so = microfacet.stretched_length(lobe, v)
    density = microfacet.visible_normal_pdf(lobe, v, so, h, cos_h) * jacobian
    share = F if ior == 1.0 else 1.0 - F
    return density * share * wall.scale * microfacet.unshadowed(lobe, v, so, w), density


@kernel
def _spread(lobe, wo, u, u0, u1):
    """A direction of those that have been reflected often: about a cone along the hair, and anywhere around it."""
    v = 4.0 * lobe.alpha_x
    cos_o = math.sqrt(max(1.0 - wo.x * wo.x, ZERO))
    height = -v * math.log(max(u0, 1e-5) + (1.0 - u0) * math.exp(-2.0 / v))
    x = -(1.0 - height) * wo.x + math.sqrt(max(height * (2.0 - height), ZERO)) * cos_sin_turn(u1)[0] * cos_o
    x = min(max(x, -ONE), ONE)
    across = math.sqrt(max(1.0 - x * x, ZERO))
    c, s = cos_sin_turn(u)
    return normalize(Vec3(x, across * c, across * s))


@kernel
def _into(wall, w):
    return Vec3(dot(wall.s, w), dot(wall.t, w), dot(wall.m, w))


@kernel
def _out_of(wall, w):
    return wall.s * w.x + wall.t * w.y + wall.m * w.z
