# SPDX-License-Identifier: GPL-3.0-or-later
"""Where lights stand, whereto they shine and how strongly: the leaves of the tree of lights.

Bounds are conservative: what lies outside of box and cone gets no light.
"""

import numpy as np

from ..tables import LightKind

CLUSTER = np.dtype(
    [  # what is known of lights taken together; see LIGHT_NODE
        ("centre", "f4", (3,)),
        ("half", "f4", (3,)),
        ("axis", "f4", (3,)),
        ("theta_o", "f4"),
        ("theta_e", "f4"),
        ("two_sided", "i4"),
        ("intensity", "f4"),
        ("closest", "f4"),
        ("child", "i4"),  # > 0: row of its second half, the first stands right behind it; < 0: a leaf, ~row of LIGHT
    ]
)
ROUNDING = 2.0**-22  # of a coordinate: boxes are wider by so much, since kernels round as they go
SAME = 1e-4  # of the size of a triangle: corners as near as that are one
SOMEWHERE = np.array([0.36, 0.48, 0.8])  # a direction that normals are seldom perpendicular to


def is_far(lights):
    """Which rows of LIGHT shine the same however far away they are: suns, area lights that are beams, and a world that
    is sampled by a map."""
    kind = lights["kind"]
    is_beam = ((kind == LightKind.QUAD) | (kind == LightKind.DISK)) & (lights["is_delta"] != 0)
    is_sky = (kind == LightKind.BACKGROUND) & (lights["program"] > 0)
    return (kind == LightKind.SUN) | is_beam | is_sky


def irradiance(lights):
    """Of lights that are far: what arrives on a surface across their direction, the mean of the colours, W/m2: (n,)."""
    height = np.where(lights["kind"] == LightKind.SUN, lights["height"], 0.0).astype(np.float64)
    projected = np.where(lights["is_delta"] != 0, 1.0, np.pi * height * (2.0 - height))  # pi sin^2
    projected = np.where(lights["kind"] == LightKind.BACKGROUND, np.pi, projected)
    return _emission(lights) * projected


def intensity(lights):
    """Of lights that are not: radiant intensity where it is largest, the mean of the colours, W/sr: (n,)."""
    kind, is_delta = lights["kind"], lights["is_delta"] != 0
    disk = np.pi * lights["radius"].astype(np.float64) ** 2
    is_flat = np.isin(kind, (LightKind.TRIANGLE, LightKind.QUAD, LightKind.DISK))
    is_round = np.isin(kind, (LightKind.POINT, LightKind.SPOT, LightKind.SPHERE))
    kinds = [is_flat, kind == LightKind.BOX, is_round & ~is_delta, is_round]
    surface = np.select(kinds, [lights["area"].astype(np.float64), _largest_outline(lights), disk, 1.0])
    return _emission(lights) * surface


def pairs(lights):
    """Which rows of LIGHT make a leaf together with the next row, (n,): the triangles of a flat quadrilateral.

    Meshes are mostly made of those, and from nearly everywhere both halves look the same.
    """
    a, b = lights[:-1], lights[1:]
    alike = (a["kind"] == LightKind.TRIANGLE) & (b["kind"] == LightKind.TRIANGLE) & (intensity(a) > 0.0)
    alike &= (a["instance"] == b["instance"]) & (a["prim"] + 1 == b["prim"]) & (a["two_sided"] == b["two_sided"])
    alike &= (a["emission"] == b["emission"]).all(axis=1) & ((a["n"] * b["n"]).sum(axis=1) > 1.0 - 1e-6)
    near = np.flatnonzero(alike)
    apart = _corners(a[near])[:, :, None] - _corners(b[near])[:, None]
    is_same = (apart**2).sum(axis=3) < SAME**2 * a["area"][near, None, None]
    alike[near] = is_same.sum(axis=(1, 2)) == 2
    # Of a run in which each would pair with the next, take every other.
    rows = np.arange(len(lights))
    alike = np.append(alike, False)
    return alike & ((rows - np.maximum.accumulate(np.where(alike, 0, rows + 1))) % 2 == 0)


def clusters(lights, is_pair):
    """A row of CLUSTER for each leaf: for the rows of LIGHT that have an intensity, and do not follow in a pair."""
    follows = np.append(False, is_pair[:-1])
    rows = np.flatnonzero((intensity(lights) > 0.0) & ~is_far(lights) & ~follows)
    both = rows + is_pair[rows]
    low, high = boxes(lights)
    low, high = np.minimum(low[rows], low[both]), np.maximum(high[rows], high[both])
    centre, half = (low + high) / 2.0, (high - low) / 2.0
    result = np.zeros(len(rows), CLUSTER)
    result["centre"], result["half"] = centre, half + ROUNDING * (np.abs(centre) + half)

    strength = intensity(lights[rows]) + np.where(is_pair[rows], intensity(lights[both]), 0.0)
    lights = lights[rows]
    result["child"], result["intensity"] = ~rows, strength
    result["closest"] = np.sqrt(_largest_irradiance(lights) / strength)

    theta_o, theta_e = _cones(lights)
    everywhere = theta_o == np.pi
    result["theta_o"], result["theta_e"] = theta_o, theta_e
    result["two_sided"] = (lights["two_sided"] != 0) & ~everywhere
    # Of what shines from both sides either normal will do: choose the same for all that are parallel.
    turned = (result["two_sided"] != 0) & (lights["n"] @ SOMEWHERE < 0.0)
    result["axis"] = np.where(turned[:, None], -1.0, 1.0) * lights["n"]
    result["axis"][everywhere] = 0.0, 0.0, 1.0
    return result


def boxes(lights):
    """Low and high corners, (n, 3)."""
    kind = lights["kind"][:, None]
    p, u, v = (lights[name].astype(np.float64) for name in ("p", "u", "v"))
    corners = _corners(lights)
    is_triangle = kind == LightKind.TRIANGLE
    radius = np.where(lights["is_delta"] != 0, 0.0, lights["radius"]).astype(np.float64)[:, None]
    flat = np.abs(u) + np.abs(v)
    kinds = {LightKind.QUAD: flat, LightKind.DISK: np.hypot(u, v), LightKind.BOX: flat + radius * np.abs(lights["n"])}
    half = np.select([kind == k for k in kinds], list(kinds.values()), radius)
    low = np.where(is_triangle, corners.min(axis=1), p - half)
    high = np.where(is_triangle, corners.max(axis=1), p + half)
    return low, high


def _emission(lights):
    return lights["emission"].astype(np.float64).mean(axis=-1)


def _largest_outline(lights):
    """Of boxes: the largest area that they are seen with, the length of a vector of the areas of faces: (n,)."""
    x, y = (np.linalg.norm(lights[name].astype(np.float64), axis=1) for name in "uv")
    z = lights["radius"].astype(np.float64)
    return 4.0 * np.sqrt((x * y) ** 2 + (y * z) ** 2 + (z * x) ** 2)


def _corners(lights):
    """Of triangles: (n, 3 corners, 3)."""
    p, u, v = (lights[name].astype(np.float64) for name in ("p", "u", "v"))
    return np.stack([p, p + u, p + v], axis=1)


def _cones(lights):
    """Angles theta_o and theta_e around the axis n, (n,).

    A spot has its full intensity within theta_o, and its blended edge within theta_e. Its cone is round in a space to
    which a matrix leads; singular values tell how much longer or shorter a direction may become there.
    """
    kind = lights["kind"]
    theta_o, theta_e = np.zeros(len(lights)), np.full(len(lights), np.pi / 2.0)
    theta_o[np.isin(kind, (LightKind.POINT, LightKind.SPHERE, LightKind.BOX))] = np.pi
    flat = (kind == LightKind.QUAD) | (kind == LightKind.DISK)
    theta_e[flat] = np.arctan(lights["spread"][flat].astype(np.float64))

    spot = kind == LightKind.SPOT
    rows = lights[spot]
    stretch = np.stack([rows["u"], rows["v"], rows["n"]], axis=1).astype(np.float64)
    singular = np.linalg.svd(stretch, compute_uv=False)
    cosine = rows["cos_angle"].astype(np.float64)
    with np.errstate(divide="ignore"):
        inner = np.arccos(np.clip(cosine + 1.0 / rows["blend"].astype(np.float64), -1.0, 1.0))
    outer = np.arccos(np.clip(cosine * np.where(cosine > 0.0, singular[:, 2], singular[:, 0]), -1.0, 1.0))
    theta_e[spot] = np.minimum(outer - np.minimum(inner, outer), np.pi / 2.0)
    theta_o[spot] = outer - theta_e[spot]
    return theta_o, theta_e


def _largest_irradiance(lights):
    """What a surface can get, however close: for radiance L, pi L, or as much less as the spread is narrow; (n,)."""
    flat = np.isin(lights["kind"], (LightKind.QUAD, LightKind.DISK))
    points = np.isin(lights["kind"], (LightKind.POINT, LightKind.SPOT)) & (lights["is_delta"] != 0)
    return np.where(points, np.inf, np.pi * _emission(lights) * np.where(flat, _spread_fraction(lights), 1.0))


def _spread_fraction(lights):
    """Flux of a light that shines within an angle `a`, over that of a Lambertian one: 1 - a / tan a."""
    tangent = lights["spread"].astype(np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.isinf(tangent), 1.0, 1.0 - np.arctan(tangent) / tangent)
