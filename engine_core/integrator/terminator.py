# SPDX-License-Identifier: GPL-3.0-or-later
"""Where light grazes a smooth mesh: its faces are not to be seen in the shadow on its far side.

The normals of a smooth mesh are those of a curved surface; its faces are flat. Where light comes from below the horizon
of a face but above that of the curved surface, the face would be in its own shadow, and the edge of light would be
jagged. So there shadow rays leave from where the curved surface would be, which Blender calls Geometry Offset. It is
for sampled light alone, as in Cycles: what scattering finds still sees the faces.
"""

import numpy as np

from ..jit import kernel
from ..linalg.ray import offset_ray_origin
from ..linalg.transform import transform_vector
from ..linalg.vec3 import dot, load3, load3_at, normalize
from ..motion import instance_at, new_instance

ZERO = np.float32(0.0)


@kernel
def lift_below(scene, walk, it, wi):
    """The cosine below which light lifts the origin of shadow rays; 0 where light along `wi` need not be asked."""
    most = scene.world[0].lift_below
    if most <= 0.0 or walk.prim < 0:
        return ZERO
    flat, smooth = dot(load3(it, "ng"), wi), dot(load3(it, "ns"), wi)
    if (flat if smooth >= 0.0 else -flat) >= 2.0 * most:
        return ZERO
    return scene.objects[it.instance].lift_below


@kernel
def lifted(scene, walk, it, wi, below):
    """Origin of a shadow ray along `wi` from `it`, on the side that the smooth normal says."""
    smooth = dot(load3(it, "ns"), wi)
    ng = load3(it, "ng") if smooth >= 0.0 else -load3(it, "ng")
    flat, smooth = dot(ng, wi), abs(smooth)
    share = 2.0 - (flat + smooth) / below if smooth < below else 1.0 - flat / below
    p = load3(it, "p")
    if share > 0.0:
        p = p + height(scene, walk, it, ng) * min(share, 1.0)
    return offset_ray_origin(p, ng)


@kernel
def height(scene, walk, it, ng):
    """The way from the face to the curved surface, on the side of `ng`.

    Along the interpolated normal n by the larger of two guesses: half the height of a parabola that has the normals of
    the corners, and the lowest of the three planes through corners, each at right angles to the normal there and moved
    up until no other corner is above it.
    """
    triangle = scene.triangles[walk.prim]
    b1, b2 = walk.b1, walk.b2
    b0 = 1.0 - b1 - b2
    p0, p1, p2 = load3_at(triangle, "p", 0), load3_at(triangle, "p", 1), load3_at(triangle, "p", 2)
    n0, n1 = normalize(load3_at(triangle, "n", 0)), normalize(load3_at(triangle, "n", 1))
    n2 = normalize(load3_at(triangle, "n", 2))
    p, n = p0 * b0 + p1 * b1 + p2 * b2, n0 * b0 + n1 * b1 + n2 * b2
    up = n
    if triangle.instance < 0:  # stands in the space of its object
        through = instance_at(scene, it.instance, it.time, new_instance())
        up = transform_vector(through, "to_world", n)
    side = 1.0 if dot(up, ng) > 0.0 else -1.0

    a, b, c = dot(n2 - n0, p0 - p2), dot(n2 - n1, p1 - p2), dot(n1 - n0, p1 - p0)
    parabola = side * (a * b0 * (b0 - 1.0) + (a + b + c) * b0 * b1 + b * b1 * (b1 - 1.0))
    n0, n1, n2 = n0 * side, n1 * side, n2 * side
    planes = min(
        dot(p0 - p, n0) + max(dot(p1 - p0, n0), dot(p2 - p0, n0), 0.0),
        dot(p1 - p, n1) + max(dot(p0 - p1, n1), dot(p2 - p1, n1), 0.0),
        dot(p2 - p, n2) + max(dot(p0 - p2, n2), dot(p1 - p2, n2), 0.0),
    )
    return up * (side * max(planes, 0.0, 0.5 * parabola))
