# SPDX-License-Identifier: GPL-3.0-or-later
"""Questions to an analytic shape of any kind: a row of SHAPE."""

import numpy as np

from ..jit import kernel
from ..linalg.frame import frame_from_normal
from ..tables import ShapeKind
from . import box, disk, quad, sphere, strand


@kernel
def intersect(shape, o, d, t_min, t_max):
    """First hit of the ray o + t d with t_min < t < t_max; t is infinite when there is none. `d` need not be unit."""
    if shape.kind == ShapeKind.SPHERE:
        return sphere.intersect(shape, o, d, t_min, t_max)
    if shape.kind == ShapeKind.QUAD:
        return quad.intersect(shape, o, d, t_min, t_max)
    if shape.kind == ShapeKind.BOX:
        return box.intersect(shape, o, d, t_min, t_max)
    if shape.kind == ShapeKind.STRAND:
        return strand.intersect(shape, o, d, t_min, t_max)
    if shape.kind == ShapeKind.DISK:
        return disk.intersect(shape, o, d, t_min, t_max)
    return disk.intersect_facing(shape, o, d, t_min, t_max)


@kernel
def geometric_normal(shape, o, p):
    """Unit normal at `p`, out of the front, whichever side the ray from `o` came from."""
    if shape.kind == ShapeKind.SPHERE:
        return sphere.normal(shape, p)
    if shape.kind == ShapeKind.BOX:
        return box.normal(shape, p)
    if shape.kind == ShapeKind.STRAND:
        return strand.normal(shape, p)
    if shape.kind == ShapeKind.FACING_DISK:
        return disk.normal_facing(shape, o)
    return quad.normal(shape, p)


@kernel
def snap(shape, p):
    """`p`, which lies on the shape but for the rounding of o + t d, moved onto it."""
    if shape.kind == ShapeKind.SPHERE:
        return sphere.snap(shape, p)
    if shape.kind == ShapeKind.BOX:
        return box.snap(shape, p)
    if shape.kind == ShapeKind.STRAND:
        return strand.snap(shape, p)
    if shape.kind == ShapeKind.FACING_DISK:
        return p
    return quad.snap(shape, p)


@kernel
def uv(shape, p):
    """Texture coordinates (u, v) of the point `p` of the shape. A facing disk has none: 0.5, 0.5."""
    if shape.kind == ShapeKind.SPHERE:
        return sphere.uv(shape, p)
    if shape.kind == ShapeKind.BOX:
        return box.uv(shape, p)
    if shape.kind == ShapeKind.STRAND:
        return strand.uv(shape, p)
    if shape.kind == ShapeKind.FACING_DISK:
        return np.float32(0.5), np.float32(0.5)
    return quad.uv(shape, p)


@kernel
def tangent(shape, p):
    """A direction along the surface at `p`; not unit."""
    if shape.kind == ShapeKind.STRAND:
        return strand.tangent(shape, p)
    s, _ = frame_from_normal(geometric_normal(shape, p, p))
    return s


def bounds(shapes):
    """Boxes around rows of SHAPE: lo, hi, float32 (n, 3). They contain the shapes, rounded outwards."""
    kind = shapes["kind"][:, None]
    u, v = shapes["u"].astype(np.float64), shapes["v"].astype(np.float64)
    ball = np.repeat(shapes["radius"].astype(np.float64)[:, None], 3, axis=1)
    flat = np.abs(u) + np.abs(v)
    kinds = {ShapeKind.QUAD: flat, ShapeKind.DISK: np.hypot(u, v), ShapeKind.BOX: flat + ball * np.abs(_across(u, v))}
    half = np.select([kind == k for k in kinds], list(kinds.values()), ball)
    centre = shapes["p"].astype(np.float64)
    hairs = shapes["kind"] == ShapeKind.STRAND
    if hairs.any():
        centre[hairs] += 0.5 * u[hairs]
        half[hairs] = _half_of_strands(u[hairs], np.maximum(shapes["radius"], shapes["radius_end"])[hairs])
    lo, hi = (centre - half).astype(np.float32), (centre + half).astype(np.float32)
    return np.nextafter(lo, np.float32(-np.inf)), np.nextafter(hi, np.float32(np.inf))


def _half_of_strands(u, radius):
    """Half sizes of boxes around cylinders along `u` that are longer by `radius` at both ends."""
    axis = np.abs(u) / np.maximum(np.linalg.norm(u, axis=1, keepdims=True), 1e-300)
    return 0.5 * np.abs(u) + radius[:, None] * (axis + np.sqrt(np.maximum(1.0 - axis**2, 0.0)))


def _across(u, v):
    """Unit vectors along u x v, (n, 3); zero where that is."""
    n = np.cross(u, v)
    return n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
