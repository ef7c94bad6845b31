# SPDX-License-Identifier: GPL-3.0-or-later
"""Warps: maps from the unit square to shapes, by which two random numbers become a point or a direction.

`square_to_X(u0, u1)` takes uniform numbers in [0, 1) to a point of X with density `square_to_X_pdf`; on the sphere that
is a density per solid angle, else per area. `X_to_square` is the inverse. Directions are around +z.
All are continuous where that is possible, so that well spread numbers stay well spread. Their cases are selected, not
branched to: which one comes next is as random as the numbers, so a branch costs more than what it saves.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import Vec3

ONE = np.float32(1.0)
PI = np.float32(math.pi)
TWO_PI = np.float32(2.0 * math.pi)
HALF_PI = np.float32(0.5 * math.pi)
QUARTER_PI = np.float32(0.25 * math.pi)
INV_PI = np.float32(1.0 / math.pi)
INV_TWO_PI = np.float32(0.5 / math.pi)
INV_FOUR_PI = np.float32(0.25 / math.pi)
LEAST = np.float32(1e-37)

# ---- Disk ------------------------------------------------------------------------------------------------------------


@kernel
def square_to_disk(u0, u1):
    """(x, y) uniform on the unit disk; squares around the centre become circles (Shirley and Chiu 1997)."""
    a = 2.0 * u0 - 1.0
    b = 2.0 * u1 - 1.0
    wide = abs(a) > abs(b)
    r, other = a if wide else b, b if wide else a
    c, s = cos_sin_octant(QUARTER_PI * (other / (r if r != 0.0 else ONE)))
    return r * (c if wide else s), r * (s if wide else c)


@kernel
def square_to_disk_pdf(x, y):
    """Per area: 1 / pi on the disk."""
    return INV_PI if x * x + y * y <= 1.0 else np.float32(0.0)


@kernel
def disk_to_square(x, y):
    """(u0, u1) that `square_to_disk` takes to (x, y)."""
    r = math.sqrt(x * x + y * y)
    if abs(x) > abs(y):
        a = math.copysign(r, x)
        b = a * math.atan(y / x) / QUARTER_PI
    elif y != 0.0:
        b = math.copysign(r, y)
        a = b * math.atan(x / y) / QUARTER_PI
    else:
        a, b = r, r
    return 0.5 * a + 0.5, 0.5 * b + 0.5


# ---- Directions ------------------------------------------------------------------------------------------------------


@kernel
def square_to_cosine_hemisphere(u0, u1):
    """A direction with density proportional to its cosine: the disk, lifted to the sphere (Malley's method)."""
    x, y = square_to_disk(u0, u1)
    return Vec3(x, y, math.sqrt(max(1.0 - x * x - y * y, 0.0)))


@kernel
def square_to_cosine_hemisphere_pdf(w):
    """Per solid angle: cos / pi above the horizon."""
    return max(w.z, 0.0) * INV_PI


@kernel
def cosine_hemisphere_to_square(w):
    return disk_to_square(w.x, w.y)


@kernel
def square_to_sphere(u0, u1):
    """A direction uniform on the sphere."""
    z = 1.0 - 2.0 * u0
    r = math.sqrt(max(1.0 - z * z, 0.0))
    c, s = cos_sin_turn(u1)
    return Vec3(r * c, r * s, z)


@kernel
def square_to_sphere_pdf():
    """Per solid angle: 1 / (4 pi) everywhere."""
    return INV_FOUR_PI


@kernel
def sphere_to_square(w):
    """(u0, u1) that `square_to_sphere` takes to `w`."""
    turn = angle_of(w.y, w.x) * INV_TWO_PI
    return 0.5 - 0.5 * w.z, turn + 1.0 if turn < 0.0 else turn


@kernel
def square_to_cone(u0, u1, height):
    """A direction uniform in the cone whose half angle has 1 - cos = `height`: the height of the cap it cuts out.

    Not the cosine itself: for a cone as narrow as the sun's disk float32 leaves the cosine two digits of information.
    The concentric disk, with its radius changed from that of a projected hemisphere to that of the cap.
    """
    x, y = square_to_disk(u0, u1)
    down = height * (x * x + y * y)
    stretch = math.sqrt(height * (2.0 - down))
    return Vec3(x * stretch, y * stretch, 1.0 - down)


@kernel
def square_to_cone_pdf(height):
    """Per solid angle, inside of the cone; its solid angle is 2 pi `height`."""
    return INV_TWO_PI / height


@kernel
def cone_to_square(w, height):
    """(u0, u1) that `square_to_cone` takes to `w`."""
    shrink = 1.0 / math.sqrt(height * (1.0 + w.z))
    return disk_to_square(w.x * shrink, w.y * shrink)


@kernel
def cap_height(sine_squared):
    """1 - cos of an angle up to 90 degrees, from the square of its sine, without cancellation."""
    return sine_squared / (1.0 + math.sqrt(max(1.0 - sine_squared, 0.0)))


# ---- Triangles and polygons ------------------------------------------------------------------------------------------


@kernel
def square_to_triangle(u0, u1):
    """Barycentrics (b1, b2) uniform on a triangle; the density per area is 1 / its area.

    Folds the square along its diagonal, which distorts less than the map by a square root (Heitz 2019).
    """
    half = 0.5 * min(u0, u1)
    return half if u1 > u0 else u0 - half, u1 - half if u1 > u0 else half


@kernel
def triangle_to_square(b1, b2):
    """(u0, u1) that `square_to_triangle` takes to (b1, b2)."""
    if b2 > b1:
        return 2.0 * b1, b2 + b1
    return b1 + b2, 2.0 * b2


@kernel
def square_to_regular_polygon(u0, u1, corners):
    """(x, y) uniform on the regular polygon inscribed in the unit circle, with the middle of an edge on the x axis.

    u0 chooses one of the triangles around the centre and then, stretched again, a point of it.
    """
    n = np.float32(corners)
    scaled = u0 * n
    triangle = np.float32(np.int32(scaled))
    b1, b2 = square_to_triangle(scaled - triangle, u1)
    half_edge, apothem = math.sin(PI / n), math.cos(PI / n)
    x, y = (b1 + b2) * apothem, (b2 - b1) * half_edge
    c, s = cos_sin_turn(triangle / n)
    return c * x - s * y, s * x + c * y


@kernel
def square_to_regular_polygon_pdf(corners):
    """Per area, inside of the polygon: 1 / its area."""
    n = np.float32(corners)
    return 1.0 / (0.5 * n * math.sin(TWO_PI / n))


# ---- Circular functions ----------------------------------------------------------------------------------------------


@kernel
def cos_sin_octant(angle):
    """(cos, sin) for |angle| <= pi / 4, to 1 in the last place: minimax polynomials, cheaper than calls of libm."""
    q = angle * angle
    c = 1.0 + q * (-0.5 + q * (4.166664568298827e-2 + q * (-1.388731625493765e-3 + q * 2.443315711809948e-5)))
    s = angle + angle * q * (-1.6666654611e-1 + q * (8.3321608736e-3 + q * -1.9515295891e-4))
    return c, s


@kernel
def cos_sin_turn(turn):
    """(cos, sin) of 2 pi `turn`, for a turn from 0 to 1."""
    quarter = np.int32(4.0 * turn + 0.5)
    c, s = cos_sin_octant(HALF_PI * (4.0 * turn - np.float32(quarter)))
    odd = quarter & 1 != 0
    x, y = s if odd else c, c if odd else s
    return -x if (quarter + 1) & 2 != 0 else x, -y if quarter & 2 != 0 else y


@kernel
def angle_of(y, x):
    """The angle of the point (x, y) from the x axis, -pi to pi, as math.atan2; 0 at the origin.

    With a relative error below 2.5e-7 and without a branch: atan(a) = a + a^3 P(a^2) for 0 <= a <= 1, with the P of
    least relative error, and the octants mirrored. Cheaper than a call of libm, too.
    """
    abs_x, abs_y = abs(x), abs(y)
    a = min(abs_x, abs_y) / max(abs_x, abs_y, LEAST)
    q = a * a
    high = -7.552212476730347e-2 + q * (4.321183264255524e-2 + q * (-1.636791042983532e-2 + q * 2.9206876643002e-3))
    low = -3.3333153252577515e-1 + q * (
        1.9993773102760315e-1 + q * (-1.4211055636405945e-1 + q * 1.0666003823280334e-1)
    )
    q2 = q * q
    angle = a + a * q * (low + q2 * q2 * high)
    angle = HALF_PI - angle if abs_y > abs_x else angle
    angle = PI - angle if x < 0.0 else angle
    return math.copysign(angle, y)
