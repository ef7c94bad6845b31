# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/nodes.md says of every shader node of Blender what becomes of it."""

import bpy
import pytest

from blender_tests.against_cycles import node_states, table

pytestmark = pytest.mark.skipif(bpy.app.version < (5, 2), reason="the page is about the nodes of Blender 5.2")


def states(text):
    """{label: state} of the page's table."""
    rows = [line.split("|")[1:3] for line in text.splitlines() if line.startswith("| ")]
    return {label.strip(): state.strip() for label, state in rows}


def test_every_shader_node_of_blender_is_on_the_page():
    assert states(node_states.text()).keys() == states(node_states.TARGET.read_text(encoding="utf-8")).keys()


def test_what_the_page_says_is_rendered_is_translated():
    now, told = (states(text) for text in (node_states.text(), node_states.TARGET.read_text(encoding="utf-8")))
    assert [label for label, state in told.items() if state != "stand-in" and now[label] == "stand-in"] == []


def test_every_node_that_gives_values_is_compared_with_cycles():
    text = table.TARGET.read_text(encoding="utf-8").split("## From the node to the pixel")[1].split("\n## ")[0]
    assert node_states.giving_values() == states(text).keys() - {"node"}


def test_notes_are_about_nodes_that_there_are():
    assert node_states.PARTLY.keys() <= {kind for kind, _ in node_states.node_classes()}
