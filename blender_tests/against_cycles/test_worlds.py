# SPDX-License-Identifier: GPL-3.0-or-later
"""The worlds of the gallery in both engines, as small as they can be told apart: what differs is noise."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import ttest_ind

from blender_tests.bench.gallery_worlds import WORLDS
from blender_tests.helpers.cycles import cycles_picture
from blender_tests.helpers.engines import open_for_both, render_with

SCENES = Path(__file__).parents[2] / "scenes_blend"
SIZE, BLOCK, SEEDS, SAMPLES = (40, 24), 4, 5, 64
ELSEWHERE = {"cornell_box", "three_spheres"}  # test_scenes.py has them


def blocks(picture):
    """Means over blocks of 4 x 4 pixels and the three colours, (6, 10)."""
    height, width = picture.shape[:2]
    return picture[..., :3].reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).mean(axis=(1, 3, 4))


@pytest.mark.parametrize("name", sorted({world.scene for world in WORLDS} - ELSEWHERE))
def test_a_world_is_the_same_in_both_engines(name):
    """Means of the whole pictures are within 5 standard deviations of 2 % at most, blocks agree by Welch's t-test."""
    path = SCENES / f"{name}.blend"
    theirs = np.array([blocks(cycles_picture(path, SAMPLES, SIZE, seed)) for seed in range(SEEDS)], float)
    scene = open_for_both(path, SIZE)
    ours = np.array([blocks(render_with("LAMBENT", scene, SAMPLES, seed)[0]) for seed in range(SEEDS)], float)

    level = theirs.mean()
    variance = (ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / SEEDS
    error = np.sqrt(variance.sum()) / variance.size  # blocks are independent of each other
    assert error < 0.02 * level
    assert abs(ours.mean() - level) < 5.0 * error + 1e-4 * level
    noisy = np.sqrt(variance) > 1e-4 * level
    p = ttest_ind(ours, theirs, equal_var=False).pvalue[noisy]
    assert (p < 0.01).mean() < 0.1  # chance gives 0.01, give or take 0.013 for 60 blocks
    assert p.min(initial=1.0) > 1e-4 / len(noisy.ravel())
    np.testing.assert_allclose(ours.mean(axis=0)[~noisy], theirs.mean(axis=0)[~noisy], rtol=1e-3, atol=5e-4 * level)
