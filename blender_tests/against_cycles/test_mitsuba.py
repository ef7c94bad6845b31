# SPDX-License-Identifier: GPL-3.0-or-later
"""Our scenes in Mitsuba 3: the translation that the benchmark compares itself with shows the same picture."""

import numpy as np
import pytest

from blender_tests.bench.mitsuba_scene import MitsubaScene, NotExpressibleError
from blender_tests.bench.noise import FOLDER, builder_of, open_scene
from blender_tests.helpers.engines import render

PIXELS, SAMPLES, SEEDS = 48 * 48, 64, 8


@pytest.mark.parametrize("name", ["cornell_box", "cornell_mirror", "random_spheres"])
def test_a_scene_is_as_bright_in_mitsuba(name):
    """The means of independent pictures differ by no more than noise, and than what another pixel filter lets in from
    outside of the picture. (The lamps alone are half of a mean.)"""
    scene = open_scene(FOLDER / f"{name}.blend", PIXELS)
    size = scene.render.resolution_x, scene.render.resolution_y
    mitsuba = MitsubaScene(builder_of(scene), size, scene.lambent.max_bounces, "scalar_rgb")
    ours = np.array([render("LAMBENT", scene, SAMPLES, seed).picture[..., :3].mean() for seed in range(SEEDS)])
    theirs = np.array([mitsuba.render(SAMPLES, seed).mean() for seed in range(SEEDS)])

    error = np.sqrt(sum(means.var(ddof=1) / SEEDS for means in (ours, theirs)))
    assert error < 0.005 * theirs.mean()
    assert abs(ours.mean() - theirs.mean()) < 3.5 * error + 0.002 * theirs.mean()


def test_what_mitsuba_has_not_is_named():
    scene = open_scene(FOLDER / "instances.blend", PIXELS)

    with pytest.raises(NotExpressibleError, match="lobes"):
        MitsubaScene(builder_of(scene), (48, 48), 12, "scalar_rgb")
