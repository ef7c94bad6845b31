# SPDX-License-Identifier: GPL-3.0-or-later
"""BSDFs in a white furnace: light of radiance 1 from everywhere. What leaves a white, lossless material is 1 again.

The mean weight of sampled directions is that radiance.
"""

import math

import numpy as np
import pytest

from blender_tests.helpers.bsdfs import ALL_CASES, HAIR, direction, evaluate_many, lobe, make_bsdf, sample_many
from blender_tests.helpers.chi_square import integrate_over_cells
from engine_core.bsdf import dispatch
from engine_core.linalg.vec3 import Vec3
from engine_core.tables import FresnelKind, LobeKind

SAMPLES = 100_000
ANGLES = (0.0, 30.0, 60.0, 80.0)
# Lossless materials: no light is lost by the model, at no angle
LOSSLESS = {
    "diffuse": lobe(LobeKind.DIFFUSE),
    "translucent": lobe(LobeKind.TRANSLUCENT),
    "transparent": lobe(LobeKind.TRANSPARENT),
    "mirror": lobe(LobeKind.CONDUCTOR),
    "glass": lobe(LobeKind.DIELECTRIC, ior=1.5),
    "glass from inside": lobe(LobeKind.DIELECTRIC, ior=1 / 1.5),
    "rough glass of the index of air": lobe(LobeKind.DIELECTRIC, ior=1.0, alpha_x=0.3, alpha_y=0.3),
    "refraction": lobe(LobeKind.REFRACTION, ior=1.45),
    "white hair": lobe(LobeKind.HAIR, **{**HAIR, "f82": (0.0, 0.0, 0.0)}),
    "white rough hair": lobe(LobeKind.HAIR, **{**HAIR, "alpha_x": 27.0, "alpha_y": 4.2, "f82": (0.0, 0.0, 0.0)}),
}
# How far `albedo` may be from the truth. It is exact to the interpolation of its tables, but for the lobes of which its
# docstring says that it is an estimate.
EXACT = 0.005
ESTIMATED = {
    "CONDUCTOR stretched": 0.15,  # the tables are for isotropic widths
    "DIELECTRIC stretched": 0.05,
    "COATING stretched": 0.08,
    "CONDUCTOR gold": 0.02,  # through the F82 curve that fits it best
    "CONDUCTOR Beckmann": 0.12,  # a guess from what GGX loses
    "CONDUCTOR Beckmann roughest": 0.12,
    "CONDUCTOR Beckmann stretched": 0.12,
    "DIELECTRIC Beckmann": 0.15,  # as if of GGX
    "REFRACTION Beckmann": 0.1,
    "CONDUCTOR film": 0.1,  # under a film, that of a smooth surface
    "CONDUCTOR gold film": 0.1,
    "DIELECTRIC film": 0.05,
    "DIELECTRIC film from inside": 0.05,
    "COATING film": 0.2,
    "COATING tinted": 0.01,  # that of Cycles, by which pictures look alike: too bright at grazing angles
    "TOON_GLOSSY": 0.5,  # as if the cone had no part below the horizon
    "TOON_GLOSSY sharp": 0.5,
    "ASHIKHMIN_SHIRLEY": 0.08,  # from sixteen samples; worst at grazing angles, where half of them are lost
    "ASHIKHMIN_SHIRLEY sharp": 0.08,
    "ASHIKHMIN_SHIRLEY stretched": 0.08,
    **dict.fromkeys((c for c in ALL_CASES if c.startswith("HAIR_FACETS")), 0.4),  # of some of the facets a guess
    "HAIR_REFLECTION": 0.5,  # as if nothing went below the horizon, or back around the fibre
    "HAIR_REFLECTION wide": 0.7,
    "HAIR_TRANSMISSION": 0.5,
    "HAIR_TRANSMISSION wide": 0.5,
    "VELVET": 0.03,  # from a few directions
    "VELVET soft": 0.03,
    "VELVET sharp": 0.03,
    "REFRACTION rough": 0.1,
    "REFRACTION rough from inside": 1.0,  # near the critical angle all or nothing is asked of a smooth curve
}
# Models that would lose light and are compensated
COMPENSATED = {
    f"{name} {alpha}": lobe(kind, ior=ior, alpha_x=alpha, alpha_y=alpha, multiscatter=1)
    for name, kind, ior in (
        ("conductor", LobeKind.CONDUCTOR, 1.0),
        ("glass", LobeKind.DIELECTRIC, 1.5),
        ("glass from inside", LobeKind.DIELECTRIC, 1 / 1.5),
        ("diamond", LobeKind.DIELECTRIC, 2.42),
    )
    for alpha in (0.03, 0.17, 0.5, 0.8, 1.0)
} | {f"rough diffuse {r}": lobe(LobeKind.ROUGH_DIFFUSE, alpha_x=r) for r in (0.0, 0.1, 0.5, 1.0)}


def furnace(bsdf, wo, samples=SAMPLES, seed=1):
    """Radiance towards wo by colour, and the standard error of its mean."""
    weight = sample_many(bsdf, wo, samples, seed).weight.astype(float)
    return weight.mean(axis=0), weight.std(axis=0).max() / math.sqrt(samples)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("name", LOSSLESS)
def test_lossless_materials_vanish_in_a_white_furnace(name, angle):
    wo = direction(angle)
    samples = sample_many(make_bsdf(LOSSLESS[name], wo=wo), wo, 1000)
    assert samples.weight == pytest.approx(1.0, abs=2e-6)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("name", COMPENSATED)
def test_compensated_materials_vanish_in_a_white_furnace(name, angle):
    wo = direction(angle)
    radiance, error = furnace(make_bsdf(COMPENSATED[name], wo=wo), wo)
    assert radiance == pytest.approx(1.0, abs=0.01 + 4.0 * error)


@pytest.mark.parametrize("angle", [*ANGLES, 88.0])
@pytest.mark.parametrize("case", [c for c in ALL_CASES if c != "HAIR_FACETS white"])  # on the average: see below
def test_nothing_gives_back_more_than_it_gets(case, angle):
    kind, fields = ALL_CASES[case]
    wo = direction(angle)
    radiance, error = furnace(make_bsdf(lobe(kind, **fields), wo=wo), wo, 20_000)
    assert radiance.max() <= 1.0 + 0.01 + 4.0 * error


@pytest.mark.parametrize("sine", [0.0, -0.5, 0.5, 0.8])
def test_white_hair_of_microfacets_vanishes_in_a_white_furnace(sine):
    """On average over its breadth: what it gives back in one place depends on facets that are drawn there."""
    kind, fields = ALL_CASES["HAIR_FACETS white"]
    radiance, across = [], math.sqrt(1.0 - sine * sine)
    for number in range(1000):
        h = (number + 0.5) / 500.0 - 1.0
        wo = np.array((sine, across * h, across * math.sqrt(1.0 - h * h)))
        bsdf = make_bsdf(lobe(kind, **fields), wo=wo)
        radiance.append(furnace(bsdf, wo, 200, seed=number)[0][1])
    error = np.std(radiance) / math.sqrt(len(radiance))
    assert error < 0.03
    assert np.mean(radiance) == pytest.approx(1.0, abs=0.01 + 4.5 * error)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("case", ALL_CASES)
def test_albedo_is_the_radiance_in_the_furnace(case, angle):
    kind, fields = ALL_CASES[case]
    wo = direction(angle)
    bsdf = make_bsdf(lobe(kind, **fields), wo=wo)
    radiance, error = furnace(bsdf, wo)
    tolerance = ESTIMATED.get(case, EXACT) + 4.0 * error
    assert tuple(dispatch.albedo(bsdf, Vec3(*wo))) == pytest.approx(radiance, abs=tolerance)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("case", [c for c in ALL_CASES if "rough" in c or c in ("DIFFUSE", "TRANSLUCENT")])
def test_evaluated_light_from_everywhere_is_the_sampled_light(case, angle):
    kind, fields = ALL_CASES[case]
    wo = direction(angle)
    bsdf = make_bsdf(lobe(kind, **fields), wo=wo)
    evaluated = integrate_over_cells(lambda w: evaluate_many(bsdf, wo, w)[0][:, 0], 20, 40).sum()
    radiance, error = furnace(bsdf, wo)
    assert evaluated == pytest.approx(radiance[0], abs=1e-3 + 4.0 * error)


@pytest.mark.parametrize("angle", ANGLES)
def test_further_bounces_between_microfacets_take_the_colour_of_the_metal(angle):
    """Light that misses the way out is reflected again, each time by the metal: the sum of that series."""
    wo, color = direction(angle), np.array([0.9, 0.5, 0.1])
    mirror = lobe(LobeKind.CONDUCTOR, alpha_x=0.8, alpha_y=0.8)
    leaves = furnace(make_bsdf(mirror, wo=wo), wo)[0]
    cos = (np.arange(32) + 0.5) / 32
    views = [direction(math.degrees(math.acos(c))) for c in cos]
    leaves_on_average = np.sum(
        [2.0 * c / 32 * furnace(make_bsdf(mirror, wo=v), v, 5000)[0] for c, v in zip(cos, views, strict=True)], axis=0
    )
    expected, trapped = color * leaves, color * (1.0 - leaves)
    for _ in range(50):
        trapped = trapped * color
        expected = expected + trapped * leaves_on_average
        trapped = trapped * (1.0 - leaves_on_average)
    metal = make_bsdf(lobe(LobeKind.CONDUCTOR, alpha_x=0.8, alpha_y=0.8, f0=color, multiscatter=1), wo=wo)
    radiance, error = furnace(metal, wo)
    assert radiance == pytest.approx(expected, abs=0.01 + 4.0 * error)


# ---- Layers ----------------------------------------------------------------------------------------------------------


def varnished(weight=1.0, covers=1.0, alpha=0.3, ior=1.5, tint=(1.0, 1.0, 1.0)):
    """White paint under varnish that covers a part of it; all of it mixed in with `weight`."""
    widths = {"alpha_x": alpha, "alpha_y": alpha}
    coat = lobe(
        LobeKind.COATING, weight=(weight * covers,) * 3, ior=ior, covers=covers, layer=1, refract_tint=tint, **widths
    )
    return [{**coat, "multiscatter": 1}, lobe(LobeKind.DIFFUSE, weight=(weight,) * 3, layer=1)]


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("covers", [1.0, 0.4])
@pytest.mark.parametrize("weight", [1.0, 0.3])
@pytest.mark.parametrize("alpha", [0.0, 0.3])
def test_white_paint_under_varnish_vanishes_in_a_white_furnace(alpha, weight, covers, angle):
    """The paint gets what the varnish lets through; also where both are a part of a mix, and the rest is black."""
    wo = direction(angle)
    radiance, error = furnace(make_bsdf(*varnished(weight, covers, alpha), wo=wo), wo)
    assert radiance == pytest.approx(weight, abs=0.01 + 4.0 * error)


def test_varnish_covers_only_later_lobes_of_its_layer():
    wo = direction(50.0)
    coat, paint = varnished()
    bsdf = make_bsdf(paint, coat, paint, {**paint, "layer": 2}, {**paint, "layer": 0}, wo=wo)
    before, _, below, other, none = (row.weight[0] for row in bsdf.lobes[:5])
    assert before == other == none == 1.0
    assert below == pytest.approx(1.0 - dispatch.albedo(make_bsdf(coat, wo=wo), Vec3(*wo)).x, abs=1e-6)


@pytest.mark.parametrize("angle", ANGLES)
def test_tinted_varnish_absorbs_along_the_refracted_ray(angle):
    """Beer's law: at the tint's depth straight down, 1 / cos of the refracted ray deeper at an angle (Snell)."""
    wo, tint = direction(angle), np.array([0.9, 0.5, 0.2])
    clear, tinted = (make_bsdf(*varnished(tint=t), wo=wo).lobes[1].weight for t in ((1.0, 1.0, 1.0), tint))
    refracted = math.asin(math.sin(math.radians(angle)) / 1.5)
    assert tinted == pytest.approx(clear * tint ** (1.0 / math.cos(refracted)), rel=1e-4)


def test_lobes_are_chosen_by_what_they_give_back():
    wo = direction(30.0)
    bsdf = make_bsdf(*varnished(), lobe(LobeKind.CONDUCTOR, fresnel=FresnelKind.CONSTANT, f0=(0.5, 0.5, 0.5)), wo=wo)
    share = [dispatch.lobe_albedo(row, Vec3(*wo)).x * row.weight[0] for row in bsdf.lobes[:3]]
    assert bsdf.lobes["pmf"][:3] == pytest.approx(np.array(share) / np.sum(share), rel=1e-5)
    assert bsdf.lobes["pmf"][:3].sum() == pytest.approx(1.0, abs=1e-6)
