# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist sets: `scene.lambent`, `view_layer.lambent` and `object.lambent`.

What Blender has already is not asked for twice: transparent film, threads (`-t` on the command line), border, motion
blur and passes live in Blender's own properties. Defaults are those of `engine_core.settings`.
"""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty

# Identifiers and numbers are those of engine_core.settings, which is not imported before a render starts.
INTEGRATORS = (
    ("BRUTE_FORCE", "Brute Force", "Scatter by the material alone and find lights by luck: slow, but plain to see", 0),
    (
        "MIXTURE",
        "Mixture PDF",
        "Half of the directions by the material, half towards lights and the objects chosen in their properties",
        1,
    ),
    ("PATH", "Path", "Sample lights and materials at each bounce, weighted against each other", 2),
)
SAMPLERS = (
    ("SOBOL", "Sobol", "Well-spread points: less noise, and finer to look at", 0),
    ("RANDOM", "Random", "Independent random numbers, to compare with", 1),
)
FILTERS = (
    ("BOX", "Box", "Every sample counts for its own pixel, evenly", 0),
    ("GAUSSIAN", "Gaussian", "Soft", 1),
    ("BLACKMAN_HARRIS", "Blackman-Harris", "Sharp, without ringing", 2),
)
SHAPES = (
    ("MESH", "Mesh", "As it was modelled", 0),
    ("SPHERE", "Sphere", "The sphere, or ellipsoid, that fills the mesh's bounding box", 1),
    ("BOX", "Box", "The mesh's bounding box", 2),
    ("QUAD", "Quad", "The rectangle that the mesh's bounding box is without its thinnest side", 3),
)
AIMS = (
    ("AUTOMATIC", "Automatic", "If it is a light, or emits", 0),
    ("ALWAYS", "Always", "Whatever it is: glass that gathers light, a mirror, a window", 1),
    ("NEVER", "Never", "Rays find it by scattering alone", 2),
)
MAX_BOUNCES = 1024


def bounces(name, default, what):
    return IntProperty(name=name, default=default, min=0, max=MAX_BOUNCES, description=f"Largest number of {what}")


class LambentSceneSettings(bpy.types.PropertyGroup):
    # ---- Sampling ----
    integrator: EnumProperty(name="Integrator", items=INTEGRATORS, default="PATH", description="How light is followed")
    samples: IntProperty(
        name="Samples",
        default=128,
        min=1,
        max=1 << 24,
        description="Number of paths traced through each pixel; on average, when sampling is adaptive",
    )
    viewport_samples: IntProperty(
        name="Viewport Samples", default=256, min=1, max=1 << 24, description="Where the rendered viewport stops"
    )
    use_adaptive: BoolProperty(
        name="Adaptive",
        default=True,
        description="Give one half of the samples to all pixels alike, and the other to those that need it most",
    )
    use_guiding: BoolProperty(
        name="Guiding",
        default=True,
        description="Let paths learn from which directions light comes, where that makes for less noise: in rooms lit "
        "through windows or from wall to wall, and by caustics. Path integrator only",
    )
    noise_target: FloatProperty(
        name="Noise Target",
        default=0.0,
        min=0.0,
        soft_max=20.0,
        max=100.0,
        precision=1,
        subtype="PERCENTAGE",
        description="Stop when the noise of the picture, its error in relation to its brightness, is estimated to be "
        "that low; 0 is no target",
    )
    sampler: EnumProperty(
        name="Sampler", items=SAMPLERS, default="SOBOL", description="Where the random numbers of paths come from"
    )
    time_limit: FloatProperty(
        name="Time Limit",
        default=0.0,
        min=0.0,
        step=100,
        subtype="TIME_ABSOLUTE",
        unit="TIME_ABSOLUTE",
        description="Stop after this time, with the samples done by then; 0 is no limit",
    )
    seed: IntProperty(name="Seed", default=0, min=0, description="Another seed gives another pattern of noise")
    use_animated_seed: BoolProperty(
        name="Animate Seed", default=False, description="Another pattern of noise on each frame"
    )

    # ---- Light paths ----
    max_bounces: bounces("Total", 12, "bounces of any kind")
    diffuse_bounces: bounces("Diffuse", 4, "diffuse bounces")
    glossy_bounces: bounces("Glossy", 4, "reflections")
    transmission_bounces: bounces("Transmission", 12, "refractions")
    volume_bounces: bounces("Volume", 0, "scatterings in volumes")
    transparent_max_bounces: bounces("Transparent", 8, "transparent surfaces that a path goes straight through")
    min_bounces: IntProperty(
        name="Min Bounces",
        default=3,
        min=0,
        max=MAX_BOUNCES,
        description="Bounces before Russian roulette may end a path that carries little light",
    )
    clamp_direct: FloatProperty(
        name="Direct Light",
        default=0.0,
        min=0.0,
        description="Largest value a sample of direct light may have; 0 is no limit. Removes fireflies, and light",
    )
    clamp_indirect: FloatProperty(
        name="Indirect Light",
        default=0.0,
        min=0.0,
        description="Largest value a sample of indirect light may have; 0 is no limit. Removes fireflies, and light",
    )
    caustics_reflective: BoolProperty(
        name="Reflective", default=True, description="Light that a mirror or gloss throws onto a diffuse surface"
    )
    caustics_refractive: BoolProperty(
        name="Refractive", default=True, description="Light that glass throws onto a diffuse surface"
    )

    # ---- Motion blur ----
    motion_steps: IntProperty(
        name="Steps",
        default=1,
        min=1,
        max=7,
        description="How closely motion is followed: it is looked at 2^steps times while the shutter is open, and even "
        "in between. More for wheels and propellers",
    )

    # ---- Film ----
    exposure: FloatProperty(
        name="Exposure", default=1.0, min=0.0, soft_max=10.0, description="Factor on all light that reaches the film"
    )
    filter_type: EnumProperty(
        name="Pixel Filter", items=FILTERS, default="BLACKMAN_HARRIS", description="How samples blend into pixels"
    )
    filter_width: FloatProperty(
        name="Filter Width",
        default=1.5,
        min=0.01,
        max=10.0,
        subtype="PIXEL",
        description="Width of the pixel filter; 1.5 is sharp, 3 soft",
    )
    use_shared_samples: BoolProperty(
        name="Share Samples",
        default=True,
        description="Let a sample count for all pixels whose filter reaches it, not for the nearest alone: half the "
        "error, as fine noise is smoothed away. Done with filters from 1.25 to 1.5 pixels wide, and not where there "
        "is Denoising Data or a Denoise node, as denoisers want each pixel's noise to be its own, nor where the first "
        "eight samples show less noise without it",
    )


class LambentViewLayerSettings(bpy.types.PropertyGroup):
    use_pass_denoising_data: BoolProperty(
        name="Denoising Data", default=False, description="Albedo and normal, for the Denoise node of the compositor"
    )
    use_pass_sample_count: BoolProperty(
        name="Sample Count", default=False, description="Number of samples in each pixel"
    )


def tag_object(settings, context):
    """Let the object be evaluated anew: Blender does so by itself where a change is made in the UI, not in a script."""
    settings.id_data.update_tag()


class LambentObjectSettings(bpy.types.PropertyGroup):
    use_motion_blur: BoolProperty(
        name="Motion Blur",
        default=True,
        update=tag_object,
        description="Blur the object where it moves while the shutter is open, if the scene has motion blur",
    )
    shape: EnumProperty(
        name="Render As",
        items=SHAPES,
        default="MESH",
        update=tag_object,
        description="Replace the mesh by a perfect shape of the same size: round at any distance, less to compute, "
        "and with less noise where it emits",
    )
    aim: EnumProperty(
        name="Sample This Object",
        items=AIMS,
        default="AUTOMATIC",
        update=tag_object,
        description="Whether the integrator Mixture PDF sends more rays at this object. The picture stays the same; "
        "only its noise changes",
    )


CLASSES = (LambentSceneSettings, LambentViewLayerSettings, LambentObjectSettings)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.lambent = PointerProperty(type=LambentSceneSettings)
    bpy.types.ViewLayer.lambent = PointerProperty(type=LambentViewLayerSettings)
    bpy.types.Object.lambent = PointerProperty(type=LambentObjectSettings)


def unregister():
    for owner in (bpy.types.Scene, bpy.types.ViewLayer, bpy.types.Object):
        if hasattr(owner, "lambent"):
            del owner.lambent
    for cls in reversed(CLASSES):
        if cls.is_registered:
            bpy.utils.unregister_class(cls)
