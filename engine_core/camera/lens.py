# SPDX-License-Identifier: GPL-3.0-or-later
"""The thin lens: where on it a ray starts, so that what is out of focus blurs into its shape.

In the camera's own space: x right, y up, looking along -z, the lens at z = 0.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.transform import transform_point, transform_vector
from ..linalg.vec3 import Vec3, normalize
from ..sampling.warp import square_to_disk, square_to_regular_polygon


class CameraRay(NamedTuple):
    o: Vec3  # on the plane at clip_start
    d: Vec3  # unit
    t_max: float  # to the plane at clip_end


@kernel
def square_to_aperture(u0, u1, camera):
    """(x, y) uniform on an aperture of radius 1: a disk or a polygon with an edge across the direction of its rotation.

    As in Cycles: with 3 blades or more the corners lie on the circle; the ratio narrows it in x after the rotation.
    """
    if camera.blades >= 3:
        x, y = square_to_regular_polygon(u0, u1, camera.blades)
        c, s = math.cos(camera.blade_rotation), math.sin(camera.blade_rotation)
        x, y = c * x - s * y, s * x + c * y
    else:
        x, y = square_to_disk(u0, u1)
    return x / camera.aperture_ratio, y


@kernel
def ray_through(camera, o, d):
    """The ray from `o` on the lens plane along `d`, in camera space, cut to what lies between the clipping planes."""
    start = camera.clip_start / -d.z
    o = transform_point(camera, "to_world", o + d * start)
    w = normalize(transform_vector(camera, "to_world", d))
    depth = camera.clip_end - camera.clip_start
    return CameraRay(o, w, depth * math.sqrt(d.x * d.x + d.y * d.y + d.z * d.z) / -d.z)


@kernel
def is_pinhole(camera):
    return not camera.lens_radius > np.float32(0.0)
