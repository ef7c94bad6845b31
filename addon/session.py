# SPDX-License-Identifier: GPL-3.0-or-later
"""A render in the making, seen from Blender's side: from a filled SceneBuilder to pixels, on threads of its own.

What follows the export touches numpy alone, no Blender data. So the thread that Blender called stays free to ask
whether the artist pressed Esc, and to show tiles, while trees are built and kernels are compiled.
"""

import enum
import threading
import time

from . import compile_cache
from .core import FilterKind, IntegratorKind, Render, Settings


class Phase(enum.Enum):
    BUILDING = "Building the scene"
    COMPILING = "Compiling kernels, once for this version"
    LOADING = "Loading kernels"
    RENDERING = "Rendering"
    ENDED = "Finished"


def settings_from(b_scene, crop, overrides=None):
    """engine_core's Settings from `scene.lambent` and Blender's own properties. `crop` says what part is rendered."""
    ours = b_scene.lambent
    settings = Settings(
        width=crop.frame_width,
        height=crop.frame_height,
        crop_x=crop.x,
        crop_y=crop.y,
        crop_width=crop.width,
        crop_height=crop.height,
        samples=ours.samples,
        seed=ours.seed + (b_scene.frame_current if ours.use_animated_seed else 0),
        integrator=int(IntegratorKind[ours.integrator]),
        max_bounces=ours.max_bounces,
        diffuse_bounces=ours.diffuse_bounces,
        glossy_bounces=ours.glossy_bounces,
        transmission_bounces=ours.transmission_bounces,
        transparent_bounces=ours.transparent_max_bounces,
        min_bounces=ours.min_bounces,
        reflective_caustics=int(ours.caustics_reflective),
        refractive_caustics=int(ours.caustics_refractive),
        clamp_direct=ours.clamp_direct,
        clamp_indirect=ours.clamp_indirect,
        filter_kind=int(FilterKind[ours.filter_type]),
        filter_width=ours.filter_width,
        transparent_background=int(b_scene.render.film_transparent),
        exposure=ours.exposure,
    )
    return settings._replace(**(overrides or {}))


class Session:
    """Builds the scene and renders it. All methods return at once, but `wait`."""

    def __init__(self, builder, settings, threads=0, time_limit=0.0):
        self.settings = settings
        self.warnings = builder.warnings
        self.render = None  # engine_core's Render, once the scene is built
        self.first_tile_s = None  # when the first tile was done; kernels are there from then on
        self._builder, self._threads, self._time_limit = builder, threads, time_limit
        self._is_cold = not compile_cache.is_warm(settings.integrator)
        self._cancelled, self._error = threading.Event(), None
        self._began = time.perf_counter()
        self._thread = threading.Thread(target=self._build, name="lambent build", daemon=True)

    def start(self):
        self._thread.start()

    def cancel(self):
        self._cancelled.set()
        if self.render is not None:
            self.render.cancel()

    def wait(self, timeout_s=None):
        """Wait for the end. Raises what a thread raised. With a timeout: give up after it."""
        self._thread.join(timeout_s)
        if self._error is not None:
            raise self._error
        if self.render is None:
            return
        if timeout_s is None:
            self.render.wait()
        deadline = time.perf_counter() + (timeout_s or 0.0)
        while self.render.is_running and time.perf_counter() < deadline:
            time.sleep(0.002)

    def _build(self):
        try:
            scene = self._builder.build()
            self._builder = None  # the meshes as Blender had them: not needed any more
            if not self._cancelled.is_set():
                render = Render(scene, self.settings, self._threads, self._time_limit)
                render.start()
                self.render = render
                if self._cancelled.is_set():  # between the two lines above
                    render.cancel()
        except BaseException as error:  # a thread has nobody to raise to: `wait` does it
            self._error = error

    def finished_tiles(self, timeout_s):
        """As Render.finished_tiles; before there is a Render, it waits for that."""
        if self.render is None:
            self._thread.join(timeout_s)
            return []
        tiles = self.render.finished_tiles(timeout_s)
        if tiles and self.first_tile_s is None:
            self.first_tile_s = self.elapsed_s
            if self._is_cold:
                compile_cache.mark_warm(self.settings.integrator)
        return tiles

    # ---- How far it is ----

    @property
    def is_running(self):
        return self._thread.is_alive() or (self.render is not None and self.render.is_running)

    @property
    def phase(self):
        if not self.is_running:
            return Phase.ENDED
        if self.first_tile_s is not None:
            return Phase.RENDERING
        if self._is_cold:  # builders are compiled too
            return Phase.COMPILING
        return Phase.BUILDING if self.render is None else Phase.LOADING

    @property
    def elapsed_s(self):
        return time.perf_counter() - self._began

    @property
    def progress(self):
        return 0.0 if self.render is None else self.render.progress

    @property
    def remaining_s(self):
        """Seconds to go at the speed since the first tile; None while that is anyone's guess."""
        if self.first_tile_s is None or self.progress <= 0.0 or (spent := self.elapsed_s - self.first_tile_s) < 0.2:
            return None
        return spent * (1.0 - self.progress) / self.progress

    @property
    def memory_mib(self):
        """Size of scene and film."""
        if self.render is None:
            return 0.0
        tables = [*self.render.scene.tables().values(), *self.render.film.tables().values()]
        return sum(table.nbytes for table in tables) / 2**20
