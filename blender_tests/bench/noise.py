# SPDX-License-Identifier: GPL-3.0-or-later
"""Noise against time, Lambent beside Cycles: which of them has less error after the same seconds?

The error of a picture falls with its samples about as 1 / samples, so error x seconds says how good an engine is,
whatever the number of samples. Seconds are the slope between two numbers of samples: export, trees and files do not
count; those fixed costs are given beside it. Each engine is compared with its own converged reference, and how far the
two references are apart is the bias. Paths are limited by the total number of bounces only, which every engine can do.

References are kept (see helpers/references.py). With them there, all scenes take about ten minutes.
"""

from pathlib import Path
from statistics import geometric_mean, median
from typing import NamedTuple

from blender_tests.helpers.engines import ENGINES, open_for_both, render, set_alike
from blender_tests.helpers.references import reference, relative_error

FOLDER = Path(__file__).parents[2] / "scenes_blend"
SCENES = (
    *("cornell_box", "cornell_mirror", "cornell_glass", "three_spheres", "random_spheres"),
    *("instances", "mesh_hdri", "many_lights", "interior", "textured_emitter"),
)


class Plan(NamedTuple):
    pixels: int  # of a picture, about
    low: int  # samples
    high: int
    converged: int
    repetitions: int


FULL, QUICK = Plan(1 << 14, 16, 128, 2048, 3), Plan(48 * 48, 4, 16, 256, 1)


def run(quick=False, scenes=(), progress=None):
    """{scene: figures}, and over all of them the geometric mean and the lowest efficiency and the greatest bias.

    `progress(fraction, text)` is called now and then.
    """
    plan, scenes = QUICK if quick else FULL, scenes or SCENES
    tell = progress or (lambda fraction, text: None)
    results = {}
    for number, name in enumerate(scenes):
        results[name] = measure(
            FOLDER / f"{name}.blend",
            plan,
            lambda f, text, number=number, name=name: tell((number + f) / len(scenes), f"{name}: {text}"),
        )
    efficiencies = [figures["efficiency_vs_cycles"] for figures in results.values()]
    return {
        **results,
        "all": {
            "efficiency_vs_cycles": geometric_mean(efficiencies),
            "lowest_efficiency_vs_cycles": min(efficiencies),
            "greatest_bias": max(figures["bias"] for figures in results.values()),
        },
    }


def measure(path, plan, tell=lambda fraction, text: None):
    """Figures of one scene; efficiency_vs_cycles is error x seconds of Cycles over that of Lambent."""
    scene = open_scene(path, plan.pixels)
    references = {}
    for engine in ENGINES:
        references[engine] = reference(
            engine, scene, path, plan.converged, lambda f, engine=engine: tell(0.0, f"{engine} reference {f:.0%}")
        )
    for engine in ENGINES:  # what is done once in a process shall not count
        tell(0.0, "warming up")
        render(engine, scene, 1)
    slopes, cpu, fixed, errors = ({engine: [] for engine in ENGINES} for _ in range(4))
    for number in range(plan.repetitions):
        for engine in ENGINES:
            tell(number / plan.repetitions, engine)
            low, high = (render(engine, scene, samples, number + 1) for samples in (plan.low, plan.high))
            extra = plan.high - plan.low
            slopes[engine].append((high.seconds - low.seconds) / extra)
            cpu[engine].append((high.cpu_s - low.cpu_s) / extra)
            fixed[engine].append(low.seconds - plan.low * slopes[engine][-1])
            errors[engine].append(relative_error(high.picture, references[engine].picture))
    slope, cpu, error = ({engine: median(values[engine]) for engine in ENGINES} for values in (slopes, cpu, errors))
    pixels = scene.render.resolution_x * scene.render.resolution_y
    ours, theirs = (references[engine] for engine in ENGINES)
    return {
        "efficiency_vs_cycles": error["CYCLES"] * slope["CYCLES"] / (error["LAMBENT"] * slope["LAMBENT"]),
        "efficiency_by_processor_time": error["CYCLES"] * cpu["CYCLES"] / (error["LAMBENT"] * cpu["LAMBENT"]),
        "bias": abs(ours.mean / theirs.mean - 1.0),
        "bias_noise": (ours.mean_error**2 + theirs.mean_error**2) ** 0.5 / theirs.mean,
        "samples_ratio": slope["CYCLES"] / slope["LAMBENT"],
        "error_ratio": error["CYCLES"] / error["LAMBENT"],
        "samples_per_s": pixels / slope["LAMBENT"],
        "cycles_samples_per_s": pixels / slope["CYCLES"],
        "fixed_s": median(fixed["LAMBENT"]),
        "cycles_fixed_s": median(fixed["CYCLES"]),
    }


def open_scene(path, pixels):
    """Open a scene for both engines in its own format, so large that it has about so many pixels."""
    scene = open_for_both(path)
    aspect = scene.render.resolution_x / scene.render.resolution_y
    scene.render.resolution_x, scene.render.resolution_y = (round((pixels * a) ** 0.5) for a in (aspect, 1 / aspect))
    scene.render.resolution_percentage = 100
    for name in ("diffuse_bounces", "glossy_bounces", "transmission_bounces"):
        setattr(scene.lambent, name, scene.lambent.max_bounces)
    set_alike(scene)
    return scene


if __name__ == "__main__":
    import json

    print(json.dumps(run(), indent=2))
