# SPDX-License-Identifier: GPL-3.0-or-later
"""Shading normals at the corners of faces, as Cycles of the running Blender has them."""

import bpy
import numpy as np


def corner_normals(b_mesh):
    """For each corner (Blender's loops), float32 (loops, 3)."""
    normals = _corner_normals(b_mesh)
    if bpy.app.version >= (5, 0) or b_mesh.has_custom_normals:
        return normals
    flat = flat_corners(b_mesh)
    return np.where(flat[:, None], normals, _across_flat_faces(b_mesh)) if flat.any() and not flat.all() else normals


def _across_flat_faces(b_mesh):
    """Normals that are split at sharp edges only: in Blender 4, Cycles does not split them where smooth faces meet flat
    ones."""
    all_smooth = b_mesh.copy()
    try:
        all_smooth.attributes.remove(all_smooth.attributes["sharp_face"])
        return _corner_normals(all_smooth)
    finally:
        bpy.data.meshes.remove(all_smooth)


def _corner_normals(b_mesh):
    normals = np.empty((len(b_mesh.loops), 3), np.float32)
    b_mesh.corner_normals.foreach_get("vector", normals.ravel())
    return normals


def flat_corners(b_mesh):
    """Which corners belong to flat faces, bool (loops,)."""
    sharp = b_mesh.attributes.get("sharp_face")
    if sharp is None:
        return np.full(len(b_mesh.loops), b_mesh.normals_domain == "FACE")
    flat, totals = np.empty(len(b_mesh.polygons), bool), np.empty(len(b_mesh.polygons), np.int32)
    sharp.data.foreach_get("value", flat)
    b_mesh.polygons.foreach_get("loop_total", totals)
    return np.repeat(flat, totals)
