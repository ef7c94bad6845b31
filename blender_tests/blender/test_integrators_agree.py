# SPDX-License-Identifier: GPL-3.0-or-later
"""All scenes of scenes_blend as all integrators see them: each by its own way of finding light, and the same."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import ttest_ind

from blender_tests.helpers.engines import open_for_both
from blender_tests.helpers.exported import export
from engine_core.integrator.tiles import Render
from engine_core.settings import IntegratorKind, Settings

SCENES = {path.stem: path for path in sorted((Path(__file__).parents[2] / "scenes_blend").glob("*.blend"))}
SIZE, SAMPLES, SEEDS, BOUNCES = (32, 24), 64, 8, 6
# Their light comes from lamps so small that hardly a path of brute force ever runs into one: too few for statistics.
FOUND_BY_SAMPLING_ALONE = {"cloud", "foggy_room", "instances", "interior"}
LIMITS = {f"{kind}_bounces": BOUNCES for kind in ("max", "diffuse", "glossy", "transmission", "volume")}


@pytest.mark.parametrize("name", SCENES)
def test_the_integrators_agree(name):
    """Welch's t-test for the mean of the picture between independent pictures, whose noise is at most some percent."""
    open_for_both(SCENES[name], SIZE)
    scene = export(SIZE)[0].build()
    width, height = SIZE
    settings = Settings(width, height, crop_width=width, crop_height=height, samples=SAMPLES, adaptive=0, **LIMITS)
    kinds = set(IntegratorKind) - ({IntegratorKind.BRUTE_FORCE} if name in FOUND_BY_SAMPLING_ALONE else set())
    found = {kind: means(scene, settings._replace(integrator=kind, seed=100 * kind)) for kind in kinds}
    path = found.pop(IntegratorKind.PATH)
    for other in found.values():
        error = np.hypot(path.std(ddof=1), other.std(ddof=1)) / SEEDS**0.5
        assert error < 0.05 * path.mean()
        same = abs(path.mean() - other.mean()) < 1e-5 * path.mean()  # without noise
        assert same or ttest_ind(path, other, equal_var=False).pvalue > 1e-5


def means(scene, settings):
    """Means of SEEDS independent pictures."""
    result = []
    for seed in range(SEEDS):
        render = Render(scene, settings._replace(seed=settings.seed + seed))
        render.run()
        result.append(render.image("Combined")[..., :3].mean(dtype=np.float64))
    return np.array(result)
