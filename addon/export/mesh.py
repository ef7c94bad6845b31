# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry as arrays: triangles of a mesh, spheres of a point cloud.

Only ways that copy a whole array at once are used. For a mesh of 524,000 triangles: positions by the attribute 1 ms,
through `vertices` 12 ms; corners by `.corner_vert` 1 ms, through `loop_triangles` 150 ms.
"""

from typing import NamedTuple

import numpy as np

from .attributes import mesh_attributes
from .normals import corner_normals

DEFAULT_RADIUS = 0.01  # of a point without a radius, in metres, as in Cycles


class MeshArrays(NamedTuple):
    """What SceneBuilder.mesh takes."""

    positions: np.ndarray  # float32 (v, 3)
    triangles: np.ndarray  # int32 (n, 3)
    normals: np.ndarray | None  # float32 (n, 3, 3)
    uvs: np.ndarray | None  # float32 (n, 3, 2)
    slots: np.ndarray | None  # int32 (n,)
    attributes: dict  # name: float32 (n, 3, up to 4)
    texture_space: tuple  # scale (3,), offset (3,), from positions to generated coordinates


def read(collection, name, count, dtype, size=1):
    """Property `name` of all items, (count,) or (count, size)."""
    array = np.empty(count * size, dtype)
    collection.foreach_get(name, array)
    return array if size == 1 else array.reshape(count, size)


def mesh_positions(b_mesh):
    """Where the vertices are, float32 (v, 3)."""
    return read(b_mesh.attributes["position"].data, "vector", len(b_mesh.vertices), np.float32, 3)


def mesh_arrays(b_mesh, attribute_names=()):
    """Triangles of an evaluated mesh as MeshArrays, with the attributes of those names; None if it has none.

    Normals are left out where all faces are flat, material slots where all faces use the first.
    """
    b_mesh.calc_loop_triangles()
    count = len(b_mesh.loop_triangles)
    if count == 0:
        return None
    positions = mesh_positions(b_mesh)
    vertices = read(b_mesh.attributes[".corner_vert"].data, "value", len(b_mesh.loops), np.int32)
    corners = _corners(b_mesh, count)
    triangles = vertices[corners]
    return MeshArrays(
        positions,
        triangles,
        _normals(b_mesh, corners, triangles),
        _uvs(b_mesh, corners),
        _slots(b_mesh, count),
        mesh_attributes(b_mesh, corners, attribute_names),
        texture_space(b_mesh),
    )


def texture_space(b_mesh):
    """(scale, offset) from positions to generated coordinates: Blender's texture space goes from 0 to 1."""
    size = np.array(b_mesh.texspace_size, np.float64)
    scale = np.where(size != 0.0, 0.5 / np.where(size != 0.0, size, 1.0), 1.0)
    return scale, 0.5 - np.array(b_mesh.texspace_location, np.float64) * scale


def without_broken_triangles(arrays):
    """The same without triangles that have a corner at infinity or nowhere, and the number of those."""
    finite = np.isfinite(arrays.positions).all(axis=1)
    if finite.all():
        return arrays, 0
    kept = finite[arrays.triangles].all(axis=1)
    positions = np.where(finite[:, None], arrays.positions, np.float32(0.0))
    rest = (None if a is None else a[kept] for a in arrays[1:5])
    attributes = {name: values[kept] for name, values in arrays.attributes.items()}
    return MeshArrays(positions, *rest, attributes, arrays.texture_space), len(kept) - int(kept.sum())


def _corners(b_mesh, count):
    """Corners (Blender's loops) of each triangle, int32 (n, 3)."""
    if len(b_mesh.loops) == 3 * count:  # all faces are triangles already
        return np.arange(3 * count, dtype=np.int32).reshape(count, 3)
    return read(b_mesh.loop_triangles, "loops", count, np.int32, 3)


def _normals(b_mesh, corners, triangles):
    """Shading normals of each corner. Blender says itself where they live: on faces only, if all of it is flat; on
    vertices, if all is smooth; else on corners (some faces flat, sharp edges, custom normals)."""
    if b_mesh.normals_domain == "FACE":
        return None
    if b_mesh.normals_domain == "POINT":
        return read(b_mesh.vertex_normals, "vector", len(b_mesh.vertices), np.float32, 3)[triangles]
    return corner_normals(b_mesh)[corners]


def _uvs(b_mesh, corners):
    """The UV map with the camera icon, which textures use unless they name another."""
    layers = b_mesh.uv_layers
    if not layers:
        return None
    layer = next((uv for uv in layers if uv.active_render), layers[0])
    return read(layer.uv, "vector", len(b_mesh.loops), np.float32, 2)[corners]


def _slots(b_mesh, count):
    """Material slot of each triangle."""
    attribute = b_mesh.attributes.get("material_index")
    if attribute is None:
        return None
    faces = np.maximum(read(attribute.data, "value", len(b_mesh.polygons), np.int32), 0)
    if not faces.any():
        return None
    return faces[read(b_mesh.loop_triangle_polygons, "value", count, np.int32)]


def point_arrays(b_points):
    """Centres (n, 3) and radii (n,) of a point cloud, float32."""
    count = len(b_points.points)
    centres = read(b_points.attributes["position"].data, "vector", count, np.float32, 3)
    radius = b_points.attributes.get("radius")
    if radius is None:
        return centres, np.full(count, DEFAULT_RADIUS, np.float32)
    return centres, np.maximum(read(radius.data, "value", count, np.float32), 0.0)


def first_slot(b_data):
    """Material slot of the first face or point, for what has one material. Geometry nodes often leave slot 0 empty."""
    attribute = b_data.attributes.get("material_index")
    return max(attribute.data[0].value, 0) if attribute and len(attribute.data) else 0
