# SPDX-License-Identifier: GPL-3.0-or-later
"""The frames in which the lobes of a BSDF scatter: one for each normal and tangent that its closures ask for.

Frame 0 has the smooth normal of the surface. Until `complete`, the `s` of a frame is the tangent that a program gave.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.frame import frame_from_normal
from ..linalg.scalar_math import float_bits
from ..linalg.vec3 import BLACK, cross, dot, is_black, load3, normalize, store3
from ..linalg.vector_math import safe_normalize
from ..sampling.rng import hash_float
from ..shape.interaction import is_strand, tangents
from ..tables import MAX_FRAMES, LobeKind

ZERO = np.float32(0.0)
LOWEST_MIRRORED = np.float32(0.01)  # least height of a mirrored view above the face, as in Cycles


@kernel
def begin_frames(bsdf, ng, ns):
    store3(bsdf, "ng", ng)
    store3(bsdf.frames[0], "n", ns)
    store3(bsdf.frames[0], "s", BLACK)
    bsdf.frame_count, bsdf.frame = 1, 0


@kernel
def frame_with(bsdf, normal, tangent):
    """Row of the frame of a closure's normal and tangent, world space; zero: those of the surface."""
    n = load3(bsdf.frames[0], "n") if is_black(normal) else safe_normalize(normal)
    for i in range(bsdf.frame_count):
        if is_black(n - load3(bsdf.frames[i], "n")) and is_black(tangent - load3(bsdf.frames[i], "s")):
            return i
    return _new_frame(bsdf, n, tangent)


@kernel
def complete_frames(bsdf):
    """Make tangents that are at right angles to the normals, in frames that lobes have."""
    last = -1
    for i in range(bsdf.count):
        row = bsdf.lobes[i].frame
        if row != last:
            _complete(bsdf, row)
            last = row


@kernel
def lay_along(scene, bsdf, it, wo):
    """Give lobes of FIBRES frames that lie along the strand: x its direction, z as near to the normal as can be.

    On other surfaces Cycles lays principled hair along the first edge of the triangle, the Hair node's lobes along the
    second, without a tilt. A tangent that a program gave goes before.
    """
    tangent, bitangent = tangents(scene, it)
    for i in range(bsdf.count):
        lobe = bsdf.lobes[i]
        if lobe.kind == LobeKind.HAIR:
            _lay(bsdf, lobe, load3(it, "ng"), tangent)
        elif lobe.kind == LobeKind.HAIR_FACETS:
            n = load3(it, "ng") if is_strand(scene, it) else _anywhere_across(it, wo, tangent)
            _lay(bsdf, lobe, n, tangent)
        elif lobe.kind == LobeKind.HAIR_REFLECTION or lobe.kind == LobeKind.HAIR_TRANSMISSION:
            given = load3(bsdf.frames[lobe.frame], "s")
            if lobe.fresnel == 0:
                given = bitangent
                if not is_strand(scene, it):
                    lobe.g = ZERO
            _lay(bsdf, lobe, load3(it, "ns"), given)


@kernel
def _anywhere_across(it, wo, tangent):
    """The normal where a ray might hit a hair that lies there: by chance, as far as the bits of the place are that."""
    p, along = load3(it, "p"), safe_normalize(tangent)
    h = 2.0 * hash_float(float_bits(p.x), float_bits(p.y), float_bits(p.z)) - 1.0
    side = safe_normalize(cross(along, wo))
    return cross(side, along) * math.sqrt(1.0 - h * h) + side * h


@kernel
def _lay(bsdf, lobe, n, tangent):
    along = safe_normalize(tangent)
    lobe.frame = _new_frame(bsdf, safe_normalize(n - along * dot(n, along)), along)
    _complete(bsdf, lobe.frame)


@kernel
def raise_mirrors(bsdf, wo):
    """Bend the normals of lobes that mirror, where what they mirror were to come out of the surface's inside.

    Towards the face as far as it takes for the mirrored view to be above it, as in Cycles: so bumps and smooth normals
    stay lit near the outline. Matt lobes keep their normals.
    """
    ng, source, bent = load3(bsdf, "ng"), -1, 0
    for i in range(bsdf.count):
        lobe = bsdf.lobes[i]
        if mirrors(lobe.kind):
            if lobe.frame != source:
                source, bent = lobe.frame, _raised(bsdf, lobe.frame, ng, wo)
            lobe.frame = bent


@kernel
def mirrors(kind):
    """Whether a lobe of that kind needs its normal raised; Translucent is among them in Cycles."""
    return (
        kind == LobeKind.CONDUCTOR
        or kind == LobeKind.DIELECTRIC
        or kind == LobeKind.REFRACTION
        or kind == LobeKind.COATING
        or kind == LobeKind.TRANSLUCENT
        or kind == LobeKind.SUBSURFACE
        or kind == LobeKind.ASHIKHMIN_SHIRLEY
        or kind == LobeKind.THIN_WALL
    )


@kernel
def _raised(bsdf, row, ng, wo):
    """Row of the frame with the normal of frame `row`, raised if need be."""
    n = load3(bsdf.frames[row], "n")
    height, cosine, along = dot(ng, wo), dot(n, wo), dot(n, ng)
    least = min(0.9 * height, LOWEST_MIRRORED)
    if 2.0 * cosine * along - height >= least:
        return row
    # In the plane of n and ng, with ng as the z axis, the raised normal is (x, z). That its mirrored view has the
    # height `least` is 2 (x wx + z wz) z - wz = least; squared, with x^2 = 1 - z^2, it is quadratic in z^2.
    side = safe_normalize(n - ng * along)
    across = dot(wo, side)
    a = across * across + height * height
    b = 2.0 * (a + height * least)
    c = (least + height) * (least + height)
    root = math.sqrt(max(b * b - 4.0 * a * c, 0.0))
    z2 = min(max(0.25 * ((b + root) if across < 0.0 else (b - root)) / a, ZERO), 1.0) if a > 0.0 else 1.0
    new = _new_frame(bsdf, side * math.sqrt(1.0 - z2) + ng * math.sqrt(z2), load3(bsdf.frames[row], "s"))
    _complete(bsdf, new)
    return new


@kernel
def _new_frame(bsdf, n, tangent):
    """Row of a new frame; where there is no room, the last one gives way."""
    row = min(bsdf.frame_count, MAX_FRAMES - 1)
    bsdf.frame_count = row + 1
    store3(bsdf.frames[row], "n", n)
    store3(bsdf.frames[row], "s", tangent)
    return row


@kernel
def _complete(bsdf, row):
    frame = bsdf.frames[row]
    n = load3(frame, "n")
    s, t = frame_from_normal(n)
    along = cross(n, load3(frame, "s"))
    if dot(along, along) > 1e-12:
        t = normalize(along)
        s = cross(t, n)
    store3(frame, "s", s)
    store3(frame, "t", t)
    frame.bend = ZERO
    if row > 0:  # Conty Estevez, Lecocq and Stein 2019, see `bsdf.dispatch.bump_shadowing`
        cos = dot(n, load3(bsdf.frames[0], "n"))
        frame.bend = min(max(0.125 * (1.0 / (cos * cos) - 1.0), 0.0), 1.0)
