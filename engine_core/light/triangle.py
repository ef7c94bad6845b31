# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of emissive meshes: by solid angle where they are large (Arvo 1995), else uniform on their area."""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import BLACK, Vec3, dot, length, load3, normalize
from ..sampling.spherical import LEAST_SOLID_ANGLE, SMALL, square_to_spherical_triangle, triangle_solid_angle
from ..sampling.warp import square_to_triangle
from .light_sample import ZERO, LightSample, area_pdf, no_light

ONE_THIRD, LEAST = np.float32(1.0 / 3.0), np.float32(1e-37)


class View(NamedTuple):
    """A triangle as seen from a point: unit directions to its corners, and its solid angle; 0: sample by area."""

    a: Vec3
    b: Vec3
    c: Vec3
    solid_angle: float


@kernel
def sample(light, p, u0, u1):
    corner, n = load3(light, "p") - p, load3(light, "n")
    height = dot(corner, n)
    if not emits_towards(light, -height):
        return no_light()
    view = view_from(light, corner)
    if view.solid_angle > 0.0:
        wi = square_to_spherical_triangle(u0, u1, view.a, view.b, view.c, view.solid_angle)
        distance = height / dot(wi, n)
        density = 1.0 / view.solid_angle
    else:
        b1, b2 = square_to_triangle(u0, u1)
        to_light = corner + load3(light, "u") * b1 + load3(light, "v") * b2
        distance = length(to_light)
        wi = to_light * (1.0 / distance)
        density = area_pdf(light.area, distance, abs(dot(wi, n)))
    if distance > 0.0 and density < np.float32(np.inf):
        return LightSample(wi, distance, load3(light, "emission"), density, False)
    return no_light()  # edge on, and rounded out of existence


@kernel
def emitted(light, wi):
    return load3(light, "emission") if emits_towards(light, -dot(wi, load3(light, "n"))) else BLACK


@kernel
def pdf(light, p, wi, t):
    corner = load3(light, "p") - p
    cosine = -dot(wi, load3(light, "n"))
    if not emits_towards(light, cosine):
        return ZERO
    view = view_from(light, corner)
    if view.solid_angle > 0.0:
        return 1.0 / view.solid_angle
    return area_pdf(light.area, t, abs(cosine))


@kernel
def row_at(scene, row, q):
    """The row of LIGHT by which the point `q` of the triangle in `row` is sampled: its own, or that of a part.

    Parts are numbered by digits to the base 4, coarse to fine: those at the three corners, then the one in the middle.
    """
    light = scene.lights[row]
    if light.level == 0:
        return np.int64(row)
    u, v, w = load3(light, "u"), load3(light, "v"), q - load3(light, "p")
    uu, uv, vv, uw, vw = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    scale = 1.0 / max(uu * vv - uv * uv, LEAST)
    b1, b2 = (uw * vv - vw * uv) * scale, (vw * uu - uw * uv) * scale
    part = 0
    for _ in range(light.level):
        b1, b2 = 2.0 * b1, 2.0 * b2
        if b1 + b2 <= 1.0:
            digit = 0
        elif b1 >= 1.0:
            digit, b1 = 1, b1 - 1.0
        elif b2 >= 1.0:
            digit, b2 = 2, b2 - 1.0
        else:
            digit, b1, b2 = 3, 1.0 - b1, 1.0 - b2
        part = 4 * part + digit
    return np.int64(light.parts + part)


@kernel
def emits_towards(light, side):
    """Whether light leaves towards a point on that side: positive is in front."""
    return light.area > 0.0 and (side > 0.0 or (side < 0.0 and light.two_sided != 0))


@kernel
def view_from(light, corner):
    """The View of a light whose first corner lies at `corner`, seen from the origin."""
    u, v = load3(light, "u"), load3(light, "v")
    centre = corner + (u + v) * ONE_THIRD
    if light.area < SMALL * dot(centre, centre):
        return View(BLACK, BLACK, BLACK, ZERO)
    a, b, c = normalize(corner), normalize(corner + u), normalize(corner + v)
    solid_angle = triangle_solid_angle(a, b, c)
    return View(a, b, c, solid_angle if solid_angle > LEAST_SOLID_ANGLE else ZERO)
