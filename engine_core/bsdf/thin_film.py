# SPDX-License-Identifier: GPL-3.0-or-later
"""Fresnel reflectance under a thin film: the colours of soap and oil.

Belcour and Barla (2017), "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence": light
that is reflected again and again inside the film interferes; the sum over the orders of reflection (their equation 10)
is integrated over wavelengths beforehand, as the Fourier transform of each channel's sensitivity. As Cycles 5: for each
channel of Rec.709 by a table, and conductors with their phases.

`film_ior` and `ior` are relative to where the light comes from; the thickness is in nanometres.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.color import CIE_1931, XYZ_TO_BLUE, XYZ_TO_GREEN, XYZ_TO_RED
from ..linalg.vec3 import Vec3, lerp
from .fresnel import f0_of_ior, f82_b, fresnel_f82
from .lobe import ONE, ZERO

NO_FILM = np.float32(0.1)  # thickness below which there is none
LONGEST = np.float32(60000.0 / (2.0 * np.pi))  # optical path of the last node of the table
NODES = 512
ORDERS = 3


def _sensitivity():
    """(channel, real or imaginary, optical path): mean of exp(-i 2 pi path / wavelength) over what a channel sees."""
    wavelength = np.linspace(380.0, 780.0, CIE_1931.shape[1])
    channels = np.array([tuple(row) for row in (XYZ_TO_RED, XYZ_TO_GREEN, XYZ_TO_BLUE)]) @ CIE_1931.astype(float)
    phase = 2.0 * np.pi * np.linspace(0.0, float(LONGEST), NODES)[:, None] / wavelength
    table = np.exp(-1j * phase) @ channels.T / channels.sum(axis=1)
    return np.ascontiguousarray(np.stack([table.real.T, table.imag.T], axis=1), np.float32)


SENSITIVITY = _sensitivity()


class Interface(NamedTuple):
    """What an interface reflects, for light polarised across (s) and in (p) the plane of incidence."""

    s: np.float32  # reflectances
    p: np.float32
    s_re: np.float32  # phase shifts, exp(i phi)
    s_im: np.float32
    p_re: np.float32
    p_im: np.float32


@kernel
def has_film(lobe):
    return lobe.film_thickness > NO_FILM


@kernel
def film_over_dielectric(cos, thickness, film_ior, ior):
    """Reflectance by colour of a film on something transparent."""
    film_ior = _faded(thickness, film_ior)
    top, cos_film = _dielectric(cos, film_ior)
    if cos_film <= 0.0:
        return Vec3(1.0, 1.0, 1.0)
    bottom, cos_below = _dielectric(cos_film, ior / film_ior)
    if cos_below <= 0.0:
        return Vec3(1.0, 1.0, 1.0)
    path = 2.0 * film_ior * thickness * cos_film
    return Vec3(_airy(0, top, bottom, path), _airy(1, top, bottom, path), _airy(2, top, bottom, path))


@kernel
def film_over_conductor(cos, thickness, film_ior, n, k):
    """Reflectance by colour of a film on a metal, by its complex indices of refraction n + i k."""
    film_ior = _faded(thickness, film_ior)
    top, cos_film = _dielectric(cos, film_ior)
    if cos_film <= 0.0:
        return Vec3(1.0, 1.0, 1.0)
    path = 2.0 * film_ior * thickness * cos_film
    return Vec3(
        _airy(0, top, _conductor(cos_film, film_ior, n.x, k.x), path),
        _airy(1, top, _conductor(cos_film, film_ior, n.y, k.y), path),
        _airy(2, top, _conductor(cos_film, film_ior, n.z, k.z), path),
    )


@kernel
def film_over_f82(cos, thickness, film_ior, f0, b):
    """... on a metal by its colours, see `fresnel_f82`: phases are those of the index that has its reflectances.

    Gulbrandsen (2014), "Artist Friendly Metallic Fresnel", with the reflectance at 82 degrees as the edge's colour.
    """
    film_ior = _faded(thickness, film_ior)
    top, cos_film = _dielectric(cos, film_ior)
    if cos_film <= 0.0:
        return Vec3(1.0, 1.0, 1.0)
    path = 2.0 * film_ior * thickness * cos_film
    edge = fresnel_f82(np.float32(1.0 / 7.0), f0, b)
    return Vec3(
        _airy(0, top, _metal(cos_film, film_ior, f0.x, edge.x), path),
        _airy(1, top, _metal(cos_film, film_ior, f0.y, edge.y), path),
        _airy(2, top, _metal(cos_film, film_ior, f0.z, edge.z), path),
    )


@kernel
def tinted_film(reflectance, ior, f0):
    """The film's reflectance with that of what lies below coloured to `f0` head on: the more, the closer to that."""
    real = f0_of_ior(ior)
    if real <= 1e-5:
        return reflectance
    return Vec3(
        _tinted(reflectance.x, real, f0.x), _tinted(reflectance.y, real, f0.y), _tinted(reflectance.z, real, f0.z)
    )


@kernel
def _tinted(r, real, f0):
    return r * lerp(ONE, f0 / real, min(max((1.0 - r) / (1.0 - real), ZERO), ONE))


@kernel
def _faded(thickness, film_ior):
    """Thinner than a nanometre, waves do not see it."""
    if thickness >= 1.0:
        return film_ior
    return lerp(ONE, film_ior, thickness * thickness * (3.0 - 2.0 * thickness))


# ---- Interfaces ------------------------------------------------------------------------------------------------------


@kernel
def _dielectric(cos, ior):
    """(Interface, cosine of the refracted ray; 0: total reflection)"""
    cos2_t = 1.0 - (1.0 - cos * cos) / (ior * ior)
    if cos2_t <= 0.0:
        return Interface(ONE, ONE, ONE, ZERO, ONE, ZERO), ZERO
    cos_t = math.sqrt(cos2_t)
    s = (cos - ior * cos_t) / (cos + ior * cos_t)
    p = (ior * cos - cos_t) / (ior * cos + cos_t)
    return Interface(s * s, p * p, ONE if s >= 0.0 else -ONE, ZERO, ONE if p >= 0.0 else -ONE, ZERO), cos_t


@kernel
def _conductor(cos, outside, n, k):
    """Of a metal under something of index `outside` (Born and Wolf, Principles of Optics, section 14.4.1)."""
    n2, k2, outside2, nk = n * n, k * k, outside * outside, 2.0 * n * k
    t1 = n2 - k2 - outside2 * (1.0 - cos * cos)
    t2 = math.sqrt(t1 * t1 + nk * nk)
    u2, v2 = max(0.5 * (t2 + t1), 0.0), max(0.5 * (t2 - t1), 0.0)
    u, v, c = math.sqrt(u2), math.sqrt(v2), outside * cos
    s = _ratio((c - u) * (c - u) + v2, (c + u) * (c + u) + v2)
    t3, t4 = (n2 - k2) * cos, nk * cos
    p = _ratio(
        (t3 - outside * u) * (t3 - outside * u) + (t4 - outside * v) * (t4 - outside * v),
        (t3 + outside * u) * (t3 + outside * u) + (t4 + outside * v) * (t4 + outside * v),
    )
    s_re, s_im = _unit(c * c - u2 - v2, -2.0 * c * v)
    square = (n2 + k2) * cos
    p_re, p_im = _unit(square * square - outside2 * (u2 + v2), 2.0 * c * (nk * u - (n2 - k2) * v))
    return Interface(s, p, s_re, s_im, p_re, p_im)


@kernel
def _metal(cos, outside, f0, edge):
    """Of a metal by its reflectances in air, which become those under something else."""
    r = min(f0, 0.999)
    root = math.sqrt(r)
    n = lerp((1.0 + root) / (1.0 - root), (1.0 - r) / (1.0 + r), edge)
    k = math.sqrt(max((r * (n + 1.0) * (n + 1.0) - (n - 1.0) * (n - 1.0)) / (1.0 - r), 0.0))
    bottom = _conductor(cos, outside, n, k)
    a, b = n / outside, k / outside
    head_on = ((a - 1.0) * (a - 1.0) + b * b) / ((a + 1.0) * (a + 1.0) + b * b)
    white = Vec3(head_on, head_on, head_on)
    f = fresnel_f82(cos, white, f82_b(white, Vec3(edge, edge, edge))).x
    return Interface(f, f, bottom.s_re, bottom.s_im, bottom.p_re, bottom.p_im)


@kernel
def _ratio(a, b):
    return a / b if b > 0.0 else ZERO


@kernel
def _unit(re, im):
    size = math.sqrt(re * re + im * im)
    if size == 0.0:
        return ONE, ZERO
    return re / size, im / size


# ---- Interference ----------------------------------------------------------------------------------------------------


@kernel
def _airy(channel, top, bottom, path):
    """The sum over orders of reflection, mean of both polarisations. On the top's inner side the phase is turned."""
    s = _airy_polarised(channel, top.s, bottom.s, path, -top.s_re * bottom.s_re, -top.s_re * bottom.s_im)
    p = _airy_polarised(channel, top.p, bottom.p, path, -top.p_re * bottom.p_re, -top.p_re * bottom.p_im)
    return min(max(0.5 * (s + p), ZERO), ONE)


@kernel
def _airy_polarised(channel, r12, r23, path, re, im):
    t121, r123 = 1.0 - r12, r12 * r23
    again = t121 * t121 * r23 / (1.0 - r123)
    total, order, root = again + r12, again - t121, math.sqrt(r123)
    power_re, power_im = re, im
    for m in range(1, ORDERS + 1):
        order *= root
        at = min(np.float32(m) * path / LONGEST, ONE) * np.float32(NODES - 1)
        i = min(int(at), NODES - 2)
        t = at - np.float32(i)
        s_re = lerp(SENSITIVITY[channel, 0, i], SENSITIVITY[channel, 0, i + 1], t)
        s_im = lerp(SENSITIVITY[channel, 1, i], SENSITIVITY[channel, 1, i + 1], t)
        total += 2.0 * order * (power_re * s_re + power_im * s_im)
        power_re, power_im = power_re * re - power_im * im, power_re * im + power_im * re
    return total
