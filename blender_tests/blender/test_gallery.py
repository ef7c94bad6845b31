# SPDX-License-Identifier: GPL-3.0-or-later
"""The gallery: pictures of a world by both engines, and a page that shows them."""

import re

import numpy as np
from PIL import Image

from blender_tests.bench.gallery import page, render_world
from blender_tests.bench.gallery_worlds import World

WORLD = World("Figure 3", "two_diffuse_spheres", "Two spheres", integrators=("PATH",), samples=4)


def test_a_world_is_rendered_by_both_engines_and_shown_on_the_page(tmp_path):
    told = []
    measured = render_world(WORLD, tmp_path, 64, lambda fraction, text: told.append(fraction))

    assert list(measured) == ["lambent_path", "cycles", "flip"]
    assert told == sorted(told)
    assert told[0] == 0.0
    assert told[-1] <= 1.0
    pictures = {path.name: np.asarray(Image.open(path).convert("RGB"), float) for path in tmp_path.iterdir()}
    assert set(pictures) == {f"two_diffuse_spheres_4_{name}.png" for name in measured}
    assert {picture.shape for picture in pictures.values()} == {(180, 320, 3)}
    ours, theirs, difference = (pictures[f"two_diffuse_spheres_4_{name}.png"] for name in measured)
    np.testing.assert_allclose(ours.mean(axis=(0, 1)), theirs.mean(axis=(0, 1)), atol=3.0)  # of 255
    assert ours[0, 0, 2] > ours[-1, 0, 2]  # the sky is above the ground, and brighter
    assert difference.mean() < 0.5 * theirs.mean()

    text = page({WORLD.stem: measured}, [("The paper", [WORLD])])
    assert set(re.findall(r"\]\((\w+\.png)\)", text)) == set(pictures)
    assert "> Two spheres" in text
    assert "| Lambent, path | Cycles | difference |" in text
    assert text.count("4 samples, ") == 2
