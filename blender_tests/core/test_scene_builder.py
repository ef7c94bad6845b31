# SPDX-License-Identifier: GPL-3.0-or-later
"""SceneBuilder: input that is wrong is named; the same thing said in two ways gives the same picture."""

import numpy as np
import pytest

from blender_tests.helpers.scenes import CUBE_CORNERS, CUBE_TRIANGLES, builder, cube, picture, sphere
from engine_core.scene.builder import SceneBuilder
from engine_core.scene.checks import SceneError
from engine_core.scene.flattening import flatten, lower
from engine_core.scene.materials import Add, Black, Diffuse, Emission, Glossy, Mix, Principled
from engine_core.settings import IntegratorKind
from engine_core.tables import LobeKind, Visibility


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"positions": np.full((8, 3), np.nan)}, "not finite"),
        ({"positions": CUBE_CORNERS * 1e20}, "beyond"),
        ({"positions": CUBE_CORNERS[:, :2]}, "shape"),
        ({"triangles": CUBE_TRIANGLES + 1}, "there are 8"),
        ({"triangles": CUBE_TRIANGLES - 1}, "from -1"),
        ({"normals": np.zeros((3, 3, 3))}, "shape"),
        ({"uvs": np.full((12, 3, 2), np.inf)}, "not finite"),
        ({"slots": np.full(12, -1)}, "slots"),
    ],
)
def test_wrong_meshes_are_refused_by_name(change, complaint):
    arguments = {"positions": CUBE_CORNERS, "triangles": CUBE_TRIANGLES, **change}
    with pytest.raises(SceneError, match=f"Suzanne.*{complaint}"):
        SceneBuilder().mesh("Suzanne", **arguments)


def test_a_scene_without_camera_is_refused():
    with pytest.raises(SceneError, match="no camera"):
        SceneBuilder().build()


def test_a_transform_of_nonsense_is_refused_by_name():
    b = builder()
    cube(b, Diffuse(), np.full((4, 4), np.nan), name="Broken")
    with pytest.raises(SceneError, match="Broken"):
        b.build()


def test_a_flat_object_is_left_out_with_a_warning():
    b = builder()
    cube(b, Diffuse(), np.diag([1.0, 1.0, 0.0, 1.0]), name="Pancake")
    b.background((1, 1, 1))
    scene = b.build()
    assert any("Pancake" in warning for warning in b.warnings)
    assert len(scene.triangles) == 0


def test_an_empty_scene_shows_its_background():
    b = builder()
    b.background((0.25, 0.5, 0.75))
    image = picture(b, size=4, samples=1)
    np.testing.assert_allclose(image[..., :3], np.broadcast_to((0.25, 0.5, 0.75), (4, 4, 3)), rtol=1e-6)


SHEAR = np.array([[1.0, 0.4, 0, 0.2], [0, 0.8, 0, 0], [0, 0.3, -0.7, 0.1], [0, 0, 0, 1]])


@pytest.mark.parametrize("matrix", [np.diag([0.7, 0.5, 0.9, 1.0]), SHEAR], ids=["scaled", "sheared and mirrored"])
@pytest.mark.parametrize(
    ("surface", "integrator"),
    [
        (Diffuse((0.7, 0.5, 0.3)), IntegratorKind.PATH),
        # without light sampling, which would choose the far cube now and then
        (Add(Diffuse((0.5, 0.5, 0.5)), Emission()), IntegratorKind.BRUTE_FORCE),
    ],
    ids=["diffuse", "emissive"],
)
def test_instances_look_as_if_they_stood_in_the_world(matrix, surface, integrator):
    """The same mesh in the world's tree, and behind a transform (since a second instance is far away).

    Smooth where the transform lets its normals be of one length, for those in the world are made unit, as in Cycles.
    """
    normals = None if matrix is SHEAR else CUBE_CORNERS[CUBE_TRIANGLES] / np.sqrt(3.0)
    pictures = []
    for shared in (False, True):
        b = builder(eye=(0.5, -4, 1.5))
        material = b.material("m", surface, one_sided_emission=True)
        mesh = b.mesh("cube", CUBE_CORNERS, CUBE_TRIANGLES, normals=normals)
        b.instance(mesh, matrix, [material])
        if shared:
            far = np.eye(4)
            far[:3, 3] = 0, -1e4, 0
            b.instance(mesh, far, [material])
        b.background((0.3, 0.3, 0.3))
        b.sun_light("Sun", (0.3, 1, -1), (1, 1, 1))
        pictures.append(picture(b, size=32, samples=64, integrator=integrator))
    assert pictures[0][..., :3].std() > 0.03
    # rays meet the same places up to rounding; only at an outline may one of 64 samples miss what the other hits
    difference = np.abs(pictures[1] - pictures[0])
    assert np.quantile(difference, 0.99) < 1e-5
    assert difference.mean() < 1e-3


def test_objects_invisible_to_the_camera_still_light():
    b = builder(eye=(0, -4, 0))
    sphere(b, Diffuse((0.8, 0.8, 0.8)), (0, 0, -1), 0.5)
    sphere(b, Emission((1, 1, 1), 5.0), (0, 0, 1), 0.5, visibility=Visibility.ALL & ~Visibility.CAMERA)
    image = picture(b, size=32, samples=16)
    assert image[18:, :, :3].max() == 0.0
    assert image[:16, :, :3].max() > 0.1


def test_slots_beyond_the_last_use_the_last():
    b = builder(eye=(0, -4, 0), field_of_view=10)
    red = b.material("red", Emission((1, 0, 0)))
    mesh = b.mesh("cube", CUBE_CORNERS, CUBE_TRIANGLES, slots=np.full(12, 7))
    b.instance(mesh, materials=[b.material("blue", Emission((0, 0, 1))), red])
    np.testing.assert_allclose(picture(b, size=4, samples=1)[..., :3], np.broadcast_to((1, 0, 0), (4, 4, 3)))


# ---- Closures become lobes -------------------------------------------------------------------------------------------


def lobes_of(surface):
    """(rows of LOBE, names of those for which there was no room) of a constant closure."""
    return lower([row for row, _ in flatten(surface).closures])


def test_mix_and_add_weigh_lobes_and_emission():
    surface = Mix(0.25, Add(Diffuse((1, 1, 1)), Emission((2, 0, 0), 3.0)), Glossy((0.5, 0.5, 0.5)))
    lobes, dropped = lobes_of(surface)
    assert [LobeKind(k) for k in lobes.kind] == [LobeKind.DIFFUSE, LobeKind.CONDUCTOR]
    np.testing.assert_allclose(lobes.weight, [[0.75] * 3, [0.25] * 3], rtol=1e-6)
    np.testing.assert_allclose(flatten(surface).emission, [4.5, 0, 0], rtol=1e-6)
    assert not dropped


def test_equal_lobes_merge_and_too_many_are_told():
    tower = Black()
    for i in range(12):
        tower = Add(tower, Mix(0.5, Diffuse((0.01, 0.01, 0.01)), Glossy((0.1, 0.1, 0.1), roughness=0.05 * (i + 1))))
    lobes, dropped = lobes_of(tower)
    assert len(lobes) == 8
    assert len(dropped) == 5
    np.testing.assert_allclose(lobes.weight[lobes.kind == LobeKind.DIFFUSE].sum(), 12 * 0.5 * 0.01 * 3, rtol=1e-4)


def test_principled_parts_share_out_the_weight():
    lobes, _ = lobes_of(Principled(base_color=(1, 1, 1), metallic=0.5, transmission=0.5, alpha=0.8))
    weights = {LobeKind(lobe["kind"]): lobe["weight"][0] for lobe in lobes}
    expected = {
        LobeKind.TRANSPARENT: 0.2,
        LobeKind.CONDUCTOR: 0.4,
        LobeKind.DIELECTRIC: 0.2,
        LobeKind.COATING: 0.2,
        LobeKind.DIFFUSE: 0.2,
    }
    assert weights == pytest.approx(expected)
