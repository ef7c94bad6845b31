# SPDX-License-Identifier: GPL-3.0-or-later
"""Rectangles and triangles as the eye sees them, from the origin: directions uniform in the solid angle they subtend.

The formulas are differences of angles, and lose their digits where little is left. There `sample_rectangle` and
`sample_triangle` take points uniform on the area instead: as good, since from afar the two hardly differ, and cheaper.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import cross, dot, length, normalize
from .warp import INV_TWO_PI, TWO_PI, angle_of, cos_sin_turn

# Smaller than this, its area over its distance squared, a shape is sampled by area.
SMALL = np.float32(0.1)
# So is one that is seen edge on. Angles up to pi have errors of 2e-7 in float32: from here on that is below 1e-4.
LEAST_SOLID_ANGLE = np.float32(2e-3)


class Rectangle(NamedTuple):
    """The points (x, y, z), x0 <= x <= x1, y0 <= y <= y1, in front of an eye at the origin; z > 0."""

    x0: float
    x1: float
    y0: float
    y1: float
    z: float


@kernel
def sample_rectangle(u0, u1, rectangle):
    """(x, y) of a point of the rectangle, and its density per solid angle."""
    x0, x1, y0, y1 = rectangle.x0, rectangle.x1, rectangle.y0, rectangle.y1
    if is_small_rectangle(rectangle):
        solid_angle = phi = np.float32(0.0)
    else:
        solid_angle, phi = rectangle_solid_angle(rectangle)
    if solid_angle > LEAST_SOLID_ANGLE:
        x, y = square_to_spherical_rectangle(u0, u1, rectangle, solid_angle, phi)
        return x, y, 1.0 / solid_angle
    x, y = x0 + u0 * (x1 - x0), y0 + u1 * (y1 - y0)
    return x, y, rectangle_area_pdf(rectangle, x, y)


@kernel
def sample_rectangle_pdf(rectangle, x, y):
    """Density per solid angle of the point (x, y) of the rectangle."""
    if not is_small_rectangle(rectangle):
        solid_angle, _ = rectangle_solid_angle(rectangle)
        if solid_angle > LEAST_SOLID_ANGLE:
            return 1.0 / solid_angle
    return rectangle_area_pdf(rectangle, x, y)


@kernel
def is_small_rectangle(rectangle):
    x, y, z = 0.5 * (rectangle.x0 + rectangle.x1), 0.5 * (rectangle.y0 + rectangle.y1), rectangle.z
    area = (rectangle.x1 - rectangle.x0) * (rectangle.y1 - rectangle.y0)
    return area < SMALL * (x * x + y * y + z * z)


@kernel
def rectangle_area_pdf(rectangle, x, y):
    """Density per solid angle of points uniform on the area: distance^3 / (area z)."""
    d2 = x * x + y * y + rectangle.z * rectangle.z
    area = (rectangle.x1 - rectangle.x0) * (rectangle.y1 - rectangle.y0)
    return d2 * math.sqrt(d2) / (area * rectangle.z)


@kernel
def rectangle_solid_angle(rectangle):
    """Steradians, and the angle `phi` at x0 that sampling starts from.

    An edge at x, seen between y0 and y1, bounds with the plane x = 0 a solid angle phi(x) = asin(c b1) - asin(c b0),
    where b = y / |(y, z)| and c = x / |(x, z)| (Urena et al. 2013).
    """
    phi = edge_angle(rectangle, rectangle.x0)
    return edge_angle(rectangle, rectangle.x1) - phi, phi


@kernel
def edge_angle(rectangle, x):
    """phi(x). Each asin is the argument of a complex number with the parts z |(x, y, z)| and x y."""
    y0, y1, z = rectangle.y0, rectangle.y1, rectangle.z
    re0, im0 = z * math.sqrt(x * x + y0 * y0 + z * z), x * y0
    re1, im1 = z * math.sqrt(x * x + y1 * y1 + z * z), x * y1
    return angle_of(im1 * re0 - re1 * im0, re1 * re0 + im1 * im0)


@kernel
def square_to_spherical_rectangle(u0, u1, rectangle, solid_angle, phi):
    """(x, y) of the rectangle's point in a direction uniform in its solid angle (Urena et al. 2013).

    u0 chooses x by inverting phi: a triangle with the sides b0 and b1 and the angle phi between them has, by the law of
    sines, c = sin phi / its third side. u1 chooses y on the line at x, uniform in y / distance.
    """
    x0, x1, y0, y1, z = rectangle.x0, rectangle.x1, rectangle.y0, rectangle.y1, rectangle.z
    phi += u0 * solid_angle
    b0 = y0 / math.sqrt(y0 * y0 + z * z)
    b1 = y1 / math.sqrt(y1 * y1 + z * z)
    _, s = cos_sin_turn(abs(phi) * (0.5 * INV_TWO_PI))
    s2 = s * s
    sin2 = 4.0 * s2 * (1.0 - s2)  # of phi, squared
    rest2 = (b1 - b0) * (b1 - b0) + 4.0 * b0 * b1 * s2 - sin2  # third side squared, less sin2
    x = z * math.sqrt(sin2 / rest2) if rest2 > 0.0 else np.float32(np.inf)
    x = min(max(math.copysign(x, phi), x0), x1)

    d2 = x * x + z * z
    h0 = y0 / math.sqrt(d2 + y0 * y0)
    h1 = y1 / math.sqrt(d2 + y1 * y1)
    h = h0 + u1 * (h1 - h0)
    h2 = h * h
    y = h * math.sqrt(d2 / (1.0 - h2)) if h2 < 1.0 else y1
    return x, min(max(y, y0), y1)


@kernel
def triangle_solid_angle(a, b, c):
    """Steradians between three unit directions (Van Oosterom and Strackee 1983)."""
    turn = 2.0 * angle_of(abs(dot(a, cross(b, c))), 1.0 + dot(a, b) + dot(b, c) + dot(c, a))
    return turn if turn >= 0.0 else turn + TWO_PI


@kernel
def square_to_spherical_triangle(u0, u1, a, b, c, solid_angle):
    """A direction uniform in the spherical triangle of three unit directions (Arvo 1995).

    u0 cuts off a triangle (a, b, c') with that part of the area, u1 chooses a point on the arc from b to c'.
    """
    normal_b, normal_c = cross(a, b), cross(a, c)
    cos_alpha, sin_alpha = dot(normal_b, normal_c), abs(dot(a, cross(b, c)))
    scale = 1.0 / math.sqrt(cos_alpha * cos_alpha + sin_alpha * sin_alpha)
    cos_alpha, sin_alpha = cos_alpha * scale, sin_alpha * scale

    cos_area, sin_area = cos_sin_turn(u0 * solid_angle * INV_TWO_PI)
    s = sin_area * cos_alpha - cos_area * sin_alpha
    t = cos_area * cos_alpha + sin_area * sin_alpha
    u = t - cos_alpha
    v = s + sin_alpha * dot(a, b)
    denominator = (v * s + u * t) * sin_alpha
    q = np.float32(1.0)
    if denominator != 0.0:
        q = min(max(((v * t - u * s) * cos_alpha - v) / denominator, -1.0), 1.0)
    cut = a * q + normalize(c - a * dot(a, c)) * math.sqrt(1.0 - q * q)

    z = 1.0 - u1 * (1.0 - dot(cut, b))
    across = cut - b * dot(cut, b)
    across_length = length(across)
    if across_length == 0.0:
        return b
    return b * z + across * (math.sqrt(max(1.0 - z * z, 0.0)) / across_length)
