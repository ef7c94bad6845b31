# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/nodes_against_cycles.md: how far each node is from Cycles in each of its modes.

    python -m blender_tests.against_cycles.table

with a Python that has bpy. What the tests hold, it shows: the cases are theirs.
"""

import os
import sys
from pathlib import Path

import bpy
import numpy as np

from blender_tests.helpers import node_sheet
from blender_tests.helpers.bsdfs import evaluate_many, lobe, make_bsdf
from blender_tests.helpers.node_sheet import compared
from blender_tests.helpers.node_values import cycles_values, differences

from . import (
    node_states,
    test_closure_means,
    test_lobes,
    test_node_math,
    test_nodes,
    test_nodes_of_instances,
    test_nodes_rare,
    test_nodes_with_rays,
    test_textures,
)

TARGET = Path(__file__).parents[2] / "docs" / "nodes_against_cycles.md"
HEAD = """# Nodes against Cycles

How far the engine's formulas for shader nodes are from Cycles of Blender {version}: the largest difference over
settings, parameters and pixels, relative where values exceed 1. Both see the same points or colours, which vary.
Closures: value times cosine, for pairs of directions. Written by `python -m blender_tests.against_cycles.table`.

| node | modes | cases | largest difference |
|---|---|---:|---:|
"""


TAIL = """
## From the node to the pixel

{count} settings of nodes, each made in Blender and rendered by both engines as what a surface emits: by how much 95 %
of the pixels differ at most. (Where a function jumps, or at outlines, the others have what is on either side.)

| node | mode | largest difference | why, where it is above 1e-3; or how it is compared |
|---|---|---:|---|
"""
MEANS = """
## Balls of closures

A ball of each closure under a sky and a sun, by both engines with {seeds} x {samples} samples a pixel: the mean over
it (and over colours), by how much ours differs, and by how many of the standard errors that the {seeds} renders
tell, where that is most.

| closure | Cycles | difference | Z |
|---|---:|---:|---:|
"""
ELSEWHERE = {  # nodes that give values, but none that a surface here shines with
    "Curves Info": "on strands of hair, by the mean of a picture (`test_hair.py`)",
    "Displacement": "by the surfaces that they move (`test_displacement.py`)",
    "IES Texture": "by what a lamp lights up (`test_lamp_nodes.py`)",
    "Shader to RGB": "Cycles does not render it",
    "Sky Texture": "all around, by direction (`test_sky.py`)",
    "Squeeze Value (Legacy)": "Cycles does not render it",
    "UV Along Stroke": "Cycles does not render it",
    "Vector Displacement": "by the surfaces that they move (`test_displacement.py`)",
    "Volume Info": "no values from grids of volumes",
}
NOISE = "noise: it is random, and these are means of 512 samples"


def main():
    found = {}  # {(node, modes): differences}
    for cases in (test_textures.CASES, test_node_math.CASES):
        for case, tile in zip(cases, cycles_values(cases), strict=True):
            modes = ", ".join(str(v) for v in case.settings.values() if isinstance(v, str))
            found.setdefault((case.kind, modes), []).append(differences(case, tile).max())
    for name, difference in differences_of_lobes().items():
        kind, settings = test_lobes.CASES[name][:2]
        found.setdefault((f"Bsdf{kind}", ", ".join(settings.values())), []).append(difference)
    rows = []
    for (node, modes), differences_ in sorted(found.items()):
        rows.append(f"| {node} | {modes} | {len(differences_)} | {in_digits(max(differences_))} |")
    head = HEAD.format(version=bpy.app.version_string)
    TARGET.write_text(head + "\n".join(rows) + "\n" + from_node_to_pixel() + of_balls(), encoding="utf-8")


def in_digits(difference):
    return f"{difference:.0e}" if difference > 0 else "none"


def from_node_to_pixel():
    """The second part of the page."""
    found = {}  # {name of a case: largest difference}
    for module in (test_nodes, test_nodes_rare):
        found |= {name: node_sheet.difference(*cell) for name, cell in compared(module.CASES).items()}
    for module in (test_nodes_of_instances, test_nodes_with_rays):
        found |= {name: module.difference(*cell) for name, cell in module.cells().items()}
    labels = {label for _, label in node_states.node_classes()}
    rows = []
    for name, difference in sorted(found.items()):
        node = node_of(name, labels)
        reason = test_nodes.LOOSE.get(name, (0, NOISE if name in test_nodes_with_rays.CASES else ""))[1]
        rows.append(f"| {node} | {name.removeprefix(node).strip()} | {in_digits(difference)} | {reason} |")
    rows += [f"| {node} | | | {how} |" for node, how in ELSEWHERE.items()]
    return TAIL.format(count=len(found)) + "\n".join(rows) + "\n"


def of_balls():
    """The third part of the page."""
    rows = []
    for name, means in test_closure_means.means().items():
        ours, theirs, z = means.ours.mean(), means.theirs.mean(), means.z()
        rows.append(f"| {name} | {theirs:.4f} | {100 * (ours / theirs - 1):+.2f} % | {z[np.argmax(np.abs(z))]:+.1f} |")
    head = MEANS.format(seeds=test_closure_means.SEEDS, samples=test_closure_means.SAMPLES)
    return head + "\n".join(rows) + "\n"


def node_of(name, labels):
    """The node that a case is about: its name begins with the label that Blender shows."""
    return max((label for label in labels if name.startswith(label)), key=len)


def differences_of_lobes():
    """{name of a case: largest difference}"""
    values, wo, wi = test_lobes.values_of_cycles()
    result = {}
    for name, (_, _, _, kind, fields) in test_lobes.CASES.items():
        ours = [
            evaluate_many(make_bsdf(lobe(kind, weight=test_lobes.COLOR, **fields), wo=view), view, wi[:, column])[0]
            for column, view in enumerate(wo)
        ]
        theirs = np.moveaxis(values[name], 1, 0)
        result[name] = (abs(np.array(ours) - theirs) / np.maximum(1, abs(theirs))).max()
    return result


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # bpy 4.5 would wait for ever
