# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of POSE for what moves, the space that it sweeps, and the times at which the shutter is open."""

import numpy as np

from ..accel.instances import instance_boxes
from ..tables import CAMERA, POSE, TreeKind
from . import checks

LOOKS = 16  # between two poses, for the space that something sweeps
STILL = 1e-7  # moves that float32 cannot tell from none, in parts of the largest number of a transform


def moves(name, motion):
    """The matrices of a motion, float64 (n, 4, 4), if anything moves in it; else None."""
    if motion is None:
        return None
    motion = checks.array(name, "motion", motion, np.float64, None, 4, 4)
    if len(motion) < 2:
        raise checks.SceneError(f"{name}: a motion has at least two poses")
    if np.ptp(motion, axis=0).max() <= STILL * np.abs(motion).max():
        return None
    if not checks.transforms([name] * len(motion), motion)[1].all():
        raise checks.SceneError(f"{name}: is scaled to 0 while it moves")
    return motion


def pose_rows(motions):
    """Rows of POSE: an unused one, then those of each motion, float64 (n, 4, 4). All have the same n."""
    counts = {len(motion) for motion in motions}
    if len(counts) > 1:
        raise checks.SceneError(f"Things move in different numbers of poses: {sorted(counts)}")
    rows = np.zeros(1 + sum(map(len, motions)), POSE)
    rows["rotation"][0, 0], rows["stretch"][0] = 1.0, np.eye(3)
    for i, motion in enumerate(motions):
        first = 1 + i * len(motion)
        part = rows[first : first + len(motion)]
        part["rotation"], part["stretch"] = decomposed(motion[:, :3, :3])
        part["location"] = motion[:, :3, 3]
    return rows


def decomposed(linear):
    """Polar decomposition of matrices (n, 3, 3): rotations as quaternions (n, 4), and stretches before them (n, 3, 3).

    Neighbouring quaternions stand for the shortest turn between them.
    """
    u, s, vt = np.linalg.svd(linear)
    rotations, stretches = u @ vt, np.swapaxes(vt, 1, 2) @ (s[:, :, None] * vt)
    mirrored = np.linalg.det(rotations) < 0.0
    rotations[mirrored], stretches[mirrored] = -rotations[mirrored], -stretches[mirrored]
    quaternions = np.array([quaternion(r) for r in rotations])
    for i in range(1, len(quaternions)):
        if quaternions[i] @ quaternions[i - 1] < 0.0:
            quaternions[i] = -quaternions[i]
    return quaternions, stretches


def quaternion(rotation):
    """w x y z of a rotation matrix: the eigenvector of Bar-Itzhack 2000, which has no special cases."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation
    k = [
        [xx + yy + zz, zy - yz, xz - zx, yx - xy],
        [zy - yz, xx - yy - zz, xy + yx, xz + zx],
        [xz - zx, xy + yx, yy - xx - zz, yz + zy],
        [yx - xy, xz + zx, yz + zy, zz - xx - yy],
    ]
    return np.linalg.eigh(np.array(k))[1][:, -1]


def instance_bounds(instances, poses, pose_count, nodes, packets):
    """Boxes around rows of INSTANCE, float32 (n, 3) low and high: around all that they sweep, if they move."""

    def boxes(rows, matrices):
        low, high = np.empty((2, len(rows), 3), np.float32)
        roots, has_packets = np.ascontiguousarray(rows["root"]), rows["kind"] == TreeKind.TRIANGLES
        instance_boxes(nodes, packets, roots, has_packets, np.ascontiguousarray(matrices, np.float32), low, high)
        return low, high

    low, high = boxes(instances, instances["to_world"])
    for i in np.flatnonzero(instances["motion"] > 0):
        own, root = poses[instances["motion"][i] :][:pose_count], nodes[instances["root"][i]]["bounds"]
        present = root[0] <= root[3]
        radius = np.linalg.norm(np.maximum(-root[:3, present].min(axis=1), root[3:, present].max(axis=1)))
        matrices, margin = swept(own, radius)
        lows, highs = boxes(np.repeat(instances[i : i + 1], len(matrices)), matrices)
        low[i], high[i] = lows.min(axis=0) - margin, highs.max(axis=0) + margin
    return low, high


def swept(rows, radius):
    """Where something with these rows of POSE stands now and then: float64 (m, 3, 4), and how far from the nearest box
    around two such places, in metres, a point may be in between that is `radius` from its origin.

    Between two looks the way of a point differs from the chord by an eighth of its largest second derivative (linear
    interpolation's error): that of a turn at speed w is w^2 r, and 2 w r' where it is stretched at speed r' meanwhile.
    """
    q, t, s = (rows[field].astype(np.float64) for field in ("rotation", "location", "stretch"))
    matrices, margin = [], 0.0
    for i in range(len(rows) - 1):
        angle = np.arccos(np.clip(q[i] @ q[i + 1], -1.0, 1.0))  # half of the turn
        largest = max(np.linalg.norm(s[i], 2), np.linalg.norm(s[i + 1], 2)) * radius
        change = np.linalg.norm(s[i + 1] - s[i], 2) * radius
        margin = max(margin, ((2.0 * angle) ** 2 * largest + 4.0 * angle * change) / 8.0 / LOOKS**2)
        for f in np.linspace(0.0, 1.0, LOOKS + 1):
            a, b = (1.0 - f, f) if angle < 1e-3 else (np.sin((1.0 - f) * angle), np.sin(f * angle))
            turn = rotation_matrix(a * q[i] + b * q[i + 1])
            linear = turn @ (s[i] * (1.0 - f) + s[i + 1] * f)
            matrices.append(np.column_stack([linear, t[i] * (1.0 - f) + t[i + 1] * f]))
    return np.array(matrices), margin


def rotation_matrix(q):
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def shutter_times(openness):
    """The times of CAMERA.shutter: the inverse of the share of light that has come in by a time.

    `openness`: numbers at times evenly from 0 to 1, or None for a shutter that is fully open all the time.
    """
    count = CAMERA["shutter"].shape[0]
    if openness is None:
        return np.linspace(0.0, 1.0, count)
    fine = np.linspace(0.0, 1.0, 4097)
    values = np.interp(fine, np.linspace(0.0, 1.0, len(openness)), openness)
    share = np.concatenate([[0.0], np.cumsum(values[1:] + values[:-1])])
    return np.interp(np.linspace(0.0, 1.0, count), share / share[-1], fine)
