# SPDX-License-Identifier: GPL-3.0-or-later
"""What shader programs and shadow rays have to know of lobes: entry points, compiled when the first scene needs them.

The light of a Principled BSDF shines through its sheen and its coat. Its smooth thin walls do not bend light, so
whatever is no ray of the camera passes them as it passes what is transparent: light is sampled through them.
"""

from ..bsdf.coating import absorption
from ..bsdf.dispatch import prepare, to_local
from ..bsdf.microfacet import is_smooth
from ..jit import kernel
from ..linalg.records import scratch_record
from ..linalg.vec3 import BLACK, WHITE, load3, store3
from ..program_tables import CLOSURE, POINT, ClosureKind
from ..shader import link
from ..shader.closures import add_closure
from ..shader.evaluate import fill_bsdf
from ..shader.frames import begin_frames, complete_frames, raise_mirrors
from ..shader.opcodes import Entry
from ..shader.operands import give_vector, number, vector
from ..tables import BSDF, MATERIAL, Facets, LobeKind, MaterialFlag, SubsurfaceKind

new_bsdf, new_closure = scratch_record(BSDF), scratch_record(CLOSURE)


def left_below(scene, op, point, registers):
    """Op.LEFT_BELOW: the share of light that a sheen and a coat let through, from a white base towards `point.wo`."""
    bsdf, closure, wo = new_bsdf(), new_closure(), load3(point, "wo")
    begin_frames(bsdf, load3(point, "ng"), load3(point, "ns"))
    bsdf.count = 0
    set_bare(closure)
    closure.sheen_weight, closure.sheen_roughness = number(op, registers, 0), number(op, registers, 1)
    store3(closure, "sheen_tint", vector(op, registers, 2))
    closure.coat_weight, closure.coat_roughness = number(op, registers, 3), number(op, registers, 4)
    closure.coat_ior = number(op, registers, 5)
    store3(closure, "coat_tint", vector(op, registers, 6))
    store3(closure, "normal", vector(op, registers, 7))
    store3(closure, "coat_normal", vector(op, registers, 8))
    add_closure(bsdf, closure)
    complete_frames(bsdf)
    raise_mirrors(bsdf, wo)
    prepare(bsdf, wo, point.backfacing != 0)
    base = bsdf.lobes[bsdf.count - 1]
    give_vector(op, registers, load3(base, "weight"))


@kernel
def set_bare(closure):
    """A white Principled BSDF with nothing but its matt base: one lobe, the last."""
    closure.kind, closure.layer, closure.multiscatter = ClosureKind.PRINCIPLED, 1, 1
    closure.facets, closure.loose, closure.subsurface = Facets.GGX, 0, SubsurfaceKind.RANDOM_WALK
    closure.weight = closure.alpha = closure.ior = closure.film_ior = 1.0
    closure.roughness = closure.anisotropy = closure.metallic = closure.specular_level = closure.transmission = 0.0
    closure.diffuse_roughness = closure.subsurface_weight = closure.film_thickness = closure.thin_wall = 0.0
    store3(closure, "color", WHITE)
    store3(closure, "edge_tint", WHITE)
    store3(closure, "tangent", BLACK)


def pane(scene, material, point, unused):
    """What a shadow ray gets through a material: its transparent lobes and smooth thin walls, to `point.result`.

    As in Cycles, it is not dimmed by what a coat or a sheen reflects, only by the colour of the coat.
    """
    bsdf, wo, total = new_bsdf(), load3(point, "wo"), BLACK
    fill_bsdf(scene, material, load3(point, "ng"), load3(point, "ns"), wo, point, bsdf, True, True)
    for i in range(bsdf.count):
        if bsdf.lobes[i].covers > 0.0:
            only_tint(bsdf, i, wo)
    prepare(bsdf, wo, point.backfacing != 0)
    open_panes(bsdf)
    for i in range(bsdf.count):
        if bsdf.lobes[i].kind == LobeKind.TRANSPARENT:
            total = total + load3(bsdf.lobes[i], "weight")
    store3(point, "result", total)


@kernel
def only_tint(bsdf, cover, wo):
    """Let a coat or a sheen cover what is below with nothing but its colour."""
    coat, passing = bsdf.lobes[cover], WHITE
    if coat.kind == LobeKind.COATING:
        passing = absorption(coat, to_local(bsdf.frames[coat.frame], wo))
    coat.covers = 0.0
    for i in range(cover + 1, bsdf.count):
        lobe = bsdf.lobes[i]
        if lobe.layer == coat.layer:
            store3(lobe, "weight", load3(lobe, "weight") * passing)


@kernel
def open_panes(bsdf):
    """Let smooth thin walls be transparent, once they are prepared."""
    for i in range(bsdf.count):
        lobe = bsdf.lobes[i]
        if lobe.kind == LobeKind.THIN_WALL and is_smooth(lobe):
            lobe.kind = LobeKind.TRANSPARENT


link.provide_family(Entry.LAYERS, left_below)
link.provide(Entry.PANE, pane, MATERIAL, POINT)


def entries_needed(materials):
    """Entry points that a scene with this table MATERIAL needs beside those of its programs."""
    flags = materials["flags"]
    wanted = ((MaterialFlag.SUBSURFACE, Entry.SUBSURFACE), (MaterialFlag.PANE, Entry.PANE))
    return tuple(entry for flag, entry in wanted if (flags & flag).any())
