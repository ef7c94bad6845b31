# SPDX-License-Identifier: GPL-3.0-or-later
"""What documents point to is there."""

import re

import pytest
from sources import ROOT

DOCUMENTS = [ROOT / "README.md", ROOT / "ARCHITECTURE.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_and_pictures_lead_to_files(document):
    targets = re.findall(r"\]\(([^)#]+)\)", document.read_text(encoding="utf-8"))

    assert [t for t in targets if "://" not in t and not (document.parent / t).exists()] == []


def test_every_figure_is_in_the_page_of_figures():
    shown = re.findall(r"figures/(\w+\.png)", (ROOT / "docs" / "figures.md").read_text(encoding="utf-8"))

    assert sorted(shown) == sorted(path.name for path in (ROOT / "docs" / "figures").iterdir())
