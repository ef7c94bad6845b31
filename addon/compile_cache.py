# SPDX-License-Identifier: GPL-3.0-or-later
"""Kernels are compiled once for each version and machine: in the background, and visibly.

numba keeps machine code in a folder named by the sources' digest. A mark in that folder says that a render with an
integrator got as far as a tile, so that the next one need not compile.
"""

import threading
import time

import bpy

from .preferences import preferences

START_AFTER_S = 1.0  # let Blender draw its window first
JOIN_S = 0.3  # how long Blender may be kept from closing

_warm_up = None


def _mark(integrator):
    from .core import jit

    return jit.use_cache() / f"warm_{int(integrator)}"


def is_warm(integrator):
    """Whether a render with this IntegratorKind finds its kernels compiled."""
    return _mark(integrator).exists()


def mark_warm(integrator):
    """Remember it. A folder that cannot be written to holds no machine code either, so nothing is lost then."""
    try:
        mark = _mark(integrator)
        mark.parent.mkdir(parents=True, exist_ok=True)
        mark.touch()
    except OSError:
        pass


class WarmUp:
    """Renders a tiny scene on a thread, so that all kernels of the default integrator get compiled."""

    def __init__(self):
        self.began = time.perf_counter()
        self.error = None
        self.state = "Loading"
        self.thread = threading.Thread(target=self._work, name="lambent warm-up", daemon=True)
        self.thread.start()

    def _work(self):
        try:
            from . import core

            integrator = core.IntegratorKind.PATH
            if not is_warm(integrator):
                self.state = "Compiling"
                settings = core.Settings(
                    width=8, height=8, crop_width=8, crop_height=8, samples=1, integrator=int(integrator)
                )
                core.Render(tiny_scene(core), settings, threads=1).run()
                mark_warm(integrator)
            self.state = "Ready"
        except Exception as error:  # a render would say it again, to somebody who looks
            self.error = error
            self.state = "Failed"

    @property
    def text(self):
        if self.state == "Compiling":
            return f"Compiling kernels, once for this version: {time.perf_counter() - self.began:.0f} s"
        return {"Loading": "Loading kernels", "Ready": "Kernels are ready", "Failed": f"No kernels: {self.error}"}[
            self.state
        ]


def tiny_scene(core):
    """A triangle, a ball and a lamp: one of each kind of tree."""
    builder = core.SceneBuilder()
    grey = builder.material("Grey", core.materials.Diffuse((0.5, 0.5, 0.5)))
    triangle = builder.mesh("Triangle", [(-1, -1, 0), (1, -1, 0), (0, 1, 0)], [(0, 1, 2)])
    ball = builder.spheres("Ball", [(0, 0, 1)], [0.5])
    for geometry in (triangle, ball):
        builder.instance(geometry, materials=[grey])
    builder.point_light("Lamp", (0, 0, 3), (100, 100, 100), radius=0.1)
    builder.camera([(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 5), (0, 0, 0, 1)], (-1, 1, -1, 1))
    return builder.build()


def status():
    """A line for the panel, or None when there is nothing to say."""
    return None if _warm_up is None else _warm_up.text


def is_busy():
    return _warm_up is not None and _warm_up.thread.is_alive()


def _start():
    global _warm_up
    _warm_up = WarmUp()
    bpy.app.timers.register(_redraw, first_interval=1.0)


def _redraw():
    """Let the panels show how it goes, as long as it goes."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"PROPERTIES", "PREFERENCES"}:
                area.tag_redraw()
    return 1.0 if is_busy() else None


def register():
    if not bpy.app.background and preferences().warm_up:
        bpy.app.timers.register(_start, first_interval=START_AFTER_S)


def unregister():
    global _warm_up
    for timer in (_start, _redraw):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    if _warm_up is not None:
        _warm_up.thread.join(JOIN_S)
        _warm_up = None
