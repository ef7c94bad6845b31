# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels: colours of bytes, decoded in lanes, are those of the standard."""

import numpy as np

from engine_core.jit import kernel
from engine_core.linalg.simd import lanes_of, vector_of
from engine_core.linalg.vec3 import Vec3
from engine_core.texture.image import bytes_to_linear, inside

REPEAT, EXTEND, CLIP, MIRROR = range(4)


@kernel
def decoded(x):
    return vector_of(bytes_to_linear(lanes_of(Vec3(x, x, x), np.float32(0.0)))).y


def test_colours_of_bytes_are_decoded_as_srgb():
    x = np.linspace(0.0, 1.0, 2001)
    exact = np.where(x < 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose([decoded(np.float32(a)) for a in x], exact, rtol=1e-5)


def test_columns_beyond_an_image_are_brought_into_it():
    beyond = range(-7, 8)
    assert [inside(i, 3, REPEAT) for i in beyond] == [i % 3 for i in beyond]
    assert [inside(i, 3, EXTEND) for i in beyond] == [min(max(i, 0), 2) for i in beyond]
    assert [inside(i, 3, CLIP) for i in beyond] == [i if 0 <= i < 3 else -1 for i in beyond]
    assert [inside(i, 3, MIRROR) for i in beyond] == [(0, 1, 2, 2, 1, 0)[i % 6] for i in beyond]
