# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of few materials: tilings, wires, properties of objects; pixel by pixel the same as in Cycles."""

import bpy
import numpy as np
import pytest

from blender_tests.helpers.node_sheet import add, compared, position

CASES = {}
TOLERANCE = 1e-3  # of the value, or where that is below 1 of 1
NEW = bpy.app.version >= (5, 0)


def case(name):
    def keep(build):
        CASES[name] = build
        return build

    return keep


if NEW:
    for sides, roundness in ((5, 0.0), (5, 0.4), (2, 0.0), (3, 1.0), (4.3, 0.0), (4.3, 0.35), (6.7, 1.0), (2.4, 0.6)):
        for normalize in (False, True):
            for output in ("Segment Coordinates", "Segment Width", "Segment Rotation", "Segment ID"):

                @case(f"Radial Tiling {sides} {roundness} {normalize} {output}")
                def _(tree, inputs=(sides, roundness), normalize=normalize, output=output):
                    vector = position(tree, 1.1, (0.05, 0.03, 0.0))
                    node = add(tree, "RadialTiling", {0: vector, 1: inputs[0], 2: inputs[1]}, normalize=normalize)
                    return node.outputs[output]


for in_pixels, size in ((False, 0.3), (True, 2.5)):

    @case(f"Wireframe {in_pixels}")
    def _(tree, in_pixels=in_pixels, size=size):
        return add(tree, "Wireframe", {0: size}, use_pixel_size=in_pixels).outputs[0]


for kind, name in (
    ("OBJECT", "color"),
    ("OBJECT", "location"),
    ("OBJECT", "pass_index"),
    ("OBJECT", "nothing"),
    ("INSTANCER", "color"),
    ("VIEW_LAYER", "frame_current"),
    ("VIEW_LAYER", "color"),
    ("VIEW_LAYER", "nothing"),
):
    for output in ("Color", "Vector", "Fac", "Alpha"):
        case(f"Attribute {kind} {name} {output}")(
            lambda tree, kind=kind, name=name, output=output: add(
                tree, "Attribute", attribute_type=kind, attribute_name=name
            ).outputs[output]
        )


@pytest.fixture(scope="module")
def pictures():
    return compared(CASES)


@pytest.mark.parametrize("name", CASES)
def test_a_node_gives_what_it_gives_in_cycles(pictures, name):
    ours, theirs = pictures[name]
    difference = np.abs(ours - theirs) / np.maximum(np.abs(theirs), 1.0)
    # where a function jumps, a picture has what is on either side
    assert np.quantile(difference, 0.95) <= TOLERANCE, f"{difference.max():.2g}"
