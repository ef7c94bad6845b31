# SPDX-License-Identifier: GPL-3.0-or-later
"""Kernels are compiled once for each version and machine: in the background, and visibly.

numba keeps machine code in a folder named by the sources' digest. A mark in that folder says that all of it is there,
so that the next Blender loads it in a moment. `prepare` does either, for whoever comes first; the others wait.

Integrators share nearly all of their kernels. The default one is prepared ahead; another one, when it is chosen, takes
some seconds more.
"""

import threading
import time

import bpy

from .preferences import preferences

START_AFTER_S = 1.0  # let Blender draw its window first
JOIN_S = 0.3  # how long Blender may be kept from closing
POLL_S = 0.02  # how long somebody who waits may not notice that nobody wants the kernels any more

IDENTITY = [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)]
DEFAULT = 2  # engine_core's IntegratorKind.PATH
_lock, _ready = threading.Lock(), set()  # of numbers of integrators
_warm_up = None


def are_compiled(integrator=DEFAULT):
    """Whether its kernels need not be compiled: this process has them, or finds them on disk."""
    return integrator in _ready or _mark(integrator).exists()


def prepare(integrator=DEFAULT, cancelled=None):
    """Load the kernels, or compile them; that cannot be interrupted. False if `cancelled`, an event, was set before."""
    while integrator not in _ready:
        if cancelled is not None and cancelled.is_set():
            return False
        if _lock.acquire(timeout=POLL_S):
            try:
                if integrator not in _ready:
                    _use_all_kernels(integrator)
                    _ready.add(integrator)
            finally:
                _lock.release()
    return True


def _mark(integrator=DEFAULT):
    from .core import jit

    return jit.use_cache() / f"compiled {integrator}"


def _use_all_kernels(integrator):
    """Render a tiny scene: a triangle, a ball and a lamp, twice, so that there is one of each kind of tree.

    The first time with shader programs wherever there can be any, and all that programs may be made of.
    """
    from . import core

    builder = core.SceneBuilder()
    with_programs = not are_compiled(integrator)
    grey = builder.material("Grey", core.materials.Diffuse((0.5, 0.5, 0.5)))
    shader = None
    if with_programs:
        entry = core.opcodes.Entry
        core.compile_all_programs(but={entry.VORONOI if bpy.app.version < (5, 0) else entry.VORONOI_OF_4})
        value = core.graph.node(core.opcodes.Op.INPUT_VECTOR, mode=core.opcodes.InputVector.OBJECT)
        shader = core.LampShader(value, IDENTITY)
        grey = builder.material(
            "Coloured", core.materials.Add(core.materials.Diffuse(value), core.materials.Emission(value))
        )
        builder.background(value)
    triangle = builder.mesh("Triangle", [(-1, -1, 0), (1, -1, 0), (0, 1, 0)], [(0, 1, 2)])
    ball = builder.spheres("Ball", [(0, 0, 1)], [0.5])
    for geometry in (triangle, triangle, ball):
        builder.instance(geometry, materials=[grey])
    builder.point_light("Lamp", (0, 0, 3), (100, 100, 100), radius=0.1, shader=shader)
    builder.camera([(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 5), (0, 0, 0, 1)], (-1, 1, -1, 1))
    settings = core.Settings(width=8, height=8, crop_width=8, crop_height=8, samples=1, integrator=integrator)
    render = core.Render(builder.build(), settings, threads=1)
    render.run()
    render.image("Combined")
    try:
        mark = _mark(integrator)
        mark.parent.mkdir(parents=True, exist_ok=True)
        mark.touch()
    except OSError:  # a folder that cannot be written to holds no machine code either
        pass


class WarmUp:
    """Prepares the kernels on a thread, before somebody needs them."""

    def __init__(self):
        self._began, self._state, self._error = time.perf_counter(), "Loading kernels", None
        self.thread = threading.Thread(target=self._run, name="lambent warm-up", daemon=True)
        self.thread.start()

    def _run(self):
        try:
            if not are_compiled():
                self._state = "Compiling kernels, once for this version"
            prepare()
            self._state = "Kernels are ready"
        except Exception as error:  # a render would say it again, to somebody who looks
            self._state = f"No kernels: {error}"

    @property
    def text(self):
        seconds = f" ({time.perf_counter() - self._began:.0f} s)" if self.thread.is_alive() else ""
        return self._state + seconds


def status():
    """A line for the panel, or None when there is nothing to say."""
    return None if _warm_up is None else _warm_up.text


def is_busy():
    return _warm_up is not None and _warm_up.thread.is_alive()


def _start():
    global _warm_up
    _warm_up = WarmUp()
    bpy.app.timers.register(_redraw, first_interval=1.0, persistent=True)


def _redraw():
    """Let the panels show how it goes, as long as it goes."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"PROPERTIES", "PREFERENCES"}:
                area.tag_redraw()
    return 1.0 if is_busy() else None


def register():
    if not bpy.app.background and preferences().warm_up:
        bpy.app.timers.register(_start, first_interval=START_AFTER_S, persistent=True)


def unregister():
    global _warm_up
    for timer in (_start, _redraw):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    if _warm_up is not None:
        _warm_up.thread.join(JOIN_S)
        _warm_up = None
