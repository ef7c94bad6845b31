# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes give what Cycles' closures give, for pairs of directions: no noise, so equal to rounding."""

import numpy as np
import pytest

from blender_tests.helpers.bsdfs import evaluate_many, lobe, make_bsdf
from blender_tests.helpers.lobe_values import around, cycles_values, node
from engine_core.tables import LobeKind

COLOR = np.array((0.9, 0.5, 0.2))
COSINES = (1.0, 0.83, 0.5, 0.21)
DIRECTIONS = around((0.99, 0.8, 0.5, 0.2, -0.1), 7)


def rough(roughness):
    return {"alpha_x": roughness, "f0": COLOR}


# {name: (node, its settings, its sockets but the colour, kind of lobe, its fields)}
CASES = {
    "diffuse": ("Diffuse", {}, {}, LobeKind.DIFFUSE, {}),
    **{
        f"rough diffuse {r}": ("Diffuse", {}, {"Roughness": r}, LobeKind.ROUGH_DIFFUSE, rough(r))
        for r in (0.1, 0.5, 1.0)
    },
    **{
        f"toon {component} {size} {smooth}": (
            "Toon",
            {"component": component},
            {"Size": size, "Smooth": smooth},
            LobeKind[f"TOON_{component}"],
            {"alpha_x": size, "alpha_y": smooth},
        )
        for component in ("DIFFUSE", "GLOSSY")
        for size, smooth in ((0.5, 0.0), (0.3, 0.4), (0.8, 0.6))
    },
    **{
        f"sheen {r}": ("Sheen", {"distribution": "MICROFIBER"}, {"Roughness": r}, LobeKind.SHEEN, {"alpha_x": r})
        for r in (0.2, 0.47, 0.8, 1.0)
    },
    **{
        f"velvet {r}": ("Sheen", {"distribution": "ASHIKHMIN"}, {"Roughness": r}, LobeKind.VELVET, {"alpha_x": r})
        for r in (0.2, 0.6, 1.0)
    },
    **{
        f"Ashikhmin-Shirley {r}": (
            "Glossy",
            {"distribution": "ASHIKHMIN_SHIRLEY"},
            {"Roughness": r},
            LobeKind.ASHIKHMIN_SHIRLEY,
            {"alpha_x": r * r, "alpha_y": r * r},
        )
        for r in (0.3, 0.6, 0.9)
    },
    "translucent": ("Translucent", {}, {}, LobeKind.TRANSLUCENT, {}),
}


def values_of_cycles():
    """({name: f |cos|, (directions, views, 3)}, wo, wi); see `cycles_values`."""
    closures = [node(kind, settings, Color=(*COLOR, 1), **sockets) for kind, settings, sockets, _, _ in CASES.values()]
    f, wo, wi = cycles_values(closures, COSINES, DIRECTIONS)
    return dict(zip(CASES, np.moveaxis(f, 1, 0), strict=True)), wo, wi


@pytest.fixture(scope="module")
def cycles():
    return values_of_cycles()


@pytest.mark.parametrize("name", CASES)
def test_a_lobe_scatters_as_in_cycles(name, cycles):
    values, wo, wi = cycles
    _, _, _, kind, fields = CASES[name]
    for column, view in enumerate(wo):
        bsdf = make_bsdf(lobe(kind, weight=COLOR, **fields), wo=view)
        f, _ = evaluate_many(bsdf, view, wi[:, column])
        np.testing.assert_allclose(f, values[name][:, column], rtol=1e-3, atol=1e-4)
    assert values[name].max() > 0.05
