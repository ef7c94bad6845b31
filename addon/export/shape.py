# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of objects that are marked to be rendered as a sphere, a box or a quad: the shape that fills their bounds.

The bounds are those in the object's own space, so the shape turns and stretches with the object.
"""

import numpy as np

from .mesh import mesh_positions, read

FAR_OFF = 0.02  # of its size: a vertex so far from the surface, or a corner so far from any vertex, is worth a warning


def read_shape(context, name, b_mesh, kind):
    """The number in the builder of the analytic shape that stands for a mesh; None if the mesh is empty."""
    positions = mesh_positions(b_mesh)
    positions = positions[np.isfinite(positions).all(axis=1)].astype(np.float64)
    if not len(positions):
        return None
    low, high = positions.min(axis=0), positions.max(axis=0)
    centre, half = (low + high) / 2.0, (high - low) / 2.0
    if kind == "SPHERE":
        radius = half.max()
        deviation = np.abs(np.linalg.norm(positions - centre, axis=1) - radius).max()
        _warn_if_far(context, name, deviation, radius, "a sphere")
        return context.builder.spheres(name, centre[None], [radius])
    across = int(np.argmin(half))
    if kind == "BOX" and half[across] > 0.0:
        off = np.abs(np.abs(positions - centre) - half).min(axis=1).max()
        _warn_if_far(context, name, max(off, _missing_corner(positions, centre, half)), half.max(), "a box")
        return context.builder.boxes(name, centre[None], half[None])

    # a box without thickness is a quad, too
    deviation = max(half[across], _missing_corner(positions, centre, half))
    _warn_if_far(context, name, deviation, half.max(), "a flat rectangle along the object's axes")
    u, v = np.zeros((2, 1, 3))
    u[0, across - 2], v[0, across - 1] = half[across - 2], half[across - 1]
    if _front(b_mesh)[across] < 0.0:
        v = -v
    return context.builder.quads(name, centre[None], u, v)


def _missing_corner(positions, centre, half):
    """How far the corner of the bounds that is the farthest from all vertices is from them."""
    corners = centre + half * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return max(np.linalg.norm(positions - corner, axis=1).min() for corner in corners)


def _warn_if_far(context, name, deviation, size, what):
    if deviation > FAR_OFF * size:
        context.warn(
            name,
            f"is marked to be rendered as {what}, but its mesh is none: it is off by {deviation:.3g} m (Object "
            "Properties > Shape)",
        )


def _front(b_mesh):
    """The mean normal of the faces, (3,)."""
    if not len(b_mesh.polygons):
        return np.zeros(3)
    return read(b_mesh.polygons, "normal", len(b_mesh.polygons), np.float32, 3).mean(axis=0)
