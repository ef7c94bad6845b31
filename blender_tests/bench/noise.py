# SPDX-License-Identifier: GPL-3.0-or-later
"""Noise against time, Lambent beside Cycles: which of them has less error after the same seconds?

The error of a picture falls with its samples about as 1 / samples, so error x seconds says how good an engine is,
whatever the number of samples. Seconds are the slope between two numbers of samples: export, trees and files do not
count; those fixed costs are given beside it. Each engine is compared with its own converged reference, and how far the
two references are apart is the bias. Paths are limited by the total number of bounces only, which every engine can do.

Lambent distributes its samples as it does for a user; efficiency_of_uniform_samples is what it has without that. Where
Mitsuba 3 can express the scene it takes part too, compiled for single rays ("scalar") and, where there is LLVM 19, for
all at once ("llvm"). References are kept (see helpers/references.py); with them there, all takes about ten minutes.
"""

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import geometric_mean, median
from typing import NamedTuple

import bpy

from addon.export import Report, export_scene
from blender_tests.helpers.engines import ENGINES, Rendered, open_for_both, render, set_alike
from blender_tests.helpers.references import Reference, reference, relative_error

from . import mitsuba_scene

FOLDER = Path(__file__).parents[2] / "scenes_blend"
SCENES = (
    *("cornell_box", "cornell_mirror", "cornell_glass", "three_spheres", "random_spheres"),
    *("instances", "mesh_hdri", "many_lights", "interior", "textured_emitter"),
)


ALWAYS = 3  # of the entrants: Lambent, Cycles and Lambent with uniform samples; Mitsuba is rendered once
ANOTHER_PICTURE = 0.01  # bias beyond which Mitsuba's speed says nothing about ours


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
    return {**results, "all": summary(list(results.values()))}


def summary(scenes):
    """Geometric mean and least of each efficiency, over the scenes that have it, and the greatest bias."""
    found = {"greatest_bias": max(figures["bias"] for figures in scenes)}
    for name in (
        "efficiency_vs_cycles",
        "efficiency_of_uniform_samples",
        "efficiency_vs_mitsuba_scalar",
        "efficiency_vs_mitsuba_llvm",
    ):
        values = [figures[name] for figures in scenes if name in figures]
        if values:
            found |= {name: geometric_mean(values), f"lowest_{name}": min(values)}
    return found


def measure(path, plan, tell=lambda fraction, text: None):
    """Figures of one scene; efficiency_vs_cycles is error x seconds of Cycles over that of Lambent."""
    scene = open_scene(path, plan.pixels)
    pixels = scene.render.resolution_x * scene.render.resolution_y
    entrants = [*blender_engines(scene, path, plan, tell), *mitsuba_variants(scene, path, plan, tell)]
    for number, entrant in enumerate(entrants):
        tell(0.1 * number / len(entrants), f"{entrant.name}, warming up")
        entrant.render(plan.low, 0)  # what is done once in a process shall not count
    runs = {entrant.name: [] for entrant in entrants}
    for number in range(plan.repetitions):
        for entrant in entrants if number == 0 else entrants[:ALWAYS]:  # in turns: all meet the same disturbance
            tell(0.1 + 0.9 * number / plan.repetitions, entrant.name)
            runs[entrant.name].append(run_once(entrant, plan, number + 1))
    speed = {name: Run(*(median(column) for column in zip(*values, strict=True))) for name, values in runs.items()}
    ours, theirs = (entrant.reference for entrant in entrants[:2])
    lambent, uniform, cycles = (speed[name] for name in ("lambent", "lambent_uniform", "cycles"))
    figures = {
        "efficiency_vs_cycles": cycles.error * cycles.slope / (lambent.error * lambent.slope),
        "efficiency_by_processor_time": cycles.error * cycles.cpu_slope / (lambent.error * lambent.cpu_slope),
        "efficiency_of_uniform_samples": cycles.error * cycles.slope / (uniform.error * uniform.slope),
        "bias": abs(ours.mean / theirs.mean - 1.0),
        "bias_noise": (ours.mean_error**2 + theirs.mean_error**2) ** 0.5 / theirs.mean,
        "samples_ratio": cycles.slope / lambent.slope,
        "error_ratio": cycles.error / lambent.error,
        "samples_per_s": pixels / lambent.slope,
        "cycles_samples_per_s": pixels / cycles.slope,
        "fixed_s": lambent.fixed,
        "cycles_fixed_s": cycles.fixed,
    }
    for entrant in entrants[ALWAYS:]:
        other = speed[entrant.name]
        figures["mitsuba_bias"] = abs(ours.mean / entrant.reference.mean - 1.0)
        if figures["mitsuba_bias"] > ANOTHER_PICTURE:
            continue
        figures[f"efficiency_vs_{entrant.name}"] = other.error * other.slope / (lambent.error * lambent.slope)
        figures[f"{entrant.name}_samples_per_s"] = pixels / other.slope
    return figures


class Run(NamedTuple):
    slope: float  # seconds for one more sample of all pixels
    cpu_slope: float
    fixed: float  # seconds before the first
    error: float


class Entrant(NamedTuple):
    name: str
    render: Callable  # of samples and seed: Rendered
    reference: Reference


def run_once(entrant, plan, seed):
    low, high = (entrant.render(samples, seed) for samples in (plan.low, plan.high))
    error = relative_error(high.picture, entrant.reference.picture)
    slope, cpu_slope = (slope_of(a, b, plan) for a, b in ((low.seconds, high.seconds), (low.cpu_s, high.cpu_s)))
    return Run(slope, cpu_slope, low.seconds - plan.low * slope, error)


def slope_of(low, high, plan):
    """Seconds for one more sample. At least a tenth of what all samples took on average: a disturbance may make the
    difference vanish."""
    return max((high - low) / (plan.high - plan.low), 0.1 * high / plan.high)


def blender_engines(scene, path, plan, tell):
    for engine in ENGINES:
        found = reference(engine, scene, path, plan.converged, lambda f, e=engine: tell(0.0, f"{e} reference {f:.0%}"))
        yield Entrant(engine.lower(), partial(render, engine, scene, adaptive=True), found)
        if engine == "LAMBENT":
            uniform = Entrant("lambent_uniform", partial(render, engine, scene), found)
    yield uniform


def mitsuba_variants(scene, path, plan, tell):
    """An entrant for each variant of Mitsuba that runs here; none if Mitsuba cannot express the scene."""
    builder, size = builder_of(scene), (scene.render.resolution_x, scene.render.resolution_y)
    key = [mitsuba_scene.version(), Path(mitsuba_scene.__file__).read_bytes()]
    found = None
    for variant in reversed(mitsuba_scene.available_variants()):  # the fastest first: it makes the reference
        try:
            ready = mitsuba_scene.MitsubaScene(builder, size, scene.lambent.max_bounces, variant)
        except mitsuba_scene.NotExpressibleError:
            return
        if found is None:
            tell(0.0, "mitsuba reference")
            draw = lambda samples, seed, _, ready=ready: ready.render(samples, seed)  # noqa: E731
            found = reference("MITSUBA", scene, path, plan.converged, draw=draw, key=key)
        yield Entrant(f"mitsuba_{variant.split('_')[0]}", partial(render_with_mitsuba, ready), found)


def render_with_mitsuba(scene, samples, seed):
    began, cpu_began = time.perf_counter(), time.process_time()
    picture = scene.render(samples, seed)
    return Rendered(picture, time.perf_counter() - began, time.process_time() - cpu_began, samples)


def builder_of(scene):
    """What Lambent renders, in a SceneBuilder."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    builder, _ = export_scene(depsgraph, Report(), scene.render.resolution_x, scene.render.resolution_y)
    return builder


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
