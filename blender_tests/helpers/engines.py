# SPDX-License-Identifier: GPL-3.0-or-later
"""The same .blend in Lambent and in Cycles: pictures, seconds, and how different two pictures are."""

import hashlib
import os
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

import addon
from engine_core.jit import source_digest

from .cycles import load, references_folder, set_up_cycles
from .exr import read_rgba
from .small_blend import enable_cycles, save_as_exr

BOUNCES = ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces")


def open_for_both(source, size):
    """Open a .blend (or build a scene) at `size`, with both engines there and set alike. Returns its scene."""
    enable_cycles()
    if not hasattr(bpy.types.Scene, "lambent"):
        addon.register()
    scene = load(source)
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.use_border = scene.render.use_compositing = scene.render.use_sequencer = False
    for name in BOUNCES:
        setattr(scene.cycles, name, getattr(scene.lambent, name))
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", scene.lambent.filter_width
    return scene


def render_with(engine, scene, samples, seed=0):
    """(picture float32 (h, w, 4), bottom row first; seconds of the whole render) of the open scene."""
    set_up_cycles(scene, samples, seed)
    scene.render.engine = engine
    scene.lambent.samples, scene.lambent.seed = samples, seed
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "picture.exr")
        save_as_exr(scene, path)
        began = time.perf_counter()
        bpy.ops.render.render(write_still=True)
        seconds = time.perf_counter() - began
        return read_rgba(path), seconds


def reference(engine, scene, source, samples):
    """A converged picture, kept outside the repository from run to run. `source`: what names the open scene."""
    parts = [engine, samples, scene.render.resolution_x, scene.render.resolution_y, bpy.app.version_string]
    parts += [Path(source).read_bytes(), source_digest() if engine == "LAMBENT" else ""]
    if engine == "LAMBENT":
        parts += [path.read_bytes() for path in sorted(Path(addon.__file__).parent.rglob("*.py"))]
    kept = references_folder() / f"{hashlib.sha256(repr(parts).encode()).hexdigest()[:32]}.npy"
    if not kept.exists():
        picture, _ = render_with(engine, scene, samples, seed=977)
        kept.parent.mkdir(parents=True, exist_ok=True)
        unfinished = kept.with_suffix(f".{os.getpid()}.npy")
        np.save(unfinished, picture)
        unfinished.replace(kept)
    return np.load(kept)


def relative_error(picture, reference):
    """Mean of (x - r)^2 / (r^2 + 0.01) over pixels and colours, without the worst 0.1 % of the pixels."""
    x, r = (image[..., :3].astype(np.float64) for image in (picture, reference))
    errors = ((x - r) ** 2 / (r**2 + 0.01)).mean(axis=-1).ravel()
    kept = len(errors) - int(np.ceil(len(errors) * 0.001))
    return float(np.sort(errors)[:kept].mean())
