# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a base is seen below a varnish, from straight above to the horizon: as much as in Cycles.

By pairs of directions, so there is no noise: a white base with its varnish, less a black one.
"""

import numpy as np
import pytest

from blender_tests.helpers.engines import enable_engines
from blender_tests.helpers.lobe_values import node, values_of_engines

ANGLES = (0, 40, 60, 70, 75, 80, 82, 85, 87, 89)
SUN = [(0.0, 0.3, 1.0)]
WHITE, BLACK, TINT = (1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0), (0.2, 0.6, 1.0, 1.0)
SINGLE = {"distribution": "GGX"}  # which loses light, and covers as if it did not
VARNISHES = {
    **{f"roughness {r}": (None, {"Roughness": r}) for r in (0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0)},
    **{f"index {ior}": (None, {"Roughness": 0.2, "IOR": ior}) for ior in (0.7, 1.05, 1.33, 2.4)},
    **{f"single scattering {r}": (SINGLE, {"Roughness": r}) for r in (0.1, 0.5, 1.0)},
    "bright": (None, {"Roughness": 0.4, "Specular IOR Level": 0.9}),
    "tinted": (None, {"Roughness": 0.4, "Specular Tint": TINT}),
    "stretched": (None, {"Roughness": 0.5, "Anisotropic": 0.8}),
    "stretched and roughest": (None, {"Roughness": 1.0, "Anisotropic": 0.8}),
    "coat": (None, {"Coat Weight": 1.0, "Coat Roughness": 0.1, "Coat IOR": 1.8}),
    "half a coat": (None, {"Coat Weight": 0.5, "Coat Roughness": 0.6}),
}


@pytest.fixture(scope="module")
def values():
    """{name: (bases, varnishes) of Lambent and of Cycles}, each (angles, 3)."""
    enable_engines()
    closures = [
        node("Principled", settings, **{"Base Color": color, **inputs})
        for settings, inputs in VARNISHES.values()
        for color in (WHITE, BLACK)
    ]
    cosines = np.cos(np.radians(ANGLES)).tolist()
    both = [f[0] for f in values_of_engines(closures, cosines, SUN, ["LAMBENT", "CYCLES"])]
    return {name: [(f[2 * row] - f[2 * row + 1], f[2 * row + 1]) for f in both] for row, name in enumerate(VARNISHES)}


@pytest.mark.parametrize("name", VARNISHES)
def test_a_base_shines_through_a_varnish_as_in_cycles_up_to_the_horizon(values, name):
    (ours, _), (theirs, _) = values[name]
    assert theirs[0].min() > 2 * theirs[-1].min()  # less is seen of it at the horizon
    np.testing.assert_allclose(ours, theirs, rtol=2e-3)


@pytest.mark.parametrize("name", VARNISHES)
def test_a_varnish_reflects_as_in_cycles_up_to_the_horizon(values, name):
    (_, ours), (_, theirs) = values[name]
    np.testing.assert_allclose(ours, theirs, rtol=1e-2, atol=1e-7)  # at 89 degrees both interpolate in short tables
