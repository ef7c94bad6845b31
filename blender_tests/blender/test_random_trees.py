# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever somebody wires up in a node editor is exported and rendered, or reported: nothing raises, nothing hangs."""

import bpy
import pytest

from blender_tests.helpers.random_trees import faults_of_tree
from blender_tests.helpers.shader_nodes import link, material_tree, node, translated


@pytest.mark.parametrize("seed", range(6))
def test_random_trees_are_rendered(seed):
    assert faults_of_tree(seed, size=40, volumes=False) == []


def test_a_lamps_output_in_a_material_counts_as_one_of_a_surface():
    """Pasted from elsewhere. It has neither a volume nor a displacement."""
    tree = material_tree()
    tree.nodes.clear()
    link(tree, node(tree, "BsdfDiffuse"), node(tree, "OutputLight"))
    closure, warnings = translated(bpy.data.materials["Material"])
    assert closure is not None
    assert warnings == []
