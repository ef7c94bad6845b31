# SPDX-License-Identifier: GPL-3.0-or-later
"""The tree of lights: no light is lost in it, its probabilities are those it samples by, and it lowers the noise."""

import numpy as np
import pytest

from blender_tests.helpers.chi_square import compare_counts, significance_of_one_of
from blender_tests.helpers.lights import (
    irradiance_of_all,
    light,
    many_lights,
    pmf_of_all,
    random_numbers,
    sample_light,
    select_often,
)
from blender_tests.helpers.scenes import builder, cube, mean_and_error, picture, plane, sphere
from engine_core.light.bounds import clusters, intensity, pairs
from engine_core.light.build import build_binary, build_tree
from engine_core.scene.materials import Add, Diffuse, Emission, Glass, Glossy, Mix, Refraction, Translucent
from engine_core.settings import IntegratorKind
from engine_core.tables import LIGHT_WIDTH
from engine_core.tables import LightKind as Kind


def unit_vectors(rng, count):
    v = rng.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def frames(rng, count):
    """Random orthonormal axes, (count, 3, 3)."""
    return np.linalg.qr(rng.normal(size=(count, 3, 3)))[0]


def mixture(count, seed=0, offset=0.0):
    """`count` lights of all kinds, in a cube of 10 metres around `offset`: turned, sized and coloured at random."""
    rng = np.random.default_rng(seed)
    makers = [
        lambda a, s: light(Kind.POINT, is_delta=1),
        lambda a, s: light(Kind.POINT, radius=0.5 * s),
        lambda a, s: light(Kind.POINT, radius=0.5 * s, soft=1),
        lambda a, s: light(Kind.SPHERE, radius=0.5 * s, two_sided=int(s > 0.5)),
        lambda a, s: light(Kind.SPOT, is_delta=1, cos_angle=s, blend=1.0 / (1.0 - s), u=a[0], v=a[1], n=a[2]),
        lambda a, s: light(Kind.SPOT, radius=0.3, soft=1, cos_angle=s, u=0.4 * a[0], v=2.0 * a[1], n=a[2]),
        lambda a, s: light(Kind.SPOT, is_delta=1, cos_angle=s, u=a[0] + 0.5 * a[2], v=a[1], n=a[2]),
        lambda a, s: light(Kind.QUAD, u=s * a[0], v=0.5 * a[1]),
        lambda a, s: light(Kind.QUAD, u=s * a[0], v=a[1], spread=s),
        lambda a, s: light(Kind.DISK, u=s * a[0], v=0.2 * a[1]),
        lambda a, s: light(Kind.DISK, u=s * a[0], v=a[1], spread=0.2 * s),
        lambda a, s: light(Kind.TRIANGLE, u=s * a[0], v=a[1] + 0.3 * a[0]),
        lambda a, s: light(Kind.TRIANGLE, u=s * a[0], v=a[1], two_sided=1),
        lambda a, s: light(Kind.QUAD, u=s * a[0], v=0.5 * a[1], two_sided=1),
        lambda a, s: light(Kind.BOX, u=s * a[0], v=0.5 * a[1], radius=0.3 * s, two_sided=int(s > 0.5)),
    ]
    axes, sizes = frames(rng, count), 0.05 + 0.9 * rng.random(count)
    rows = np.concatenate([makers[i % len(makers)](axes[i], sizes[i]) for i in range(count)])
    rows["p"] = offset + 10.0 * rng.random((count, 3))
    rows["emission"] *= 10.0 ** rng.uniform(-3.0, 1.0, (count, 1))
    return rows


def receivers(count, seed=1, offset=0.0):
    """Points in and around the same cube, and normals."""
    rng = np.random.default_rng(seed)
    return offset + 16.0 * rng.random((count, 3)) - 3.0, unit_vectors(rng, count)


def emissive_mesh(side):
    """Triangles of a mesh of side x side flat quadrilaterals, each of its own height and tilt."""
    rng = np.random.default_rng(12)
    rows = []
    for x in range(side):
        for y in range(side):
            a, (u, v, _) = np.array([x, y, 3.0 * rng.random()]), 0.5 * frames(rng, 1)[0]
            both = [light(Kind.TRIANGLE, p=a, u=u, v=u + v), light(Kind.TRIANGLE, p=a, u=u + v, v=0.7 * v)]
            rows += both
    rows = np.concatenate(rows)
    rows["prim"] = np.arange(len(rows))
    return rows


def binary_tree(rows):
    return build_binary(clusters(rows, pairs(rows)))


# ---- The tree bounds what is in it -----------------------------------------------------------------------------------


def test_every_light_has_its_leaf():
    rows = np.concatenate([mixture(100), light(Kind.SUN), light(Kind.TRIANGLE, u=(0, 0, 0)), light(Kind.BACKGROUND)])
    scene = many_lights(rows)
    child, leaf = scene.light_nodes["child"], scene.lights["leaf"]
    in_tree = np.flatnonzero(leaf >= 0)
    assert len(in_tree) == 100
    np.testing.assert_array_equal(~child.ravel()[leaf[in_tree]], in_tree)
    assert (child < 0).sum() == 100
    hangs = np.flatnonzero(child.ravel() > 0)
    np.testing.assert_array_equal(scene.light_nodes["parent"][child.ravel()[hangs]], hangs)
    assert len(child) == 1 + len(hangs) < 40


@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_light_leaves_within_the_bounds_of_its_leaf(offset):
    """Points that samples come from are in the box, directions that they take are in the cone."""
    rows = mixture(130, offset=offset)
    p, _ = receivers(2000, offset=offset)
    rounding = 4e-7 * offset + 2e-6
    for i, cluster in enumerate(clusters(rows, pairs(rows))):
        s = sample_light(rows[i : i + 1], p.astype(np.float32), random_numbers(len(p)))
        lit = (s.pdf > 0.0) & (s.radiance.max(axis=1) > 0.0)
        wi = s.wi[lit].astype(float)
        q = p.astype(np.float32)[lit] + wi * s.distance[lit, None]
        error = rounding + 4e-7 * s.distance[lit, None]
        assert (np.abs(q - cluster["centre"]) <= cluster["half"] + error).all()
        cosine = -wi @ cluster["axis"].astype(float)
        if cluster["two_sided"]:
            cosine = np.abs(cosine)
        assert (cosine >= np.cos(min(cluster["theta_o"] + cluster["theta_e"], np.pi)) - 1e-5).all()


def test_clusters_bound_what_is_below():
    clusters = binary_tree(mixture(300))
    for row in np.flatnonzero(clusters["child"] > 0):
        cluster, halves = clusters[row], clusters[[row + 1, clusters["child"][row]]]
        for half in halves:
            low, high = half["centre"] - half["half"], half["centre"] + half["half"]
            assert (cluster["centre"] - cluster["half"] <= low + 1e-6).all()
            assert (cluster["centre"] + cluster["half"] >= high - 1e-6).all()
            assert cluster["theta_e"] >= half["theta_e"]
            everywhere = cluster["theta_o"] >= np.float32(np.pi)
            assert cluster["two_sided"] or everywhere or not half["two_sided"]
            cosine = float(np.dot(cluster["axis"].astype(float), half["axis"]))
            between = np.arccos(np.clip(abs(cosine) if cluster["two_sided"] else cosine, -1.0, 1.0))
            assert everywhere or between + half["theta_o"] <= cluster["theta_o"] + 1e-3
        assert cluster["intensity"] == pytest.approx(halves["intensity"].sum())


def test_narrow_bounds_stay_narrow():
    """A ceiling of panels that all look down is one cone without width; a lamp among them opens it."""
    rows = np.repeat(light(Kind.QUAD, u=(0.1, 0, 0), v=(0, -0.1, 0)), 64)
    rows["p"][:, :2] = np.random.default_rng(0).random((64, 2))
    root = binary_tree(rows)[0]
    assert root["theta_o"] == pytest.approx(0.0, abs=1e-6)
    assert root["axis"] == pytest.approx([0, 0, -1])
    assert root["half"][2] < 1e-5
    rows = np.concatenate([rows, light(Kind.POINT, is_delta=1)])
    assert binary_tree(rows)["theta_o"][0] == pytest.approx(np.pi)


def test_halves_of_quadrilaterals_are_pairs():
    rows = emissive_mesh(5)
    assert pairs(rows).tolist() == [True, False] * 25
    cluster = clusters(rows, pairs(rows))[0]
    corners = np.concatenate([rows["p"][:2], (rows["p"] + rows["u"])[:2], (rows["p"] + rows["v"])[:2]])
    np.testing.assert_allclose(cluster["centre"] - cluster["half"], corners.min(axis=0), atol=1e-5)
    np.testing.assert_allclose(cluster["centre"] + cluster["half"], corners.max(axis=0), atol=1e-5)
    assert cluster["intensity"] == pytest.approx(intensity(rows)[:2].sum())
    for change in ({"n": (0, 0, 1)}, {"emission": 1}, {"instance": 3}, {"two_sided": 1}, {"p": 9}):
        other = rows.copy()
        for name, value in change.items():
            other[name][1] = value
        assert not pairs(other)[:2].any(), change


def test_a_strip_of_triangles_is_paired_without_overlap():
    """Each of seven would make a pair with the next."""
    rows = np.concatenate([light(Kind.TRIANGLE, p=(i // 2, i % 2, 0), u=(1, 0, 0), v=(0, 1, 0)) for i in range(7)])
    rows["u"][1::2], rows["v"][1::2] = (1, -1, 0), (1, 0, 0)
    rows["n"] = 0, 0, 1
    rows["prim"] = np.arange(7)
    assert pairs(rows).tolist() == [True, False, True, False, True, False, False]


# ---- No light is lost ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("both_sides", [False, True])
@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_no_light_that_arrives_has_probability_zero(offset, both_sides):
    mesh = emissive_mesh(4)
    mesh["p"] += offset
    suns = [light(Kind.SUN, height=0.01), light(Kind.SUN, is_delta=1)]
    rows = np.concatenate([mixture(130, offset=offset), mesh, *suns])
    beams = np.repeat(light(Kind.QUAD, u=(4, 0, 0), v=(0, 4, 0), is_delta=1, spread=0.0), 2)
    beams["p"] = offset + 5.0
    parallel = np.repeat(light(Kind.QUAD, u=(0.3, 0, 0), v=(0, -0.3, 0), spread=2.0), 64)  # bounds of them are narrow
    parallel["p"] = offset + 10.0 * np.random.default_rng(13).random((64, 3))
    scene = many_lights(np.concatenate([rows, parallel, beams]))
    p, n = receivers(400, offset=offset)
    # half of them where they just see the centre of some light, or just do not
    graze = p[:200].astype(np.float32) - scene.lights["p"][:200][np.arange(200) % len(scene.lights)]
    n[:200] = np.cross(graze, unit_vectors(np.random.default_rng(3), 200))
    n[:200] /= np.linalg.norm(n[:200], axis=1, keepdims=True)
    pmf, received = pmf_of_all(scene, p, n, both_sides), irradiance_of_all(scene, p, n, both_sides, side=8)
    arrives = received > 0.0
    assert 0.1 < arrives.mean() < 0.9
    assert (pmf[arrives] > 0.0).all()


@pytest.mark.parametrize("both_sides", [False, True])
def test_probabilities_sum_to_one_or_to_what_is_chosen(both_sides):
    """What is missing is chosen away: on some numbers the tree ends where nothing can be seen."""
    scene = many_lights(np.concatenate([mixture(50), emissive_mesh(3)]))
    p, n = receivers(40)
    totals = pmf_of_all(scene, p, n, both_sides).sum(axis=1)
    u = ((np.arange(2**14) + 0.5) / 2**14).astype(np.float32)
    for point, normal, total in zip(p, n, totals, strict=True):
        _, pmf, _ = select_often(scene, point, normal, u, both_sides)
        assert total == pytest.approx((pmf > 0.0).mean(), abs=80 / 2**14)
    assert totals.max() < 1.0 + 1e-5


def test_probabilities_sum_to_one_where_all_is_seen():
    rows = np.repeat(light(Kind.POINT, is_delta=1), 500)
    rows["p"] = np.random.default_rng(5).normal(size=(500, 3))
    p, n = receivers(100)
    np.testing.assert_allclose(pmf_of_all(many_lights(rows), p, n, both_sides=True).sum(axis=1), 1.0, rtol=1e-5)
    above = np.array([[0, 0, 20.0]]), np.array([[0, 0, -1.0]])
    np.testing.assert_allclose(pmf_of_all(many_lights(rows), *above).sum(axis=1), 1.0, rtol=1e-5)


# ---- Sampling --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("both_sides", [False, True])
def test_lights_are_chosen_as_often_as_claimed(both_sides):
    scene = many_lights(np.concatenate([mixture(60), emissive_mesh(3), light(Kind.BACKGROUND), light(Kind.SUN)]))
    p, n = receivers(8)
    expected = pmf_of_all(scene, p, n, both_sides)
    for i in range(len(p)):
        u = random_numbers(50_000, seed=i)[:, 0]
        chosen, pmf, rest = select_often(scene, p[i], n[i], u, both_sides)
        found = pmf > 0.0
        result = compare_counts(np.bincount(chosen[found], minlength=80), expected[i], len(u))
        assert result.p_value > significance_of_one_of(16), result
        np.testing.assert_allclose(pmf[found], expected[i][chosen[found]], rtol=1e-5)
        assert rest.min() >= 0.0
        assert rest.max() < 1.0


def test_one_light_divided_by_its_probability_is_all_lights():
    """The mean over the random number of irradiance / pmf is the sum over all lights."""
    scene = many_lights(np.concatenate([mixture(150), emissive_mesh(5)]))
    p, n = receivers(20)
    received = irradiance_of_all(scene, p, n, side=8)
    u = ((np.arange(2**18) + 0.5) / 2**18).astype(np.float32)
    for i in range(len(p)):
        chosen, pmf, _ = select_often(scene, p[i], n[i], u)
        found = pmf > 0.0
        mean = (received[i][chosen[found]] / pmf[found]).sum() / len(u)
        assert mean == pytest.approx(received[i].sum(), rel=5e-3)


CLOSED = {
    "all in one place": np.zeros((50, 3)),
    "in a row": np.linspace(0, 1, 50)[:, None] * [1.0, 0, 0],
    "in a plane": np.random.default_rng(0).random((50, 3)) * [1.0, 1.0, 0.0],
    "ever closer": 10.0 ** np.linspace(-30, 2, 200)[:, None] * [1.0, 1.0, 1.0],
}


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("kind", [Kind.POINT, Kind.TRIANGLE])
def test_degenerate_places_are_safe(name, kind):
    """Seen from a lamp itself, from within its box, from its plane and from far away."""
    rows = np.repeat(light(kind, is_delta=int(kind == Kind.POINT), two_sided=1), len(CLOSED[name]))
    rows["p"] = CLOSED[name]
    scene = many_lights(rows)
    p = np.array([rows["p"][0], rows["p"][-1], [0.5, 0, 0], [0.5, 0.5, 0], [0, 0, 1e-20], [1e6, 0, 0], [0, 0, -1e12]])
    n = np.tile([0.6, 0.0, 0.8], (len(p), 1))
    pmf = pmf_of_all(scene, p, n, both_sides=True)
    assert np.isfinite(pmf).all()
    if name == "all in one place":
        pmf = pmf[2:]  # at that very place there is no direction to them
        np.testing.assert_allclose(pmf, 1.0 / len(rows), rtol=1e-5)
    np.testing.assert_allclose(pmf.sum(axis=1), 1.0, rtol=1e-4)


def test_faint_lights_are_found_where_they_are_near():
    """A candle before the eyes outshines the stadium; from far above in the tree it is hard to see, but not lost."""
    rows = np.repeat(light(Kind.POINT, is_delta=1), 100)
    rows["p"] = np.random.default_rng(2).random((100, 3)) * 10.0
    rows["emission"][7] *= 1e-4
    p = rows["p"][7] + [[0.0, 0.0, 1e-3]]
    assert pmf_of_all(many_lights(rows), p, [[0, 0, -1.0]])[0, 7] > 0.05


def test_a_hundred_thousand_lights_do_not_make_a_deep_tree():
    rows = np.repeat(light(Kind.POINT, is_delta=1), 100_000)
    rows["p"] = np.random.default_rng(11).random((100_000, 3)) ** 8
    nodes = build_tree(clusters(rows, pairs(rows)))
    depth = np.zeros(len(nodes), int)
    for row in range(1, len(nodes)):  # parents come first
        depth[row] = depth[nodes["parent"][row] // LIGHT_WIDTH] + 1
    assert depth.max() < 16
    assert (nodes["intensity"] > 0.0).mean() > 0.5


# ---- Noise -----------------------------------------------------------------------------------------------------------


def relative_variance(received, probability):
    """Variance of one light's irradiance / probability, over the square of the mean; the mean over all points."""
    with np.errstate(divide="ignore", invalid="ignore"):
        second = np.where(received > 0.0, received**2 / probability, 0.0).sum(axis=1)
        relative = second / received.sum(axis=1) ** 2 - 1.0
    return np.nanmean(relative)  # not a number where there is no light


def thousand_lamps():
    rows = np.repeat(light(Kind.POINT, is_delta=1), 1000)
    rows["p"] = np.random.default_rng(6).random((1000, 3)) * 10.0
    return rows


def ceiling():
    rows = np.repeat(light(Kind.QUAD, u=(0.3, 0, 0), v=(0, -0.3, 0)), 1024)
    x, y = np.meshgrid(np.arange(32.0), np.arange(32.0))
    rows["p"] = np.stack([x, y, np.full_like(x, 10.0)], axis=-1).reshape(-1, 3)
    return rows


def globe():
    """A closed mesh that emits from both sides of its triangles."""
    rng = np.random.default_rng(7)
    n = unit_vectors(rng, 1000)
    u = np.cross(n, unit_vectors(rng, 1000))
    u *= 0.1 / np.linalg.norm(u, axis=1, keepdims=True)
    rows = np.concatenate([light(Kind.TRIANGLE, u=a, v=np.cross(b, a), two_sided=1) for a, b in zip(u, n, strict=True)])
    rows["p"] = 5.0 + 2.0 * n
    return rows


@pytest.mark.parametrize(("rows", "ratio"), [(thousand_lamps(), 10.0), (ceiling(), 10.0), (globe(), 3.0)])
def test_a_thousand_lights_are_far_less_noisy_than_by_power(rows, ratio):
    rng = np.random.default_rng(8)
    p, n = rng.random((200, 3)) * 9.0, unit_vectors(rng, 200)
    scene = many_lights(rows)
    received = irradiance_of_all(scene, p, n, side=2)
    by_tree = relative_variance(received, pmf_of_all(scene, p, n))
    by_power = relative_variance(received, intensity(rows) / intensity(rows).sum())
    assert by_tree * ratio < by_power


# ---- In pictures -----------------------------------------------------------------------------------------------------


def room():
    """Glossy walls, a rough glass ball, and a thin pane that lets light through from behind."""
    b = builder(eye=(0, -0.9, 0.3), target=(0, 0, -0.3), field_of_view=80)
    cube(b, Mix(0.3, Diffuse((0.7, 0.6, 0.5)), Glossy((0.6, 0.6, 0.6), 0.3)))
    sphere(b, Glass(roughness=0.3), (0.4, 0.4, -0.6), 0.35)
    cube(b, Add(Translucent((0.6, 0.3, 0.3)), Diffuse((0.3, 0.3, 0.3))), np.diag([0.01, 0.4, 0.4, 1.0]))
    return b


def lamps():
    """One function for each of some lamps that adds it to a room."""
    rng = np.random.default_rng(9)
    places, axes = 1.6 * rng.random((16, 3)) - 0.8, frames(rng, 16)

    def lamp(i):
        to_world = np.eye(4)
        to_world[:3, :3], to_world[:3, 3] = axes[i], places[i]
        power = 5.0 * rng.random(3) + 1.0
        return [
            lambda b: b.point_light("point", places[i], power),
            lambda b: b.point_light("ball", places[i], power, radius=0.1, soft=False),
            lambda b: b.spot_light("spot", to_world, 4.0 * power, 0.02, 1.2, 0.3),
            lambda b: b.area_light("area", to_world, power, 0.3, 0.2, spread=2.0),
        ][i % 4]

    return [lamp(i) for i in range(16)]


def test_lamps_together_shine_as_the_sum_of_each_alone():
    """Each alone is chosen without the tree."""
    options = {"size": 16, "samples": 256, "max_bounces": 2, "clamp_indirect": 0.0}
    together, alone = room(), 0.0
    for i, add in enumerate(lamps()):
        add(together)
        one = room()
        add(one)
        alone = alone + picture(one, seed=i + 1, **options)
    all_lamps = picture(together, seed=100, **{**options, "samples": 2048})
    mean, error = mean_and_error(all_lamps - alone)
    assert (np.abs(mean) < 4.0 * error).all()
    assert error.max() < 0.01 * all_lamps[..., :3].mean()


@pytest.mark.parametrize("surface", [Translucent((0.8, 0.6, 0.4)), Glass(roughness=0.8), Refraction(roughness=0.8)])
def test_lamps_behind_a_surface_shine_through_it(surface):
    """Points, which only light sampling finds; all of them are behind."""
    pictures = []
    for chosen in ([0, 1, 2], [0], [1], [2]):
        b = builder(eye=(0, -0.1, 2), target=(0, 0, 0), field_of_view=50)
        plane(b, surface)
        for i in chosen:
            b.point_light("lamp", (0.4 * i - 0.4, 0.3 * i, -1.0), (30, 20, 10))
        pictures.append(picture(b, samples=1024, max_bounces=1, seed=len(pictures)).astype(float))
    together, alone = pictures[0], sum(pictures[1:])
    mean, error = mean_and_error(together - alone)
    assert (np.abs(mean) < 4.0 * error + 1e-6 * alone[..., :3].mean()).all()
    assert error.max() < 0.02 * alone[..., :3].mean()


def test_many_emitters_are_found_as_by_luck():
    """MIS on both sides: what scattering finds is weighed with the probability that the tree would have had."""
    b = room()
    rng = np.random.default_rng(10)
    for i, (place, axes) in enumerate(zip(1.5 * rng.random((24, 3)) - 0.75, frames(rng, 24), strict=True)):
        emission = Emission(tuple(0.2 + rng.random(3)), 10.0)
        if i % 2:
            sphere(b, emission, place, 0.08)
        else:
            to_world = np.eye(4)
            to_world[:3, :3], to_world[:3, 3] = axes * [0.1, 0.15, 0.01], place
            cube(b, emission, to_world)
    options = {"size": 24, "samples": 256, "max_bounces": 4, "clamp_indirect": 0.0}
    pictures = [picture(b, integrator=kind, seed=int(kind), **options) for kind in IntegratorKind]
    mean, error = mean_and_error(pictures[0] - pictures[1])
    assert (np.abs(mean) < 4.0 * error).all()
    assert error.max() < 0.02 * pictures[0][..., :3].mean()
