# SPDX-License-Identifier: GPL-3.0-or-later
"""The same .blend in Lambent and in Cycles: pictures, and the seconds that they took."""

import contextlib
import re
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np

import addon

from .cycles import cycles_picture, load, set_up_cycles
from .exr import read_exr
from .small_blend import enable_cycles, save_as_exr

ENGINES = ("LAMBENT", "CYCLES")
BOUNCES = (
    "max_bounces",
    "diffuse_bounces",
    "glossy_bounces",
    "transmission_bounces",
    "volume_bounces",
    "transparent_max_bounces",
)
MOST_SAMPLES = 1 << 24  # where a time limit ends a render


class Rendered(NamedTuple):
    picture: np.ndarray  # scene-linear, float32 (h, w, 3 or 4), bottom row first
    seconds: float  # of the whole render, on the clock
    cpu_s: float  # of all processors together
    samples: int


def open_for_both(source, size=None):
    """Open a .blend (or build a scene) at `size`, with both engines there and set alike. Returns its scene."""
    enable_engines()
    scene = load(source)
    if size:
        scene.render.resolution_x, scene.render.resolution_y = size
        scene.render.resolution_percentage = 100
    scene.render.use_border = scene.render.use_compositing = scene.render.use_sequencer = False
    set_alike(scene)
    return scene


def enable_engines():
    enable_cycles()
    if not hasattr(bpy.types.Scene, "lambent"):
        addon.register()


def set_alike(scene):
    """Give Cycles the bounces and the pixel filter of Lambent."""
    for name in BOUNCES:
        setattr(scene.cycles, name, getattr(scene.lambent, name))
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = scene.lambent.filter_type, scene.lambent.filter_width


def render_with(engine, scene, samples, seed=0):
    """(picture, seconds on the clock) of the open scene, with samples as Lambent distributes them."""
    rendered = render(engine, scene, samples, seed, adaptive=True)
    return rendered.picture, rendered.seconds


def cells_in_both(build, names, columns, cell, samples=1):
    """{name: (Lambent's pixels, Cycles')} of a scene that shows one thing in each square cell, row by row from below.

    `build` makes the scene, of `columns` cells of `cell` x `cell` pixels side by side; pixels are (cell, cell, 3).
    """
    size = (columns * cell, -(-len(names) // columns) * cell)
    scene = open_for_both(build, size)
    ours, theirs = render_with("LAMBENT", scene, samples)[0], cycles_picture(build, samples, size)
    cells = {}
    for number, name in enumerate(names):
        row, column = divmod(number, columns)
        part = np.s_[cell * row : cell * (row + 1), cell * column : cell * (column + 1), :3]
        cells[name] = ours[part], theirs[part]
    return cells


def render(engine, scene, samples=MOST_SAMPLES, seed=0, time_limit=0.0, progress=None, display=None, adaptive=False):
    """Render the open scene without short cuts, and by samples or by time. Returns Rendered.

    `progress(fraction)` is called now and then. `display`: path of a PNG, as the file's colour management shows it.
    `adaptive`: Lambent may give more samples to some pixels, as many on the whole. Cycles never does: its adaptive
    sampling only ends pixels early.
    """
    set_up_cycles(scene, samples, seed)
    scene.render.engine = engine
    ours = scene.lambent
    ours.samples, ours.seed, ours.clamp_direct, ours.clamp_indirect = samples, seed, 0.0, 0.0
    ours.use_animated_seed, ours.use_adaptive, ours.noise_target = False, adaptive, 0.0
    scene.cycles.time_limit = ours.time_limit = time_limit
    with tempfile.TemporaryDirectory() as folder, told(progress, samples, time_limit) as seen:
        path = Path(folder, "picture.exr")
        save_as_exr(scene, path)
        began, cpu_began = time.perf_counter(), time.process_time()
        bpy.ops.render.render(write_still=True)
        seconds, cpu_s = time.perf_counter() - began, time.process_time() - cpu_began
        channels, _ = read_exr(path)
        if display:
            save_display(scene, display)
    ends = {name.rsplit(".", 1)[-1]: pixels for name, pixels in channels.items()}
    picture = np.stack([ends[c] for c in "RGBA" if c in ends], axis=-1).astype(np.float32)
    return Rendered(picture, seconds, cpu_s, max(seen) if time_limit else samples)


def save_display(scene, path):
    image = scene.render.image_settings
    image.file_format, image.color_mode, image.color_depth = "PNG", "RGB", "8"
    bpy.data.images["Render Result"].save_render(str(path), scene=scene)


@contextlib.contextmanager
def told(progress, samples, time_limit):
    """While the body runs, call `progress(fraction)` with each line of status, such as `... | Sample 3/16`; gives the
    numbers of samples in those lines. (The header of Cycles' files has the number that was asked for.)"""
    began, seen = time.perf_counter(), [0]

    def on_stats(stats, _=None):
        sample = re.search(r"Sample (\d+)/(\d+)", stats)
        by_time = (time.perf_counter() - began) / time_limit if time_limit else 0.0
        if sample:
            seen.append(int(sample.group(1)))
        if sample and progress:
            progress(min(max(seen[-1] / samples, by_time), 1.0))

    bpy.app.handlers.render_stats.append(on_stats)
    try:
        yield seen
    finally:
        bpy.app.handlers.render_stats.remove(on_stats)
