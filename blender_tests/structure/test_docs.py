# SPDX-License-Identifier: GPL-3.0-or-later
"""What documents point to is there."""

import re

import pytest
from sources import ROOT

from blender_tests.bench.gallery_worlds import WORLDS

DOCUMENTS = [ROOT / "README.md", ROOT / "ARCHITECTURE.md", *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_and_pictures_lead_to_files(document):
    targets = re.findall(r"\]\(([^)#]+)\)", document.read_text(encoding="utf-8"))

    assert [t for t in targets if "://" not in t and not (document.parent / t).exists()] == []


def test_every_figure_is_in_the_page_of_figures():
    shown = re.findall(r"figures/(\w+\.png)", (ROOT / "docs" / "figures.md").read_text(encoding="utf-8"))

    assert sorted(shown) == sorted(path.name for path in (ROOT / "docs" / "figures").iterdir())


def test_every_world_is_in_the_gallery_with_all_its_pictures():
    gallery = ROOT / "docs" / "gallery"
    text = (gallery / "README.md").read_text(encoding="utf-8")

    assert sorted(re.findall(r"\]\((\w+\.png)\)", text)) == sorted(path.name for path in gallery.glob("*.png"))
    assert [world.stem for world in WORLDS if f"({world.stem}_cycles.png)" not in text] == []
    assert [world.title for world in WORLDS if f"### {world.title}\n" not in text] == []
    assert sum(path.stat().st_size for path in gallery.iterdir()) < 6e6


def test_every_world_has_a_small_file():
    scenes = ROOT / "scenes_blend"

    assert [world.scene for world in WORLDS if (scenes / f"{world.scene}.blend").stat().st_size > 300e3] == []
    assert sum(path.stat().st_size for path in scenes.glob("*.blend")) < 3e6
