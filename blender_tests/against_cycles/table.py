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

from blender_tests.helpers.bsdfs import evaluate_many, lobe, make_bsdf
from blender_tests.helpers.node_values import cycles_values, differences

from . import test_lobes, test_node_math, test_textures

TARGET = Path(__file__).parents[2] / "docs" / "nodes_against_cycles.md"
HEAD = """# Nodes against Cycles

How far the engine's formulas for shader nodes are from Cycles of Blender {version}: the largest difference over
settings, parameters and pixels, relative where values exceed 1. Both see the same points or colours, which vary.
Closures: value times cosine, for pairs of directions. Written by `python -m blender_tests.against_cycles.table`.

| node | modes | cases | largest difference |
|---|---|---:|---:|
"""


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
        largest = max(differences_)
        rows.append(f"| {node} | {modes} | {len(differences_)} | {f'{largest:.0e}' if largest > 0 else 'none'} |")
    TARGET.write_text(HEAD.format(version=bpy.app.version_string) + "\n".join(rows) + "\n", encoding="utf-8")


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
