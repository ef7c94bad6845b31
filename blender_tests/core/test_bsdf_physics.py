# SPDX-License-Identifier: GPL-3.0-or-later
"""BSDFs: the laws they follow. Fresnel, Snell, reciprocity, and that nothing depends on how the frame is turned."""

import cmath
import math

import numpy as np
import pytest
from scipy.integrate import quad

from blender_tests.helpers.bsdfs import ALL_CASES, DELTAS, GOLD, direction, evaluate_many, lobe, make_bsdf, sample_many
from blender_tests.helpers.chi_square import integrate_over_cells
from engine_core.bsdf import fresnel, microfacet
from engine_core.jit import kernel
from engine_core.linalg.vec3 import Vec3
from engine_core.tables import TRANSMITTING, LobeKind

# Toon is a style of drawing; the table of sheen is fitted to one view at a time;
# a film counts waves of the near side, as in Cycles.
# The place across a fibre is told by the view (Chiang et al. 2016), the Hair node's lobes are densities.
NOT_RECIPROCAL = {
    "HAIR",
    "HAIR_FACETS",
    "HAIR_REFLECTION",
    "HAIR_TRANSMISSION",
    "TOON_DIFFUSE",
    "TOON_GLOSSY",
    "SHEEN",
    "DIELECTRIC film",
    "DIELECTRIC film from inside",
}
HAVE_SIDES = [
    case for case, (kind, _) in ALL_CASES.items() if kind not in (LobeKind.HAIR, LobeKind.HAIR_FACETS)
]  # light goes all around a fibre
COSINES = np.cos(np.radians([0.0, 20.0, 45.0, 60.0, 75.0, 85.0, 89.0])).astype(np.float32)


def fresnel_by_amplitudes(cos, index):
    """Reflectance of unpolarised light by Fresnel's equations in complex numbers; `index` n + i k."""
    sin2 = 1.0 - cos * cos
    root = cmath.sqrt(index * index - sin2)
    s = (cos - root) / (cos + root)
    p = (index * index * cos - root) / (index * index * cos + root)
    return 0.5 * (abs(s) ** 2 + abs(p) ** 2)


# ---- Fresnel ---------------------------------------------------------------------------------------------------------


def test_glass_reflects_four_percent_head_on_from_either_side():
    for ior in (1.5, 1.0 / 1.5):
        assert fresnel.fresnel_dielectric(np.float32(1.0), np.float32(ior))[0] == pytest.approx(0.04, rel=1e-5)
        assert fresnel.f0_of_ior(np.float32(ior)) == pytest.approx(0.04, rel=1e-5)


@pytest.mark.parametrize("ior", [1.0, 1.33, 1.5, 2.42, 1 / 1.5])
@pytest.mark.parametrize("cos", COSINES)
def test_dielectrics_reflect_by_fresnels_equations(cos, ior):
    reflectance, cos_t = fresnel.fresnel_dielectric(cos, np.float32(ior))
    assert reflectance == pytest.approx(fresnel_by_amplitudes(float(cos), ior), abs=2e-6)
    sin_t = math.sqrt(1.0 - float(cos) ** 2) / ior
    assert cos_t == pytest.approx(math.sqrt(1.0 - sin_t**2) if sin_t < 1.0 else 0.0, abs=1e-5)


def test_light_is_reflected_totally_beyond_the_critical_angle():
    critical = math.degrees(math.asin(1.0 / 1.5))
    below, beyond = (np.float32(math.cos(math.radians(critical + d))) for d in (-0.1, 0.1))
    assert fresnel.fresnel_dielectric(below, np.float32(1 / 1.5))[0] < 0.9
    assert fresnel.fresnel_dielectric(beyond, np.float32(1 / 1.5)) == (1.0, 0.0)
    for angle in (critical + 1.0, 60.0, 85.0):
        samples = sample_many(
            make_bsdf(lobe(LobeKind.DIELECTRIC, ior=1 / 1.5), wo=direction(angle)), direction(angle), 100
        )
        assert (samples.is_transmission == 0).all()


@pytest.mark.parametrize("index", [0.2 + 3.9j, 1.5 + 7.6j, 2.9 + 3.1j, 1.5 + 0j])
@pytest.mark.parametrize("cos", COSINES)
def test_metals_reflect_by_fresnels_equations(cos, index):
    n, k = (Vec3(x, x, x) for x in (index.real, index.imag))
    assert fresnel.fresnel_conductor(cos, n, k).x == pytest.approx(fresnel_by_amplitudes(float(cos), index), abs=1e-5)


def test_f82_passes_through_its_colours():
    """f0 head on, Schlick's value times the tint at cos 1/7, white at grazing (Kutz et al. 2021)."""
    f0, tint = Vec3(0.9, 0.5, 0.1), Vec3(0.3, 1.0, 0.8)
    b = fresnel.f82_tint_b(f0, tint)
    schlick = np.array([*f0]) + (1.0 - np.array([*f0])) * (6 / 7) ** 5
    assert tuple(fresnel.fresnel_f82(np.float32(1.0), f0, b)) == pytest.approx(tuple(f0))
    assert tuple(fresnel.fresnel_f82(np.float32(1 / 7), f0, b)) == pytest.approx(tuple(schlick * [*tint]), rel=1e-4)
    assert tuple(fresnel.fresnel_f82(np.float32(0.0), f0, b)) == pytest.approx((1.0, 1.0, 1.0))


def test_a_tinted_coat_goes_from_its_tint_to_white():
    ior, tint = np.float32(1.5), Vec3(0.5, 1.0, 30.0)
    head_on = tuple(fresnel.fresnel_coating(np.float32(1.0), ior, tint))
    assert head_on == pytest.approx((0.02, 0.04, 1.0), rel=1e-4)  # never above 1
    assert tuple(fresnel.fresnel_coating(np.float32(1e-4), ior, tint)) == pytest.approx((1.0, 1.0, 1.0), abs=1e-3)
    white = fresnel.fresnel_coating(np.float32(0.5), ior, Vec3(1.0, 1.0, 1.0)).x
    assert white == pytest.approx(fresnel.fresnel_dielectric(np.float32(0.5), ior)[0], rel=1e-4)


def test_mean_reflectances_are_the_means():
    """Integral of 2 cos F(cos); what compensation for multiple scattering takes for the colour of a bounce."""

    def mean(curve):
        return quad(lambda cos: 2.0 * cos * curve(np.float32(cos)), 0.0, 1.0, epsabs=1e-5)[0]

    for ior in (1.1, 1.5, 2.5, 1 / 1.1, 1 / 1.5, 1 / 2.5):
        expected = mean(lambda cos, ior=ior: fresnel.fresnel_dielectric(cos, np.float32(ior))[0])
        assert fresnel.fresnel_dielectric_average(np.float32(ior)) == pytest.approx(expected, abs=0.01)
        tint = Vec3(0.5, 0.5, 0.5)
        expected = mean(lambda cos, ior=ior, tint=tint: fresnel.fresnel_coating(cos, np.float32(ior), tint).x)
        assert fresnel.fresnel_coating_average(np.float32(ior), tint).x == pytest.approx(expected, abs=0.01)
    f0 = Vec3(0.7, 0.5, 0.2)
    b = fresnel.f82_tint_b(f0, Vec3(0.6, 0.6, 0.6))
    expected = mean(lambda cos: fresnel.fresnel_f82(cos, f0, b).y)
    assert fresnel.fresnel_f82_average(f0, b).y == pytest.approx(expected, abs=1e-3)


# ---- Microfacets -----------------------------------------------------------------------------------------------------


@kernel
def _areas(row, wo, h, out):
    so = microfacet.stretched_length(row, wo)
    for i in range(len(h)):
        n = Vec3(h[i, 0], h[i, 1], h[i, 2])
        cos_h = n.x * wo.x + n.y * wo.y + n.z * wo.z
        out[i, 0] = microfacet.distribution(row, n) * max(n.z, 0.0)
        out[i, 1] = microfacet.visible_normal_pdf(row, wo, so, n, cos_h) if n.z > 0.0 and cos_h > 0.0 else 0.0


@pytest.mark.parametrize("widths", [(0.1, 0.1), (0.5, 0.5), (1.0, 1.0), (0.6, 0.15)])
@pytest.mark.parametrize("angle", [0.0, 50.0, 85.0])
def test_microfacets_cover_the_surface_once_and_their_visible_part_is_what_is_seen(widths, angle):
    """Integrals of D cos, and of the visible normals, D G1 (wo . h) / zo: both 1 (Heitz 2014, equations 1 and 16)."""
    row = make_bsdf(lobe(LobeKind.CONDUCTOR, alpha_x=widths[0], alpha_y=widths[1])).lobes[0]

    def area(which):
        def density(h):
            out = np.empty((len(h), 2), np.float32)
            _areas(row, Vec3(*direction(angle)), h.astype(np.float32), out)
            return out[:, which]

        return density

    assert integrate_over_cells(area(0), 20, 40).sum() == pytest.approx(1.0, abs=2e-3)
    assert integrate_over_cells(area(1), 20, 40).sum() == pytest.approx(1.0, abs=2e-3)


# ---- Laws of scattering ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [0.0, 20.0, 41.0])
@pytest.mark.parametrize("ior", [1.5, 1 / 1.5, 2.42])
@pytest.mark.parametrize("kind", [LobeKind.DIELECTRIC, LobeKind.REFRACTION])
def test_refraction_obeys_snell(kind, ior, angle):
    """sin(wo) = ior sin(wi), in one plane with the normal."""
    wo = direction(angle)
    samples = sample_many(make_bsdf(lobe(kind, ior=ior), wo=wo), wo, 100)
    wi = samples.wi[samples.is_transmission == 1].astype(float)
    assert len(wi) > 0
    assert wi[:, :2] * ior == pytest.approx(-wo[None, :2].repeat(len(wi), 0), abs=1e-6)
    assert (wi[:, 2] < 0.0).all()


@pytest.mark.parametrize("case", DELTAS)
def test_mirrors_reflect_at_the_same_angle(case):
    kind, fields = ALL_CASES[case]
    wo = direction(50.0)
    samples = sample_many(make_bsdf(lobe(kind, **fields), wo=wo), wo, 1000)
    assert (samples.is_delta[samples.pdf > 0.0] == 1).all()
    reflected = samples.wi[(samples.pdf > 0.0) & (samples.is_transmission == 0)]
    assert reflected == pytest.approx((wo * [-1, -1, 1])[None].repeat(len(reflected), 0), abs=1e-6)


@pytest.mark.parametrize("case", [c for c in ALL_CASES if not {c, c.split()[0]} & (NOT_RECIPROCAL | {*DELTAS})])
def test_swapping_the_directions_changes_nothing(case):
    """f(wo, wi) = f(wi, wo); through an interface ior ** 2 f(wi, wo), as radiance is not scaled there.

    Compensation for multiple scattering is by the view alone (Turquin 2019), so those lobes are reciprocal without it.
    """
    kind, fields = ALL_CASES[case]
    fields = {**fields, "multiscatter": 0}
    ior = fields.get("ior", 1.0)
    inside = np.diag([1.0, -1.0, -1.0])  # the frame of someone on the other side
    wo = direction(50.0)
    bsdf, found = make_bsdf(lobe(kind, **fields), wo=wo), 0.0
    for wi in sample_many(bsdf, wo, 50).wi.astype(float):
        if not np.isfinite(wi).all():
            continue
        there = evaluate_many(bsdf, wo, [wi])[0][0] / abs(wi[2])
        if wi[2] > 0.0:
            back = evaluate_many(make_bsdf(lobe(kind, **fields), wo=wi), wi, [wo])[0][0] / wo[2]
        else:
            other = make_bsdf(lobe(kind, **fields), wo=wi, frame=inside, backfacing=True)
            scale = ior**2 if kind in (LobeKind.DIELECTRIC, LobeKind.REFRACTION) else 1.0
            back = scale * evaluate_many(other, wi, [wo])[0][0] / wo[2]
        found = max(found, there.max())
        assert there == pytest.approx(back, rel=2e-3)
    assert found > 0.0


@pytest.mark.parametrize("kind", sorted(set(LobeKind) - {LobeKind.TRANSPARENT, LobeKind.SUBSURFACE}))
def test_kinds_that_let_light_through_are_listed(kind):
    """Lights behind a surface are looked for by that list. Straight through is left to the shadow ray, what scatters
    below the surface to where it comes out."""
    wo, passes = direction(30.0), False
    for fields in (fields for case, fields in ALL_CASES.values() if case == kind):
        s = sample_many(make_bsdf(lobe(kind, **fields), wo=wo), wo, 500)
        passes |= bool(((s.wi[:, 2] < 0.0) & (s.pdf > 0.0)).any())
    assert passes == (kind in TRANSMITTING)


@pytest.mark.parametrize("case", ALL_CASES)
def test_turning_everything_changes_nothing(case):
    kind, fields = ALL_CASES[case]
    q, _ = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))
    turn = q * np.sign(np.linalg.det(q))
    wo = direction(55.0)
    straight = make_bsdf(lobe(kind, **fields), wo=wo)
    turned = make_bsdf(lobe(kind, **fields), wo=turn @ wo, frame=turn.T)
    a, b = sample_many(straight, wo, 500), sample_many(turned, turn @ wo, 500)
    np.testing.assert_allclose(b.wi, a.wi @ turn.T.astype(np.float32), atol=2e-4)
    np.testing.assert_allclose(b.weight, a.weight, rtol=1e-2, atol=1e-4)
    wi = a.wi[(a.pdf > 0.0) & (a.is_delta == 0)].astype(float)
    f, pdf = evaluate_many(straight, wo, wi)
    f_turned, pdf_turned = evaluate_many(turned, turn @ wo, wi @ turn.T)
    np.testing.assert_allclose(f_turned, f, rtol=1e-2, atol=1e-4)
    np.testing.assert_allclose(pdf_turned, pdf, rtol=1e-2, atol=1e-4)


@pytest.mark.parametrize("kind", [LobeKind.DIELECTRIC, LobeKind.REFRACTION, LobeKind.COATING])
def test_a_back_face_turns_the_index_of_refraction_around(kind):
    """But not that of a coat: both sides of a face are varnished."""
    wo = direction(30.0)
    front, back = (make_bsdf(lobe(kind, ior=1.6), wo=wo, backfacing=b).lobes[0].ior for b in (False, True))
    assert front == pytest.approx(1.6)
    assert back == pytest.approx(1.6 if kind == LobeKind.COATING else 1 / 1.6)


# ---- Shading normals -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", HAVE_SIDES)
def test_no_light_leaks_through_a_face_whose_shading_normal_is_tilted(case):
    """Reflection leaves on the side of wo by the face too, transmission on the other; sampled and evaluated alike."""
    kind, fields = ALL_CASES[case]
    ng = direction(35.0, 1.0)
    wo = direction(40.0, 0.0)
    bsdf = make_bsdf(lobe(kind, **fields), wo=wo, ng=ng)
    samples = sample_many(bsdf, wo, 5000)
    found = samples[samples.pdf > 0.0]
    assert len(found) > 0
    assert ((found.wi @ ng.astype(np.float32) < 0.0) == found.is_transmission).all()
    assert ((found.wi[:, 2] < 0.0) == found.is_transmission).all()
    wi = np.random.default_rng(0).normal(size=(5000, 3))
    wi /= np.linalg.norm(wi, axis=1)[:, None]
    disputed = (wi @ ng < 0.0) != (wi[:, 2] < 0.0)
    f, pdf = evaluate_many(bsdf, wo, wi)
    assert (f[disputed] == 0.0).all()
    assert (pdf[disputed] == 0.0).all()


@pytest.mark.parametrize("case", HAVE_SIDES)
def test_a_view_from_below_the_shading_horizon_is_no_trouble(case):
    """The face is seen, its smooth normal turns away: matt lobes stay lit, the others are dark (as in Cycles)."""
    kind, fields = ALL_CASES[case]
    wo = direction(95.0)
    bsdf = make_bsdf(lobe(kind, **fields), wo=wo, ng=direction(60.0))
    samples = sample_many(bsdf, wo, 500)
    assert np.isfinite(samples.weight).all()
    if kind in (LobeKind.DIFFUSE, LobeKind.TRANSLUCENT, LobeKind.ROUGH_DIFFUSE, LobeKind.TOON_DIFFUSE, LobeKind.SHEEN):
        assert (samples.pdf > 0.0).any()
    elif kind not in (LobeKind.TRANSPARENT, LobeKind.SUBSURFACE):  # skin is half matt
        assert (samples.pdf == 0.0).all()


def test_gold_is_yellow():
    """Head on, red over green over blue; the parameters of the tests are what they say."""
    n, k = Vec3(*GOLD["f0"]), Vec3(*GOLD["f82"])
    f = fresnel.fresnel_conductor(np.float32(1.0), n, k)
    assert f.x > 0.9 > f.y > 0.7 > 0.4 > f.z
