# SPDX-License-Identifier: GPL-3.0-or-later
"""The ray of a camera of any kind: a row of CAMERA."""

from ..jit import kernel
from ..linalg.vec3 import lerp
from ..tables import CameraKind
from . import orthographic, perspective


@kernel
def generate_ray(camera, x, y, u0, u1):
    """The CameraRay for a place in the full frame, (0, 0) lower left to (1, 1) upper right.

    `u0`, `u1`: uniform in [0, 1), for the lens.
    """
    screen_x = lerp(camera.screen[0], camera.screen[1], x)
    screen_y = lerp(camera.screen[2], camera.screen[3], y)
    if camera.kind == CameraKind.ORTHOGRAPHIC:
        return orthographic.generate_ray(camera, screen_x, screen_y, u0, u1)
    return perspective.generate_ray(camera, screen_x, screen_y, u0, u1)
