# SPDX-License-Identifier: GPL-3.0-or-later
"""Questions to a light of any kind: a row of LIGHT.

`p`: the point that is lit. Visibility, and whether something stands between, is for the caller.
"""

import math

from ..jit import kernel
from ..linalg.vec3 import BLACK, load3, normalize
from ..shape.box import nearest_face
from ..tables import LightKind
from . import background, box, disk, point, quad, sphere, spot, sun, triangle


@kernel
def sample(scene, light, p, u0, u1):
    """A direction from which `light` may shine on `p`: a LightSample."""
    kind = light.kind
    if kind == LightKind.TRIANGLE:
        return triangle.sample(light, p, u0, u1)
    if kind == LightKind.QUAD:
        return quad.sample(light, p, u0, u1)
    if kind == LightKind.POINT:
        return point.sample(light, p, u0, u1)
    if kind == LightKind.SPOT:
        return spot.sample(light, p, u0, u1)
    if kind == LightKind.SUN:
        return sun.sample(light, u0, u1)
    if kind == LightKind.DISK:
        return disk.sample(light, p, u0, u1)
    if kind == LightKind.SPHERE:
        return sphere.sample(light, p, u0, u1)
    if kind == LightKind.BOX:
        return box.sample(light, p, u0, u1)
    return background.sample(scene, light, u0, u1)


@kernel
def emitted(scene, light, p, wi, t):
    """Radiance that a ray from `p` along `wi` receives, which runs into the light's shape at distance `t`.

    Of a sun: if `wi` points into its disk.
    """
    kind = light.kind
    if kind == LightKind.TRIANGLE:
        return triangle.emitted(light, wi)
    if kind == LightKind.QUAD:
        return quad.emitted(light, wi)
    if kind == LightKind.POINT:
        return point.emitted(light, p, wi, t)
    if kind == LightKind.SPOT:
        return spot.emitted(light, p, wi, t)
    if kind == LightKind.SUN:
        return sun.emitted(light, wi)
    if kind == LightKind.DISK:
        return disk.emitted(light, wi)
    if kind == LightKind.SPHERE:
        return sphere.emitted(light, p, wi, t)
    if kind == LightKind.BOX:
        return box.emitted(light, p, wi, t)
    return background.emitted(light)


@kernel
def pdf(scene, light, p, wi, t):
    """Density per solid angle with which `sample` finds `wi`, for a ray that runs into the light's shape at `t`."""
    kind = light.kind
    if kind == LightKind.TRIANGLE:
        return triangle.pdf(light, p, wi, t)
    if kind == LightKind.QUAD:
        return quad.pdf(light, p, wi, t)
    if kind == LightKind.POINT:
        return point.pdf(light, p, wi, t)
    if kind == LightKind.SPOT:
        return spot.pdf(light, p, wi, t)
    if kind == LightKind.SUN:
        return sun.pdf(light, wi)
    if kind == LightKind.DISK:
        return disk.pdf(light, p, wi, t)
    if kind == LightKind.SPHERE:
        return sphere.pdf(light, p)
    if kind == LightKind.BOX:
        return box.pdf(light, p, wi, t)
    return background.pdf(scene, wi)


@kernel
def centre(light):
    """A point in the middle of a light that stands somewhere."""
    p = load3(light, "p")
    if light.kind == LightKind.TRIANGLE:
        return p + (load3(light, "u") + load3(light, "v")) * (1.0 / 3.0)
    return p


@kernel
def size(light):
    """About how far it reaches from its centre."""
    return max(light.radius, 0.5 * math.sqrt(light.area))


@kernel
def surface_normal(light, q):
    """Unit normal of the light at its point `q` if it is geometry, which blocks rays; zero for lamps."""
    kind = light.kind
    if kind == LightKind.TRIANGLE:
        return load3(light, "n")
    if kind == LightKind.SPHERE:
        return normalize(q - load3(light, "p"))
    if kind == LightKind.BOX:
        return nearest_face(light, q).normal
    if kind == LightKind.QUAD and light.instance >= 0:
        return load3(light, "n")
    return BLACK
