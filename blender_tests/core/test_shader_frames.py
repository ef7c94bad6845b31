# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of lobes: mirrors stay above the face, and closures with equal normals share a frame."""

import numpy as np
import pytest

from blender_tests.helpers.bsdfs import direction, lobe, make_bsdf
from engine_core.linalg.vec3 import BLACK, Vec3
from engine_core.shader import frames
from engine_core.tables import BSDF, MAX_FRAMES, LobeKind

UP = Vec3(0.0, 0.0, 1.0)


def new_bsdf(normal):
    bsdf = make_bsdf(lobe(LobeKind.DIFFUSE), lobe(LobeKind.CONDUCTOR))
    frames.begin_frames(bsdf, UP, Vec3(*normal))
    frames.complete_frames(bsdf)
    return bsdf


@pytest.mark.parametrize("tilt", [-60.0, -20.0, 20.0, 60.0, 100.0])
@pytest.mark.parametrize("angle", [10.0, 60.0, 85.0, 89.5])
@pytest.mark.parametrize("turn", [0.3, 1.7, 3.0])
def test_a_mirror_shows_what_is_above_the_face(tilt, angle, turn):
    """Its normal is raised in the plane of both normals, and no further than it takes; matt lobes keep theirs."""
    normal, wo = direction(tilt, 0.3), direction(angle, turn)
    bsdf = new_bsdf(normal)
    frames.raise_mirrors(bsdf, Vec3(*wo))
    assert bsdf.lobes[0].frame == 0
    row = bsdf.frames[bsdf.lobes[1].frame]
    axes = np.array([row.s, row.t, row.n], float)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-5)
    n = axes[2]
    height = (2.0 * n * (n @ wo) - wo)[2]
    least = min(0.9 * wo[2], 0.01)
    if (2.0 * normal * (normal @ wo) - wo)[2] >= least:
        assert bsdf.lobes[1].frame == 0
    else:
        assert height == pytest.approx(least, abs=2e-4)
        assert np.cross(normal, [0.0, 0.0, 1.0]) @ n == pytest.approx(0.0, abs=1e-5)


def test_closures_of_one_normal_share_a_frame():
    bsdf = new_bsdf(UP)
    bent, tangent = Vec3(0.6, 0.0, 0.8), Vec3(1.0, 0.0, 0.0)
    wanted = [(BLACK, BLACK), (UP, BLACK), (bent, BLACK), (BLACK, tangent), (bent, BLACK), (BLACK, tangent)]
    bsdf.frames[0].s = 0.0
    assert [frames.frame_with(bsdf, n, t) for n, t in wanted] == [0, 0, 1, 2, 1, 2]


def test_there_is_room_for_no_more_frames_than_there_are():
    bsdf = np.zeros(1, BSDF).view(np.recarray)[0]
    frames.begin_frames(bsdf, UP, UP)
    rows = [frames.frame_with(bsdf, Vec3(*direction(5.0 * i + 5.0)), BLACK) for i in range(MAX_FRAMES + 3)]
    assert rows[: MAX_FRAMES - 1] == list(range(1, MAX_FRAMES))
    assert set(rows[MAX_FRAMES - 1 :]) == {MAX_FRAMES - 1}
    assert bsdf.frame_count == MAX_FRAMES
