# SPDX-License-Identifier: GPL-3.0-or-later
"""The perspective camera: rays through the centre of the lens, or with a lens radius, through a point of focus.

Points in focus lie on a plane across the axis, not on a sphere, as in Cycles.
"""

from ..jit import kernel
from ..linalg.vec3 import BLACK, Vec3
from .lens import is_pinhole, ray_through, square_to_aperture


@kernel
def generate_ray(camera, screen_x, screen_y, u0, u1):
    """The ray for the point (screen_x, screen_y) of the screen at distance 1; u0, u1 choose the point of the lens."""
    d = Vec3(screen_x, screen_y, -1.0)
    if is_pinhole(camera):
        return ray_through(camera, BLACK, d)
    x, y = square_to_aperture(u0, u1, camera)
    lens = Vec3(x, y, 0.0) * camera.lens_radius
    return ray_through(camera, lens, d * camera.focus_distance - lens)
