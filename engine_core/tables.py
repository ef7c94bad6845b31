# SPDX-License-Identifier: GPL-3.0-or-later
"""The contract: the dtype of every row, and `Scene`, which is all that a kernel may read.

Units are Blender's: metres, watts, radians; colours are linear, scene-referred, in Blender's working space.
Directions and frames are right-handed, z up. A row number of -1 means "none".
"""

from enum import IntEnum, IntFlag

import numpy as np

from .guide_tables import GUIDE, GUIDE_BRANCH, GUIDE_CELL
from .linalg.records import Tables
from .medium_tables import MEDIUM, PHASE
from .program_tables import (
    ATTRIBUTE,
    ATTRIBUTE_MAP,
    CELL,
    CLOSURE,
    CURVE,
    IMAGE,
    INSTANCE_VALUE,
    KERNEL,
    OBJECT,
    OP,
    PATCH,
    PROGRAM,
    STRAND,
    TEXEL,
)


class TreeKind(IntEnum):
    """What the leaves of a tree hold."""

    TRIANGLES = 0  # packets of eight triangles
    SHAPES = 1  # analytic shapes, rows of SHAPE
    INSTANCES = 2  # rows of INSTANCE, each with a tree of its own
    TARGETS = 3  # rows of TARGET


class ShapeKind(IntEnum):
    """Analytic shapes. `p` is the centre of each."""

    SPHERE = 0  # radius
    QUAD = 1  # half edges u and v, front along u x v; a rectangle
    DISK = 2  # half axes u and v, front along u x v; an ellipse
    FACING_DISK = 3  # radius; turned towards whoever looks: Blender's soft point and spot lights
    BOX = 4  # half edges u and v at right angles, and along u x v a third one of length radius
    STRAND = 5  # a piece of a hair: from p to p + u, radius to radius_end thick, cut across v at p and w at p + u


class LobeKind(IntEnum):
    """How a lobe scatters; each has its file in `bsdf/`."""

    DIFFUSE = 0  # Lambert
    CONDUCTOR = 1  # GGX reflection, Fresnel of a metal
    DIELECTRIC = 2  # GGX reflection and refraction, Fresnel of glass
    REFRACTION = 3  # GGX refraction alone, without Fresnel
    COATING = 4  # GGX reflection, Fresnel of a dielectric: the varnish over a Principled base
    TRANSPARENT = 5  # straight through
    TRANSLUCENT = 6  # Lambert, out of the other side
    ROUGH_DIFFUSE = 7  # Oren and Nayar: alpha_x is the roughness, f0 the colour
    TOON_DIFFUSE = 8  # a cone about the normal: alpha_x is its size, alpha_y the width of its soft edge
    TOON_GLOSSY = 9  # ... about the mirrored view
    SHEEN = 10  # fine fibres: alpha_x is the roughness
    VELVET = 11  # Ashikhmin's velvet: alpha_x is the roughness
    ASHIKHMIN_SHIRLEY = 12  # glossy reflection by powers of cosines, without Fresnel
    SUBSURFACE = 13  # the way in for light that is scattered below the surface: f0 is its colour, f82 its radius
    THIN_WALL = 14  # GGX through a thin pane
    HAIR = 15  # all that a coloured dielectric fibre does: alpha_x, alpha_y, alpha_r its widths, f82 its absorption
    HAIR_REFLECTION = 16  # of the Hair node: g is the tilt of the scales, as an angle
    HAIR_TRANSMISSION = 17  # likewise
    HAIR_FACETS = 18  # as HAIR, by microfacets: alpha_x and alpha_y its roughness, f0 how much of R, TT and TRT


TRANSMITTING = (LobeKind.DIELECTRIC, LobeKind.REFRACTION, LobeKind.TRANSLUCENT, LobeKind.THIN_WALL)
TRANSMITTING += (LobeKind.HAIR, LobeKind.HAIR_TRANSMISSION, LobeKind.HAIR_FACETS)


class Facets(IntEnum):
    """Shapes of microfacets."""

    GGX = 0
    BECKMANN = 1


class FresnelKind(IntEnum):
    """How a conductor's reflectance depends on the angle."""

    CONSTANT = 0  # f0 at every angle: Glossy
    F82 = 1  # f0 at 0 degrees, tinted by f82 at 82 degrees: Principled metal, Metallic (Kutz et al. 2021)
    CONDUCTOR = 2  # complex index of refraction f0 + i f82: physical Metallic
    THIN_WALL = 3  # what a thin pane reflects, from inside as well: a part of the weight, see bsdf/thin_wall.py


class SubsurfaceKind(IntEnum):
    """How light scatters below a surface: Blender's methods of random walk."""

    RANDOM_WALK = 0  # the radius is the mean free path; the medium's albedo by d'Eon's fit
    LEGACY = 1  # by that of Chiang et al. and Wrenninge et al.; the mean free path is the radius / 4 pi, by 1 - g
    SKIN = 2  # likewise; the radius is that of diffusion, and half of the light enters as if the surface were matt


class LightKind(IntEnum):
    """Emitters that can be sampled; each has its file in `light/`."""

    POINT = 0  # a sphere, or a facing disk, or with no radius a point
    SPOT = 1  # a point in a cone
    SUN = 2  # a disk of directions
    QUAD = 3  # a rectangular area light, or with an instance an emissive analytic quad: see SPHERE
    DISK = 4  # an elliptic area light
    TRIANGLE = 5  # a triangle of an emissive mesh
    BACKGROUND = 6  # the world
    SPHERE = 7  # an emissive analytic sphere of the scene (not a lamp: it blocks light and is opaque)
    BOX = 8  # an emissive analytic box of the scene


class CameraKind(IntEnum):
    PERSPECTIVE = 0
    ORTHOGRAPHIC = 1


class Visibility(IntFlag):
    """Which rays see an object or a lamp, by the scattering that sent the ray."""

    CAMERA = 1
    DIFFUSE = 2
    GLOSSY = 4
    TRANSMISSION = 8
    SCATTER = 16
    SHADOW = 32
    ALL = 63


BOUNDARY_SHIFT = 6  # where a medium's boundary is no surface, its Visibility is higher by so many bits, see accel/
PLAIN_SHIFT = 12  # in scenes with media, objects that hold none have their Visibility once more, so many bits higher


class MaterialFlag(IntFlag):
    EMISSIVE = 1  # emission is not black
    TRANSPARENT = 2  # has a TRANSPARENT lobe: shadow rays pass, dimmed
    ONE_SIDED = 4  # emits from the front of its faces only
    TRANSMITS = 8  # a lobe scatters light through to the other side
    SUBSURFACE = 16  # has a SUBSURFACE lobe: rays walk below its surface, so objects of it have trees of their own
    OPAQUE_SHADOW = 32  # no shadow ray passes, even if it is transparent
    BOUNDARY = 64  # no surface: only where a medium begins
    LOCAL = 128  # its programs send rays that ask for nothing but the object itself
    PANE = 256  # may have a smooth thin wall, which shadow rays pass as if it were transparent
    HAIR = 512  # has lobes of FIBRES, whose frames lie along strands
    HOLDOUT = 1024  # leaves the picture empty where the camera sees it
    FILLED = 2048  # there is a medium inside


# ---- Geometry --------------------------------------------------------------------------------------------------------

NODE = np.dtype(
    [
        ("bounds", "f4", (6, 8)),  # rows: min x y z, max x y z; a child a column; an empty one is +inf, -inf
        ("child", "i4", (8,)),  # >= 0: a node; < 0: a leaf, ~row, by the tree's kind of PACKET, SHAPE or INSTANCE
    ]
)
PACKET = np.dtype(
    [  # eight triangles, side by side for SIMD; missing ones have prim -1 and no area
        ("p", "f4", (3, 3, 8)),  # corner, axis, triangle
        ("prim", "i4", (8,)),  # row of TRIANGLE
    ]
)
TRIANGLE = np.dtype(
    [  # what shading needs of a triangle; positions stand here as the mesh has them
        ("p", "f4", (3, 3)),  # corners
        ("n", "f4", (3, 3)),  # shading normals at the corners; only the interpolated one is made unit
        ("uv", "f4", (3, 2)),
        ("slot", "i4"),  # material slot of the object
        ("instance", "i4"),  # row of INSTANCE if positions are in world space already, else -1: ask the hit
        ("light", "i4"),  # rank among the emissive triangles of the object, or -1
    ]
)
SHAPE = np.dtype(
    [
        ("kind", "i4"),  # ShapeKind
        ("p", "f4", (3,)),
        ("u", "f4", (3,)),
        ("v", "f4", (3,)),
        ("radius", "f4"),
        ("slot", "i4"),
        ("instance", "i4"),  # as in TRIANGLE
        ("light", "i4"),  # a lamp: row of LIGHT; else as in TRIANGLE
        ("number", "i4"),  # in its geometry
        ("w", "f4", (3,)),  # this and the next two: STRAND. Unit, as is its v, and a tangent of the hair
        ("radius_end", "f4"),
        ("strand", "i4"),  # row of STRAND
    ]
)
INSTANCE = np.dtype(
    [  # two cache lines: what traversal needs, and what shading needs
        ("to_object", "f4", (3, 4)),
        ("root", "i4"),  # row of NODE, or -1 if its geometry is in the world's own trees
        ("kind", "i4"),  # TreeKind of its tree: TRIANGLES or SHAPES
        ("visibility", "i4"),  # Visibility
        ("slots", "i4"),  # row of SLOT of material slot 0
        ("to_world", "f4", (3, 4)),
        ("lights", "i4"),  # row of LIGHT of its first emissive triangle or shape
        ("pass_index", "i4"),
        ("random", "f4"),  # 0 to 1, Blender's random number of the instance
        ("motion", "i4"),  # row of POSE of its first pose; 0: it stands still. Above is how it stands in the middle
    ]
)
SLOT = np.dtype([("material", "i4")])
POSE = np.dtype(
    [  # of what moves while the shutter is open: a stretch, then a rotation, then the way to its place
        ("rotation", "f4", (4,)),  # unit quaternion w x y z; 90 degrees or less from that of the next pose
        ("location", "f4", (3,)),
        ("stretch", "f4", (3, 3)),  # symmetric
    ]
)

# ---- Materials -------------------------------------------------------------------------------------------------------

LOBE = np.dtype(
    [  # one way to scatter; a material has up to eight
        ("kind", "i4"),  # LobeKind
        ("frame", "i4"),  # row of frames in its BSDF
        ("weight", "f4", (3,)),  # colour and mix factor; the albedo where the model has no Fresnel
        ("alpha_x", "f4"),  # microfacet widths, roughness ** 2; 0 is a perfect mirror
        ("alpha_y", "f4"),
        ("alpha_r", "f4"),  # HAIR: variance of what its scales reflect
        ("facets", "i4"),  # Facets: of what shape the bumps of microfacets are
        ("loose", "i4"),  # DIELECTRIC, REFRACTION: 1: light is refracted, too, where no microfacet would send a ray:
        # what Cycles shows of rough glass under lamps, more than there is
        ("ior", "f4"),  # inside over outside, as on the material; at a hit: far side over near side
        ("fresnel", "i4"),  # FresnelKind; SUBSURFACE: SubsurfaceKind; HAIR_...: 1: its frame has a given tangent
        ("film_thickness", "f4"),  # nanometres of a thin film over microfacets; 0: there is none
        ("film_ior", "f4"),  # over that of the outside, as on the material; at a hit: over that of the near side
        ("f0", "f4", (3,)),
        ("f82", "f4", (3,)),
        ("reflect_tint", "f4", (3,)),  # DIELECTRIC: colours of the two halves
        ("refract_tint", "f4", (3,)),
        ("g", "f4"),  # SUBSURFACE: anisotropy of its phase function; HAIR: sine of the tilt of its scales
        ("multiscatter", "i4"),  # 1: compensate the energy that single scattering loses (Turquin 2019)
        ("energy_scale", "f4"),  # at a hit: what that compensation came to
        ("roughness", "f4"),  # at a hit, with microfacets: where tables are asked for their width ...
        ("angle", "f4"),  # ... and, of glass, for the angle that it is seen from
        ("share", "f4"),  # at a hit, of a mirror: of light from everywhere, what it gives back by single scattering ...
        ("mean_share", "f4"),  # ... and the mean of that over all angles
        ("layer", "i4"),  # lobes of one layer number lie under the covering ones before them; 0: under none
        ("covers", "f4"),  # share of what lies below that this lobe covers (a coat's weight, without the mix factor):
        # what it reflects there does not reach the later lobes of its layer, nor what its refract_tint absorbs
        ("pmf", "f4"),  # at a hit: probability that sampling chooses this lobe
    ]
)
MAX_LOBES = 8
FRAME = np.dtype(
    [  # unit vectors at right angles
        ("n", "f4", (3,)),  # the normal
        ("s", "f4", (3,)),
        ("t", "f4", (3,)),
        ("bend", "f4"),  # of the normal from the smooth one: width^2 of microfacets that shadow as bumps so steep
    ]
)
MAX_FRAMES = 8
BSDF = np.dtype(
    [  # how light scatters at one point: made at a hit by shader/, read by bsdf/
        ("count", "i4"),
        ("cell", "i4"),  # row of GUIDE_CELL that guides what it scatters, or -1 ...
        ("guided", "f4"),  # ... and the share of the directions that come from there
        ("ng", "f4", (3,)),  # geometric normal, on the side of wo
        ("albedo", "f4", (3,)),  # of several lobes together, towards wo
        ("shadow_stretch", "f4"),  # as in OBJECT
        ("frame_count", "i4"),
        ("frame", "i4"),  # while it is made: the frame of the lobes that are being added
        ("frames", FRAME, (MAX_FRAMES,)),  # frame 0 has the smooth normal of the surface, the others bent ones
        ("lobes", LOBE, (MAX_LOBES,)),
    ]
)
MATERIAL = np.dtype(
    [
        ("program", "i4"),  # row of PROGRAM that makes its lobes and emission at a hit; 0: the constants below ...
        ("emission_program", "i4"),  # ... its emission alone
        ("transparency_program", "i4"),  # ... its transparency alone
        ("holdout_program", "i4"),  # ... its holdout alone
        ("lobes", "i4"),  # first row of LOBE
        ("lobe_count", "i4"),
        ("emission", "f4", (3,)),  # radiance of the surface
        ("transparency", "f4", (3,)),  # sum of the weights of its TRANSPARENT lobes
        ("holdout", "f4", (3,)),  # how much of the picture it leaves empty where the camera sees it
        ("flags", "i4"),  # MaterialFlag
        ("pass_index", "i4"),
        ("medium", "i4"),  # row of MEDIUM inside; -1: none
    ]
)

# ---- Light -----------------------------------------------------------------------------------------------------------

LIGHT = np.dtype(
    [
        ("kind", "i4"),  # LightKind
        ("p", "f4", (3,)),  # centre; TRIANGLE: first corner
        ("u", "f4", (3,)),  # QUAD, BOX, DISK: half edges or half axes; TRIANGLE: edges from the first corner to
        ("v", "f4", (3,)),  # the others; SPOT: see n
        ("n", "f4", (3,)),  # unit: direction that an area light faces (u x v), a spot points, sunlight travels. SPOT:
        # a direction w from the lamp is (w.u, w.v, w.n) in the space where its cone is round and its cosine counts
        ("radius", "f4"),  # BOX: its third half edge, along n
        ("area", "f4"),
        ("emission", "f4", (3,)),  # radiance, straight ahead where it depends on the angle; is_delta: POINT, SPOT:
        # radiant intensity; SUN, QUAD, DISK: irradiance
        ("soft", "i4"),  # POINT, SPOT: 1: a facing disk; 0: a sphere
        ("height", "f4"),  # SUN: 1 - cosine of half the angle of its disk; float32 has no digits left in the cosine
        ("cos_angle", "f4"),  # SPOT: cosine of half the cone
        ("blend", "f4"),  # SPOT: smoothstep((cosine - cos_angle) * blend) dims its edge; infinite: a sharp edge
        ("spread", "f4"),  # QUAD, DISK: tangent of the half angle that it shines into; infinite: Lambertian
        ("is_delta", "i4"),  # 1: no ray hits it by chance: radius 0, angle 0, spread 0
        ("two_sided", "i4"),  # TRIANGLE, and analytic shapes of the scene
        ("program", "i4"),  # row of PROGRAM that makes its radiance, `emission` being the mean; 0: it is constant
        ("gain", "f4"),  # > 0: what the program gives, times this, is to be multiplied by `emission`: a lamp's
        ("lamp", "i4"),  # row of INSTANCE of a lamp with a program, which has no geometry: its own coordinates; else -1
        ("visibility", "i4"),  # Visibility
        ("instance", "i4"),  # TRIANGLE, and analytic shapes of the scene: rows of what emits; lamps: -1
        ("prim", "i4"),
        ("level", "i4"),  # TRIANGLE: it is divided into 4^level parts, which are sampled in its place; 0: it is whole
        ("parts", "i4"),  # row of LIGHT of the first of them; they have the same `instance` and `prim`
        ("leaf", "i4"),  # row of LIGHT_NODE * LIGHT_WIDTH + child; -1: outside of the tree, or never selected
        ("share", "f4"),  # probability within its leaf: 1, or less if that holds a pair of rows; 0: never selected
        ("irradiance", "f4"),  # outside of the tree: W/m2 across the light's direction, the mean of colours
        ("aimed_at", "i4"),  # 1: the mixture integrator sends rays at it, unless it is a delta
    ]
)
TARGET = np.dtype(
    [  # what the mixture integrator aims at. What does not shine has a row of LIGHT, too, behind those that do
        ("light", "i4"),  # row of LIGHT
        ("pmf", "f4"),  # probability to be aimed at
        ("cdf", "f4"),  # sum of pmf up to and including this one, from the first of its kind (see WORLD)
    ]
)
MAX_PART_LEVEL = 5
LIGHT_WIDTH = 8
LIGHT_NODE = np.dtype(
    [  # of the tree of lights: up to eight children, side by side, which are lights or nodes
        ("centre", "f4", (3, LIGHT_WIDTH)),  # of a box around the lights below
        ("half", "f4", (3, LIGHT_WIDTH)),  # half of its edges
        ("radius", "f4", (LIGHT_WIDTH,)),  # half of its diagonal
        ("axis", "f4", (3, LIGHT_WIDTH)),  # unit; the normals of the lights lie within an angle theta_o around it ...
        ("cos_o", "f4", (LIGHT_WIDTH,)),  # ... of this cosine; -1: they point everywhere
        ("sin_o", "f4", (LIGHT_WIDTH,)),
        ("cos_oe", "f4", (LIGHT_WIDTH,)),  # of theta_o + theta_e; light leaves within theta_e of a normal
        ("two_sided", "f4", (LIGHT_WIDTH,)),  # 1: as much leaves on the other side; else -1
        ("intensity", "f4", (LIGHT_WIDTH,)),  # W/sr along the normals, the mean of colours, summed; 0: no child
        ("closest", "f4", (LIGHT_WIDTH,)),  # 1 / the distance below which light becomes no stronger
        ("child", "i4", (LIGHT_WIDTH,)),  # > 0: row of LIGHT_NODE; < 0: a leaf, ~row of its first LIGHT
        ("parent", "i4"),  # row * LIGHT_WIDTH + child: where it hangs; -1: the root
    ]
)

# ---- The camera and the world ----------------------------------------------------------------------------------------

CAMERA = np.dtype(
    [
        ("kind", "i4"),  # CameraKind
        ("to_world", "f4", (3, 4)),  # looks along -z, y up; without scale
        ("screen", "f4", (4,)),  # left, right, bottom, top of the frame at distance 1 (ORTHOGRAPHIC: in metres)
        ("clip_start", "f4"),
        ("clip_end", "f4"),
        ("lens_radius", "f4"),  # 0: everything in focus
        ("focus_distance", "f4"),  # along the axis
        ("blades", "i4"),  # below 3: round
        ("blade_rotation", "f4"),
        ("aperture_ratio", "f4"),  # above 1: squeezed in x, an anamorphic lens
        ("motion", "i4"),  # row of POSE of its first pose; 0: it stands still
        ("shutter", "f4", (65,)),  # times 0 to 1 between which it is open for equal parts of the exposure
    ]
)
WORLD = np.dtype(
    [
        ("triangle_root", "i4"),  # row of NODE; trees in world space: triangles and shapes of objects used once ...
        ("shape_root", "i4"),
        ("instance_root", "i4"),  # ... and the tree over all other instances,
        ("moving_root", "i4"),  # but over those that move
        ("pose_count", "i4"),  # rows of POSE of each thing that moves; 0: nothing does
        ("lamp_root", "i4"),  # shapes of lamps: seen by rays, in nobody's way
        ("target_root", "i4"),  # targets that stand somewhere
        ("target_count", "i4"),  # rows of TARGET: those of the tree, then from far_targets on suns and the world;
        ("far_targets", "i4"),
        ("delta_count", "i4"),  # ... and behind them lights that no ray hits by chance
        ("background", "f4", (3,)),  # radiance; of a world with a program, the mean
        ("background_program", "i4"),  # row of PROGRAM; 0: constant
        ("map_width", "i4"),  # cells of the map that the world is sampled by; 0: from all sides alike
        ("map_height", "i4"),
        ("attribute_count", "i4"),  # rows of ATTRIBUTE
        ("value_stride", "i4"),  # rows of INSTANCE_VALUE of each name
        ("background_light", "i4"),  # row of LIGHT; all directions, but those of its disk ...
        ("disk_light", "i4"),  # ... a row of its own: the sun in the picture of the sky; -1: there is none
        ("background_visibility", "i4"),
        ("suns", "i4"),  # row of LIGHT of the first sun lamp; they stand together
        ("sun_count", "i4"),
        ("light_count", "i4"),  # that shine; see TARGET
        ("far_count", "i4"),  # the first lights stand outside of the tree: suns, then beams (QUAD, DISK with spread 0)
        ("light_root", "i4"),  # row of LIGHT_NODE
        ("only_light", "i4"),  # row of LIGHT, the first of its leaf, if there is but one to select
        ("two_looks", "i4"),  # 1: where a path scatters first, two samples are taken of the lights
        ("transparent_shadows", "i4"),  # 1: some material lets shadow rays pass
        ("has_media", "i4"),  # 1: somewhere is a medium, so paths keep account of which they are in
        ("medium", "i4"),  # row of MEDIUM that is everywhere; -1: none
        ("camera_in_media", "i4"),  # 1: the camera may stand in the medium of an object that has a surface ...
        ("camera_in_boundary", "i4"),  # ... or of one that has none
        ("centre", "f4", (3,)),  # of a ball around everything
        ("radius", "f4"),
        ("lift_below", "f4"),  # the largest in OBJECT of what has smooth normals
        ("stretches_shadows", "i4"),  # 1: some shadow_stretch in OBJECT is not 1
    ]
)


class Scene(Tables):
    """Everything about the scene that a kernel may read. `world` and `camera` have one row."""

    nodes = NODE
    packets = PACKET
    triangles = TRIANGLE
    shapes = SHAPE
    strands = STRAND
    instances = INSTANCE
    objects = OBJECT
    slots = SLOT
    poses = POSE
    materials = MATERIAL
    lobes = LOBE
    media = MEDIUM
    phases = PHASE
    programs = PROGRAM
    ops = OP
    closures = CLOSURE
    patches = PATCH
    kernels = KERNEL
    curves = CURVE
    images = IMAGE
    texels = TEXEL
    attribute_maps = ATTRIBUTE_MAP
    attributes = ATTRIBUTE
    instance_values = INSTANCE_VALUE
    lights = LIGHT
    light_nodes = LIGHT_NODE
    world_map = CELL
    targets = TARGET
    guide = GUIDE
    guide_branches = GUIDE_BRANCH
    guide_cells = GUIDE_CELL
    camera = CAMERA
    world = WORLD
