# SPDX-License-Identifier: GPL-3.0-or-later
"""One scene in Lambent and in Cycles, side by side: `python3 build.py compare FILE`.

Both engines get the same bounces, filter and exposure: those of the engine that the file was saved for. Denoising,
clamping and adaptive sampling are off in both, and the compositor is left out. Errors of an engine are those against
its own reference; what the references are apart is the bias.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from rich.console import Console
from rich.table import Table

from addon.ui.copy_from_cycles import copy_settings
from blender_tests.helpers.cycles import load
from blender_tests.helpers.engines import ENGINES, MOST_SAMPLES, enable_engines, render, set_alike
from blender_tests.helpers.references import reference, relative_error, rms_error

from .quiet import leave, progress_bar, quiet_blender
from .sheet import Panel, difference_map, flip, sheet, shown

NAMES = {"LAMBENT": "Lambent", "CYCLES": "Cycles"}


class CompareError(Exception):
    """Why there is nothing to compare, for the user."""


def compare(path, samples=None, seconds=0.0, reference_samples=0, seed=0, tell=lambda fraction, text: None, **where):
    """(figures, {(engine, "picture" or "reference"): (scene-linear picture, shown picture)}, warnings).

    `samples` of each engine, else `seconds`; without either, what the file says. `where`: size, frame.
    """
    scene = open_scene(path, **where)
    if not samples and not seconds:
        samples = scene.lambent.samples
    jobs = [(engine, what) for what in ("picture", "reference") for engine in ENGINES]
    jobs = jobs if reference_samples else jobs[:2]
    figures, pictures = {engine: {} for engine in ENGINES}, {}
    with tempfile.TemporaryDirectory() as folder:
        for number, (engine, what) in enumerate(jobs):
            name = NAMES[engine] if what == "picture" else f"{NAMES[engine]}, reference"

            def progress(fraction, number=number, name=name):
                tell((number + fraction) / len(jobs), name)

            progress(0.0)
            display = Path(folder, "shown.png")
            if what == "picture":
                render(engine, scene, 1, seed)  # what is done once, such as compiling, shall not count
                done = render(engine, scene, samples or MOST_SAMPLES, seed, seconds, progress, display)
                figures[engine] |= {"samples": done.samples, "seconds": done.seconds, "mean": mean(done.picture)}
                pictures[engine, what] = done.picture[..., :3], shown(display)
            else:
                found = reference(engine, scene, path, reference_samples, progress)
                figures[engine] |= {"reference_samples": found.samples, "reference_mean": found.mean}
                figures[engine]["reference_mean_error"] = found.mean_error
                pictures[engine, what] = found.picture, as_shown(scene, found.picture, display)
    add_errors(figures, pictures, reference_samples)
    return figures, pictures, about(scene, path)


def open_scene(path, size=None, frame=None):
    """Open a user's file for both engines, set alike. Raises CompareError."""
    enable_engines()
    try:
        scene = load(path)
    except RuntimeError as error:
        raise CompareError(f"Blender cannot open {path}: {error}") from None
    if scene.camera is None:
        raise CompareError(f"{Path(path).name} has no camera in its scene '{scene.name}'")
    if scene.render.engine != "LAMBENT":
        copy_settings(scene)
    set_alike(scene)
    if frame is not None:
        scene.frame_set(frame)
    if size:
        scene.render.resolution_x, scene.render.resolution_y = size
        scene.render.resolution_percentage = 100
    scene.render.use_border = scene.render.use_compositing = scene.render.use_sequencer = False
    scene.cycles.film_exposure = scene.lambent.exposure
    return scene


def as_shown(scene, picture, path):
    """A scene-linear picture, bottom row first, as the file's colour management shows it."""
    height, width = picture.shape[:2]
    b_image = bpy.data.images.new("Shown", width, height, float_buffer=True)
    b_image.pixels.foreach_set(np.dstack([picture, np.ones((height, width))]).astype(np.float32).ravel())
    image = scene.render.image_settings
    image.file_format, image.color_mode, image.color_depth = "PNG", "RGB", "8"
    b_image.save_render(str(path), scene=scene)
    bpy.data.images.remove(b_image)
    return shown(path)


def add_errors(figures, pictures, has_references):
    """Fill in errors of each engine, and how the two are apart."""
    for engine in ENGINES if has_references else ():
        (x, x_shown), (r, r_shown) = pictures[engine, "picture"], pictures[engine, "reference"]
        figures[engine] |= {"rmse": rms_error(x, r), "relative_mse": relative_error(x, r)}
        figures[engine]["flip"] = flip(r_shown, x_shown)[1]
    what = "reference" if has_references else "picture"
    (a, a_shown), (b, b_shown) = (pictures[engine, what] for engine in ENGINES)
    ours, theirs = (figures[engine] for engine in ENGINES)
    figures["difference"] = {
        "of": f"{what}s",
        "rmse": rms_error(a, b),
        "relative_mse": relative_error(a, b),
        "flip": flip(b_shown, a_shown)[1],
        "bias": mean(a) / mean(b) - 1.0 if mean(b) else None,
        "bias_noise": bias_noise(ours, theirs, a, b, has_references),
    }
    if has_references:
        figures["efficiency_vs_cycles"] = (
            theirs["relative_mse"] * theirs["seconds"] / max(ours["relative_mse"] * ours["seconds"], 1e-30)
        )


def bias_noise(ours, theirs, a, b, has_references):
    """One standard deviation of the bias: from independent parts of the references, else from how pixels scatter."""
    if not mean(b):
        return None
    if has_references:
        return float(np.hypot(ours["reference_mean_error"], theirs["reference_mean_error"]) / mean(b))
    return float((a - b).mean(axis=2).std() / np.sqrt(a[..., 0].size) / mean(b))


def mean(picture):
    return float(picture[..., :3].mean(dtype=np.float64))


def about(scene, path):
    size = [scene.render.resolution_x, scene.render.resolution_y]
    size = [side * scene.render.resolution_percentage // 100 for side in size]
    return {"file": str(path), "frame": scene.frame_current, "size": size, "blender": bpy.app.version_string}


# ---- The sheet -------------------------------------------------------------------------------------------------------


def draw(figures, pictures, about):
    """All pictures with their figures: a PIL image."""
    rows = [row(figures, pictures, what) for what in ("picture", "reference") if (ENGINES[0], what) in pictures]
    width, height = about["size"]
    return sheet(rows, f"{Path(about['file']).name}, {width} x {height}, Blender {about['blender']}")


def row(figures, pictures, what):
    panels = []
    for engine in ENGINES:
        values = figures[engine]
        if what == "picture":
            lines = (f"{values['samples']} samples in {values['seconds']:.2f} s, mean {values['mean']:.4g}",)
            if "rmse" in values:
                errors = f"RMSE {values['rmse']:.3g}, relative MSE {values['relative_mse']:.3g}"
                lines += (f"{errors}, FLIP {values['flip']:.3f}",)
            panels.append(Panel(pictures[engine, what][1], NAMES[engine], lines))
        else:
            lines = (f"{values['reference_samples']} samples, mean {values['reference_mean']:.5g}",)
            panels.append(Panel(pictures[engine, what][1], f"{NAMES[engine]}, converged", lines))
    (a, a_shown), (b, b_shown) = (pictures[engine, what] for engine in ENGINES)
    colored, scale = difference_map(a, b)
    bias = mean(a) / mean(b) - 1.0 if mean(b) else 0.0
    lines = (f"red: Lambent is brighter, blue: Cycles is; full colour at {scale:.0%}", f"means differ by {bias:+.2%}")
    panels.append(Panel(colored, "Difference", lines))
    colored, value = flip(b_shown, a_shown)
    panels.append(
        Panel(colored, "FLIP", ("how different they look: black not at all, yellow most", f"mean {value:.3f}"))
    )
    return panels


# ---- The command -----------------------------------------------------------------------------------------------------


def main():
    options = parse()
    with quiet_blender() as blender:
        console = Console(file=blender.terminal, highlight=False)
        try:
            figures, pictures, facts = compare_with_progress(options, console)
        except CompareError as error:
            sys.stderr.write(f"build.py: {error}\n")
            return 1
        for warning in blender.warnings():
            console.print(f"[yellow]{warning}")
        stem = options.output / f"{options.file.stem}_compare"
        draw(figures, pictures, facts).save(f"{stem}.png", optimize=True)
        Path(f"{stem}.json").write_text(json.dumps({**facts, **figures}, indent=2) + "\n", encoding="utf-8")
        console.print(table(figures))
        console.print(f"{stem}.png\n{stem}.json", soft_wrap=True)
    return 0


def compare_with_progress(options, console):
    with progress_bar(console) as tell:
        return compare(
            options.file,
            options.samples,
            options.seconds,
            options.reference,
            options.seed,
            tell,
            size=options.size,
            frame=options.frame,
        )


def table(figures):
    result = Table(box=None, header_style="dim")
    result.add_column("")
    for name in (*NAMES.values(), "difference"):
        result.add_column(name, justify="right")
    names = ("samples", "seconds", "mean", "rmse", "relative_mse", "flip", "bias", "bias_noise")
    for name in names:
        values = [figures[column].get(name) for column in (*ENGINES, "difference")]
        if any(value is not None for value in values):
            texts = ["" if v is None else f"{v:,}" if isinstance(v, int) else f"{v:.4g}" for v in values]
            result.add_row(name.replace("_", " "), *texts)
    if "efficiency_vs_cycles" in figures:
        result.add_row("efficiency", f"{figures['efficiency_vs_cycles']:.2f} x Cycles")
    return result


def parse():
    parser = argparse.ArgumentParser(prog="python3 build.py compare", description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("."))
    parser.add_argument("--samples", type=int)
    parser.add_argument("--seconds", type=float, default=0.0)
    parser.add_argument("--reference", type=int, default=0)
    parser.add_argument("--frame", type=int)
    parser.add_argument("--size", type=int, nargs=2)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    return options


if __name__ == "__main__":
    leave(main)
