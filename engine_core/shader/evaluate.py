# SPDX-License-Identifier: GPL-3.0-or-later
"""Fill the BSDF of a hit with the lobes of its material.

Materials are constant: their lobes stand in the scene's table and are copied. A material that is a program of shader
nodes would be run here, and fill the same rows.
"""

from ..jit import kernel
from ..linalg.frame import frame_from_normal
from ..linalg.records import copy_record
from ..linalg.vec3 import load3, store3
from ..tables import LobeKind


@kernel
def fill_bsdf(scene, it, bsdf, keep_reflections, keep_refractions):
    """Set frame and lobes of `bsdf` for the Interaction `it`.

    `keep_reflections`, `keep_refractions`: whether lobes that would cast caustics take part.
    """
    store3(bsdf, "ng", it.ng)
    store3(bsdf, "n", it.ns)
    s, t = frame_from_normal(it.ns)
    store3(bsdf, "s", s)
    store3(bsdf, "t", t)
    material = scene.materials[it.material]
    count = 0
    for i in range(material.lobes, material.lobes + material.lobe_count):
        lobe = scene.lobes[i]
        if lobe.kind == LobeKind.CONDUCTOR or lobe.kind == LobeKind.COATING:
            if not keep_reflections:
                continue
        elif lobe.kind == LobeKind.REFRACTION and not keep_refractions:
            continue
        copy_record(bsdf.lobes[count], lobe)
        if lobe.kind == LobeKind.DIELECTRIC:
            if not keep_reflections:
                store3(bsdf.lobes[count], "reflect_tint", load3(lobe, "reflect_tint") * 0.0)
            if not keep_refractions:
                store3(bsdf.lobes[count], "refract_tint", load3(lobe, "refract_tint") * 0.0)
        count += 1
    bsdf.count = count
