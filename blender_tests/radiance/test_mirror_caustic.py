# SPDX-License-Identifier: GPL-3.0-or-later
"""The bright specks in the upper left corner of Cornell boxes with a mirror: true light, of which the mixture finds
little. See docs/integrators.md.

The box of P. Shirley, "Ray Tracing: The Rest of Your Life", in decimetres: its tall block is a mirror, whose top throws
the light of the lamp onto ceiling and walls behind it, in the upper left of the picture.
"""

import functools

import numpy as np
import pytest

from blender_tests.helpers.scenes import CUBE_TRIANGLES, builder, picture
from engine_core.scene.materials import Diffuse, Emission, Metallic
from engine_core.scene.targets import Aim
from engine_core.settings import IntegratorKind

SIZE, BLOCK, W = 60, 5, 5.55
MIRROR = Metallic((0.8, 0.85, 0.88), (1, 1, 1), roughness=0.0)
CLAY = Diffuse((0.73, 0.73, 0.73))
MIXTURE, UNIFORM, PATH = IntegratorKind.MIXTURE, IntegratorKind.BRUTE_FORCE, IntegratorKind.PATH


def shirleys_box(tall, aim):
    """x to the right, y away from the eye, z up; the book's x runs to the left."""
    b = builder((2.775, -8.0, 2.78), (2.775, 0.0, 2.78), field_of_view=40)
    white, red, green = (
        b.material("wall", Diffuse(color)) for color in ((0.73, 0.73, 0.73), (0.65, 0.05, 0.05), (0.12, 0.45, 0.15))
    )
    lamp = b.material("lamp", Emission((1, 1, 1), 15.0), one_sided_emission=True)
    half = W / 2
    for centre, u, v, material in (
        ((0, half, half), (0, half, 0), (0, 0, half), green),
        ((W, half, half), (0, half, 0), (0, 0, half), red),
        ((half, half, 0), (half, 0, 0), (0, half, 0), white),
        ((half, half, W), (half, 0, 0), (0, half, 0), white),
        ((half, W, half), (half, 0, 0), (0, 0, half), white),
        ((W - 2.78, 2.795, 5.54), (0, 0.525, 0), (0.65, 0, 0), lamp),
    ):
        b.instance(b.quads("wall", [centre], [u], [v]), materials=[material])
    angle = np.radians(15)
    corners = np.array([[x, z, y] for x in (0.0, 1.65) for z in (0.0, 1.65) for y in (0.0, 3.3)])
    x = np.cos(angle) * corners[:, 0] + np.sin(angle) * corners[:, 1] + 2.65
    z = -np.sin(angle) * corners[:, 0] + np.cos(angle) * corners[:, 1] + 2.95
    block = b.mesh("tall block", np.column_stack([W - x, z, corners[:, 2]]), CUBE_TRIANGLES[:, ::-1])
    b.instance(block, materials=[b.material("tall block", tall)], aim=aim)
    return b


@functools.cache
def pictures(integrator, aim=Aim.AUTOMATIC, tall=MIRROR, samples=64, seeds=8):
    """Brightness of blocks of pixels, (seeds, rows from below, columns)."""
    values = {"size": SIZE, "samples": samples, "max_bounces": 8, "adaptive": 0, "integrator": integrator}
    images = [picture(shirleys_box(tall, aim), seed=100 * integrator + n, **values) for n in range(seeds)]
    n = SIZE // BLOCK
    return np.array(images, float)[..., :3].mean(axis=-1).reshape(seeds, n, BLOCK, n, BLOCK).mean(axis=(2, 4))


@functools.cache
def caustic():
    """Where the mirror brings light that a block of clay would not: bool (rows, columns), above it and to the left."""
    gain = pictures(PATH, samples=512, seeds=2).mean(axis=0) - pictures(PATH, tall=CLAY, samples=512, seeds=2).mean(0)
    found = gain > 0.02
    found[: SIZE // BLOCK * 3 // 5] = False
    return found


def variance(integrator, **options):
    return pictures(integrator, **options).var(axis=0, ddof=1)


def test_the_mirror_lights_the_upper_left_of_the_picture():
    rows, columns = np.nonzero(caustic())

    assert len(rows) >= 6
    assert columns.max() <= SIZE // BLOCK // 2


@pytest.mark.parametrize("integrator", [MIXTURE, UNIFORM])
@pytest.mark.parametrize("aim", [Aim.AUTOMATIC, Aim.ALWAYS], ids=lambda aim: aim.name)
def test_the_corner_is_as_bright_as_it_should_be(integrator, aim):
    reference = pictures(PATH, samples=512, seeds=8)[:, caustic()].mean(axis=1)
    seen = pictures(integrator, aim=aim, samples=256)[:, caustic()].mean(axis=1)

    error = np.sqrt((seen.var(ddof=1) + reference.var(ddof=1)) / len(seen))
    assert error < 0.1 * reference.mean()
    assert abs(seen.mean() - reference.mean()) < 5.0 * error


def test_there_the_mixture_is_no_better_than_luck_and_elsewhere_far_better():
    """Only the half by the material finds the lamp in the mirror, and with twice the weight."""
    mixture, uniform = variance(MIXTURE), variance(UNIFORM)
    elsewhere = np.ones_like(caustic())
    elsewhere[SIZE // BLOCK // 2 :] = False

    assert mixture[caustic()].sum() > uniform[caustic()].sum()
    assert mixture[elsewhere].sum() < 0.5 * uniform[elsewhere].sum()


def test_aiming_at_the_mirror_cures_it():
    assert variance(MIXTURE, aim=Aim.ALWAYS)[caustic()].sum() < 0.5 * variance(MIXTURE)[caustic()].sum()
