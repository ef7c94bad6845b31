# SPDX-License-Identifier: GPL-3.0-or-later
"""Boxes that shine equally from everywhere: emissive analytic boxes of the scene.

From outside, one of the up to three faces that can be seen is chosen by solid angle, and sampled as a rectangle by
solid angle (Urena et al. 2013). From inside, faces are all around: directions are uniform on the sphere, and on the
hemisphere for a point on the surface.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.frame import frame_from_normal, from_local
from ..linalg.vec3 import BLACK, Vec3, dot, length, load3
from ..sampling.spherical import (
    LEAST_SOLID_ANGLE,
    Rectangle,
    is_small_rectangle,
    rectangle_area_pdf,
    rectangle_solid_angle,
    sample_rectangle,
    sample_rectangle_pdf,
)
from ..sampling.warp import INV_FOUR_PI, INV_TWO_PI, square_to_cone, square_to_sphere
from ..shape import box
from ..shape.quad import IN_PLANE
from .light_sample import ONE, ZERO, LightSample, no_light

ONE_MINUS = np.float32(1.0 - 2.0**-24)  # the largest number below 1
INFINITY = np.float32(np.inf)


class View(NamedTuple):
    """A box as seen from a point."""

    frame: box.Axes
    eye: Vec3  # the point, along the edges from the centre
    height: float  # of it over the plane of the face that is the most in front of it; negative inside
    side: int  # 1: outside, -1: inside, 0: on the surface
    weight_x: float  # solid angle of the face across each axis that can be seen from outside, else 0
    weight_y: float
    weight_z: float


@kernel
def sample(light, p, u0, u1):
    view = view_from(light, p)
    frame = view.frame
    if view.side <= 0:
        return sample_from_within(light, view, u0, u1)

    total = view.weight_x + view.weight_y + view.weight_z
    if not total > 0.0:
        return no_light()
    u0 *= total
    axis, weight = 0, view.weight_x
    if u0 >= weight and total > weight:
        u0 -= weight
        axis, weight = 1, view.weight_y
        if u0 >= weight and view.weight_z > 0.0:
            u0 -= weight
            axis, weight = 2, view.weight_z
    rectangle = face(view, axis)
    x, y, density = sample_rectangle(min(u0 / weight, ONE_MINUS), u1, rectangle)
    distance = math.sqrt(x * x + y * y + rectangle.z * rectangle.z)
    if axis == 0:
        to_light = frame.y * x + frame.z * y - frame.x * math.copysign(rectangle.z, view.eye.x)
    elif axis == 1:
        to_light = frame.z * x + frame.x * y - frame.y * math.copysign(rectangle.z, view.eye.y)
    else:
        to_light = frame.x * x + frame.y * y - frame.z * math.copysign(rectangle.z, view.eye.z)
    return LightSample(to_light * (1.0 / distance), distance, load3(light, "emission"), density * weight / total, False)


@kernel
def emitted(light, p, wi, t):
    view = view_from(light, p)
    shines = light.two_sided != 0 or t <= middle(view, box.local(view.frame, wi))
    return load3(light, "emission") if shines else BLACK


@kernel
def pdf(light, p, wi, t):
    view = view_from(light, p)
    d = box.local(view.frame, wi)
    if view.side <= 0:
        if light.two_sided == 0:
            return ZERO
        if view.side == 0:
            return INV_TWO_PI if dot(wi, box.nearest_face(light, p).normal) < 0.0 else ZERO
        return INV_FOUR_PI

    if t > middle(view, d):  # a ray that started within, as rounding has it
        return ZERO
    # of the faces that can be seen, the ray meets that one whose plane it meets last
    tx = entry(view.eye.x, d.x, view.frame.half.x, view.weight_x)
    ty = entry(view.eye.y, d.y, view.frame.half.y, view.weight_y)
    tz = entry(view.eye.z, d.z, view.frame.half.z, view.weight_z)
    total = view.weight_x + view.weight_y + view.weight_z
    axis, weight, t, x, y = 2, view.weight_z, tz, d.x, d.y
    if tx >= ty and tx >= tz:
        axis, weight, t, x, y = 0, view.weight_x, tx, d.y, d.z
    elif ty >= tz:
        axis, weight, t, x, y = 1, view.weight_y, ty, d.z, d.x
    if not weight > 0.0 or t == INFINITY:
        return ZERO
    return sample_rectangle_pdf(face(view, axis), x * t, y * t) * weight / total


@kernel
def sample_from_within(light, view, u0, u1):
    if light.two_sided == 0:
        return no_light()
    if view.side < 0:
        d, density = square_to_sphere(u0, u1), INV_FOUR_PI
    else:
        at, half = view.eye, view.frame.half
        x, y, z = abs(at.x) - half.x, abs(at.y) - half.y, abs(at.z) - half.z
        inwards = Vec3(ZERO, ZERO, -math.copysign(ONE, at.z))
        if x >= y and x >= z:
            inwards = Vec3(-math.copysign(ONE, at.x), ZERO, ZERO)
        elif y >= z:
            inwards = Vec3(ZERO, -math.copysign(ONE, at.y), ZERO)
        s, t = frame_from_normal(inwards)
        d, density = from_local(s, t, inwards, square_to_cone(u0, u1, ONE)), INV_TWO_PI
    frame = view.frame
    distance = exit_distance(view, d)
    radiance = load3(light, "emission")
    if not distance > 0.0:  # at an edge: out through the other face
        distance, radiance = ZERO, BLACK
    return LightSample(frame.x * d.x + frame.y * d.y + frame.z * d.z, distance, radiance, density, False)


@kernel
def view_from(light, p):
    frame = box.axes(light)
    h = p - load3(light, "p")
    eye = box.local(frame, h)
    in_plane = IN_PLANE * length(h)
    x, y, z = abs(eye.x) - frame.half.x, abs(eye.y) - frame.half.y, abs(eye.z) - frame.half.z
    height = max(x, max(y, z))
    side = 1 if height > in_plane else (-1 if height < -in_plane else 0)
    view = View(frame, eye, height, side, ZERO, ZERO, ZERO)
    if side <= 0:
        return view
    return View(
        frame,
        eye,
        height,
        side,
        weight_of(face(view, 0)) if x > in_plane else ZERO,
        weight_of(face(view, 1)) if y > in_plane else ZERO,
        weight_of(face(view, 2)) if z > in_plane else ZERO,
    )


@kernel
def face(view, axis):
    """The face across an axis on the side of the eye, as the eye sees it: x and y along the two axes that follow."""
    eye, half = view.eye, view.frame.half
    if axis == 0:
        return Rectangle(-half.y - eye.y, half.y - eye.y, -half.z - eye.z, half.z - eye.z, abs(eye.x) - half.x)
    if axis == 1:
        return Rectangle(-half.z - eye.z, half.z - eye.z, -half.x - eye.x, half.x - eye.x, abs(eye.y) - half.y)
    return Rectangle(-half.x - eye.x, half.x - eye.x, -half.y - eye.y, half.y - eye.y, abs(eye.z) - half.z)


@kernel
def weight_of(rectangle):
    """Solid angle of a face; where the formula has no digits left, as that of its area in its middle."""
    if not is_small_rectangle(rectangle):
        solid_angle, _ = rectangle_solid_angle(rectangle)
        if solid_angle > LEAST_SOLID_ANGLE:
            return solid_angle
    x, y = 0.5 * (rectangle.x0 + rectangle.x1), 0.5 * (rectangle.y0 + rectangle.y1)
    return 1.0 / rectangle_area_pdf(rectangle, x, y)


@kernel
def entry(eye, d, half, weight):
    """Distance to the plane of a face that can be seen, infinite if the ray does not get there; 0 for other faces."""
    if weight == 0.0:
        return ZERO
    cosine = d if eye < 0.0 else -d
    return (abs(eye) - half) / cosine if cosine > 0.0 else INFINITY


@kernel
def exit_distance(view, d):
    """Where a ray along `d` leaves the box."""
    eye, half = view.eye, view.frame.half
    x = (math.copysign(half.x, d.x) - eye.x) / d.x if d.x != 0.0 else INFINITY
    y = (math.copysign(half.y, d.y) - eye.y) / d.y if d.y != 0.0 else INFINITY
    z = (math.copysign(half.z, d.z) - eye.z) / d.z if d.z != 0.0 else INFINITY
    return min(x, min(y, z))


@kernel
def middle(view, d):
    """The middle between entering and leaving: to tell which of both a distance means. Negative from inside."""
    if view.side <= 0:
        return np.float32(-1.0)
    tx = entry(view.eye.x, d.x, view.frame.half.x, view.weight_x)
    ty = entry(view.eye.y, d.y, view.frame.half.y, view.weight_y)
    tz = entry(view.eye.z, d.z, view.frame.half.z, view.weight_z)
    return 0.5 * (max(tx, max(ty, tz)) + exit_distance(view, d))
