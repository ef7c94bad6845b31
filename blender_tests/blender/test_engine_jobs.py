# SPDX-License-Identifier: GPL-3.0-or-later
"""A render as a job: animations, failures that leave no file, cancelling, and what is said meanwhile."""

import threading
import time

import bpy
import numpy as np
import pytest

from blender_tests.helpers.exr import read_rgba
from blender_tests.helpers.small_blend import render, save_as_exr


@pytest.fixture
def sessions(monkeypatch):
    """The sessions that renders start."""
    from addon import final

    started = []

    class RecordedSession(final.Session):
        def start(self):
            started.append(self)
            super().start()

    monkeypatch.setattr(final, "Session", RecordedSession)
    return started


def replace_method(monkeypatch, name, function):
    """Let final renders see `function(engine, ...)` in place of a method that the engine has from Blender.

    A class attribute would not do: Blender's own methods come before those of Python.
    """
    from addon import final

    class Engine:
        def __init__(self, engine):
            self.engine = engine
            setattr(self, name, lambda *arguments, **options: function(engine, *arguments, **options))

        def __getattr__(self, other):
            return getattr(self.engine, other)

    render_view_layer = final.render_view_layer
    monkeypatch.setattr(final, "render_view_layer", lambda engine, graph: render_view_layer(Engine(engine), graph))


# ---- Animations ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("persistent", [False, True])
def test_an_animation_is_a_file_for_each_frame(scene, tmp_path, persistent):
    ball = bpy.data.objects["Ball"]
    for frame, x in ((1, -2), (5, 2)):
        ball.location.x = x
        ball.keyframe_insert("location", index=0, frame=frame)
    scene.frame_start, scene.frame_end, scene.frame_step = 1, 5, 2
    scene.render.use_persistent_data = persistent
    save_as_exr(scene, tmp_path / "frame_")

    bpy.ops.render.render(animation=True)

    files = sorted(path.name for path in tmp_path.iterdir())
    assert files == ["frame_0001.exr", "frame_0003.exr", "frame_0005.exr"]
    brightness = [read_rgba(tmp_path / name)[10:22, :, :3].mean(axis=(0, 2)) for name in files]
    centres = [np.average(np.arange(48), weights=np.maximum(row - 0.3, 0)) for row in brightness]
    assert centres[0] < centres[1] - 2 < centres[2] - 4


def test_settings_can_be_animated(scene, tmp_path):
    for frame, samples in ((1, 1), (2, 3)):
        scene.lambent.samples = samples
        scene.lambent.keyframe_insert("samples", frame=frame)
    scene.view_layers[0].lambent.use_pass_sample_count = True
    for frame, samples in ((1, 1), (2, 3)):
        scene.frame_set(frame)
        channels = render(tmp_path / "picture.exr", layers=True)
        count = next(channels[name] for name in channels if name.endswith("Debug Sample Count.X"))
        assert (count == samples).all()


# ---- Failures --------------------------------------------------------------------------------------------------------


def expect_failure(scene, path, message, **options):
    save_as_exr(scene, path)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.render.render(write_still=True, **options)
    assert list(path.parent.iterdir()) == []


def test_no_camera(scene, tmp_path):
    scene.camera = None
    expect_failure(scene, tmp_path / "picture.exr", "no camera")


@pytest.mark.parametrize("options", [{}, {"animation": True}])
def test_a_fault_in_the_scene_is_told_with_its_culprit(scene, tmp_path, capfd, options):
    scene.camera = bpy.data.objects["Ball"]
    expect_failure(scene, tmp_path / "picture", "Lambent: Ball: is the scene's camera, but it is a mesh", **options)
    assert "Traceback" not in "".join(capfd.readouterr())  # the artist's fault, not ours


def test_a_fault_of_ours_is_told_with_its_traceback(scene, tmp_path, monkeypatch, capfd):
    from addon import final

    def broken_export(*_):
        raise ZeroDivisionError("nobody thought of this")

    monkeypatch.setattr(final, "export_scene", broken_export)
    expect_failure(scene, tmp_path / "picture.exr", "ZeroDivisionError: nobody thought of this")
    error = capfd.readouterr().err
    assert "Traceback" in error
    assert "broken_export" in error


def test_a_fault_in_a_thread_ends_the_render(scene, tmp_path, monkeypatch):
    from engine_core.integrator import tiles

    def broken_tile(*_):
        raise ArithmeticError("tile fell off")

    monkeypatch.setitem(tiles.RENDER_TILE, 2, broken_tile)
    expect_failure(scene, tmp_path / "picture.exr", "tile fell off")


def test_a_fault_while_building_ends_the_render(scene, tmp_path, monkeypatch):
    from addon.core import SceneBuilder, SceneError

    def broken_build(self):
        raise SceneError("Ball: too round")

    monkeypatch.setattr(SceneBuilder, "build", broken_build)
    expect_failure(scene, tmp_path / "picture.exr", "Ball: too round")


def test_the_next_render_after_a_failure_is_fine(scene, tmp_path):
    camera, scene.camera = scene.camera, bpy.data.objects["Ball"]
    expect_failure(scene, tmp_path / "picture.exr", "Ball")
    scene.camera = camera
    assert render(tmp_path / "picture.exr")[..., 3].min() == 1


# ---- Cancelling ------------------------------------------------------------------------------------------------------


def break_when(monkeypatch, condition):
    """From when `condition` holds, Blender tells the engine to stop. Returns a list for the time when it did so."""
    told = []

    def test_break(engine):
        if not told and condition():
            told.append(time.perf_counter())
        return bool(told)

    replace_method(monkeypatch, "test_break", test_break)
    return told


def test_cancelling_stops_in_the_middle(scene, tmp_path, sessions, monkeypatch, record_property):
    scene.lambent.samples = 1_000_000
    told = break_when(monkeypatch, lambda: sessions and sessions[0].render and sessions[0].render.samples_done > 0)

    picture = render(tmp_path / "picture.exr")
    took = time.perf_counter() - told[0]
    print(f"stopped after {1000 * took:.0f} ms, saving included")
    record_property("cancel_s", took)

    done = sessions[0].render
    assert 0 < done.samples_done < 100_000
    assert took < 5.0  # a machine may be busy; but the picture would have taken hours
    assert picture[..., 3].max() > 0  # what there was is kept
    done.wait()
    assert not done.is_running


def test_cancelling_does_not_wait_for_the_scene_to_be_built(scene, tmp_path, sessions, monkeypatch):
    from addon.core import SceneBuilder

    build = SceneBuilder.build

    def slow_build(self):
        time.sleep(3.0)
        return build(self)

    monkeypatch.setattr(SceneBuilder, "build", slow_build)
    told = break_when(monkeypatch, lambda: bool(sessions))
    render(tmp_path / "picture.exr")  # an empty one
    assert time.perf_counter() - told[0] < 2.0
    sessions[0].wait()
    assert sessions[0].render is None  # nothing was begun for nobody


def test_cancelling_ends_all_view_layers(scene, sessions, monkeypatch):
    for name in ("Second", "Third"):
        scene.view_layers.new(name)
    break_when(monkeypatch, lambda: bool(sessions))
    bpy.ops.render.render()
    assert len(sessions) == 1


def test_a_time_limit_ends_the_render(scene, tmp_path, sessions):
    scene.lambent.samples, scene.lambent.time_limit = 50_000, 0.5
    picture = render(tmp_path / "picture.exr")
    assert (picture[..., 3] == 1).all()
    assert 0 < sessions[0].render.samples_done < 50_000


# ---- What is said ----------------------------------------------------------------------------------------------------


def said(monkeypatch, name):
    """Everything that the engine tells Blender by the method `name`."""
    calls = []

    def recording(engine, *arguments, **options):
        calls.append(arguments or options)
        return getattr(engine, name)(*arguments, **options)

    replace_method(monkeypatch, name, recording)
    return calls


def test_status_tells_samples_and_time(scene, tmp_path, monkeypatch):
    from addon import final

    monkeypatch.setattr(final, "STATUS_BACKGROUND_S", 0.0)
    scene.lambent.samples = 2000
    calls = said(monkeypatch, "update_stats")
    render(tmp_path / "picture.exr")
    lines = [line for _, line in calls]
    assert lines[0] == "Reading the scene"
    assert any("Remaining" in line and "/2000, noise " in line and " % | Elapsed 00:0" in line for line in lines)
    assert lines[-1].startswith("Sample 2000/2000")


def test_progress_runs_from_nothing_to_all(scene, tmp_path, monkeypatch):
    from addon import final

    monkeypatch.setattr(final, "STATUS_BACKGROUND_S", 0.0)
    calls = said(monkeypatch, "update_progress")
    scene.lambent.samples = 2000
    render(tmp_path / "picture.exr")
    progress = [value for (value,) in calls]
    assert progress == sorted(progress)
    assert progress[0] < 0.5
    assert progress[-1] == 1.0


def test_memory_is_told(scene, tmp_path, monkeypatch):
    calls = said(monkeypatch, "update_memory_stats")
    render(tmp_path / "picture.exr")
    assert calls[-1]["memory_used"] > 48 * 32 * 64 / 2**20  # the film alone


def test_a_cold_start_says_that_it_compiles(scene, tmp_path, monkeypatch):
    from addon import final, session

    class SlowSession(final.Session):
        def _build(self):
            time.sleep(0.2)  # as compiling would take
            super()._build()

    monkeypatch.setattr(session.compile_cache, "are_compiled", lambda integrator: False)
    monkeypatch.setattr(final, "Session", SlowSession)
    monkeypatch.setattr(final, "STATUS_BACKGROUND_S", 0.0)
    calls = said(monkeypatch, "update_stats")
    render(tmp_path / "picture.exr")
    assert any(line.startswith("Compiling kernels, once") for _, line in calls)


def test_nobody_waits_for_kernels_that_are_not_wanted_any_more(registered):
    """Only one thread compiles; the others wait for it, and may stop waiting."""
    from addon import compile_cache

    results, cancelled = [], threading.Event()
    ready, compile_cache._ready = compile_cache._ready, set()
    try:
        with compile_cache._lock:  # as long as somebody compiles
            waiting = threading.Thread(target=lambda: results.append(compile_cache.prepare(2, cancelled)))
            waiting.start()
            cancelled.set()
            waiting.join(5.0)
    finally:
        compile_cache._ready = ready
    assert results == [False]


@pytest.mark.parametrize("integrator", ["PATH", "MIXTURE", "BRUTE_FORCE"])
def test_preparing_compiles_all_that_a_render_needs(scene, tmp_path, integrator):
    """No kernel is compiled a second time, for other types of arguments."""
    from addon import compile_cache
    from engine_core.integrator.render import RENDER_TILE
    from engine_core.settings import IntegratorKind

    scene.lambent.integrator = integrator
    compile_cache.prepare(int(IntegratorKind[integrator]))
    render(tmp_path / "picture.exr")
    assert len(RENDER_TILE[IntegratorKind[integrator]].signatures) == 1


def test_a_render_leaves_a_mark_that_kernels_are_compiled(scene, tmp_path):
    from addon import compile_cache

    render(tmp_path / "picture.exr")
    assert compile_cache._mark().exists()


def test_warnings_are_told_once_in_an_animation(scene, tmp_path, capfd):
    scene.view_layers[0].use_pass_mist = True
    scene.frame_end = 3
    save_as_exr(scene, tmp_path / "frame_")
    bpy.ops.render.render(animation=True)
    bpy.ops.render.render(animation=True)
    assert "".join(capfd.readouterr()).count("Mist") == 2  # once for each job


@pytest.mark.parametrize(
    ("seconds", "text"), [(0, "00:00.00"), (61.234, "01:01.23"), (3599.99, "59:59.99"), (7322, "2:02:02")]
)
def test_times_read_as_blenders(seconds, text):
    from addon.final import clock_text

    assert clock_text(seconds) == text
