# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles, which Blender brings along, as the judge: its pictures as arrays, kept from run to run.

    cycles_picture("scenes_blend/cornell_box.blend", samples=4096, size=(128, 128))
    cycles_picture(build_scene, samples=256)         # build_scene() makes a scene in an empty file

Everything that makes Cycles' result another one than the rendering equation's is switched off: clamping, filtering of
glossy bounces, the threshold that drops faint lights. For processes in which bpy is.
"""

import functools
import hashlib
import inspect
import os
import tempfile
from pathlib import Path

import bpy
import numpy as np

from .exr import read_rgba
from .small_blend import enable_cycles, save_as_exr

SETTINGS = {
    "device": "CPU",
    "use_adaptive_sampling": False,
    "use_denoising": False,
    "use_fast_gi": False,
    "sample_clamp_direct": 0.0,
    "sample_clamp_indirect": 0.0,
    "blur_glossy": 0.0,
    "light_sampling_threshold": 0.0,
    "caustics_reflective": True,
    "caustics_refractive": True,
    "use_guiding": False,
    "time_limit": 0.0,
    "use_animated_seed": False,
}


def references_folder():
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "lambent", "references")


def cycles_picture(source, samples, size=None, seed=0):
    """Scene-linear radiance and alpha as Cycles renders them: float32 (height, width, 4), bottom row first.

    Parameters
    ----------
    source : path of a .blend, or a function that builds a scene in an empty file (a partial carries its arguments)
    size : (width, height) in pixels; None: what the scene says
    """
    kept = references_folder() / f"{digest(source, samples, size, seed)}.npy"
    if not kept.exists():
        picture = render_with_cycles(load(source), samples, size, seed)
        kept.parent.mkdir(parents=True, exist_ok=True)
        unfinished = kept.with_suffix(f".{os.getpid()}.npy")
        np.save(unfinished, picture)
        unfinished.replace(kept)
    return np.load(kept)


def digest(source, samples, size, seed):
    """Names a picture by all that decides it: Blender, these settings, the scene's file or the code that builds it."""
    parts = [bpy.app.version_string, bpy.app.build_hash, samples, size, seed, Path(__file__).read_bytes()]
    if callable(source):
        function = source.func if isinstance(source, functools.partial) else source
        arguments = (source.args, sorted(source.keywords.items())) if function is not source else ()
        parts += [Path(inspect.getsourcefile(function)).read_bytes(), function.__qualname__, arguments]
    else:
        parts.append(Path(source).read_bytes())
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:32]


def load(source):
    """Make `source` (see `cycles_picture`) the open file. Returns its scene."""
    if callable(source):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        source()
    else:
        bpy.ops.wm.open_mainfile(filepath=str(source), load_ui=False, use_scripts=False)
    return bpy.context.scene


def render_with_cycles(scene, samples, size=None, seed=0):
    """Render the open scene as it is."""
    enable_cycles()
    set_up_cycles(scene, samples, seed)
    if size:
        scene.render.resolution_x, scene.render.resolution_y = size
        scene.render.resolution_percentage = 100
    scene.render.use_border = scene.render.use_compositing = scene.render.use_sequencer = False
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "cycles.exr")
        save_as_exr(scene, path)
        bpy.ops.render.render(write_still=True)
        return read_rgba(path)


def set_up_cycles(scene, samples, seed=0):
    """Let Cycles render `scene` without short cuts."""
    scene.render.engine = "CYCLES"
    for name, value in SETTINGS.items():
        setattr(scene.cycles, name, value)
    scene.cycles.samples, scene.cycles.seed = samples, seed
