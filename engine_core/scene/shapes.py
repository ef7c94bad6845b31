# SPDX-License-Identifier: GPL-3.0-or-later
"""Analytic shapes of a scene: rows of SHAPE, where a transform takes them, and the lights that they are."""

from dataclasses import dataclass

import numpy as np

from ..shape.dispatch import bounds
from ..tables import LIGHT, SHAPE, LightKind, ShapeKind
from . import checks

RIGHT_ANGLE = 1e-5  # largest cosine between edges that still count as perpendicular
LIGHT_KINDS = {ShapeKind.SPHERE: LightKind.SPHERE, ShapeKind.QUAD: LightKind.QUAD, ShapeKind.BOX: LightKind.BOX}


@dataclass
class Shapes:
    """Analytic shapes of one kind in object space."""

    name: str
    rows: np.ndarray  # SHAPE

    @property
    def centres(self):
        return self.rows["p"]

    @property
    def radii(self):
        return self.rows["radius"]

    @property
    def texture_space(self):
        """(scale, offset) from positions to generated coordinates: 0 to 1 over the box around all of them."""
        if not len(self.rows):
            return np.ones(3), np.zeros(3)
        low, high = (limit.astype(np.float64) for limit in bounds(self.rows))
        low, high = low.min(axis=0), high.max(axis=0)
        size = np.maximum(high - low, 1e-30)
        return 1.0 / size, -low / size


def spheres(name, centres, radii):
    centres = checks.positions(name, "sphere centres", centres)
    radii = checks.array(name, "sphere radii", radii, np.float32, len(centres))
    if radii.size and radii.min() < 0:
        raise checks.SceneError(f"{name}: a sphere has radius {radii.min():g}")
    return Shapes(name, _rows(ShapeKind.SPHERE, centres, radius=radii)[radii > 0])


def boxes(name, centres, half_sizes):
    centres = checks.positions(name, "box centres", centres)
    half = checks.array(name, "half sizes of boxes", half_sizes, np.float32, len(centres), 3)
    if half.size and half.min() < 0:
        raise checks.SceneError(f"{name}: a box has half size {half.min():g}")
    u, v = np.zeros((2, len(half), 3), np.float32)
    u[:, 0], v[:, 1] = half[:, 0], half[:, 1]
    return Shapes(name, _rows(ShapeKind.BOX, centres, u, v, half[:, 2])[(half > 0).all(axis=1)])


def quads(name, centres, u, v):
    centres = checks.positions(name, "quad centres", centres)
    u = checks.array(name, "half edges u", u, np.float32, len(centres), 3)
    v = checks.array(name, "half edges v", v, np.float32, len(centres), 3)
    return Shapes(name, _rows(ShapeKind.QUAD, centres, u, v)[np.cross(u, v).any(axis=1)])


def _rows(kind, centres, u=0.0, v=0.0, radius=0.0):
    rows = np.zeros(len(centres), SHAPE)
    rows["kind"], rows["p"], rows["u"], rows["v"], rows["radius"], rows["instance"] = kind, centres, u, v, radius, -1
    rows["light"], rows["number"] = -1, np.arange(len(centres))
    return rows


def moved(rows, matrix):
    """Rows of SHAPE as `matrix`, float64 (3, 4), moves them; their fronts stay fronts under one that mirrors."""
    linear = matrix[:, :3]
    mirrors = np.linalg.det(linear) < 0.0
    result = rows.copy()
    u, v = rows["u"] @ linear.T, rows["v"] @ linear.T
    result["p"] = rows["p"] @ linear.T + matrix[:, 3]
    hairs = rows["kind"] == ShapeKind.STRAND
    result["u"], result["v"] = u, np.where(hairs[:, None], v, -v) if mirrors else v
    # a sphere's radius along x, that of a box along its third edge
    third = np.cross(rows["u"], rows["v"])
    third /= np.maximum(np.linalg.norm(third, axis=1, keepdims=True), 1e-30)
    third[(rows["kind"] == ShapeKind.SPHERE) | hairs] = 1.0, 0.0, 0.0
    stretch = np.linalg.norm(third @ linear.T, axis=1)
    result["radius"], result["radius_end"] = rows["radius"] * stretch, rows["radius_end"] * stretch
    if hairs.any():
        v, w = v[hairs], rows["w"][hairs] @ linear.T
        result["v"][hairs] = v / np.linalg.norm(v, axis=1, keepdims=True)
        result["w"][hairs] = w / np.linalg.norm(w, axis=1, keepdims=True)
    return result


def keeps_shapes(rows, matrix):
    """Whether `moved` gives shapes that are hit, and mapped, as the ones behind that transform are: bool.

    Textures on spheres and boxes turn with them, which rows in the world's space cannot say of a sphere that is turned,
    nor of a shape that is mirrored.
    """
    linear = matrix[:, :3]
    if (rows["kind"] == ShapeKind.STRAND).any():
        gram = linear.T @ linear
        return np.allclose(gram, np.eye(3) * gram[0, 0], atol=RIGHT_ANGLE * gram[0, 0])
    if np.linalg.det(linear) < 0.0:
        return False
    if (rows["kind"] == ShapeKind.SPHERE).any():
        return np.allclose(linear, np.eye(3) * linear[0, 0], atol=RIGHT_ANGLE * abs(linear[0, 0]))
    return bool(stay_themselves(rows[rows["kind"] == ShapeKind.BOX], matrix).all())


def stay_themselves(rows, matrix):
    """Which shapes `matrix` leaves what they are, bool (n,): round spheres, boxes and rectangles with right angles."""
    linear = matrix[:, :3]
    gram = linear.T @ linear
    is_round = np.allclose(gram, np.eye(3) * gram[0, 0], atol=RIGHT_ANGLE * gram[0, 0])
    u, v = rows["u"].astype(np.float64), rows["v"].astype(np.float64)
    w = np.cross(u, v)
    u, v, w = u @ linear.T, v @ linear.T, w @ linear.T
    square = _perpendicular(u, v)
    kind = rows["kind"]
    flat_or_square = (kind == ShapeKind.QUAD) | (_perpendicular(u, w) & _perpendicular(v, w))
    return np.where(kind == ShapeKind.SPHERE, is_round, square & flat_or_square) & (kind != ShapeKind.STRAND)


def _perpendicular(a, b):
    scale = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    return np.abs((a * b).sum(axis=1)) <= RIGHT_ANGLE * scale


def lights(rows):
    """Rows of LIGHT for rows of SHAPE in the world's space; what they emit is left to the caller."""
    result = np.zeros(len(rows), LIGHT)
    result["lamp"] = -1
    u, v = rows["u"].astype(np.float64), rows["v"].astype(np.float64)
    radius = rows["radius"].astype(np.float64)
    n = np.cross(u, v)
    face = np.linalg.norm(n, axis=1)
    kinds = [rows["kind"] == kind for kind in LIGHT_KINDS]
    sides = np.linalg.norm(u, axis=1) + np.linalg.norm(v, axis=1)
    result["kind"] = np.select(kinds, list(LIGHT_KINDS.values()))
    result["area"] = np.select(kinds, [4.0 * np.pi * radius**2, 4.0 * face, 8.0 * (face + radius * sides)])
    for name in ("p", "u", "v", "radius"):
        result[name] = rows[name]
    result["n"] = n / np.maximum(face, 1e-30)[:, None]
    result["spread"] = np.inf
    return result
