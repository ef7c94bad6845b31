# SPDX-License-Identifier: GPL-3.0-or-later
"""What integrators ask of materials: how a place scatters, what it emits, what it lets through.

A constant material's rows stand in the scene's tables. One with a program has the machine make them, behind an address:
see `machine`.
"""

from ..jit import kernel
from ..linalg.records import copy_record
from ..linalg.registers import call
from ..linalg.vec3 import load3, store3
from ..tables import LobeKind
from .frames import begin_frames, complete_frames, raise_mirrors
from .opcodes import Entry

SURFACE, VALUE, LIGHT = int(Entry.SURFACE), int(Entry.VALUE), int(Entry.LIGHT)


@kernel
def has_program(material):
    return material.program > 0 or material.emission_program > 0 or material.holdout_program > 0


@kernel
def fill_bsdf(scene, material, ng, ns, wo, point, bsdf, keep_reflections, keep_refractions):
    """Set frames and lobes of `bsdf` for a row of MATERIAL, seen from `wo`; `point` is set if it `has_program`.

    `keep_reflections`, `keep_refractions`: whether lobes that would cast caustics take part.
    """
    begin_frames(bsdf, ng, ns)
    if material.program > 0:
        call(scene.kernels[SURFACE].address, scene, scene.programs[material.program], point, bsdf)
    else:
        bsdf.count = material.lobe_count
        for i in range(material.lobe_count):
            copy_record(bsdf.lobes[i], scene.lobes[material.lobes + i])
    if not (keep_reflections and keep_refractions):
        drop_caustics(bsdf, keep_reflections, keep_refractions)
    complete_frames(bsdf)
    raise_mirrors(bsdf, wo)


@kernel
def drop_caustics(bsdf, keep_reflections, keep_refractions):
    """Leave out what would cast caustics by reflection, or by refraction."""
    count = 0
    for i in range(bsdf.count):
        lobe = bsdf.lobes[i]
        if lobe.kind == LobeKind.CONDUCTOR or lobe.kind == LobeKind.COATING:
            if not keep_reflections:
                continue
        elif lobe.kind == LobeKind.REFRACTION and not keep_refractions:
            continue
        if count != i:
            copy_record(bsdf.lobes[count], lobe)
        if lobe.kind == LobeKind.DIELECTRIC:
            if not keep_reflections:
                store3(bsdf.lobes[count], "reflect_tint", load3(lobe, "reflect_tint") * 0.0)
            if not keep_refractions:
                store3(bsdf.lobes[count], "refract_tint", load3(lobe, "refract_tint") * 0.0)
        count += 1
    bsdf.count = count


@kernel
def run_program(scene, program, point):
    """The colour that a program gives at `point`."""
    call(scene.kernels[VALUE].address, scene, scene.programs[program], point, point)
    return load3(point, "result")


@kernel
def emission(scene, material, point):
    """Radiance that a surface emits."""
    if material.emission_program > 0:
        return run_program(scene, material.emission_program, point)
    return load3(material, "emission")


@kernel
def holdout(scene, material, point):
    """How much of the picture a surface leaves empty where the camera sees it, 0 to 1 in each channel."""
    if material.holdout_program > 0:
        return run_program(scene, material.holdout_program, point)
    return load3(material, "holdout")


@kernel
def light_radiance(scene, light, point, q, wi, distance, visibility):
    """Radiance of a light with a program at its point `q`, which lies along `wi`, or of a lamp (gain > 0) the factor of
    its radiance; `point` is scratch."""
    store3(point, "p", q)
    store3(point, "wo", -wi)
    point.ray_length, point.visibility = distance, visibility
    call(scene.kernels[LIGHT].address, scene, light, point, point)
    return load3(point, "result")
