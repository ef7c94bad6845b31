# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures and plots of docs/figures.md: `python3 build.py figures`.

They are the experiments of A. Desai, "Ray Tracing in Python", 2021: his figures 16 to 19 (`worlds`), what those are
about as a plot (`time`), and his figures 20 and 21 (`rays`).
"""

import argparse
from pathlib import Path
from time import process_time

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot
from matplotlib.ticker import FuncFormatter
from rich.console import Console

from blender_tests.helpers.engines import open_for_both
from blender_tests.helpers.references import relative_error
from engine_core.integrator.tiles import Render
from engine_core.settings import IntegratorKind, Settings

from . import scaling
from .noise import FOLDER, builder_of
from .quiet import leave, progress_bar, quiet_blender
from .sheet import Panel, sheet, standard_view

WORLDS = {"cornell_mirror": "A mirror box", "cornell_glass": "A mirror box, a glass ball and a metal ball"}
INTEGRATORS = {"BRUTE_FORCE": "brute force", "MIXTURE": "mixture PDF", "PATH": "path"}
COLORS = {"BRUTE_FORCE": "#b5473c", "MIXTURE": "#c79a2b", "PATH": "#2f6f9f"}
SAMPLES = (5, 200)
SIDE, SMALL_SIDE = 200, 96  # pixels, of the pictures and of those whose error is measured
IN_CACHE = 20_000  # triangles, with their tree
STYLE = {"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.alpha": 0.25}


# ---- Three ways to sample --------------------------------------------------------------------------------------------


def worlds(folder, quick, tell):
    """For each of the two worlds a sheet: three integrators at 5 and at 200 samples."""
    side = 48 if quick else SIDE
    for number, (name, title) in enumerate(WORLDS.items()):
        scene, rows = build(name, side), []
        for samples in SAMPLES:
            tell((number + 0.5 * len(rows)) / len(WORLDS), f"{name}, {samples} samples")
            row = []
            for kind, text in INTEGRATORS.items():
                picture, seconds = rendered(scene, side, kind, samples)
                lines = (f"{seconds:.2f} s of the processor",)
                row.append(Panel(standard_view(picture), f"{text}, {samples} samples", lines))
            rows.append(row)
        # 256 colours are enough for noise, and a third of the bytes
        sheet(rows, title, scale=1).quantize(256).save(folder / f"{name}.png", optimize=True)


def build(name, side):
    """The Scene of a file in scenes_blend."""
    return builder_of(open_for_both(FOLDER / f"{name}.blend", (side, side))).build()


def rendered(scene, side, kind, samples, seed=1):
    """(picture, seconds that all threads computed); each pixel has the same number of samples."""
    bounces = dict.fromkeys(("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces"), 12)
    size = dict.fromkeys(("width", "height", "crop_width", "crop_height"), side)
    integrator = int(IntegratorKind[kind])
    settings = Settings(**size, **bounces, samples=samples, seed=seed, integrator=integrator, adaptive=0)
    if integrator not in _compiled:
        _compiled.add(integrator)
        Render(scene, settings._replace(samples=1)).run()
    began = process_time()
    render = Render(scene, settings)
    render.run()
    return render.image("Combined"), process_time() - began


_compiled = set()


# ---- Error against time ----------------------------------------------------------------------------------------------


def time(folder, quick, tell):
    """Relative error against seconds, for each world and integrator."""
    side, converged, counts = (32, 256, (4, 16)) if quick else (SMALL_SIDE, 4096, (1, 4, 16, 64, 256))
    with mpl.rc_context(STYLE):
        figure, axes = pyplot.subplots(1, 2, figsize=(8.0, 3.4), sharey=True, layout="constrained")
        for number, (ax, (name, title)) in enumerate(zip(axes, WORLDS.items(), strict=True)):
            scene = build(name, side)
            tell(number / 2, f"{name}, reference")
            reference = rendered(scene, side, "PATH", converged, seed=977)[0]
            for kind, text in INTEGRATORS.items():
                tell((number + 0.4) / 2, f"{name}, {text}")
                pictures, seconds = zip(*(rendered(scene, side, kind, count) for count in counts), strict=True)
                errors = [relative_error(picture, reference) ** 0.5 for picture in pictures]
                ax.loglog(seconds, errors, "o-", color=COLORS[kind], label=text, markersize=4)
                ax.annotate(f"{counts[-1]}", (seconds[-1], errors[-1]), xytext=(4, 3), textcoords="offset points")
            ax.set(title=title, xlabel="seconds of the processor")
        axes[0].set_ylabel("relative error (RMS)")
        axes[0].legend(frameon=False)
        save(figure, folder / "error_against_time.png")


# ---- What a ray costs ------------------------------------------------------------------------------------------------


def rays(folder, quick, tell):
    """Nanoseconds of a ray against the number of triangles, by the tree and by a plain list."""
    tell(0.0, "rays among 100 to 10 million triangles")
    points = scaling.measure(scaling.SIZES[:3] if quick else scaling.SIZES)
    counts = np.array([point["primitives"] for point in points])
    tree = np.array([point["tree_ns"] for point in points])
    in_list = [(point["primitives"], point["list_ns"]) for point in points if point["list_ns"]]
    with mpl.rc_context(STYLE):
        figure, (left, right) = pyplot.subplots(1, 2, figsize=(8.0, 3.4), layout="constrained")
        left.loglog(*zip(*in_list, strict=True), "s-", color=COLORS["BRUTE_FORCE"], label="list", markersize=4)
        left.loglog(counts, tree, "o-", color=COLORS["PATH"], label="tree", markersize=4)
        left.set(xlabel="triangles", ylabel="nanoseconds a ray", title="A tree and a plain list")
        left.legend(frameon=False)
        right.semilogx(counts, tree, "o", color=COLORS["PATH"], markersize=4)
        near = counts <= IN_CACHE
        slope, start = np.polyfit(np.log10(counts[near]), tree[near], 1)
        text = f"by the logarithm: {slope:.0f} ns for each factor of 10"
        right.semilogx(counts, start + slope * np.log10(counts), "--", color="0.5", linewidth=1, label=text)
        right.legend(frameon=False, loc="upper left")
        for count, cost in zip(counts, tree, strict=True):
            right.annotate(short(count), (count, cost), xytext=(0, 6), textcoords="offset points", ha="center")
        right.set(xlabel="triangles", title="The tree alone")
        right.set_ylim(0, 1.25 * tree.max())
        right.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0f}"))
        save(figure, folder / "cost_of_a_ray.png")


def short(count):
    """1.2k, 98k, 1M"""
    for unit, letter in ((1e6, "M"), (1e3, "k"), (1.0, "")):
        if count >= 0.995 * unit:
            return f"{float(f'{count / unit:.2g}'):.3g}{letter}"


def save(figure, path):
    figure.savefig(path, dpi=110)
    pyplot.close(figure)


# ---- The command -----------------------------------------------------------------------------------------------------

FIGURES = {"worlds": worlds, "time": time, "rays": rays}


def main():
    parser = argparse.ArgumentParser(prog="python3 build.py figures", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(FIGURES)}; all without any")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    for name in options.names:
        if name not in FIGURES:
            parser.error(f"there is no figure {name}; there are {', '.join(FIGURES)}")
    options.output.mkdir(parents=True, exist_ok=True)
    mpl.use("Agg")
    with quiet_blender() as blender:
        console = Console(file=blender.terminal, highlight=False)
        for name in options.names or FIGURES:
            with progress_bar(console) as tell:
                FIGURES[name](options.output, options.quick, tell)
        console.print(f"The figures are in {options.output}", soft_wrap=True)


if __name__ == "__main__":
    leave(main)
