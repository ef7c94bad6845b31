# SPDX-License-Identifier: GPL-3.0-or-later
"""Noise against time, Lambent beside Cycles: which of them has less error after the same seconds?

The error of a picture falls with its samples about as 1 / samples, so error x seconds says how good an engine is,
whatever the number of samples. Seconds are the slope between two numbers of samples: export, trees and files do not
count; those fixed costs are given beside it. Each engine is compared with its own converged reference, and how far the
two references are apart is the bias.
"""

from pathlib import Path
from statistics import median

from blender_tests.helpers.engines import open_for_both, reference, relative_error, render_with

SCENES = ("cornell_box", "three_spheres", "instances")
FOLDER = Path(__file__).parents[2] / "scenes_blend"
ENGINES = ("LAMBENT", "CYCLES")


def run(quick=False):
    """{scene: figures}; efficiency_vs_cycles is error x seconds of Cycles over that of Lambent."""
    return {name: measure(FOLDER / f"{name}.blend", quick) for name in SCENES}


def measure(path, quick):
    size, low, high, converged, repetitions = ((48, 48), 4, 16, 256, 1) if quick else ((160, 160), 16, 80, 4096, 3)
    scene = open_for_both(path, size)
    references = {engine: reference(engine, scene, path, converged) for engine in ENGINES}
    for engine in ENGINES:  # what is done once in a process shall not count
        render_with(engine, scene, 1)
    slopes, fixed, errors = ({engine: [] for engine in ENGINES} for _ in range(3))
    for seed in range(1, repetitions + 1):
        for engine in ENGINES:
            _, seconds_low = render_with(engine, scene, low, seed)
            picture, seconds_high = render_with(engine, scene, high, seed)
            slope = (seconds_high - seconds_low) / (high - low)
            slopes[engine].append(slope)
            fixed[engine].append(seconds_low - low * slope)
            errors[engine].append(relative_error(picture, references[engine]))
    pixels = size[0] * size[1]
    slope, error = ({engine: median(values[engine]) for engine in ENGINES} for values in (slopes, errors))
    means = {engine: references[engine][..., :3].mean(dtype=float) for engine in ENGINES}
    return {
        "efficiency_vs_cycles": error["CYCLES"] * slope["CYCLES"] / (error["LAMBENT"] * slope["LAMBENT"]),
        "bias": abs(means["LAMBENT"] / means["CYCLES"] - 1.0),
        "samples_ratio": slope["CYCLES"] / slope["LAMBENT"],
        "error_ratio": error["CYCLES"] / error["LAMBENT"],
        "samples_per_s": pixels / slope["LAMBENT"],
        "cycles_samples_per_s": pixels / slope["CYCLES"],
        "fixed_s": median(fixed["LAMBENT"]),
        "cycles_fixed_s": median(fixed["CYCLES"]),
    }


if __name__ == "__main__":
    import json

    print(json.dumps(run(), indent=2))
