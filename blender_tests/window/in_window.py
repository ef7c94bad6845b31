# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside a Blender with a window: presses keys, looks at the screen, and writes down what happened.

    blender --python in_window.py -- FOLDER STORY

STORY is a function below, a generator: between its steps Blender draws and works. What it notes goes to
FOLDER/notes.json when it ends; pictures of the screen go to FOLDER too. Blender ends after the story.
"""

import json
import re
import subprocess
import sys
import time
import traceback
from pathlib import Path

import bpy

STEP_S = 0.05
notes = {}


# ---- Stories ---------------------------------------------------------------------------------------------------------


def f12():
    """A picture from the first tile to the last."""
    colourful_scene(samples=64)
    yield from press("F12")
    yield from until(lambda: "completed" in notes, 240)
    yield from look("finished.png")


def escape():
    """A picture that would take hours, rough at first; Esc ends it."""
    colourful_scene(samples=1_000_000)
    yield from press("F12")
    yield from until(lambda: samples_done() >= 4, 240)
    yield from look("rough.png")
    yield from press("Escape")
    yield from until(lambda: "cancelled" in notes, 60)
    notes["escape_s"] = notes["cancelled"] - notes["pressed"]
    yield from until(lambda: not bpy.app.is_job_running("RENDER"), 10)  # the job ends after its handlers
    yield from look("cancelled.png")


def panels():
    """Every tab of the properties editor, for everything that has data of its own, with Lambent as the engine."""
    scene = colourful_scene(samples=4)
    area = next(area for area in bpy.context.screen.areas if area.type == "PROPERTIES")
    for tab in ("RENDER", "OUTPUT", "VIEW_LAYER", "SCENE", "WORLD"):
        yield from open_tab(area, tab)
    bpy.data.objects["Light"].data.type = "AREA"
    for name in ("Cube", "Light", "Camera"):
        bpy.context.view_layer.objects.active = bpy.data.objects[name]
        for tab in ("OBJECT", "DATA", "MATERIAL") if name == "Cube" else ("OBJECT", "DATA"):
            yield from open_tab(area, tab, name)
    scene.render.engine = "BLENDER_EEVEE"
    yield from open_tab(area, "RENDER", "eevee")


def open_tab(area, tab, name=""):
    area.spaces.active.context = tab
    notes.setdefault("tabs", []).append(tab)
    yield from look(f"panels_{tab}_{name}.png".lower().replace("_.", "."))


def rendered_viewport():
    """The viewport shows what is rendered, follows the view and the scene, rests during F12, and ends when left."""
    scene = colourful_scene(samples=16)
    scene.lambent.viewport_samples = 8
    area = next(area for area in bpy.context.screen.areas if area.type == "VIEW_3D")
    area.spaces.active.overlay.show_overlays = False
    area.spaces.active.region_3d.view_perspective = "CAMERA"
    bpy.context.preferences.view.render_display_type = "NONE"

    shading = area.spaces.active.shading
    shading.light, shading.color_type = "FLAT", "MATERIAL"  # of the solid view, to compare with
    bpy.data.objects["Cube"].active_material.diffuse_color = (*CUBE, 1)

    shading.type = "RENDERED"
    yield from until(
        lambda: [text[:10] for text in viewport_texts()] == ["Sample 8/8"], 240
    )  # kernels may have to be compiled
    for view in ("CAMERA", "PERSP", "ORTHO"):
        area.spaces.active.region_3d.view_perspective = view
        yield from look_at_viewport(f"{view}.png")
        shading.type = "SOLID"
        yield from look(f"{view}_solid.png")
        shading.type = "RENDERED"
    bpy.data.objects["Cube"].scale = (0.3, 0.3, 0.3)
    yield from look_at_viewport("smaller.png")
    bpy.data.objects["Cube"].hide_set(True)
    yield from look_at_viewport("hidden.png")

    bpy.data.objects["Cube"].hide_set(False)
    scene.lambent.viewport_samples = 1_000_000
    yield from until(lambda: "/1000000" in viewport_texts()[0], 60)
    yield from press("F12")
    yield from until(lambda: "completed" in notes, 240)
    yield from until(lambda: "/1000000" in viewport_texts()[0], 60)
    shading.type = "SOLID"
    yield from until(lambda: viewport_texts() == [], 10)


def look_at_viewport(name):
    """When it has its last sample, of the scene as it is now."""
    yield from wait(0.5)
    yield from until(viewport_is_finished, 60)
    yield from look(name)


def viewport_is_finished():
    return [text[:10] for text in viewport_texts()] == ["Sample 8/8"]


def viewport_texts():
    """What the 3D views say that Lambent renders."""
    module = next((module for name, module in sys.modules.items() if name.endswith("lambent.viewport")), None)
    return [viewport.text for viewport in module._viewports] if module else []


def failure():
    """A scene that cannot be rendered: F12 ends with a message, and Blender goes on."""
    scene = colourful_scene(samples=4)
    camera, scene.camera = scene.camera, bpy.data.objects["Cube"]
    yield from press("F12")
    yield from wait(3.0)
    yield from until(lambda: not bpy.app.is_job_running("RENDER"), 60)
    yield from look("failed.png")
    notes["completed_without_camera"] = "completed" in notes
    scene.camera = camera
    yield from press("Escape")  # closes the message
    yield from wait(0.5)
    yield from press("F12", mouse=(900, 650))
    yield from look("again.png")
    yield from until(lambda: "completed" in notes, 240)


def close_while_compiling():
    """Blender is closed while kernels are being compiled in the background."""
    yield from wait(4.0)
    name = next(name for name in sys.modules if name.endswith("lambent.compile_cache"))
    notes["warm_up"] = sys.modules[name].status()


def samples_done():
    found = re.search(r"Sample (\d+)/", notes.get("status", ""))
    return int(found.group(1)) if found else 0


# ---- The scene -------------------------------------------------------------------------------------------------------

WORLD, CUBE = (0.0, 0.05, 0.8), (1.0, 0.5, 0.0)  # linear; on the screen as they are


def colourful_scene(samples):
    """A glowing cube before a blue world: two colours that nothing else on the screen has."""
    scene = bpy.context.scene
    scene.render.engine = "LAMBENT"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 480, 320, 100
    scene.view_settings.view_transform = "Standard"
    scene.lambent.samples = samples
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*WORLD, 1)
    cube = bpy.data.objects["Cube"]
    nodes = cube.active_material.node_tree.nodes
    nodes["Principled BSDF"].inputs["Base Color"].default_value = (0, 0, 0, 1)
    nodes["Principled BSDF"].inputs["Specular IOR Level"].default_value = 0.0
    nodes["Principled BSDF"].inputs["Emission Color"].default_value = (*CUBE, 1)
    nodes["Principled BSDF"].inputs["Emission Strength"].default_value = 1.0
    return scene


# ---- Steps -----------------------------------------------------------------------------------------------------------


def wait(seconds):
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        yield


def until(condition, timeout_s):
    end = time.perf_counter() + timeout_s
    while not condition():
        if time.perf_counter() > end:
            raise TimeoutError(f"{timeout_s} s; notes so far: {notes}")
        yield


# F12 by its number: by its name, xdotool would press it with Alt, which asks Blender for the sequencer.
KEYS = {"F12": "96", "Escape": "Escape"}


def press(key, mouse=(400, 400)):
    """As an artist would: a key of the keyboard, with the mouse over the window."""
    subprocess.run(["xdotool", "mousemove", *map(str, mouse)], check=True)
    yield from wait(0.2)
    notes["pressed"] = time.perf_counter()
    subprocess.run(["xdotool", "key", KEYS[key]], check=True)
    yield


def look(name):
    """Save what the screen shows, after Blender had time to draw it."""
    yield from wait(0.7)
    subprocess.run(["import", "-window", "root", str(folder / name)], check=True)


# ---- Telling the story -----------------------------------------------------------------------------------------------


def run(story):
    """Take steps from a timer, until the story ends; then close Blender."""

    def step():
        try:
            next(story)
            return STEP_S
        except StopIteration:
            notes["ended"] = True
        except Exception:
            notes["error"] = traceback.format_exc()
        (folder / "notes.json").write_text(json.dumps(notes))
        bpy.ops.wm.quit_blender()
        return None

    bpy.app.timers.register(step, first_interval=2.0)


def note(name, value):
    notes[name] = value


if __name__ == "__main__":
    folder = Path(sys.argv[-2])
    bpy.context.preferences.use_preferences_save = False
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.view.render_display_type = "SCREEN"  # the picture takes the whole window
    bpy.app.handlers.render_stats.append(lambda stats, *_: note("status", str(stats)))
    bpy.app.handlers.render_complete.append(lambda *_: note("completed", time.perf_counter()))
    bpy.app.handlers.render_cancel.append(lambda *_: note("cancelled", time.perf_counter()))
    run(globals()[sys.argv[-1]]())
