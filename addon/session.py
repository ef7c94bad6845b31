# SPDX-License-Identifier: GPL-3.0-or-later
"""A render in the making, seen from Blender's side: from a filled SceneBuilder to pixels, on threads of its own.

What follows the export touches numpy alone, no Blender data. So the thread that Blender called stays free to ask
whether the artist pressed Esc, and to show tiles, while trees are built and kernels are compiled.
"""

import enum
import threading
import time

from . import compile_cache
from .core import FilterKind, IntegratorKind, Render, SamplerKind, Settings


class Phase(enum.Enum):
    LOADING = "Loading kernels"
    COMPILING = "Compiling kernels, once for this version"
    BUILDING = "Building the scene"
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
        sampler=int(SamplerKind[ours.sampler]),
        adaptive=int(ours.use_adaptive),
        guiding=int(ours.use_guiding),
        noise_target=ours.noise_target / 100.0,
        integrator=int(IntegratorKind[ours.integrator]),
        max_bounces=ours.max_bounces,
        diffuse_bounces=ours.diffuse_bounces,
        glossy_bounces=ours.glossy_bounces,
        transmission_bounces=ours.transmission_bounces,
        volume_bounces=ours.volume_bounces,
        transparent_bounces=ours.transparent_max_bounces,
        min_bounces=ours.min_bounces,
        reflective_caustics=int(ours.caustics_reflective),
        refractive_caustics=int(ours.caustics_refractive),
        clamp_direct=ours.clamp_direct,
        clamp_indirect=ours.clamp_indirect,
        filter_kind=int(FilterKind[ours.filter_type]),
        filter_width=ours.filter_width,
        share_samples=int(ours.use_shared_samples and not is_denoised(b_scene)),
        transparent_background=int(b_scene.render.film_transparent),
        exposure=ours.exposure,
    )
    return settings._replace(**(overrides or {}))


def is_denoised(b_scene):
    """Whether the picture is to be denoised: layers keep data for it, or the compositor has a node that does it."""
    if any(b_layer.lambent.use_pass_denoising_data for b_layer in b_scene.view_layers):
        return True
    if hasattr(b_scene, "compositing_node_group"):
        b_tree = b_scene.compositing_node_group
    else:  # before Blender 5
        b_tree = b_scene.node_tree if b_scene.use_nodes else None
    return b_scene.render.use_compositing and has_denoise_node(b_tree)


def has_denoise_node(b_tree):
    """Whether a Denoise node is in a tree of the compositor, or in a group of it."""
    nodes = [node for node in b_tree.nodes if not node.mute] if b_tree else []
    return any(n.type == "DENOISE" or (n.type == "GROUP" and has_denoise_node(n.node_tree)) for n in nodes)


class Session:
    """Builds the scene and renders it. All methods return at once, but `wait`."""

    def __init__(self, builder, settings, threads=0, time_limit=0.0):
        self.settings = settings
        self.warnings = builder.warnings
        self.render = None  # engine_core's Render, once the scene is built
        self.first_tile_s = None  # when the first tile was done; kernels are there from then on
        self._builder, self._threads, self._time_limit = builder, threads, time_limit
        self._phase = Phase.LOADING if compile_cache.are_compiled(settings.integrator) else Phase.COMPILING
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
        """Wait for the end, or until `timeout_s` has passed. Raises what a thread raised."""
        deadline = time.perf_counter() + (float("inf") if timeout_s is None else timeout_s)
        self._thread.join(timeout_s)
        while self.is_running and time.perf_counter() < deadline:
            time.sleep(0.002)
        if self._error is not None:
            raise self._error
        if self.render is not None and not self.render.is_running:
            self.render.wait()

    def _build(self):
        try:
            if not compile_cache.prepare(self.settings.integrator, self._cancelled):
                return
            self._phase = Phase.BUILDING
            scene = self._builder.build()
            self._builder = None  # the meshes as Blender had them: not needed any more
            if not self._cancelled.is_set():
                render = Render(scene, self.settings, self._threads, self._time_limit)
                render.start()
                self.render, self._phase = render, Phase.RENDERING
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
        return tiles

    # ---- How far it is ----

    @property
    def is_running(self):
        return self._thread.is_alive() or (self.render is not None and self.render.is_running)

    @property
    def phase(self):
        return self._phase if self.is_running else Phase.ENDED

    @property
    def elapsed_s(self):
        return time.perf_counter() - self._began

    @property
    def progress(self):
        return 0.0 if self.render is None else self.render.progress

    @property
    def remaining_s(self):
        """Seconds to go; None while that is anyone's guess."""
        return None if self.render is None else self.render.remaining_s

    @property
    def memory_mib(self):
        """Size of scene and film."""
        if self.render is None:
            return 0.0
        tables = [*self.render.scene.tables().values(), *self.render.film.tables().values()]
        return sum(table.nbytes for table in tables) / 2**20
