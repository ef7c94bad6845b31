# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the scenes beside this file.

    python3 scenes_blend/make_scenes.py [NAME ...]

Run it with the Python of the oldest supported Blender (`build.py setup --blender-version 4.5`), so that every Blender
can open the files. Each shows one idea:

cornell_box       diffuse light between coloured walls: the box of Cornell University, lit by an emissive square
cornell_mirror    the same with a mirror for a block, which throws the light about
cornell_glass     the same with a mirror block, a glass ball and a metal ball: caustics
three_spheres     glass, diffuse and metal on a great sphere under a plain sky; all of them perfect spheres
random_spheres    500 spheres of all materials, some of which shine
instances         10,000 instances of one mesh in five materials, under a sun
mesh_hdri         a million triangles under a picture of the sky
many_lights       a thousand lights in a hall
interior          a room that is lit through one small window
textured_emitter  a stage in the light of a picture
materials         balls, each of another shader
foggy_room        beams of light in fog, from a small lamp behind slats
cloud             a ball as dense and white as a cloud, under sun and sky
colored_glass     glass with colour, and with milk, inside

The worlds of A. Desai, "Ray Tracing in Python", 2021, are those three boxes, three_spheres, and

normals_as_colors     a sphere whose colours are its normals
two_diffuse_spheres   a grey sphere on another
metals_and_fuzz       a clear and a fuzzy metal, and a diffuse sphere between them
checkered_spheres     a pattern that is a product of sines
turbulent_noise       the sum of Perlin's noise at seven scales
picture_around_sphere a picture wrapped around a sphere
one_weekend           a field of random spheres, with depth of field
light_in_the_world    a sphere in the light of a lamp that is in the picture
picture_as_light      a picture that shines on other pictures
cornell_measured      the box as Cornell University measured it, walls, blocks and spectra
cornell_smoke         a box and a ball of smoke

one_weekend is the last picture of the first of P. Shirley's three books as well; those of the others are

next_week             all of "Ray Tracing: The Next Week": blocks, marble, mist, a sphere that moves
rest_of_your_life     the box with a glass ball, at which rays are aimed

docs/gallery shows them beside Cycles.
"""

import os
import sys
from pathlib import Path

import bpy
from balls import materials
from books import next_week, one_weekend, rest_of_your_life
from boxes import cornell_box, cornell_glass, cornell_measured, cornell_mirror, cornell_smoke
from crowds import instances, many_lights, random_spheres, three_spheres
from daylight import interior, mesh_hdri, textured_emitter
from fog import cloud, colored_glass, foggy_room
from paper import (
    checkered_spheres,
    light_in_the_world,
    metals_and_fuzz,
    normals_as_colors,
    picture_around_sphere,
    picture_as_light,
    turbulent_noise,
    two_diffuse_spheres,
)

FOLDER = Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent))
SCENES = (
    *(cornell_box, cornell_mirror, cornell_glass, three_spheres, random_spheres),
    *(instances, mesh_hdri, many_lights, interior, textured_emitter),
    *(normals_as_colors, two_diffuse_spheres, metals_and_fuzz, checkered_spheres, turbulent_noise),
    *(picture_around_sphere, light_in_the_world, picture_as_light, cornell_measured, cornell_smoke),
    *(one_weekend, next_week, rest_of_your_life, materials, foggy_room, cloud, colored_glass),
)
CYCLES = {  # what makes its pictures comparable: no short cuts
    "sample_clamp_direct": 0.0,
    "sample_clamp_indirect": 0.0,
    "blur_glossy": 0.0,
    "light_sampling_threshold": 0.0,
    "use_fast_gi": False,
    "caustics_reflective": True,
    "caustics_refractive": True,
    "use_adaptive_sampling": False,
    "use_denoising": False,
}


def make(fill):
    """Make the scene of a function of this file, and save it under the function's name."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    for kind in (bpy.data.workspaces, bpy.data.screens):  # one is enough, and makes a smaller file
        bpy.data.batch_remove([b_id for b_id in kind if b_id.name != "Layout"])
    fill(scene)
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = f"//{fill.__name__}"
    for name, value in CYCLES.items():
        setattr(scene.cycles, name, value)
    for b_object in bpy.data.objects:
        b_object.shadow_terminator_geometry_offset = 0.0
    scene.cycles.samples = scene.lambent.samples = 256
    scene.render.engine = "LAMBENT"
    path = FOLDER / f"{fill.__name__}.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)
    path.with_suffix(".blend1").unlink(missing_ok=True)
    print(f"{path}: {path.stat().st_size / 1024:.0f} KiB", flush=True)


def main(names):
    import addon_utils  # where bpy puts it

    import addon

    addon_utils.enable("cycles")
    addon.register()
    scenes = {fill.__name__: fill for fill in SCENES}
    for name in names or scenes:
        make(scenes[name])


if __name__ == "__main__":
    main(sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)  # bpy 4.5 hangs when it is unloaded
