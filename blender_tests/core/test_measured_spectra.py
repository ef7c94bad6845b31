# SPDX-License-Identifier: GPL-3.0-or-later
"""From the measured spectra of the Cornell box to colours."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scenes_blend"))

import spectra


def test_equal_energy_is_the_white_of_the_colour_matching_functions():
    """x = y = z = 1/3, by definition of the CIE's functions; over all that the eye sees."""
    xyz = spectra.color_matching(np.arange(380, 781)).sum(axis=1)
    np.testing.assert_allclose(xyz / xyz.sum(), 1 / 3, atol=0.005)


def test_the_eye_is_most_sensitive_to_yellow_green():
    """V(555 nm) = 1 is the unit of the lumen."""
    luminance = spectra.color_matching(np.arange(380, 781))[1]
    assert 380 + luminance.argmax() == pytest.approx(555, abs=5)
    assert luminance.max() == pytest.approx(1.0, abs=0.02)


def test_a_grey_surface_is_grey_in_any_light(monkeypatch):
    flat = " ".join(["400"] * len(spectra.WAVELENGTHS))
    monkeypatch.setitem(spectra.REFLECTANCES, "grey", flat)
    np.testing.assert_allclose(spectra.reflectance("grey"), 0.4, rtol=1e-12)


@pytest.mark.parametrize("name", ["white", "red", "green"])
def test_a_colour_seen_in_the_lamp_is_that_of_its_reflected_spectrum(name):
    """Lamp x reflectance, a product of three numbers, is the colour of the product of the spectra."""
    measured = np.array(spectra.REFLECTANCES[name].split(), float) / 1000.0
    assert len(measured) == len(spectra.WAVELENGTHS)
    seen = spectra.lamp_color() * spectra.reflectance(name)
    exact = spectra.srgb(measured * spectra.lamp())
    np.testing.assert_allclose(seen / seen[0], exact / exact[0], rtol=1e-9)
    assert (spectra.reflectance(name) > 0.0).all()
    assert (spectra.reflectance(name) < 1.0).all()


def test_the_lamp_has_luminance_one_and_is_orange():
    red, green, blue = spectra.lamp_color()
    assert 0.2126 * red + 0.7152 * green + 0.0722 * blue == pytest.approx(1.0)
    assert red > green > blue > 0.0
