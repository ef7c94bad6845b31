# SPDX-License-Identifier: GPL-3.0-or-later
"""A hair as a dielectric cylinder of rough scales and a coloured inside; the fibre is along x, its surface's normal z.

Chiang, Bitterli, Tappan and Burley, "A Practical and Controllable Hair and Fur Model for Production Path Tracing"
(2016), after Marschner et al. (2003); the notation is theirs. Light takes one of four ways, numbered by p: reflected
(R), through (TT), reflected once inside (TRT), and all that is reflected more often. Each is attenuated by A, spread
along the fibre by M about a cone, and around it by N about the direction that an ideal cylinder would give. It enters
and leaves at one point, and where that is across the fibre, h, the view tells in the frame of the surface: so the model
fits any surface with a tangent. Of the lobe, alpha_x is the variance v along the fibre, alpha_r that of what the scales
reflect, alpha_y the scale s around it; f82 what is absorbed in one radius, and `g` the sine of the tilt of the scales.

M and N are densities, so a white hair loses nothing, and `albedo` is exact. Light counts by angles, without a cosine.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, WHITE, Vec3, average, load3
from ..sampling.warp import angle_of, cos_sin_turn
from .fresnel import fresnel_dielectric
from .lobe import ONE, ZERO, LobeSample, LobeValue

PI, INV_TWO_PI = np.float32(np.pi), np.float32(0.5 / np.pi)
TWO_PI = np.float32(2.0 * np.pi)
WAYS, REST = 4, 3
LEAST_VARIANCE, LEAST_ACROSS = np.float32(5e-7), np.float32(1e-6)


class Fibre(NamedTuple):
    """What the view alone decides."""

    sin_o: float  # of the angle between the view and the plane across the fibre
    cos_o: float
    y: float  # unit direction of the view around the fibre
    z: float
    gamma_o: float  # angle between that and the normal, outside ...
    gamma_t: float  # ... and inside
    reflected: float  # Fresnel
    passing: Vec3  # what is not absorbed on one way through


# ---- The trio --------------------------------------------------------------------------------------------------------


@kernel
def evaluate_and_pdf(lobe, wo, wi):
    fibre = fibre_of(lobe, wo)
    around = angle_of(fibre.y * wi.z - fibre.z * wi.y, fibre.y * wi.y + fibre.z * wi.z)
    return _scattered(lobe, fibre, wi.x, around)


@kernel
def sample(lobe, wo, u_choice, u0, u1):
    fibre = fibre_of(lobe, wo)
    p, u = _choose_way(fibre, u_choice)
    # Along the fibre: M, by inverting it (d'Eon et al. 2013, "A Fiber Scattering Model With Non-Separable Lobes")
    v = _variance(lobe, p)
    sin_t, cos_t = _tilted(lobe, fibre, p)
    height = -v * math.log(max(u0, 1e-5) + (1.0 - u0) * math.exp(-2.0 / v))  # 1 - cosine about the cone
    x = -(1.0 - height) * sin_t + math.sqrt(max(height * (2.0 - height), ZERO)) * cos_sin_turn(u1)[0] * cos_t
    x = min(max(x, -ONE), ONE)
    # Around it: N
    around = TWO_PI * u if p == REST else _turn(fibre, p) + _sample_logistic(u, lobe.alpha_y)
    turn = around * INV_TWO_PI
    c, s = cos_sin_turn(turn - np.float32(math.floor(turn)))
    across = math.sqrt(max(1.0 - x * x, ZERO))
    wi = Vec3(x, across * (fibre.y * c - fibre.z * s), across * (fibre.z * c + fibre.y * s))
    value = _scattered(lobe, fibre, x, around)
    if not value.pdf > 0.0:
        return LobeSample(wi, BLACK, ZERO, False)
    return LobeSample(wi, value.f * (1.0 / value.pdf), value.pdf, False)


@kernel
def albedo(lobe, wo):
    fibre, total = fibre_of(lobe, wo), BLACK
    for p in range(WAYS):
        total = total + attenuation(fibre, p)
    return total


@kernel
def goes_through(lobe, wo, u_choice):
    """Whether the direction that `sample` gives for `u_choice` has been inside of the fibre."""
    return _choose_way(fibre_of(lobe, wo), u_choice)[0] > 0


# ---- Ways through the fibre ------------------------------------------------------------------------------------------


@kernel
def fibre_of(lobe, wo):
    across = math.sqrt(wo.y * wo.y + wo.z * wo.z)
    if across > LEAST_ACROSS:
        y, z = wo.y / across, wo.z / across
    else:
        y, z = ZERO, ONE
    sin_o = min(max(wo.x, -ONE), ONE)
    cos_o = min(across, ONE)
    h = -y
    cos_gamma = math.sqrt(max(1.0 - h * h, ZERO))
    ior = lobe.ior
    sin_inside = min(max(h * cos_o / math.sqrt(max(ior * ior - sin_o * sin_o, 1e-6)), -ONE), ONE)
    cos_inside = math.sqrt(1.0 - sin_inside * sin_inside)
    cos_t = math.sqrt(max(1.0 - sin_o * sin_o / (ior * ior), 1e-6))
    reflected, _ = fresnel_dielectric(cos_o * cos_gamma, ior)
    depth = load3(lobe, "f82") * (-2.0 * cos_inside / cos_t)
    passing = Vec3(math.exp(depth.x), math.exp(depth.y), math.exp(depth.z))
    return Fibre(sin_o, cos_o, y, z, angle_of(h, cos_gamma), angle_of(sin_inside, cos_inside), reflected, passing)


@kernel
def attenuation(fibre, p):
    """A of the way p: Fresnel's shares and what is absorbed (equations 12 and 13); of the last, the sum of the rest."""
    f = fibre.reflected
    if p == 0:
        return WHITE * f
    passing = fibre.passing
    A = passing * ((1.0 - f) * (1.0 - f))
    if p == 1:
        return A
    inside = passing * f
    A = A * inside
    if p == 2:
        return A
    if f >= 1.0:
        return BLACK
    return Vec3(A.x * inside.x / (1.0 - inside.x), A.y * inside.y / (1.0 - inside.y), A.z * inside.z / (1.0 - inside.z))


@kernel
def _choose_way(fibre, u):
    """(p, u as good as new): each as often as it brings light."""
    total = ZERO
    for p in range(WAYS):
        total += average(attenuation(fibre, p))
    chosen, rest, share = 0, u * total, ZERO
    for p in range(WAYS):
        own = average(attenuation(fibre, p))
        if own > 0.0:
            chosen, share = p, own
            if rest < own:
                break
            rest -= own
    return chosen, min(rest / share, ONE) if share > 0.0 else ZERO


@kernel
def _scattered(lobe, fibre, sin_i, around):
    """What goes to the angle with that sine, and so far around from the view."""
    cos_i = math.sqrt(max(1.0 - sin_i * sin_i, ZERO))
    f, density, total = BLACK, ZERO, ZERO
    norm = 1.0 / (_logistic_cdf(PI, lobe.alpha_y) - _logistic_cdf(-PI, lobe.alpha_y))
    for p in range(WAYS):
        A = attenuation(fibre, p)
        share = average(A)
        if share > 0.0:
            sin_t, cos_t = _tilted(lobe, fibre, p)
            spread = along(sin_i, cos_i, sin_t, cos_t, _variance(lobe, p))
            if p == REST:
                spread *= INV_TWO_PI
            else:
                spread *= norm * _logistic(_wrapped(around - _turn(fibre, p)), lobe.alpha_y)
            f, density, total = f + A * spread, density + share * spread, total + share
    return LobeValue(f, density / total if total > 0.0 else ZERO)


@kernel
def _variance(lobe, p):
    if p == 0:
        return max(lobe.alpha_r, LEAST_VARIANCE)
    return 0.25 * lobe.alpha_x if p == 1 else 4.0 * lobe.alpha_x


@kernel
def _turn(fibre, p):
    """How far around the fibre an ideal cylinder sends the way p."""
    ways = np.float32(p)
    return 2.0 * ways * fibre.gamma_t - 2.0 * fibre.gamma_o + ways * PI


@kernel
def _tilted(lobe, fibre, p):
    """(sine, cosine) of the view's angle, turned by what the scales do to the way p: 2, -1, -4 times their tilt."""
    s1 = lobe.g
    c1 = math.sqrt(max(1.0 - s1 * s1, ZERO))
    s2, c2 = 2.0 * s1 * c1, c1 * c1 - s1 * s1
    if p == 0:
        s, c = s2, c2
    elif p == 1:
        s, c = -s1, c1
    elif p == 2:
        s, c = -2.0 * s2 * c2, c2 * c2 - s2 * s2
    else:
        s, c = ZERO, ONE
    return fibre.sin_o * c + fibre.cos_o * s, abs(fibre.cos_o * c - fibre.sin_o * s)


# ---- M and N ---------------------------------------------------------------------------------------------------------


@kernel
def along(sin_i, cos_i, sin_o, cos_o, v):
    """M: a density over the sphere (without 1 / 2 pi), for a cone of the sine -sin_o (d'Eon et al. 2011, equation 7).

    I0(a) exp(-b - 1/v) / (v (1 - exp(-2/v))) for a = cos cos / v and b = sin sin / v, where the exponents are taken
    together before they grow: cos_i cos_o - sin_i sin_o - 1 = -((cos_i - cos_o)^2 + (sin_i + sin_o)^2) / 2.
    """
    c, s = cos_i - cos_o, sin_i + sin_o
    return math.exp(-0.5 * (c * c + s * s) / v) * scaled_bessel(cos_i * cos_o / v) / (v * (1.0 - math.exp(-2.0 / v)))


@kernel
def scaled_bessel(x):
    """I0(x) exp(-x) for x >= 0, the modified Bessel function (Abramowitz and Stegun 1964, 9.8.1 and 9.8.2)."""
    if x < 3.75:
        t = x * x * np.float32(1.0 / 14.0625)
        t = 1.0 + t * (
            3.5156229 + t * (3.0899424 + t * (1.2067492 + t * (0.2659732 + t * (0.0360768 + t * 0.0045813))))
        )
        return t * math.exp(-x)
    t = 3.75 / x
    high = -0.02057706 + t * (0.02635537 + t * (-0.01647633 + t * 0.00392377))
    low = 0.39894228 + t * (0.01328592 + t * (0.00225319 + t * (-0.00157565 + t * (0.00916281 + t * high))))
    return low / math.sqrt(x)


@kernel
def _logistic(x, s):
    e = math.exp(-abs(x) / s)
    return e / (s * (1.0 + e) * (1.0 + e))


@kernel
def _logistic_cdf(x, s):
    return 1.0 / (1.0 + math.exp(min(-x / s, 80.0)))


@kernel
def _sample_logistic(u, s):
    """An angle from -pi to pi."""
    low = _logistic_cdf(-PI, s)
    u = low + u * (1.0 - 2.0 * low)
    x = -s * math.log(1.0 / max(u, np.float32(1e-30)) - 1.0) if u < 1.0 else PI
    return min(max(x, -PI), PI)


@kernel
def _wrapped(angle):
    """The same angle from -pi to pi."""
    return angle - TWO_PI * np.float32(math.floor(angle * INV_TWO_PI + 0.5))
