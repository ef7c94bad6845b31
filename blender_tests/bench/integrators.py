# SPDX-License-Identifier: GPL-3.0-or-later
"""What importance sampling is worth: the three integrators in the Cornell box, at the same number of samples.

Efficiency is 1 / (error x seconds), which hardly depends on the number of samples; it is given over that of brute
force. Seconds are those of the processor, on one thread, of rendering alone. All are compared with one converged
picture of the path tracer.
"""

import time
from pathlib import Path
from statistics import median

from addon.export import Report, export_scene
from blender_tests.helpers.engines import open_for_both
from blender_tests.helpers.references import relative_error
from engine_core.integrator.tiles import Render
from engine_core.settings import IntegratorKind, Settings

SCENE = Path(__file__).parents[2] / "scenes_blend" / "cornell_box.blend"


def run(quick):
    """{integrator: {"efficiency_vs_brute_force", "relative_error", "samples_per_s"}}"""
    size, samples, converged, repetitions = (32, 16, 256, 1) if quick else (128, 64, 2048, 3)
    scene = exported(size)
    settings = Settings(width=size, height=size, crop_width=size, crop_height=size, samples=samples, adaptive=0)
    reference, _ = picture(scene, settings._replace(samples=converged, seed=977), threads=0)
    errors, seconds = ({kind: [] for kind in IntegratorKind} for _ in range(2))
    for kind in IntegratorKind:  # compiled once, before it counts
        picture(scene, settings._replace(samples=1, integrator=kind))
    for seed in range(1, repetitions + 1):
        for kind in IntegratorKind:
            image, spent = picture(scene, settings._replace(integrator=kind, seed=seed))
            errors[kind].append(relative_error(image, reference))
            seconds[kind].append(spent)
    cost = {kind: median(errors[kind]) * median(seconds[kind]) for kind in IntegratorKind}
    return {
        kind.name.lower(): {
            "efficiency_vs_brute_force": cost[IntegratorKind.BRUTE_FORCE] / cost[kind],
            "relative_error": median(errors[kind]),
            "samples_per_s": size * size * samples / median(seconds[kind]),
        }
        for kind in IntegratorKind
    }


def exported(size):
    """The Scene of the Cornell box, as Blender's viewport sees it."""
    import bpy

    open_for_both(SCENE, (size, size))
    builder, _ = export_scene(bpy.context.evaluated_depsgraph_get(), Report(), size, size)
    return builder.build()


def picture(scene, settings, threads=1):
    """(picture (h, w, 4), seconds of the processor)"""
    render = Render(scene, settings, threads)
    began = time.process_time()
    render.run()
    return render.image("Combined"), time.process_time() - began
