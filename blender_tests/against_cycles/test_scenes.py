# SPDX-License-Identifier: GPL-3.0-or-later
"""Our scenes in both engines: no pixel is further apart than their noise explains."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import ttest_ind

from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with

SCENES = Path(__file__).parents[2] / "scenes_blend"
SIZE, BLOCK, SEEDS, SAMPLES = (48, 48), 4, 16, 128


def blocks(picture):
    """Means over blocks of 4 x 4 pixels: near enough to normally distributed for a t-test."""
    height, width = picture.shape[:2]
    return picture[..., :3].reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).mean(axis=(1, 3))


@pytest.mark.parametrize("name", ["cornell_box", "three_spheres", "instances"])
def test_a_scene_is_the_same_in_both_engines(name):
    """Welch's t-test for each block and colour, between independent pictures of Lambent and of Cycles.

    Of blocks that agree, one in a hundred has p < 0.01: no more may than chance allows, and none by far. The means of
    the whole pictures differ by no more than their noise, which is within a percent.
    """
    path = SCENES / f"{name}.blend"
    theirs = np.array([blocks(cycles_picture(path, SAMPLES, SIZE, seed)) for seed in range(SEEDS)], float)
    scene = open_for_both(path, SIZE)
    ours = np.array([blocks(render_with("LAMBENT", scene, SAMPLES, seed)[0]) for seed in range(SEEDS)], float)

    means = ours.mean(axis=(1, 2, 3)), theirs.mean(axis=(1, 2, 3))
    error = np.sqrt(sum(m.var(ddof=1) / SEEDS for m in means))
    assert error < 0.01 * theirs.mean()
    assert abs(ours.mean() - theirs.mean()) < max(3.5 * error, 1e-4 * theirs.mean())
    noisy = ours.std(axis=0) + theirs.std(axis=0) > 1e-4 * theirs.mean()
    p = ttest_ind(ours, theirs, equal_var=False).pvalue[noisy]
    assert (p < 0.01).mean() < 0.025
    assert p.min() > 1e-3 / len(p)
    np.testing.assert_allclose(ours.mean(axis=0)[~noisy], theirs.mean(axis=0)[~noisy], rtol=1e-3)
