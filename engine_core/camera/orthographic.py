# SPDX-License-Identifier: GPL-3.0-or-later
"""The orthographic camera: parallel rays; with a lens radius, each point of the picture has a lens of its own."""

from ..jit import kernel
from ..linalg.vec3 import Vec3
from .lens import is_pinhole, ray_through, square_to_aperture


@kernel
def generate_ray(camera, screen_x, screen_y, u0, u1):
    """The ray for the point (screen_x, screen_y) of the camera's plane, metres; u0, u1 choose the point of the lens."""
    o = Vec3(screen_x, screen_y, 0.0)
    ahead = Vec3(0.0, 0.0, -1.0)
    if is_pinhole(camera):
        return ray_through(camera, o, ahead)
    x, y = square_to_aperture(u0, u1, camera)
    lens = Vec3(x, y, 0.0) * camera.lens_radius
    return ray_through(camera, o + lens, ahead * camera.focus_distance - lens)
