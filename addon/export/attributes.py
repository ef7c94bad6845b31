# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of meshes that shader nodes ask for by name: UV maps, colours, tangents, numbers of islands."""

import bpy
import numpy as np

from .normals import corner_normals, flat_corners

ACTIVE_COLOR = "<active colour>"  # names that no attribute of an artist has
TANGENT = "<tangent> "
ORIGINAL = "<original normal> "  # before displacement, where there is such a UV map
ISLANDS = "<random per island>"
POINTINESS = "<pointiness>"
SIZES = {
    "FLOAT": 1,
    "INT": 1,
    "BOOLEAN": 1,
    "INT8": 1,
    "FLOAT2": 2,
    "FLOAT_VECTOR": 3,
    "FLOAT_COLOR": 4,
    "BYTE_COLOR": 4,
}
PROPERTIES = {"FLOAT_COLOR": "color", "BYTE_COLOR": "color", "FLOAT2": "vector", "FLOAT_VECTOR": "vector"}


def wanted_names():
    """Names of attributes that any shader node of the file asks for."""
    names = set()
    trees = [m.node_tree for m in bpy.data.materials if m.node_tree]
    trees += [t for t in bpy.data.node_groups if t.bl_idname == "ShaderNodeTree"]
    for node in (node for tree in trees for node in tree.nodes):
        if node.type == "UVMAP" and node.uv_map:
            names.add(node.uv_map)
        elif node.type == "ATTRIBUTE":
            names.add(node.attribute_name)
        elif node.type == "VERTEX_COLOR":
            names.add(node.layer_name or ACTIVE_COLOR)
        elif node.type == "TANGENT" or (node.type == "NORMAL_MAP" and node.space == "TANGENT"):
            names.add(TANGENT + node.uv_map)
            if getattr(node, "base", "DISPLACED") == "ORIGINAL":
                names.add(ORIGINAL + node.uv_map)
        elif node.type == "VECTOR_DISPLACEMENT" and node.space == "TANGENT":
            names.add(TANGENT)
        elif node.type == "NEW_GEOMETRY":
            linked = {output.identifier for output in node.outputs if output.is_linked}
            names |= {name for name, of in ((ISLANDS, "Random Per Island"), (POINTINESS, "Pointiness")) if of in linked}
    return names


def mesh_attributes(b_mesh, corners, names):
    """{name: float32 (n, 3, up to 4)} of those of the names that the mesh has. `corners`: of the triangles, (n, 3)."""
    found = {}
    for name in names:
        if name.startswith(TANGENT):
            tangents = _tangents(b_mesh, corners, name.removeprefix(TANGENT))
            found |= {} if tangents is None else {name: tangents}
            continue
        if name.startswith(ORIGINAL):
            values = _original_normals(b_mesh, name.removeprefix(ORIGINAL))
        elif name == ISLANDS:
            values = _islands(b_mesh)
        elif name == POINTINESS:
            values = _pointiness(b_mesh)
        else:
            values = _values(b_mesh, name)
        if values is not None:
            found[name] = values[corners]
    return found


def _values(b_mesh, name):
    """Values of an attribute at each corner (Blender's loops), float32 (loops, size); None if there is none."""
    if name == ACTIVE_COLOR:
        layers = b_mesh.color_attributes
        attribute = layers[layers.render_color_index] if 0 <= layers.render_color_index < len(layers) else None
    else:
        attribute = b_mesh.attributes.get(name)
    values = owned_values(attribute)
    return None if values is None else values[_owners(b_mesh, attribute.domain)]


def owned_values(attribute):
    """Values of an attribute for each that owns some, as colours or vectors, float32 (n, 3 or 4); None without any."""
    size = SIZES.get(attribute.data_type) if attribute else None
    if size is None or not len(attribute.data):
        return None
    values = np.empty(len(attribute.data) * size, np.float32)
    attribute.data.foreach_get(PROPERTIES.get(attribute.data_type, "value"), values)
    return three_at_least(values.reshape(-1, size))


def three_at_least(values):
    """Numbers as grey, pairs with a third number, 0; (n, 3 or 4)."""
    if values.shape[1] == 1:
        return np.repeat(values, 3, axis=1)
    return np.pad(values, ((0, 0), (0, 1))) if values.shape[1] == 2 else values


def _owners(b_mesh, domain):
    """For each corner the number of the point, face or corner that owns its values."""
    count = len(b_mesh.loops)
    if domain == "POINT":
        owners = np.empty(count, np.int32)
        b_mesh.attributes[".corner_vert"].data.foreach_get("value", owners)
        return owners
    if domain == "FACE":
        totals = np.empty(len(b_mesh.polygons), np.int32)
        b_mesh.polygons.foreach_get("loop_total", totals)
        return np.repeat(np.arange(len(totals)), totals)
    return np.arange(count)


def _uv_name(b_mesh, uv_map):
    """The UV map of that name, or without a name the active one; None if there is none."""
    name = uv_map or next((uv.name for uv in b_mesh.uv_layers if uv.active_render), "")
    return name if name in b_mesh.uv_layers else None


def _original_normals(b_mesh, uv_map):
    """Normals at corners, object space, and 1 where smooth, 0 where flat; (loops, 4). None without that UV map."""
    if _uv_name(b_mesh, uv_map) is None:
        return None
    smooth = ~flat_corners(b_mesh)
    return np.concatenate([corner_normals(b_mesh), smooth[:, None]], axis=1, dtype=np.float32)


def _tangents(b_mesh, corners, uv_map):
    """Tangents of a UV map and the signs of bitangents at the corners of the triangles, (n, 3, 4); None without that
    map. They are those of triangles, as in Cycles; Blender itself has none for faces of more than four corners."""
    name = _uv_name(b_mesh, uv_map)
    if name is None:
        return None
    triangles = _triangulated(b_mesh, corners.ravel(), name)
    try:
        return _mesh_tangents(triangles, name).reshape(-1, 3, 4)
    finally:
        bpy.data.meshes.remove(triangles)


def _mesh_tangents(b_mesh, name):
    """(loops, 4)"""
    b_mesh.calc_tangents(uvmap=name)
    count = len(b_mesh.loops)
    tangents, signs = np.empty(count * 3, np.float32), np.empty(count, np.float32)
    b_mesh.loops.foreach_get("tangent", tangents)
    b_mesh.loops.foreach_get("bitangent_sign", signs)
    b_mesh.free_tangents()
    return np.concatenate([tangents.reshape(-1, 3), signs[:, None]], axis=1)


def _triangulated(b_mesh, corners, name):
    """A mesh of the triangles alone, with the normals of the other and its UV map `name`. `corners`: (3 n,).

    Triangles of flat faces have normals of their own, as in Cycles: where rounding tells two of them apart, so do the
    tangents at their corners.
    """
    result, count = bpy.data.meshes.new("Triangles"), len(corners)
    result.vertices.add(len(b_mesh.vertices))
    result.loops.add(count)
    result.polygons.add(count // 3)
    positions, uvs = np.empty(len(b_mesh.vertices) * 3, np.float32), np.empty(len(b_mesh.loops) * 2, np.float32)
    b_mesh.attributes["position"].data.foreach_get("vector", positions)
    b_mesh.uv_layers[name].uv.foreach_get("vector", uvs)
    result.attributes["position"].data.foreach_set("vector", positions)
    vertices = _owners(b_mesh, "POINT")[corners]
    result.loops.foreach_set("vertex_index", vertices)
    result.polygons.foreach_set("loop_start", np.arange(0, count, 3, dtype=np.int32))
    result.uv_layers.new(name=name).uv.foreach_set("vector", uvs.reshape(-1, 2)[corners].ravel())
    result.update(calc_edges=True)
    p0, p1, p2 = positions.reshape(-1, 3)[vertices].reshape(-1, 3, 3).swapaxes(0, 1)
    own = _unit(np.cross(p1 - p0, p2 - p0)).astype(np.float32)
    normals = np.where(
        flat_corners(b_mesh)[corners][:, None], np.repeat(own, 3, axis=0), corner_normals(b_mesh)[corners]
    )
    result.attributes.new("custom_normal", "FLOAT_VECTOR", "CORNER").data.foreach_set("vector", normals.ravel())
    return result


def _edges(b_mesh):
    """The two vertices of each edge, (2, edges)."""
    edges = np.empty(len(b_mesh.edges) * 2, np.int32)
    b_mesh.edges.foreach_get("vertices", edges)
    return edges.reshape(-1, 2).T


def _pointiness(b_mesh):
    """How far each vertex stands out, 0 to 1, 0.5 where it is flat, as Cycles defines it; (loops, 3).

    The angle between its normal and the mean direction of its edges, over pi, and then the mean of that over the vertex
    and its neighbours. Vertices at one place count as one.
    """
    count = len(b_mesh.vertices)
    positions, normals = np.empty((2, count * 3), np.float32)
    b_mesh.attributes["position"].data.foreach_get("vector", positions)
    b_mesh.vertex_normals.foreach_get("vector", normals)
    places, place = np.unique(positions.reshape(-1, 3) + np.float32(0.0), axis=0, return_inverse=True)
    place = place.ravel()
    edges = np.unique(np.sort(place[_edges(b_mesh)], axis=0), axis=1)
    a, b = edges[:, edges[0] != edges[1]]
    normals = _sums(place, normals.reshape(-1, 3), len(places))
    along = _unit(places[b] - places[a])
    means = _sums(a, along, len(places)) - _sums(b, along, len(places))
    degree = np.bincount(a, minlength=len(places)) + np.bincount(b, minlength=len(places))
    cosine = (_unit(normals) * means).sum(axis=1) / np.maximum(degree, 1)
    own = np.where(degree > 0, np.arccos(np.clip(cosine, -1.0, 1.0)) / np.pi, 0.0)
    around = own + _sums(a, own[b, None], len(places))[:, 0] + _sums(b, own[a, None], len(places))[:, 0]
    values = (around / (degree + 1)).astype(np.float32)[place]
    return np.repeat(values[_owners(b_mesh, "POINT")][:, None], 3, axis=1)


def _sums(owners, values, count):
    """Sums of the rows of `values` by their owners, (count, columns)."""
    return np.stack([np.bincount(owners, column, count) for column in values.T], axis=1)


def _unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)


def _islands(b_mesh):
    """A random number for each connected part of the mesh, (loops, 3)."""
    count = len(b_mesh.vertices)
    a, b = _edges(b_mesh)
    island = np.arange(count)
    while True:  # each point takes the least number next to it, and then that point's own: few rounds
        least = island.copy()
        np.minimum.at(least, a, island[b])
        np.minimum.at(least, b, island[a])
        least = least[least]
        if (least == island).all():
            break
        island = least
    bits = (island.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(40)
    values = (bits.astype(np.float64) / 2.0**24).astype(np.float32)
    return np.repeat(values[_owners(b_mesh, "POINT")][:, None], 3, axis=1)
