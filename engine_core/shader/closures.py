# SPDX-License-Identifier: GPL-3.0-or-later
"""From what an artist sets, a row of CLOSURE, to the lobes that scatter: rows of LOBE in a BSDF.

The one place where that is written: for constant materials it runs once, when a scene is built; where a program sets
the numbers, at each hit. What Blender's nodes mean, Cycles defines.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.color import not_negative
from ..linalg.records import copy_record
from ..linalg.vec3 import BLACK, WHITE, Vec3, average, is_black, lerp, load3, max_component, store3
from ..program_tables import ClosureKind
from ..tables import MAX_LOBES, Facets, FresnelKind, LobeKind, SubsurfaceKind
from .frames import frame_with
from .hair import set_fibre, set_strand
from .maths import saturate

ZERO, ONE = np.float32(0.0), np.float32(1.0)
NEGLIGIBLE = np.float32(1e-5)  # weights below this are dropped, as Cycles does
NO_FILM = np.float32(0.1)  # nanometres
SMALLEST_IOR = np.float32(1e-5)
LEAST_ENTRY_IOR, MOST_ENTRY_IOR = np.float32(1.01), np.float32(3.8)  # limits of subsurface scattering, as Cycles'
MOST_ANISOTROPY, MOST_LEGACY_ANISOTROPY = np.float32(0.99), np.float32(0.9)
LEAST_RADIUS = np.float32(1e-8)  # metres, below which light comes out where it went in
LEAST_ROUGHNESS = np.float32(0.03)  # below, an Ashikhmin-Shirley lobe is as good as a mirror


@kernel
def add_closure(bsdf, c):
    """Add the lobes of the closure `c` to those of the BSDF, which has a frame already."""
    kind = c.kind
    bsdf.frame = frame_with(bsdf, load3(c, "normal"), load3(c, "tangent"))
    weight = WHITE * c.weight
    if kind == ClosureKind.PRINCIPLED:
        add_principled(bsdf, c, weight)
    elif kind == ClosureKind.DIFFUSE:
        add_diffuse(bsdf, weight, load3(c, "color"), c.roughness, 0)
    elif kind == ClosureKind.TRANSLUCENT:
        new_lobe(bsdf, LobeKind.TRANSLUCENT, weight * load3(c, "color"), 0)
    elif kind == ClosureKind.TRANSPARENT:
        new_lobe(bsdf, LobeKind.TRANSPARENT, weight * load3(c, "color"), 0)
    elif kind == ClosureKind.GLASS:
        i = new_lobe(bsdf, LobeKind.DIELECTRIC, weight, 0)
        if i >= 0:
            set_glass(bsdf.lobes[i], c, load3(c, "color"), load3(c, "color"))
    elif kind == ClosureKind.REFRACTION:
        i = new_lobe(bsdf, LobeKind.REFRACTION, weight * load3(c, "color"), 0)
        if i >= 0:
            lobe = bsdf.lobes[i]
            lobe.ior, lobe.facets, lobe.loose = max(c.ior, SMALLEST_IOR), c.facets, c.loose
            set_alphas(lobe, c.roughness, ONE)
    elif kind == ClosureKind.SUBSURFACE:
        add_subsurface(bsdf, c, weight, load3(c, "color"), saturate(c.roughness), c.ior, 0)
    elif ClosureKind.HAIR_COLOR <= kind <= ClosureKind.HAIR_TRANSMISSION:
        add_hair(bsdf, c, weight)
    elif ClosureKind.TOON_DIFFUSE <= kind <= ClosureKind.VELVET:
        add_cloth(bsdf, c, weight * load3(c, "color"))
    else:
        add_metal(bsdf, c, weight)


@kernel
def add_diffuse(bsdf, weight, color, roughness, layer):
    add_diffuse_of(bsdf, weight * color, color, roughness, layer, False)


@kernel
def add_diffuse_of(bsdf, weight, color, roughness, layer, goes_through):
    """What is matt, `color` being that which its weight has: on this side of the face, or through it."""
    kind = LobeKind.DIFFUSE if roughness < NEGLIGIBLE else LobeKind.ROUGH_DIFFUSE
    i = new_lobe(bsdf, LobeKind.TRANSLUCENT if goes_through else kind, weight, layer)
    if i >= 0 and roughness >= NEGLIGIBLE:
        bsdf.lobes[i].alpha_x = saturate(roughness)
        store3(bsdf.lobes[i], "f0", color)


@kernel
def add_cloth(bsdf, c, weight):
    """Sheen, velvet and toon: what is not of microfacets, and has its roughness as it is."""
    kind = LobeKind.SHEEN
    if c.kind == ClosureKind.VELVET:
        kind = LobeKind.VELVET
    elif c.kind == ClosureKind.TOON_DIFFUSE:
        kind = LobeKind.TOON_DIFFUSE
    elif c.kind == ClosureKind.TOON_GLOSSY:
        kind = LobeKind.TOON_GLOSSY
    i = new_lobe(bsdf, kind, weight, 0)
    if i >= 0:
        bsdf.lobes[i].alpha_x, bsdf.lobes[i].alpha_y = saturate(c.roughness), saturate(c.smooth)


@kernel
def add_metal(bsdf, c, weight):
    """Glossy in both its distributions, and Metallic in both its models."""
    if c.kind == ClosureKind.METALLIC or c.kind == ClosureKind.CONDUCTOR:
        stretch = principled_stretch(c.anisotropy)
    else:  # as Blender's Glossy node
        anisotropy = min(max(c.anisotropy, -0.99), 0.99)
        stretch = 1.0 / (1.0 + anisotropy) if anisotropy < 0.0 else 1.0 - anisotropy
    if c.kind == ClosureKind.ASHIKHMIN_SHIRLEY and c.roughness > LEAST_ROUGHNESS:
        i = new_lobe(bsdf, LobeKind.ASHIKHMIN_SHIRLEY, weight * load3(c, "color"), 0)
        if i >= 0:
            set_alphas(bsdf.lobes[i], c.roughness, stretch)
        return
    i = new_lobe(bsdf, LobeKind.CONDUCTOR, weight, 0)
    if i < 0:
        return
    lobe = bsdf.lobes[i]
    if c.kind == ClosureKind.METALLIC:
        lobe.fresnel = FresnelKind.F82
    elif c.kind == ClosureKind.CONDUCTOR:
        lobe.fresnel = FresnelKind.CONDUCTOR
    store3(lobe, "f0", load3(c, "color"))
    if c.kind == ClosureKind.METALLIC or c.kind == ClosureKind.CONDUCTOR:
        store3(lobe, "f82", load3(c, "edge_tint"))
    lobe.multiscatter, lobe.facets = c.multiscatter, c.facets
    set_film(lobe, c)
    set_alphas(lobe, c.roughness, stretch)


@kernel
def add_hair(bsdf, c, weight):
    """Strands, by the Hair node or by Principled Hair."""
    if c.kind == ClosureKind.HAIR_REFLECTION or c.kind == ClosureKind.HAIR_TRANSMISSION:
        kind = LobeKind.HAIR_REFLECTION if c.kind == ClosureKind.HAIR_REFLECTION else LobeKind.HAIR_TRANSMISSION
        i = new_lobe(bsdf, kind, weight * load3(c, "color"), 0)
        if i >= 0:
            set_strand(bsdf.lobes[i], c)
            bsdf.lobes[i].fresnel = 0 if is_black(load3(c, "tangent")) else 1
        return
    i = new_lobe(bsdf, LobeKind.HAIR if is_black(load3(c, "edge_tint")) else LobeKind.HAIR_FACETS, weight, 0)
    if i >= 0:
        set_fibre(bsdf.lobes[i], c)


@kernel
def add_principled(bsdf, c, weight):
    """The order of the layers is that of Cycles: see-through, sheen, coat, metal, glass, specular, base."""
    alpha, metallic, transmission = saturate(c.alpha), saturate(c.metallic), saturate(c.transmission)
    color = load3(c, "color")
    base = Vec3(max(color.x, ZERO), max(color.y, ZERO), max(color.z, ZERO))
    tint = load3(c, "edge_tint")
    stretch = principled_stretch(c.anisotropy)
    frame, coat_frame, sheen_frame = principled_frames(bsdf, c)

    new_lobe(bsdf, LobeKind.TRANSPARENT, weight * (1.0 - alpha), 0)
    weight = weight * alpha
    if c.sheen_weight > NEGLIGIBLE:
        bsdf.frame = sheen_frame
        sheen_tint = load3(c, "sheen_tint") * c.sheen_weight
        i = new_lobe(bsdf, LobeKind.SHEEN, weight * sheen_tint, c.layer)
        if i >= 0:
            bsdf.lobes[i].alpha_x = saturate(c.sheen_roughness)
            bsdf.lobes[i].covers = saturate(max_component(sheen_tint))
    if c.coat_weight > NEGLIGIBLE:
        bsdf.frame = coat_frame
        coat_weight = saturate(c.coat_weight)
        i = new_lobe(bsdf, LobeKind.COATING, weight * coat_weight, c.layer)
        if i >= 0:
            coat = bsdf.lobes[i]
            coat.covers = coat_weight
            store3(coat, "refract_tint", load3(c, "coat_tint"))
            coat.ior = max(c.coat_ior, ONE)
            coat.multiscatter = 1
            set_alphas(coat, c.coat_roughness, ONE)
    bsdf.frame = frame

    i = new_lobe(bsdf, LobeKind.CONDUCTOR, weight * metallic, c.layer)
    if i >= 0:
        metal = bsdf.lobes[i]
        metal.fresnel = FresnelKind.F82
        store3(metal, "f0", Vec3(min(base.x, ONE), min(base.y, ONE), min(base.z, ONE)))
        store3(metal, "f82", tint)
        metal.multiscatter = c.multiscatter
        set_film(metal, c)
        set_alphas(metal, c.roughness, stretch)
    weight = weight * (1.0 - metallic)

    if c.thin_wall > 0.5:
        add_pane(bsdf, c, weight * transmission, tint, base)
    else:
        i = new_lobe(bsdf, LobeKind.DIELECTRIC, weight * transmission, c.layer)
        if i >= 0:  # a ray passes the glass going in and coming out: each time half of the colour
            set_glass(bsdf.lobes[i], c, WHITE, Vec3(math.sqrt(base.x), math.sqrt(base.y), math.sqrt(base.z)))
            store3(bsdf.lobes[i], "f0", tint)
    weight = weight * (1.0 - transmission)

    ior = specular_ior(c.ior, c.specular_level)
    if ior != 1.0 or c.film_thickness > NO_FILM:
        i = new_lobe(bsdf, LobeKind.COATING, weight, c.layer)
        if i >= 0:
            specular = bsdf.lobes[i]
            specular.covers = ONE
            specular.ior = ior
            store3(specular, "f0", tint)
            specular.multiscatter = c.multiscatter
            set_film(specular, c)
            set_alphas(specular, c.roughness, stretch)
    below = saturate(c.subsurface_weight)
    if below > NEGLIGIBLE:
        clamped = Vec3(min(base.x, ONE), min(base.y, ONE), min(base.z, ONE))
        roughness = saturate(c.roughness)
        entry = c.subsurface_ior if c.subsurface == SubsurfaceKind.SKIN else ior
        if c.thin_wall > 0.5:
            add_leaf(bsdf, c, weight * clamped * below, clamped)
        else:
            add_subsurface(bsdf, c, weight * below, clamped, roughness * roughness, entry, c.layer)
        weight = weight * (1.0 - below)
    add_diffuse(bsdf, weight, base, c.diffuse_roughness, c.layer)


@kernel
def add_subsurface(bsdf, c, weight, color, alpha, ior, layer):
    """Scattering below the surface, entered through a roughness of width `alpha`; matt where light does not get far."""
    radius, weight = not_negative(load3(c, "subsurface_radius")), weight * color
    near = Vec3(
        ONE if radius.x < LEAST_RADIUS else ZERO,
        ONE if radius.y < LEAST_RADIUS else ZERO,
        ONE if radius.z < LEAST_RADIUS else ZERO,
    )
    new_lobe(bsdf, LobeKind.DIFFUSE, weight * near, layer)
    i = new_lobe(bsdf, LobeKind.SUBSURFACE, weight * (WHITE - near), layer)
    if i >= 0:
        lobe = bsdf.lobes[i]
        store3(lobe, "f0", color)
        store3(lobe, "f82", radius)
        lobe.fresnel = c.subsurface
        lobe.alpha_x = lobe.alpha_y = ONE if c.subsurface == SubsurfaceKind.SKIN else alpha
        lobe.ior = min(max(ior, LEAST_ENTRY_IOR), MOST_ENTRY_IOR)
        most = MOST_ANISOTROPY if c.subsurface == SubsurfaceKind.RANDOM_WALK else MOST_LEGACY_ANISOTROPY
        lobe.g = min(max(c.subsurface_anisotropy, -MOST_ANISOTROPY), most)


@kernel
def add_leaf(bsdf, c, weight, color):
    """A thin wall that scatters light below its surfaces: to the side that it came from or through, as g says."""
    g = min(max(c.subsurface_anisotropy, -ONE), ONE)
    add_diffuse_of(bsdf, weight * (0.5 * (1.0 - g)), color, c.diffuse_roughness, c.layer, False)
    add_diffuse_of(bsdf, weight * (0.5 * (1.0 + g)), color, c.diffuse_roughness, c.layer, True)


@kernel
def principled_frames(bsdf, c):
    """(frame of the base, of the coat, of the sheen above it)"""
    base, coat_normal = bsdf.frame, load3(c, "coat_normal")
    if is_black(coat_normal) or not (c.coat_weight > NEGLIGIBLE or c.sheen_weight > NEGLIGIBLE):
        return base, base, base
    coat = frame_with(bsdf, coat_normal, BLACK)
    between = lerp(load3(bsdf.frames[base], "n"), load3(bsdf.frames[coat], "n"), saturate(c.coat_weight))
    return base, coat, frame_with(bsdf, between, BLACK) if c.sheen_weight > NEGLIGIBLE else coat


@kernel
def principled_stretch(anisotropy):
    """As the Principled BSDF stretches widths (Burley 2012, section 5.4)."""
    return 1.0 / math.sqrt(1.0 - 0.9 * min(anisotropy, ONE)) if anisotropy > 0.0 else ONE


@kernel
def set_glass(lobe, c, reflect_tint, refract_tint):
    store3(lobe, "reflect_tint", reflect_tint)
    store3(lobe, "refract_tint", refract_tint)
    lobe.ior, lobe.facets, lobe.loose = max(c.ior, SMALLEST_IOR), c.facets, c.loose
    lobe.multiscatter = c.multiscatter
    set_film(lobe, c)
    set_alphas(lobe, c.roughness, ONE)


@kernel
def add_pane(bsdf, c, weight, tint, base):
    """The two halves of a thin wall."""
    color = Vec3(min(base.x, ONE), min(base.y, ONE), min(base.z, ONE))
    for kind in (LobeKind.CONDUCTOR, LobeKind.THIN_WALL):
        i = new_lobe(bsdf, kind, weight, c.layer)
        if i >= 0:
            lobe = bsdf.lobes[i]
            set_glass(lobe, c, WHITE, color)
            store3(lobe, "f0", tint)
            lobe.fresnel, lobe.multiscatter = FresnelKind.THIN_WALL, 1
            if kind == LobeKind.THIN_WALL:
                lobe.alpha_x = lobe.alpha_y = pane_width(lobe.alpha_x, lobe.ior)


@kernel
def pane_width(alpha, ior):
    """Width of what a pane transmits, after two refractions (Kulla and Conty 2017, page 40)."""
    bend = 3.4 * max(ior - 1.0, 0.0) * (ior - 0.5) * (ior - 0.5) / (ior * ior * ior)
    return min(alpha * math.sqrt(bend), 1.0)


@kernel
def set_film(lobe, c):
    lobe.film_thickness, lobe.film_ior = c.film_thickness, max(c.film_ior, SMALLEST_IOR)


@kernel
def set_alphas(lobe, roughness, stretch):
    """No width is above 1, however stretched: as in Cycles."""
    alpha = saturate(roughness) * saturate(roughness)
    lobe.alpha_x = min(alpha * stretch, ONE)
    lobe.alpha_y = min(alpha / stretch, ONE)


@kernel
def specular_ior(ior, level):
    """Index of refraction whose reflectance at normal incidence is that of `ior` times 2 `level`."""
    if level == 0.5:
        return ior
    f = (ior - 1.0) / (ior + 1.0)
    f0 = math.sqrt(min(f * f * 2.0 * max(level, ZERO), 0.99))
    adjusted = (1.0 + f0) / (1.0 - f0)
    return 1.0 / adjusted if ior < 1.0 else adjusted


# ---- Rows of lobes ---------------------------------------------------------------------------------------------------


@kernel
def new_lobe(bsdf, kind, weight, layer):
    """Row of a new lobe with nothing set but its weight; -1 if that is negligible.

    Where all rows are in use the faintest gives way, and the others keep their order, which layers depend on.
    """
    weight = Vec3(max(weight.x, ZERO), max(weight.y, ZERO), max(weight.z, ZERO))
    if not max_component(weight) > NEGLIGIBLE:
        return -1
    if bsdf.count == MAX_LOBES and not drop_faintest(bsdf, average(weight)):
        return -1
    i = bsdf.count
    bsdf.count = i + 1
    lobe = bsdf.lobes[i]
    lobe.kind, lobe.frame = kind, bsdf.frame
    lobe.facets, lobe.loose, lobe.film_thickness, lobe.film_ior = Facets.GGX, 0, ZERO, ONE
    store3(lobe, "weight", weight)
    lobe.alpha_x = lobe.alpha_y = lobe.alpha_r = ZERO
    lobe.ior = ONE
    lobe.fresnel = FresnelKind.CONSTANT
    store3(lobe, "f0", WHITE)
    store3(lobe, "f82", WHITE)
    store3(lobe, "reflect_tint", WHITE)
    store3(lobe, "refract_tint", WHITE)
    lobe.g = ZERO
    lobe.multiscatter = 0
    lobe.energy_scale = ONE
    lobe.layer = layer
    lobe.covers = ZERO
    lobe.pmf = ZERO
    return i


@kernel
def drop_faintest(bsdf, brightness):
    """Make room for a lobe of that brightness; False if all others are brighter."""
    faintest, least = -1, brightness
    for i in range(MAX_LOBES):
        lobe = bsdf.lobes[i]
        f0 = load3(lobe, "f0")
        shown = average(load3(lobe, "weight") * Vec3(min(f0.x, ONE), min(f0.y, ONE), min(f0.z, ONE)))
        if shown < least:
            faintest, least = i, shown
    if faintest < 0:
        return False
    remove_lobe(bsdf, faintest)
    return True


@kernel
def remove_lobe(bsdf, row):
    for i in range(row + 1, bsdf.count):
        copy_record(bsdf.lobes[i - 1], bsdf.lobes[i])
    bsdf.count -= 1
