# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of TRIANGLE, and of LIGHT, for the triangles of a mesh where a transform takes them."""

import numpy as np

from ..jit import builder_kernel
from ..tables import LIGHT, TRIANGLE, LightKind

NOTHING = np.zeros((0, 0, 0), np.float32)


def triangle_rows(mesh, matrix, instance):
    """Rows of TRIANGLE: of a mesh moved by `matrix`, float64 (3, 4), and owned by that row of INSTANCE."""
    rows = np.empty(len(mesh.triangles), TRIANGLE)
    fill_triangles(
        rows,
        mesh.positions,
        mesh.triangles,
        NOTHING if mesh.normals is None else mesh.normals,
        NOTHING if mesh.uvs is None else mesh.uvs,
        np.zeros(0, np.int32) if mesh.slots is None else mesh.slots,
        np.ascontiguousarray(matrix),
        np.ascontiguousarray(inverse(matrix)),
        instance,
    )
    return rows


def inverse(matrices):
    """The inverses of affine transforms (..., 3, 4)."""
    linear = np.linalg.inv(matrices[..., :3])
    return np.concatenate([linear, -linear @ matrices[..., 3:]], axis=-1)


def scales(matrices):
    """By how much affine transforms (n, 3, 4) enlarge what they move; 0 if they stretch it so that angles change."""
    products = np.swapaxes(matrices[..., :3], -1, -2) @ matrices[..., :3]
    square = np.trace(products, axis1=-2, axis2=-1) / 3.0
    change = np.abs(products - square[:, None, None] * np.eye(3)).max(axis=(-2, -1))
    return np.where(change <= 1e-5 * square, np.sqrt(square), 0.0)


def triangle_lights(mesh, numbers, matrix):
    """Rows of LIGHT for triangles of a mesh, by number, as `matrix` (3, 4) moves them; what they emit is left out."""
    return from_corners(mesh.positions[mesh.triangles[numbers]] @ matrix[:, :3].T + matrix[:, 3], matrix)


def from_corners(p, matrix):
    """Rows of LIGHT for triangles with the corners `p`, (n, 3, 3), that `matrix` has moved there."""
    if np.linalg.det(matrix[:, :3]) < 0.0:
        p = p[:, [0, 2, 1]]
    rows = np.zeros(len(p), LIGHT)
    rows["lamp"] = -1
    u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    normal = np.cross(u, v)
    length = np.linalg.norm(normal, axis=1)
    rows["kind"], rows["p"], rows["u"], rows["v"] = LightKind.TRIANGLE, p[:, 0], u, v
    rows["area"] = length / 2.0
    rows["n"] = normal / np.maximum(length, 1e-30)[:, None]
    return rows


@builder_kernel
def fill_triangles(rows, positions, triangles, normals, uvs, slots, matrix, inverted, instance):
    """Fill rows of TRIANGLE: gather corners, move them by `matrix`, and normals by the transpose of `inverted`.

    A transform that mirrors would turn triangles inside out; their second and third corner change places. Moved normals
    are made unit before they are interpolated, as Cycles does with objects that are there once; behind an instance's
    transform that is the other way round, there as here.
    """
    determinant = (
        matrix[0, 0] * (matrix[1, 1] * matrix[2, 2] - matrix[1, 2] * matrix[2, 1])
        - matrix[0, 1] * (matrix[1, 0] * matrix[2, 2] - matrix[1, 2] * matrix[2, 0])
        + matrix[0, 2] * (matrix[1, 0] * matrix[2, 1] - matrix[1, 1] * matrix[2, 0])
    )
    mirrored = determinant < 0.0
    smooth = normals.shape[0] > 0
    p, n = np.zeros((3, 3)), np.zeros(3)
    for i in range(triangles.shape[0]):
        row = rows[i]
        for corner in range(3):
            source = 3 - corner if mirrored and corner > 0 else corner
            vertex = triangles[i, source]
            for k in range(3):
                p[corner, k] = (
                    matrix[k, 0] * positions[vertex, 0]
                    + matrix[k, 1] * positions[vertex, 1]
                    + matrix[k, 2] * positions[vertex, 2]
                    + matrix[k, 3]
                )
                row.p[corner, k] = p[corner, k]
            if uvs.shape[0] > 0:
                row.uv[corner, 0], row.uv[corner, 1] = uvs[i, source, 0], uvs[i, source, 1]
            else:
                row.uv[corner, 0], row.uv[corner, 1] = 0.0, 0.0
        ax, ay, az = p[1, 0] - p[0, 0], p[1, 1] - p[0, 1], p[1, 2] - p[0, 2]
        bx, by, bz = p[2, 0] - p[0, 0], p[2, 1] - p[0, 1], p[2, 2] - p[0, 2]
        n[0], n[1], n[2] = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        length = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
        for k in range(3):
            n[k] = n[k] / length if length > 0.0 else (1.0 if k == 2 else 0.0)
        for corner in range(3):
            source = 3 - corner if mirrored and corner > 0 else corner
            total = 0.0
            if smooth:
                for k in range(3):
                    moved = (
                        inverted[0, k] * normals[i, source, 0]
                        + inverted[1, k] * normals[i, source, 1]
                        + inverted[2, k] * normals[i, source, 2]
                    )
                    row.n[corner, k] = moved
                    total += moved * moved
            scale = 1.0 / np.sqrt(total) if total > 0.0 else 0.0
            for k in range(3):
                row.n[corner, k] = row.n[corner, k] * scale if total > 0.0 else n[k]
        row.slot = slots[i] if slots.shape[0] > 0 else 0
        row.instance = instance
        row.light = -1
