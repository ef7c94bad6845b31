# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered viewport without a window: what it would draw, and when."""

import threading
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from blender_tests.helpers.small_blend import small_scene

SIZE, TIMEOUT_S = (40, 24), 800.0  # the first picture may have to wait for the compiler


class Engine:
    """What a viewport asks of the RenderEngine that it belongs to."""

    def get_preview_pixel_size(self, b_scene):
        return 1

    def update_stats(self, stats, text):
        self.text = text

    def tag_redraw(self):
        pass

    def as_pointer(self):
        return 1


class Screen:
    """A 3D view that looks through the scene's camera. A redraw gives the picture that is to be seen then, or None."""

    def __init__(self, monkeypatch):
        from addon import viewport

        monkeypatch.setattr(viewport, "make_texture", lambda picture: SimpleNamespace(picture=picture))
        monkeypatch.setattr(viewport, "draw_texture", self._see)
        self.b_scene = small_scene(size=SIZE)
        self.depsgraph = bpy.context.evaluated_depsgraph_get()
        b_camera = self.b_scene.camera.evaluated_get(self.depsgraph)
        projection = b_camera.calc_matrix_camera(self.depsgraph, x=SIZE[0], y=SIZE[1])
        region_data = SimpleNamespace(
            view_matrix=b_camera.matrix_world.inverted(),
            window_matrix=projection,
            is_perspective=True,
            view_perspective="PERSP",
        )
        self.context = SimpleNamespace(
            region=SimpleNamespace(width=SIZE[0], height=SIZE[1]),
            region_data=region_data,
            space_data=SimpleNamespace(camera=None),
        )
        self.viewport = viewport.Viewport(Engine())

    def _see(self, engine, b_scene, texture, region):
        self.seen = texture.picture

    def redraw(self):
        self.seen = None
        self.viewport.draw(self.context, self.depsgraph)
        return self.seen

    def finish(self):
        """Redraw when all that is under way has been rendered."""
        self.viewport._work.thread.join(TIMEOUT_S)
        assert not self.viewport._work.thread.is_alive()
        return self.redraw()


@pytest.fixture
def screen(registered, monkeypatch):
    screen = Screen(monkeypatch)
    screen.viewport.update(screen.context, screen.depsgraph)
    yield screen
    screen.viewport.close()


def turn_the_view(screen):
    screen.context.region_data.view_matrix = screen.context.region_data.view_matrix @ Matrix.Rotation(0.3, 4, "Z")


def hide_the_ball(screen):
    bpy.data.objects["Ball"].hide_viewport = True
    bpy.context.view_layer.update()
    screen.viewport.update(screen.context, screen.depsgraph)


@pytest.mark.parametrize("change", [turn_the_view, hide_the_ball])
def test_the_earlier_picture_is_seen_until_there_is_another(screen, monkeypatch, change):
    from addon.viewport import compile_cache

    earlier = screen.finish()
    assert earlier.shape == (SIZE[1], SIZE[0], 4)
    assert earlier[..., :3].mean() > 0.01

    may_begin, prepare = threading.Event(), compile_cache.prepare
    monkeypatch.setattr(compile_cache, "prepare", lambda *options: may_begin.wait(TIMEOUT_S) and prepare(*options))
    change(screen)
    for _ in range(3):
        np.testing.assert_array_equal(screen.redraw(), earlier)
    may_begin.set()
    later = screen.finish()
    assert later.shape == earlier.shape
    assert np.abs(later - earlier).mean() > 0.01


def test_a_coarse_picture_comes_first(screen, monkeypatch):
    from addon.viewport import Work

    put_out, sizes = Work._put_out, []

    def noted(work, render):
        put_out(work, render)
        sizes.append(work.picture.shape)

    monkeypatch.setattr(Work, "_put_out", noted)
    turn_the_view(screen)
    screen.redraw()
    screen.finish()
    coarse, full = (SIZE[1] // 4, SIZE[0] // 4, 4), (SIZE[1], SIZE[0], 4)
    assert sizes[0] == coarse
    assert sizes[-1] == full
    assert sizes == sorted(sizes)
