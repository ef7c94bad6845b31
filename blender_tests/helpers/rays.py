# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays by the array, for tests and benchmarks of trees; and scenes that are nothing but geometry."""

import numpy as np

from engine_core.accel.build import aligned_rows, build_boxes, build_triangles, rebase, rebase_packets
from engine_core.accel.traverse import NO_FACE, intersect_closest, intersect_lamps, occluded
from engine_core.jit import kernel
from engine_core.linalg.records import Tables
from engine_core.linalg.vec3 import load3
from engine_core.shape.dispatch import bounds
from engine_core.tables import INSTANCE, NODE, PACKET, SHAPE, WORLD, Scene, TreeKind, Visibility

FAR, NOW = np.float32(np.inf), np.float32(0.0)
RAY = np.dtype(
    [
        ("o", "f4", (3,)),
        ("d", "f4", (3,)),
        ("t_min", "f4"),
        ("t_max", "f4"),
        # what was found
        ("t", "f4"),
        ("kind", "i4"),
        ("prim", "i4"),
        ("instance", "i4"),
        ("b1", "f4"),
        ("b2", "f4"),
        ("occluded", "i4"),
    ]
)


class Rays(Tables):
    rays = RAY


@kernel
def closest_all(scene, rays, count, visibility):
    for i in range(count):
        ray = rays.rays[i]
        hit = intersect_closest(scene, load3(ray, "o"), load3(ray, "d"), ray.t_min, ray.t_max, visibility, NOW, NO_FACE)
        ray.t, ray.kind, ray.prim, ray.instance, ray.b1, ray.b2 = hit


@kernel
def occluded_all(scene, rays, count):
    for i in range(count):
        ray = rays.rays[i]
        ray.occluded = 1 if occluded(scene, load3(ray, "o"), load3(ray, "d"), ray.t_max, NOW, NO_FACE) else 0


@kernel
def lamps_all(scene, rays, count):
    for i in range(count):
        ray = rays.rays[i]
        hit = intersect_lamps(scene, load3(ray, "o"), load3(ray, "d"), ray.t_min, ray.t_max)
        ray.t, ray.kind, ray.prim, ray.instance, ray.b1, ray.b2 = hit


def make_rays(o, d, t_max=FAR, t_min=0.0):
    """The Rays from `o` along `d`, (n, 3) each or one for all."""
    rows = aligned_rows(len(np.broadcast_to(o, np.broadcast_shapes(np.shape(o), np.shape(d)))), RAY)
    rows["o"], rows["d"], rows["t_min"], rows["t_max"] = o, d, t_min, t_max
    return Rays(rays=rows)


def closest(scene, o, d, t_max=FAR, visibility=Visibility.ALL, t_min=0.0):
    """Rows of RAY with the first hits beyond `t_min`."""
    rays = make_rays(o, d, t_max, t_min)
    closest_all(scene, rays, len(rays.rays), int(visibility))
    return rays.rays


def blocked(scene, o, d, t_max=FAR):
    """Whether rays are occluded, bool (n)."""
    rays = make_rays(o, d, t_max)
    occluded_all(scene, rays, len(rays.rays))
    return rays.rays["occluded"] == 1


def lamps(scene, o, d, t_min=0.0, t_max=FAR):
    """Rows of RAY with the first lamps beyond `t_min`."""
    rays = make_rays(o, d, t_max, t_min)
    lamps_all(scene, rays, len(rays.rays))
    return rays.rays


def geometry_scene(triangles=None, shapes=None, lamps=None, instances=()):
    """A Scene with nothing but trees.

    `triangles`: (n, 3, 3); `shapes`, `lamps`: rows of SHAPE; `instances`: pairs of a geometry, which is `triangles` or
    `shapes` as above, and a list of (3, 4) matrices, or pairs of a matrix and a visibility. Hits on triangles number
    them through: the world's own first, then those of each instanced geometry. Shapes are sorted into the table.
    """
    nodes, packets, rows = [], [], []
    counts = {"triangles": 0}
    world = np.zeros(1, WORLD)

    def add(geometry):
        root, leaves = sum(map(len, nodes)), sum(map(len, rows))
        if geometry.dtype == SHAPE:
            tree, order = build_boxes(*bounds(geometry))
            rows.append(geometry[order])
        else:
            tree, more = build_triangles(geometry)
            leaves = sum(map(len, packets))
            rebase_packets(more, counts["triangles"])
            counts["triangles"] += len(geometry)
            packets.append(more)
        rebase(tree, root, leaves)
        nodes.append(tree)
        return root

    for field, geometry in (("triangle_root", triangles), ("shape_root", shapes), ("lamp_root", lamps)):
        world[field] = -1 if geometry is None else add(geometry)
    table = []
    for geometry, placements in instances:
        root = add(geometry)
        kind = TreeKind.SHAPES if geometry.dtype == SHAPE else TreeKind.TRIANGLES
        for placement in placements:
            matrix, visibility = placement if isinstance(placement, tuple) else (placement, Visibility.ALL)
            row = np.zeros(1, INSTANCE)
            row["to_world"], row["to_object"] = matrix, np.linalg.inv(np.vstack([matrix, [0, 0, 0, 1]]))[:3]
            row["kind"], row["root"], row["visibility"] = kind, root, visibility
            table.append((row, *_transformed_box(matrix, nodes[-1][0]["bounds"])))
    world["instance_root"] = world["moving_root"] = -1
    if table:
        tree, order = build_boxes(np.array([lo for _, lo, _ in table]), np.array([hi for *_, hi in table]))
        world["instance_root"] = sum(map(len, nodes))
        rebase(tree, world["instance_root"][0], 0)
        nodes.append(tree)
        table = [table[i][0] for i in order]

    given = {
        "nodes": _joined(nodes, NODE),
        "packets": _joined(packets, PACKET),
        "shapes": _joined(rows, SHAPE),
        "instances": _joined(table, INSTANCE),
        "world": world,
    }
    return Scene(**{name: given.get(name, np.zeros(0, dtype)) for name, dtype in Scene.dtypes().items()})


def bumpy_sphere(rings):
    """A closed surface of triangles around the origin: vertices (v, 3), faces (n, 3)."""
    u = np.linspace(0, 2 * np.pi, 2 * rings, endpoint=False)
    v = np.linspace(0, np.pi, rings + 1)[1:-1, None]
    ring = np.stack(np.broadcast_arrays(np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)), axis=-1)
    ring *= 1 + 0.1 * np.sin(15 * ring[..., :1]) * np.sin(17 * ring[..., 1:2])
    vertices = np.concatenate([ring.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]]).astype(np.float32)
    columns = 2 * rings
    a = np.arange((rings - 2) * columns).reshape(-1, columns)
    b = np.roll(a, -1, axis=1)
    last, north, south = (rings - 2) * columns, len(vertices) - 2, len(vertices) - 1
    faces = [np.stack([a, a + columns, b], -1), np.stack([b, a + columns, b + columns], -1)]
    caps = [np.stack([np.full(columns, north), a[0], b[0]], -1)]
    caps += [np.stack([np.full(columns, south), np.roll(np.arange(columns), -1) + last, np.arange(columns) + last], -1)]
    return vertices, np.concatenate([f.reshape(-1, 3) for f in faces + caps])


def _joined(parts, dtype):
    table = aligned_rows(sum(map(len, parts)), dtype)
    return np.concatenate(parts, out=table) if parts else table


def _transformed_box(matrix, box):
    lo, hi = box[:3].min(axis=1), box[3:].max(axis=1)
    corners = np.array(np.meshgrid(*zip(lo, hi, strict=True))).reshape(3, 8).T
    corners = corners @ np.asarray(matrix)[:, :3].T + np.asarray(matrix)[:, 3]
    return corners.min(axis=0), corners.max(axis=0)
