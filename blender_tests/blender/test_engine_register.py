# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on comes and goes without traces, and what it offers fits the engine."""

import subprocess
import sys

import bpy
import pytest

import addon
from addon import properties, result
from addon.ui import blender_panels, copy_from_cycles
from blender_tests.helpers.small_blend import enable_cycles, small_scene
from engine_core.film import passes
from engine_core.settings import FilterKind, IntegratorKind, Settings


def compatible_panels():
    """{name of a panel: engines}"""
    panels = [panel for panel in bpy.types.Panel.__subclasses__() if hasattr(panel, "COMPAT_ENGINES")]
    return {panel.__name__: set(panel.COMPAT_ENGINES) for panel in panels if not panel.__module__.startswith("addon")}


def has_engine():
    engines = [cls for cls in bpy.types.RenderEngine.__subclasses__() if cls.is_registered]
    return "LAMBENT" in {getattr(cls, "bl_idname", None) for cls in engines}


def test_unregistering_leaves_nothing_behind():
    before = compatible_panels()
    handlers = len(bpy.app.handlers.render_init)
    for _ in range(2):
        addon.register()
        assert has_engine()
        addon.unregister()
        assert not has_engine()
        assert not hasattr(bpy.types.Scene, "lambent")
        assert not hasattr(bpy.types, "LAMBENT_RENDER_PT_sampling")
        assert compatible_panels() == before
        assert len(bpy.app.handlers.render_init) == handlers


def test_registering_again_is_harmless(registered):
    addon.register()
    assert has_engine()
    assert len([handler for handler in bpy.app.handlers.render_init if handler.__module__.startswith("addon")]) == 1


def test_a_register_that_fails_half_way_takes_back_what_it_did(monkeypatch):
    def fail():
        raise RuntimeError("no panels today")

    with monkeypatch.context() as patch:
        patch.setattr(addon.ui, "register", fail)
        with pytest.raises(RuntimeError, match="no panels today"):
            addon.register()
    assert not has_engine()
    addon.register()
    addon.unregister()


def test_blender_starts_without_loading_numba():
    """numba takes 0.3 s to import, which nobody should wait for who does not render."""
    code = "import sys, os, bpy, addon; addon.register(); print('numba' in sys.modules, flush=True); os._exit(0)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.stdout.split()[-1] == "False", run.stderr


# ---- Properties ------------------------------------------------------------------------------------------------------


def test_choices_are_those_of_the_engine():
    for items, kind in ((properties.INTEGRATORS, IntegratorKind), (properties.FILTERS, FilterKind)):
        assert {(identifier, number) for identifier, _, _, number in items} == {(k.name, k.value) for k in kind}


def test_an_untouched_scene_asks_for_the_default_settings(registered):
    from addon.session import settings_from

    scene = small_scene()
    scene.lambent.property_unset("samples")
    crop = result.Crop(0, 0, 512, 512, 512, 512)
    given, default = settings_from(scene, crop), Settings()
    assert given._asdict() == pytest.approx(default._asdict())


def test_denoisers_get_pixels_that_share_no_samples(registered):
    from addon.session import settings_from

    scene = small_scene()
    crop = result.Crop(0, 0, 512, 512, 512, 512)
    assert settings_from(scene, crop).share_samples == 1
    scene.view_layers[0].lambent.use_pass_denoising_data = True
    assert settings_from(scene, crop).share_samples == 0
    scene.view_layers[0].lambent.use_pass_denoising_data = False

    inner, outer = (bpy.data.node_groups.new(name, "CompositorNodeTree") for name in ("Inner", "Outer"))
    outer.nodes.new("CompositorNodeGroup").node_tree = inner
    if hasattr(scene, "compositing_node_group"):
        scene.compositing_node_group = outer
    else:
        scene.use_nodes = True
        scene.node_tree.nodes.new("CompositorNodeGroup").node_tree = outer
    assert settings_from(scene, crop).share_samples == 1
    node = inner.nodes.new("CompositorNodeDenoise")
    assert settings_from(scene, crop).share_samples == 0
    node.mute = True
    assert settings_from(scene, crop).share_samples == 1


def test_every_pass_of_the_engine_can_be_had():
    assert {name: channels for name, (channels, _, _) in result.PASSES.items()} == {
        name: channels for name, (channels, _) in passes.PASSES.items()
    }


# ---- Panels ----------------------------------------------------------------------------------------------------------


def test_blender_still_has_the_panels_that_we_count_on():
    """They are named by their classes, which a new Blender may rename; then they would be missing silently."""
    names = set(compatible_panels())
    assert names >= blender_panels.BORROWED


@pytest.mark.parametrize(
    "panel",
    [
        "RENDER_PT_format", "RENDER_PT_output", "RENDER_PT_color_management", "RENDER_PT_post_processing",
        "RENDER_PT_stamp", "DATA_PT_lens", "DATA_PT_camera_dof", "DATA_PT_EEVEE_light", "DATA_PT_spot",
        "EEVEE_MATERIAL_PT_context_material", "WORLD_PT_context_world", "OBJECT_PT_visibility", "VIEWLAYER_PT_layer",
    ],
)  # fmt: skip
def test_blenders_own_panel_stays(registered, panel):
    assert "LAMBENT" in compatible_panels()[panel]


def test_panels_stand_in_one_place_only(registered):
    """Where we have a panel of our own, Blender's is not there too."""
    ours = {(cls.bl_context, cls.bl_label) for cls in addon.ui.CLASSES if hasattr(cls, "bl_context")}
    theirs = {
        (getattr(panel, "bl_context", ""), panel.bl_label)
        for panel in bpy.types.Panel.__subclasses__()
        if "LAMBENT" in getattr(panel, "COMPAT_ENGINES", ()) and not panel.__module__.startswith("addon")
    }
    assert ours & theirs == {("data", "Beam Shape")}  # Blender's is for spots, ours for area lights


# ---- Settings of Cycles ----------------------------------------------------------------------------------------------


def test_settings_of_cycles_are_taken_over(registered):
    enable_cycles()
    scene = small_scene()
    given = {
        "samples": 77, "seed": 5, "max_bounces": 3, "diffuse_bounces": 2, "transparent_max_bounces": 9,
        "sample_clamp_indirect": 4.5, "caustics_reflective": False, "film_exposure": 2.0, "filter_width": 2.5,
        "pixel_filter_type": "GAUSSIAN", "time_limit": 30.0,
    }  # fmt: skip
    for name, value in given.items():
        setattr(scene.cycles, name, value)

    assert bpy.ops.lambent.copy_from_cycles() == {"FINISHED"}

    taken = {name: getattr(scene.lambent, ours) for name, ours in copy_from_cycles.SAME_MEANING.items()}
    taken["pixel_filter_type"] = scene.lambent.filter_type
    assert {name: taken[name] for name in given} == given


def test_every_setting_to_take_over_exists_on_both_sides(registered):
    enable_cycles()
    scene = bpy.context.scene
    for theirs, ours in copy_from_cycles.SAME_MEANING.items():
        assert hasattr(scene.cycles, theirs), theirs
        assert hasattr(scene.lambent, ours), ours
