# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of LIGHT for tests, and asking one light many questions at a time."""

import numpy as np

from engine_core.jit import kernel
from engine_core.light import dispatch
from engine_core.light.bounds import is_far
from engine_core.light.select import pmf, prepare_selection, select
from engine_core.linalg.records import Tables
from engine_core.linalg.vec3 import Vec3, average, dot
from engine_core.program_tables import CELL
from engine_core.shape.dispatch import intersect
from engine_core.tables import LIGHT, LIGHT_NODE, SHAPE, WORLD, LightKind, ShapeKind

EMISSION = (3.0, 2.0, 1.0)
SHAPES = {
    LightKind.QUAD: ShapeKind.QUAD,
    LightKind.DISK: ShapeKind.DISK,
    LightKind.SPHERE: ShapeKind.SPHERE,
    LightKind.BOX: ShapeKind.BOX,
}


class OneLight(Tables):
    """A scene with one light and, in the first row of `shapes`, what rays hit of it."""

    lights = LIGHT
    shapes = SHAPE
    world = WORLD
    world_map = CELL


def light(kind, **fields):
    """One row of LIGHT, (1,); what is not given is that of a light one metre above the origin that shines down."""
    row = np.zeros(1, LIGHT)
    row["kind"], row["emission"], row["spread"], row["blend"] = kind, EMISSION, np.inf, np.inf
    row["p"], row["u"], row["v"], row["n"] = (0, 0, 1), (1, 0, 0), (0, -1, 0), (0, 0, -1)
    for name, value in fields.items():
        row[name] = value
    if kind in (LightKind.QUAD, LightKind.DISK, LightKind.TRIANGLE, LightKind.BOX):
        u, v = row["u"][0].astype(float), row["v"][0].astype(float)
        normal = np.cross(u, v)
        row["n"] = normal / max(np.linalg.norm(normal), 1e-30)
        shape_area = {LightKind.QUAD: 4.0, LightKind.DISK: np.pi, LightKind.TRIANGLE: 0.5, LightKind.BOX: 8.0}[kind]
        row["area"] = np.linalg.norm(normal) * shape_area
        if kind == LightKind.BOX:
            row["area"] += 8.0 * row["radius"] * (np.linalg.norm(u) + np.linalg.norm(v))
    return row


def scene_of(row):
    """The OneLight around a row of LIGHT."""
    shape = np.zeros(1, SHAPE)
    soft = row["soft"][0]
    shape["kind"] = SHAPES.get(LightKind(row["kind"][0]), ShapeKind.FACING_DISK if soft else ShapeKind.SPHERE)
    for name in ("p", "u", "v", "radius"):
        shape[name] = row[name]
    world = np.zeros(1, WORLD)
    world["light_count"] = 1
    return OneLight(lights=row, shapes=shape, world=world, world_map=np.zeros(0, CELL))


SAMPLES = np.dtype(
    [
        ("wi", "f4", (3,)),
        ("distance", "f4"),
        ("radiance", "f4", (3,)),
        ("pdf", "f4"),
        ("is_delta", "?"),
    ]
)


@kernel
def _sample_often(scene, p, u, result):
    for i in range(len(u)):
        s = dispatch.sample(scene, scene.lights[0], Vec3(p[i, 0], p[i, 1], p[i, 2]), u[i, 0], u[i, 1])
        result[i].wi[0], result[i].wi[1], result[i].wi[2] = s.wi.x, s.wi.y, s.wi.z
        result[i].radiance[0], result[i].radiance[1], result[i].radiance[2] = s.radiance.x, s.radiance.y, s.radiance.z
        result[i].distance, result[i].pdf, result[i].is_delta = s.distance, s.pdf, s.is_delta


@kernel
def _hit_often(scene, p, wi, result):
    """Columns: distance to the light's shape, or a negative number; density; emitted radiance."""
    light_row = scene.lights[0]
    for i in range(len(wi)):
        o, d = Vec3(p[i, 0], p[i, 1], p[i, 2]), Vec3(wi[i, 0], wi[i, 1], wi[i, 2])
        t = hit_distance(scene, o, d)
        result[i, 0] = t
        result[i, 1] = 0.0
        if t > 0.0:
            Le = dispatch.emitted(scene, light_row, o, d, t)
            result[i, 1] = dispatch.pdf(scene, light_row, o, d, t)
            result[i, 2], result[i, 3], result[i, 4] = Le.x, Le.y, Le.z


@kernel
def hit_distance(scene, o, d):
    light_row = scene.lights[0]
    far = np.float32(np.inf)
    if light_row.kind == LightKind.SUN or light_row.kind == LightKind.BACKGROUND:
        return far
    if light_row.kind == LightKind.TRIANGLE:
        return hit_triangle(light_row, o, d)
    t = intersect(scene.shapes[0], o, d, np.float32(0.0), far).t
    return t if t < far else np.float32(-1.0)


@kernel
def hit_triangle(light_row, o, d):
    """Moeller and Trumbore 1997, on the corners that stand in the row itself."""
    p, u, v = light_row.p, light_row.u, light_row.v
    e1, e2 = Vec3(u[0], u[1], u[2]), Vec3(v[0], v[1], v[2])
    s = o - Vec3(p[0], p[1], p[2])
    hx, hy, hz = d.y * e2.z - d.z * e2.y, d.z * e2.x - d.x * e2.z, d.x * e2.y - d.y * e2.x
    qx, qy, qz = s.y * e1.z - s.z * e1.y, s.z * e1.x - s.x * e1.z, s.x * e1.y - s.y * e1.x
    scale = 1.0 / (e1.x * hx + e1.y * hy + e1.z * hz)
    b1 = (s.x * hx + s.y * hy + s.z * hz) * scale
    b2 = (d.x * qx + d.y * qy + d.z * qz) * scale
    t = (e2.x * qx + e2.y * qy + e2.z * qz) * scale
    return t if b1 >= 0.0 and b2 >= 0.0 and b1 + b2 <= 1.0 and t > 0.0 else np.float32(-1.0)


def random_numbers(n, seed=0):
    """Numbers as samplers give them: multiples of 2^-24 below 1, float32 (n, 2)."""
    return (np.random.default_rng(seed).integers(0, 2**24, (n, 2)) * 2.0**-24).astype(np.float32)


def even_numbers(side):
    """The middles of side x side cells: float32 (side * side, 2)."""
    x = (np.arange(side) + 0.5) / side
    return np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2).astype(np.float32)


def sample_light(row, p, u):
    """Samples of the light in `row`, for a point `p` (3,) or points (n, 3): recarray (n,) of SAMPLES."""
    result = np.zeros(len(u), SAMPLES).view(np.recarray)
    points = np.ascontiguousarray(np.broadcast_to(np.asarray(p, np.float32), (len(u), 3)))
    _sample_often(scene_of(row), points, u, result)
    return result


def hit_light(row, p, wi):
    """What rays from `p` along `wi` (n, 3) find: distance, negative if they miss; density; radiance (n, 3)."""
    result = np.zeros((len(wi), 5), np.float32)
    points = np.ascontiguousarray(np.broadcast_to(np.asarray(p, np.float32), (len(wi), 3)))
    _hit_often(scene_of(row), points, np.ascontiguousarray(wi, np.float32), result)
    return result[:, 0], result[:, 1], result[:, 2:]


def irradiance(row, p, n, side=200):
    """Irradiance, (3,), that the light brings to a surface at `p` with the normal `n`."""
    s = sample_light(row, p, even_numbers(side))
    cosine = np.maximum(s.wi.astype(float) @ np.asarray(n, float), 0.0)
    return (s.radiance * (cosine / np.where(s.pdf > 0, s.pdf, np.inf))[:, None]).mean(axis=0)


# ---- Many lights -----------------------------------------------------------------------------------------------------


class ManyLights(Tables):
    """All of a scene that choosing among its lights reads."""

    lights = LIGHT
    light_nodes = LIGHT_NODE
    world = WORLD
    world_map = CELL


def many_lights(rows):
    """The ManyLights of rows of LIGHT, a copy: those that stand outside of the tree come first, as `select` wants."""
    rows = rows[np.argsort(~is_far(rows), kind="stable")]
    world = np.zeros(1, WORLD)
    world["light_count"] = len(rows)
    nodes = prepare_selection(rows, world)
    return ManyLights(lights=rows, light_nodes=nodes, world=world, world_map=np.zeros(0, CELL))


@kernel
def _select_often(scene, p, n, both_sides, u, result):
    for i in range(len(u)):
        s = select(scene, Vec3(p[0], p[1], p[2]), Vec3(n[0], n[1], n[2]), both_sides, u[i])
        result[i, 0], result[i, 1], result[i, 2] = s.light, s.pmf, s.u


@kernel
def _pmf_of_all(scene, p, n, both_sides, result):
    for i in range(len(p)):
        for row in range(result.shape[1]):
            point, normal = Vec3(p[i, 0], p[i, 1], p[i, 2]), Vec3(n[i, 0], n[i, 1], n[i, 2])
            result[i, row] = pmf(scene, row, point, normal, both_sides)


@kernel
def _irradiance_of_all(scene, p, n, both_sides, u, result):
    for i in range(len(p)):
        for row in range(result.shape[1]):
            total = np.float32(0.0)
            for k in range(len(u)):
                s = dispatch.sample(scene, scene.lights[row], Vec3(p[i, 0], p[i, 1], p[i, 2]), u[k, 0], u[k, 1])
                cosine = dot(s.wi, Vec3(n[i, 0], n[i, 1], n[i, 2]))
                if both_sides:
                    cosine = abs(cosine)
                if s.pdf > 0.0 and cosine > 0.0:
                    total += average(s.radiance) * cosine / s.pdf
            result[i, row] = total / np.float32(len(u))


def select_often(scene, p, n, u, both_sides=False):
    """What `select` chooses for the numbers `u` at one point: rows, their probabilities, what is left of `u`."""
    result = np.empty((len(u), 3), np.float64)
    _select_often(scene, np.asarray(p, np.float32), np.asarray(n, np.float32), both_sides, u, result)
    return result[:, 0].astype(int), result[:, 1], result[:, 2]


def pmf_of_all(scene, p, n, both_sides=False):
    """Probability of each light at points `p` with normals `n`, (m, 3): (m, lights)."""
    result = np.empty((len(p), len(scene.lights)), np.float32)
    _pmf_of_all(scene, np.asarray(p, np.float32), np.asarray(n, np.float32), both_sides, result)
    return result.astype(np.float64)


def irradiance_of_all(scene, p, n, both_sides=False, side=4):
    """Irradiance from each light, the mean of its colours, by side^2 samples: (m, lights)."""
    result = np.empty((len(p), len(scene.lights)), np.float32)
    p, n = np.asarray(p, np.float32), np.asarray(n, np.float32)
    _irradiance_of_all(scene, p, n, both_sides, even_numbers(side), result)
    return result.astype(np.float64)
