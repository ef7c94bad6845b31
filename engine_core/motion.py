# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves while the shutter is open: objects and the camera, whose rows stand still at one time of a ray.

Something that moves has `world.pose_count` rows of POSE, evenly from the opening of the shutter (time 0) to its closing
(time 1). Between two of them it turns the shortest way at constant speed, and moves and stretches evenly: Shoemake and
Duff 1992, "Matrix animation and polar decomposition", which is what Cycles does.
"""

import math
from typing import NamedTuple

import numpy as np

from .jit import kernel
from .linalg.records import copy_record, scratch_record
from .linalg.vec3 import Vec3, cross, dot, lerp, load3, load3_at
from .tables import CAMERA, INSTANCE

ZERO = np.float32(0.0)
new_instance, new_camera = scratch_record(INSTANCE), scratch_record(CAMERA)


class Affine(NamedTuple):
    """A transform by its columns: p -> x p.x + y p.y + z p.z + t."""

    x: Vec3
    y: Vec3
    z: Vec3
    t: Vec3


@kernel
def shutter_time(camera, u):
    """A time of the shutter, 0 to 1, as likely as it is open then; `u` is uniform in [0, 1)."""
    steps = np.float32(camera.shutter.shape[0] - 1)
    i = min(np.int64(u * steps), camera.shutter.shape[0] - 2)
    return lerp(camera.shutter[i], camera.shutter[i + 1], u * steps - np.float32(i))


@kernel
def instance_at(scene, number, time, scratch):
    """The row of INSTANCE as it stands at that time; `scratch` holds it if it moves."""
    instance = scene.instances[number]
    if instance.motion == 0:
        return instance
    copy_record(scratch, instance)
    m = pose_at(scene, instance.motion, time)
    set_matrix(scratch.to_world, m)
    set_matrix(scratch.to_object, inverse(m))
    return scratch


@kernel
def camera_at(scene, time, scratch):
    """The row of CAMERA as it stands at that time; `scratch` holds it if it moves."""
    camera = scene.camera[0]
    if camera.motion == 0:
        return camera
    copy_record(scratch, camera)
    set_matrix(scratch.to_world, pose_at(scene, camera.motion, time))
    return scratch


@kernel
def pose_at(scene, first, time):
    """The Affine at that time of what has its poses from row `first` of POSE on."""
    last = scene.world[0].pose_count - 1
    x = time * np.float32(last)
    i = min(np.int64(x), last - 1)
    return between(scene.poses[first + i], scene.poses[first + i + 1], x - np.float32(i))


@kernel
def between(a, b, f):
    """From the row `a` of POSE, `f` 0, to the row `b`, 1."""
    cosine = ZERO
    for k in range(4):
        cosine += a.rotation[k] * b.rotation[k]
    angle = math.acos(min(cosine, 1.0))
    if angle > 1e-3:
        part_a, part_b = math.sin((1.0 - f) * angle), math.sin(f * angle)
    else:
        part_a, part_b = 1.0 - f, f
    w = part_a * a.rotation[0] + part_b * b.rotation[0]
    v = Vec3(
        part_a * a.rotation[1] + part_b * b.rotation[1],
        part_a * a.rotation[2] + part_b * b.rotation[2],
        part_a * a.rotation[3] + part_b * b.rotation[3],
    )
    scale = 1.0 / math.sqrt(w * w + dot(v, v))
    w, v = w * scale, v * scale
    return Affine(
        turned(w, v, lerp(load3_at(a, "stretch", 0), load3_at(b, "stretch", 0), f)),
        turned(w, v, lerp(load3_at(a, "stretch", 1), load3_at(b, "stretch", 1), f)),
        turned(w, v, lerp(load3_at(a, "stretch", 2), load3_at(b, "stretch", 2), f)),
        lerp(load3(a, "location"), load3(b, "location"), f),
    )


@kernel
def turned(w, v, p):
    """The vector `p` turned by the unit quaternion (w, v)."""
    t = cross(v, p) * 2.0
    return p + t * w + cross(v, t)


@kernel
def inverse(m):
    """The inverse of an Affine."""
    x, y, z = cross(m.y, m.z), cross(m.z, m.x), cross(m.x, m.y)
    scale = 1.0 / dot(m.x, x)
    x, y, z = x * scale, y * scale, z * scale
    return Affine(
        Vec3(x.x, y.x, z.x), Vec3(x.y, y.y, z.y), Vec3(x.z, y.z, z.z), Vec3(-dot(x, m.t), -dot(y, m.t), -dot(z, m.t))
    )


@kernel
def set_matrix(matrix, m):
    """Write an Affine to a field of (3, 4)."""
    matrix[0, 0], matrix[0, 1], matrix[0, 2], matrix[0, 3] = m.x.x, m.y.x, m.z.x, m.t.x
    matrix[1, 0], matrix[1, 1], matrix[1, 2], matrix[1, 3] = m.x.y, m.y.y, m.z.y, m.t.y
    matrix[2, 0], matrix[2, 1], matrix[2, 2], matrix[2, 3] = m.x.z, m.y.z, m.z.z, m.t.z
