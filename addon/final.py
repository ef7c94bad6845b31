# SPDX-License-Identifier: GPL-3.0-or-later
"""The final render of one view layer: read the scene, render it, show tiles as they come, stop when asked.

With a window Blender calls this in a thread of its own, so nothing here writes to Blender's data; all that the render
needs is read before it begins.
"""

import time

import bpy

from .core import status
from .export import export_scene
from .export.report import Report
from .messages import tell_warnings
from .result import Result, crop_of, missing_passes
from .session import Phase, Session, settings_from

POLL_S = 0.04  # how long Esc may go unnoticed
REFRESH_S = 0.1  # between two looks at new tiles ...
REFRESH_SHARE = 0.25  # ... which may take this share of the thread's time
GIVE_UP_S = 0.05  # for showing the last tiles of a cancelled render
STATUS_S = 0.2  # between two lines of status ...
STATUS_BACKGROUND_S = 2.0  # ... each of which is a line in the log without a window


def render_view_layer(engine, depsgraph):
    """Render the view layer of `depsgraph`, in all its views. Raises what is wrong; a cancelled render is not wrong."""
    b_render = depsgraph.scene_eval.render
    layer = depsgraph.view_layer.name
    crop = crop_of(engine, b_render)
    views = [view.name for view in b_render.views if view.use] if b_render.use_multiview else [""]
    missing = missing_passes(depsgraph.view_layer)
    report = Report()
    if missing:
        report.warn(layer, f"passes that are not there yet stay empty: {', '.join(missing)}")
    for number, view in enumerate(views):
        if view:
            engine.active_view_set(view)
        session = _export(engine, depsgraph, report, crop)
        tell_warnings(engine, report.warnings)
        if number == len(views) - 1:
            engine.free_blender_memory()  # the depsgraph is gone from here on
        result = Result(engine, layer, view, crop)
        if session is None or not _run(engine, session, result):
            result.ensure()
            return


def _export(engine, depsgraph, report, crop):
    """A Session with all that it needs of Blender's data; None when cancelled."""
    engine.update_stats("", "Reading the scene")
    b_scene = depsgraph.scene_eval
    builder, overrides = export_scene(depsgraph, report, crop.frame_width, crop.frame_height, engine)
    if engine.test_break():
        return None
    settings = settings_from(b_scene, crop, overrides)
    return Session(builder, settings, b_scene.render.threads, b_scene.lambent.time_limit)


def _run(engine, session, result):
    """Render and show; False when cancelled."""
    screen, line = Screen(result), Status(engine)
    cancelled = False
    session.start()
    try:
        while session.is_running and not (cancelled := engine.test_break()):
            line.tell(session)
            screen.add(session.finished_tiles(POLL_S))
            if is_watched():
                screen.refresh(session.render)
    except BaseException:
        session.cancel()  # nobody else would stop the threads
        raise
    if cancelled:
        session.cancel()
    session.wait(POLL_S if cancelled else None)
    screen.add(session.finished_tiles(0.0))  # a small picture is finished before the first look
    tell_warnings(engine, session.warnings)
    if cancelled:
        screen.give_up(session.render)
    else:
        result.write(session.render)
        result.stamp(status.metadata(session.render))
    line.tell(session, now=True)
    return not cancelled


def is_watched():
    """Whether somebody sees tiles before the picture is finished."""
    return not bpy.app.background


class Screen:
    """Tiles on their way to the image editor; no more often than is good for the render."""

    def __init__(self, result):
        self._result, self._tiles, self._due = result, {}, 0.0

    def add(self, tiles):
        self._tiles.update(dict.fromkeys(tiles))  # a tile that was done again meanwhile is shown once

    def refresh(self, render):
        began = time.perf_counter()
        if self._tiles and began >= self._due:
            self._show(render)
            ended = time.perf_counter()
            self._due = ended + max(REFRESH_S, (ended - began) * (1.0 - REFRESH_SHARE) / REFRESH_SHARE)

    def give_up(self, render):
        """Show what there is, without holding up who wants to stop."""
        if render is not None:
            self._show(render, deadline=time.perf_counter() + GIVE_UP_S)

    def _show(self, render, deadline=float("inf")):
        while self._tiles and time.perf_counter() < deadline:
            tile, _ = self._tiles.popitem()
            self._result.write(render, tile)


class Status:
    """The line above the picture, or in the log."""

    def __init__(self, engine):
        self._engine, self._due, self._phase = engine, 0.0, None

    def tell(self, session, now=False):
        clock = time.perf_counter()
        if not now and clock < self._due and session.phase == self._phase:
            return
        self._phase = session.phase
        self._due = clock + (STATUS_S if is_watched() else STATUS_BACKGROUND_S)
        self._engine.update_progress(session.progress)
        self._engine.update_memory_stats(memory_used=session.memory_mib, memory_peak=session.memory_mib)
        self._engine.update_stats("", status_text(session))


def status_text(session):
    """For example: Sample 16/128, noise 4.1 % | Elapsed 00:03.20 | Remaining 00:21.64"""
    parts = [session.phase.value]
    if session.first_tile_s is not None:
        parts = [status.text(session.render)]
    parts.append(f"Elapsed {clock_text(session.elapsed_s)}")
    if session.phase == Phase.RENDERING and (remaining := session.remaining_s) is not None:
        parts.append(f"Remaining {clock_text(remaining)}")
    return " | ".join(parts)


def clock_text(seconds):
    """As Blender writes times: 01:02.30, or 2:01:02 from an hour on."""
    minutes, rest = divmod(seconds, 60.0)
    if minutes < 60:
        return f"{int(minutes):02}:{rest:05.2f}"
    hours, minutes = divmod(int(minutes), 60)
    return f"{hours}:{minutes:02}:{int(rest):02}"
