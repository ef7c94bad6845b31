# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered viewport: a picture that starts coarse and goes on improving until something changes.

Blender calls `update` when the scene changed and `draw` for each redraw; both on the main thread, and neither waits for
a render. A thread in between (`Work`) knows numpy alone. A timer on the main thread asks for a redraw when there is
news, and notices when Blender has thrown the engine away: that may happen at any time, and is told to nobody.
"""

import threading
from typing import NamedTuple

import bpy
import numpy as np

from . import compile_cache
from .core import Render, Scene, SceneBuilder, status
from .export.camera import lens
from .export.context import Context
from .export.instances import export_instances
from .export.report import Report
from .export.world import export_world
from .result import Crop
from .session import Phase, settings_from

COARSE = 4  # the first picture has so many times fewer columns and rows
REFRESH_S = 0.1  # between two pictures
TICK_S = 0.05
JOIN_S = 0.3  # how long the end of a view may take
LARGEST_HALF = 65504.0  # the texture has half floats

_viewports = set()


class View(NamedTuple):
    """What a 3D view shows, as numbers that can be compared."""

    width: int
    height: int
    to_world: tuple  # 16 numbers, row by row
    screen: tuple  # left, right, bottom, top, as SceneBuilder.camera has it
    kind: str
    clip_start: float
    clip_end: float
    lens: tuple  # items of the options of SceneBuilder.camera


def view_of(region, region_data, b_camera, pixel_size):
    """Read a 3D view. `b_camera`: the evaluated camera object that it looks through, or None."""
    to_world = np.linalg.inv(np.array(region_data.view_matrix, np.float64))
    projection = np.array(region_data.window_matrix, np.float64)
    size = max(region.width // pixel_size, 1), max(region.height // pixel_size, 1)
    (xx, _, xz, xw), (_, yy, yz, yw), (_, _, zz, zw), _ = projection
    if region_data.is_perspective:
        screen = ((xz - 1) / xx, (xz + 1) / xx, (yz - 1) / yy, (yz + 1) / yy)
        kind, clip_start, clip_end = "PERSPECTIVE", zw / (zz - 1), zw / (zz + 1)
    else:
        screen = ((-1 - xw) / xx, (1 - xw) / xx, (-1 - yw) / yy, (1 - yw) / yy)
        near, far = (zw + 1) / zz, (zw - 1) / zz
        to_world[:3, 3] -= near * to_world[:3, 2]  # the view has its eye in the middle of what it shows
        kind, clip_start, clip_end = "ORTHOGRAPHIC", 0.0, far - near
    options = lens(b_camera.data, to_world) if b_camera else {}
    return View(*size, tuple(to_world.ravel()), screen, kind, clip_start, clip_end, tuple(options.items()))


class Build:
    """Makes a Scene on a thread. That cannot be interrupted, so it is done once for all views of the scene."""

    def __init__(self, builder):
        self.scene = self.error = None
        self._builder = builder
        self._done = threading.Event()
        threading.Thread(target=self._run, name="lambent viewport build", daemon=True).start()

    def wait(self, cancelled):
        """The Scene, or None if `cancelled` (an event) is set first. Raises what went wrong."""
        while not self._done.wait(TICK_S):
            if cancelled.is_set():
                return None
        if self.error is not None:
            raise self.error
        return self.scene

    def _run(self):
        try:
            self.scene = self._builder.build()
        except Exception as error:
            self.error = error
        self._done.set()


class Work:
    """Renders one view of a scene on a thread, first coarsely. Touches no data of Blender."""

    def __init__(self, build, view, settings, threads):
        self.picture = None  # float32 (h, w, 4); the newest
        self.is_new = True  # whether there is news to draw
        self.text = (Phase.BUILDING if compile_cache.are_compiled(settings.integrator) else Phase.COMPILING).value
        self._build, self._view, self._settings, self._threads = build, view, settings, threads
        self._cancelled = threading.Event()
        self.thread = threading.Thread(target=self._run, name="lambent viewport", daemon=True)
        self.thread.start()

    def cancel(self):
        """End soon; returns at once."""
        self._cancelled.set()

    def _run(self):
        try:
            scene = self._build.wait(self._cancelled)
            if scene is not None and compile_cache.prepare(self._settings.integrator, self._cancelled):
                scene = with_camera(scene, self._view)
                coarse_size = max(self._view.width // COARSE, 1), max(self._view.height // COARSE, 1)
                self._render(scene, coarse_size, 1)
                self._render(scene, (self._view.width, self._view.height), self._settings.samples)
        except Exception as error:  # shown in the view
            self.text = f"{type(error).__name__}: {error}"
            self.is_new = True

    def _render(self, scene, size, samples):
        """Put pictures out, from the first whole one to the last."""
        width, height = size
        settings = self._settings._replace(
            width=width, height=height, crop_x=0, crop_y=0, crop_width=width, crop_height=height, samples=samples
        )
        if self._cancelled.is_set():
            return
        render = Render(scene, settings, self._threads)
        render.start()
        while render.is_running and not self._cancelled.is_set():
            if render.finished_tiles(TICK_S) and render.samples_done:
                self._put_out(render)
                self._cancelled.wait(REFRESH_S)
        if self._cancelled.is_set():
            render.cancel()
            return
        render.wait()
        self._put_out(render)

    def _put_out(self, render):
        self.picture = np.clip(render.image("Combined"), -LARGEST_HALF, LARGEST_HALF)
        self.text = status.text(render)
        self.is_new = True


def with_camera(scene, view):
    """The same tables, seen from elsewhere."""
    builder = SceneBuilder()
    builder.camera(
        np.reshape(view.to_world, (4, 4)),
        view.screen,
        view.kind,
        clip_start=view.clip_start,
        clip_end=view.clip_end,
        **dict(view.lens),
    )
    return Scene(**{**scene.tables(), "camera": builder.camera_row})


class Viewport:
    """One 3D view with its engine."""

    def __init__(self, engine):
        self._engine, self._build, self._work, self._texture = engine, None, None, None
        self._settings, self._view, self._threads = None, None, 0
        self._visible, self._is_paused = None, False
        _viewports.add(self)
        # persistent, or it would not see that another file was opened
        bpy.app.timers.register(self._tick, first_interval=TICK_S, persistent=True)

    def update(self, context, depsgraph):
        """Something in the scene changed: read it again."""
        visible, before = visible_objects(depsgraph), self._visible
        self._visible = visible
        if visible == before and not any(has_consequences(update) for update in depsgraph.updates):
            return
        builder = SceneBuilder()
        export = Context(depsgraph, Report(), builder, context.region.width, context.region.height)
        export_world(export)
        export_instances(export)
        builder.camera(np.eye(4), (-1, 1, -1, 1))  # a scene has one; each view takes its own
        self._build = Build(builder)
        self._settings, self._view = self._settings_of(depsgraph), self._view_of(context, depsgraph)
        self._threads = depsgraph.scene.render.threads
        self._restart()

    def draw(self, context, depsgraph):
        """Draw the newest picture; begin anew where the view or the settings changed meanwhile."""
        now = self._settings_of(depsgraph), self._view_of(context, depsgraph)
        if now != (self._settings, self._view):
            self._settings, self._view = now
            self._restart()
        work = self._work
        if work and work.is_new:
            work.is_new = False
            if work.picture is not None:
                self._texture = make_texture(work.picture)
            self._engine.update_stats("", work.text)
        if self._texture:
            draw_texture(self._engine, depsgraph.scene, self._texture, context.region)

    @property
    def text(self):
        """How far it is."""
        return self._work.text if self._work else "Paused"

    def close(self):
        """End soon; returns the thread that is about to end, or None."""
        _viewports.discard(self)
        self._is_paused = True
        work = self._work
        self._restart()
        return work.thread if work else None

    def _restart(self):
        if self._work:
            self._work.cancel()
            self._work = None
        if self._build and not self._is_paused:
            self._work = Work(self._build, self._view, self._settings, self._threads)

    def _settings_of(self, depsgraph):
        crop = Crop(0, 0, 1, 1, 1, 1)  # the size is that of the view
        b_scene = depsgraph.scene_eval
        return settings_from(b_scene, crop)._replace(samples=b_scene.lambent.viewport_samples)

    def _view_of(self, context, depsgraph):
        region_data, b_camera = context.region_data, None
        if region_data.view_perspective == "CAMERA":
            b_camera = context.space_data.camera or depsgraph.scene.camera
        if b_camera is not None:
            b_camera = b_camera.evaluated_get(depsgraph) if b_camera.type == "CAMERA" else None
        return view_of(context.region, region_data, b_camera, self._engine.get_preview_pixel_size(depsgraph.scene))

    def _tick(self):
        """Every now and then, on the main thread."""
        try:
            if self not in _viewports:
                return None
            is_final = bpy.app.is_job_running("RENDER")  # leaves the processors to it
            if is_final != self._is_paused:
                self._is_paused = is_final
                self._restart()
            if self._work and self._work.is_new:
                self._engine.tag_redraw()
            self._engine.as_pointer()  # is it still there?
            return TICK_S
        except ReferenceError:  # Blender has freed the engine
            self.close()
            return None


def visible_objects(depsgraph):
    """Which objects are there to be seen. Hiding one is no update that differs from selecting it."""
    return [instance.object.as_pointer() for instance in depsgraph.object_instances if instance.show_self]


def has_consequences(update):
    """Whether a picture may look different after a depsgraph update; after selecting an object it does not."""
    return update.is_updated_geometry or update.is_updated_transform or update.is_updated_shading


def make_texture(picture):
    import gpu  # only with a window: it fails, or worse, without

    height, width, _ = picture.shape
    buffer = gpu.types.Buffer("FLOAT", picture.size, picture.ravel())
    return gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)


def draw_texture(engine, b_scene, texture, region):
    """Scene-linear pixels onto the screen; Blender's view transform is applied to all that the view draws."""
    import gpu
    from gpu_extras.presets import draw_texture_2d

    gpu.state.blend_set("ALPHA_PREMULT")
    engine.bind_display_space_shader(b_scene)
    draw_texture_2d(texture, (0, 0), region.width, region.height)
    engine.unbind_display_space_shader()
    gpu.state.blend_set("NONE")


def close_all():
    """End all views' renders, and wait a moment for their threads."""
    threads = [viewport.close() for viewport in list(_viewports)]
    for thread in filter(None, threads):
        thread.join(JOIN_S)
