# SPDX-License-Identifier: GPL-3.0-or-later
"""BSDFs: directions are sampled with the density that is claimed, and weighted by what is evaluated."""

import numpy as np
import pytest

from blender_tests.helpers.bsdfs import ALL_CASES, CASES, direction, evaluate_many, lobe, make_bsdf, sample_many
from blender_tests.helpers.chi_square import compare_directions, significance_of_one_of, window_around
from engine_core.bsdf.fresnel import fresnel_dielectric
from engine_core.tables import MAX_LOBES, LobeKind

SAMPLES = 100_000
ANGLES = (0.0, 35.0, 80.0)
MIXTURES = {
    "varnished": [
        lobe(LobeKind.COATING, ior=1.5, alpha_x=0.1, alpha_y=0.1, layer=1, covers=1.0),
        lobe(LobeKind.DIFFUSE, weight=(0.8, 0.2, 0.1), layer=1),
    ],
    "mirror and matt": [
        lobe(LobeKind.CONDUCTOR, weight=(0.3, 0.3, 0.3)),
        lobe(LobeKind.DIFFUSE, weight=(0.2, 0.5, 0.3)),
        lobe(LobeKind.TRANSLUCENT, weight=(0.1, 0.1, 0.3)),
    ],
}
MIXTURES["of two normals"] = [
    lobe(LobeKind.DIFFUSE, weight=(0.5, 0.5, 0.2), frame=1),
    lobe(LobeKind.CONDUCTOR, weight=(0.3, 0.3, 0.3), alpha_x=0.3, alpha_y=0.3),
    lobe(LobeKind.DIELECTRIC, weight=(0.3, 0.3, 0.3), ior=1.5, alpha_x=0.2, alpha_y=0.2, frame=1),
]
KINDS = list(LobeKind)
for first in range(0, len(KINDS), MAX_LOBES):
    kinds = KINDS[first : first + MAX_LOBES]
    MIXTURES[f"everything from {kinds[0].name}"] = [
        lobe(kind, weight=(0.2, 0.1, 0.15), ior=1.4, alpha_x=0.3, alpha_y=0.2) for kind in kinds
    ]
TESTS = 3 * (len(ALL_CASES) + len(MIXTURES)) * len(ANGLES)


def test_every_kind_of_lobe_has_parameters():
    assert set(CASES) == set(LobeKind)


def check_chi_square(bsdf, wo):
    """Over the whole sphere, and zoomed in on what is reflected and on what is transmitted."""
    samples = sample_many(bsdf, wo, SAMPLES)
    wi = samples.wi.copy()
    wi[samples.is_delta == 1] = np.nan  # deltas are no part of the density
    windows = [None]
    for half in (0, 1):
        part = wi[samples.is_transmission == half]
        if np.isfinite(part).all(axis=1).sum() > 0.01 * SAMPLES:
            windows.append(window_around(part))
    for window in windows:
        result = compare_directions(wi, lambda w: evaluate_many(bsdf, wo, w)[1], window)
        assert result.p_value > significance_of_one_of(TESTS), (window, str(result))
        assert result.total <= 1.0 + 1e-3


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("case", ALL_CASES)
def test_sampled_directions_follow_the_pdf(case, angle):
    kind, fields = ALL_CASES[case]
    wo = direction(angle)
    check_chi_square(make_bsdf(lobe(kind, **fields), wo=wo), wo)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("name", MIXTURES)
def test_directions_sampled_from_several_lobes_follow_their_common_pdf(name, angle):
    wo = direction(angle)
    check_chi_square(make_bsdf(*MIXTURES[name], wo=wo), wo)


def test_chi_square_finds_a_pdf_that_is_wrong():
    wo = direction(35.0)
    bsdf = make_bsdf(lobe(LobeKind.CONDUCTOR, alpha_x=0.4, alpha_y=0.4), wo=wo)
    other = make_bsdf(lobe(LobeKind.CONDUCTOR, alpha_x=0.43, alpha_y=0.4), wo=wo)
    result = compare_directions(sample_many(bsdf, wo, SAMPLES).wi, lambda w: evaluate_many(other, wo, w)[1])
    assert result.p_value < significance_of_one_of(TESTS)


@pytest.mark.parametrize("case", [*ALL_CASES, *MIXTURES])
def test_weight_is_value_over_pdf(case):
    """Of all lobes together; and of deltas, which cannot be evaluated, the weights of a white lobe are its albedo."""
    wo = direction(50.0)
    if case in MIXTURES:
        bsdf = make_bsdf(*MIXTURES[case], wo=wo)
    else:
        kind, fields = ALL_CASES[case]
        bsdf = make_bsdf(lobe(kind, **fields), wo=wo)
    samples = sample_many(bsdf, wo, 5000)
    smooth = samples[(samples.pdf > 0.0) & (samples.is_delta == 0)]
    f, pdf = evaluate_many(bsdf, wo, smooth.wi)
    np.testing.assert_allclose(pdf, smooth.pdf, rtol=2e-3)
    np.testing.assert_allclose(f, smooth.weight * smooth.pdf[:, None], rtol=2e-3, atol=1e-6)
    # where a sample is a delta, nothing can be found by evaluating
    delta = samples[samples.is_delta == 1]
    if len(delta) and bsdf.count == 1:
        assert (evaluate_many(bsdf, wo, delta.wi)[1] == 0.0).all()


def test_a_mixture_of_deltas_and_smooth_lobes_gives_back_the_sum_of_both():
    """A third mirror, a third matt, a third see-through: by sampling alone, and by the share of each kind."""
    third = (1 / 3, 1 / 3, 1 / 3)
    kinds = (LobeKind.CONDUCTOR, LobeKind.DIFFUSE, LobeKind.TRANSPARENT)
    wo = direction(40.0)
    bsdf = make_bsdf(*(lobe(kind, weight=third) for kind in kinds), wo=wo)
    samples = sample_many(bsdf, wo, SAMPLES)
    for kind in kinds:
        chosen = samples[samples.kind == kind]
        assert chosen.weight.sum(axis=0) / SAMPLES == pytest.approx(third, abs=0.01)
        assert (chosen.is_delta == (kind != LobeKind.DIFFUSE)).all()
    assert set(samples.kind) == set(kinds)
    straight = samples[samples.kind == LobeKind.TRANSPARENT].wi
    np.testing.assert_allclose(straight, np.broadcast_to(-wo, straight.shape), atol=1e-6)


def test_a_black_bsdf_has_no_directions():
    wo = direction(20.0)
    black = [lobe(kind, weight=(0, 0, 0)) for kind in LobeKind]
    for lobes in ([], black[:1], black[:MAX_LOBES], black[-MAX_LOBES:]):
        bsdf = make_bsdf(*lobes, wo=wo)
        assert (bsdf.lobes["pmf"][: len(lobes)] == 0.0).all()
        samples = sample_many(bsdf, wo, 100)
        assert (samples.pdf == 0.0).all()
        assert (evaluate_many(bsdf, wo, [direction(10.0)])[0] == 0.0).all()


@pytest.mark.parametrize("case", ALL_CASES)
def test_samples_at_the_ends_of_every_range_are_numbers(case):
    """Widths, angles and random numbers at their limits: finite, never negative, unit directions."""
    kind, fields = ALL_CASES[case]
    ends = np.array([0.0, 2.0**-24, 0.5, 1.0 - 2.0**-24], np.float32)
    u = np.stack(np.meshgrid(ends, ends, ends), axis=-1).reshape(-1, 3)
    for width in (None, 1e-3, 1.0):
        changed = {**fields, "alpha_x": width, "alpha_y": width} if width else fields
        for angle in (0.0, 1e-3, 45.0, 89.0, 89.99, 89.9999):
            wo = direction(angle)
            bsdf = make_bsdf(lobe(kind, **changed), wo=wo)
            samples = sample_many(bsdf, wo, len(u), u=u)
            found = samples[samples.pdf > 0.0]
            assert np.isfinite(samples.pdf).all()
            assert np.isfinite(samples.weight).all()
            assert (samples.weight >= 0.0).all()
            assert np.linalg.norm(found.wi, axis=1) == pytest.approx(1.0, abs=1e-5)
            f, pdf = evaluate_many(bsdf, wo, found.wi)
            assert np.isfinite(f).all()
            assert (pdf >= 0.0).all()


def test_choosing_a_lobe_uses_up_no_randomness():
    """u_lobe near both ends of a lobe's share chooses reflection and refraction: it is stretched again."""
    wo = direction(60.0)
    bsdf = make_bsdf(lobe(LobeKind.DIFFUSE), lobe(LobeKind.DIELECTRIC, ior=1.5), wo=wo)
    samples = sample_many(bsdf, wo, SAMPLES)
    glass = samples[samples.kind == LobeKind.DIELECTRIC]
    expected = fresnel_dielectric(np.float32(wo[2]), np.float32(1.5))[0]
    assert (glass.is_transmission == 0).mean() == pytest.approx(expected, abs=0.01)
