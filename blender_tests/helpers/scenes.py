# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes for tests, and rendering them in one line."""

import numpy as np

from engine_core.integrator.tiles import Render
from engine_core.scene.builder import SceneBuilder, look_at, perspective_screen
from engine_core.settings import Settings

CUBE_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
CUBE_TRIANGLES = np.array(  # seen from outside, counter-clockwise
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ],
    np.int32,
)  # fmt: skip


def settings(size=16, **changes):
    """Settings for a square picture of `size` pixels.

    Unless `changes` say otherwise, bounces are unlimited, and pixels share no samples: their errors are independent.
    """
    bounces = dict.fromkeys(
        ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "volume_bounces"), 1000
    )
    values = {"width": size, "height": size, "crop_width": size, "crop_height": size, "share_samples": 0}
    values |= {**bounces, **changes}
    return Settings(**values)


def builder(eye=(0.0, 0.0, 0.0), target=(0.0, 1.0, 0.0), field_of_view=60.0):
    """A builder whose camera is set."""
    b = SceneBuilder()
    b.camera(look_at(eye, target), perspective_screen(field_of_view))
    return b


def sphere(b, surface, centre=(0, 0, 0), radius=1.0, **options):
    """Add an analytic sphere."""
    material = b.material("sphere", surface)
    b.instance(b.spheres("sphere", [centre], [radius]), materials=[material], **options)


def cube(b, surface, to_world=None, **options):
    """Add a cube of triangles, from -1 to 1."""
    material = b.material("cube", surface)
    matrix = np.eye(4) if to_world is None else to_world
    b.instance(b.mesh("cube", CUBE_CORNERS, CUBE_TRIANGLES), matrix, [material], **options)


def box(b, surface, to_world=None, **options):
    """Add an analytic box, from -1 to 1."""
    matrix = np.eye(4) if to_world is None else to_world
    b.instance(b.boxes("box", [(0, 0, 0)], [(1, 1, 1)]), matrix, [b.material("box", surface)], **options)


def quad(b, surface, to_world=None, **options):
    """Add an analytic square in the xy plane, from -1 to 1, facing up."""
    matrix = np.eye(4) if to_world is None else to_world
    geometry = b.quads("quad", [(0, 0, 0)], [(1, 0, 0)], [(0, 1, 0)])
    b.instance(geometry, matrix, [b.material("quad", surface)], **options)


def plane(b, surface, half=1.0, z=0.0):
    """Add a square in the plane at height `z`, facing up."""
    corners = np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]], np.float32)
    material = b.material("plane", surface)
    b.instance(b.mesh("plane", corners, np.array([[0, 1, 2], [0, 2, 3]])), materials=[material])


def picture(b, threads=0, **changes):
    """Render what the builder has; float32 (h, w, 4), bottom row first."""
    render = Render(b.build(), settings(**changes), threads)
    render.run()
    return render.image("Combined")


def mean_and_error(image):
    """Mean radiance (3,) of a picture, and the standard error of it, from the spread of its pixels."""
    pixels = image[..., :3].reshape(-1, 3).astype(np.float64)
    return pixels.mean(axis=0), pixels.std(axis=0, ddof=1) / np.sqrt(len(pixels))
