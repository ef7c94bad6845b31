# SPDX-License-Identifier: GPL-3.0-or-later
"""Render one picture inside Blender, the module or the program: `build.py render` starts this with a job.

    python tools/render_driver.py -- JOB             blender -b --python tools/render_driver.py -- JOB

JOB is the JSON of a dict: file, out, engine, and as wanted width, height, frame, samples, seed, threads, time_limit,
integrator, noise_target, sampler, use_adaptive. Lines that start with MARK and hold a JSON list are for build.py:
["progress", 0.5 or null, text], ["error", text], ["done", path, ...].
"""

import json
import os
import re
import sys
from pathlib import Path

import bpy

MARK = "lambent> "
ROOT = Path(__file__).resolve().parent.parent
FILE_FORMATS = {".png": "PNG", ".exr": "OPEN_EXR", ".jpg": "JPEG", ".jpeg": "JPEG", ".tif": "TIFF", ".tiff": "TIFF"}


class JobError(Exception):
    """Why there is no picture, for the user."""


def tell(*message):
    print(MARK + json.dumps(message), flush=True)


def main(job):
    enable_engine(job["engine"])
    try:
        bpy.ops.wm.open_mainfile(filepath=job["file"], load_ui=False, use_scripts=False)
    except RuntimeError as error:
        raise JobError(f"Blender cannot open {job['file']}: {error}") from None
    scene = bpy.context.scene
    prepare(scene, job)
    bpy.app.handlers.render_stats.append(on_stats)

    # ---- Render; the operator raises what the engine reports as an error, and then writes no file ----
    out = pictures_of(scene.render, Path(job["out"]))
    before = [written(path) for path in out]
    try:
        bpy.ops.render.render(write_still=True)
    except RuntimeError as error:
        raise JobError(re.sub(r"^Error: ", "", str(error).strip(), flags=re.MULTILINE)) from None
    for path, time in zip(out, before, strict=True):
        if written(path) == time:
            raise JobError(f"Blender rendered, but did not write {path}. Is the folder writable?")
    tell("done", *map(str, out))


def pictures_of(render, path):
    """The files that Blender writes: one, or one for each view of a stereo picture."""
    if not render.use_multiview or render.image_settings.views_format == "STEREO_3D":
        return [path]
    views = render.stereo_views if render.views_format == "STEREO_3D" else render.views
    return [path.with_name(path.stem + view.file_suffix + path.suffix) for view in views if view.use]


def written(path):
    """When, in nanoseconds; None if it is not there."""
    return path.stat().st_mtime_ns if path.exists() else None


def enable_engine(engine):
    """Cycles ships with Blender; Lambent is an extension in Blender, and in the module the sources beside us."""
    import addon_utils  # can be found only after bpy is imported

    if engine == "CYCLES":
        addon_utils.enable("cycles")
    elif bpy.app.module:
        sys.path.insert(0, str(ROOT))
        import addon

        addon.register()
    elif addon_utils.enable("bl_ext.user_default.lambent") is None:
        raise JobError("the installed extension does not load: see --verbose")


def prepare(scene, job):
    if scene.camera is None:
        raise JobError(f"{Path(job['file']).name} has no camera in its scene '{scene.name}'")
    render = scene.render
    render.engine = job["engine"]
    if job.get("frame") is not None:
        scene.frame_set(job["frame"])
    if job.get("width"):
        render.resolution_x, render.resolution_y = job["width"], job["height"]
        render.resolution_percentage = 100
    if render.use_border and (render.border_max_x <= render.border_min_x or render.border_max_y <= render.border_min_y):
        raise JobError(f"the render region of scene '{scene.name}' is empty: see Output Properties > Render Region")
    if job.get("threads"):
        render.threads_mode, render.threads = "FIXED", job["threads"]

    settings = scene.cycles if job["engine"] == "CYCLES" else scene.lambent
    for name in ("samples", "seed", "time_limit"):
        if job.get(name) is not None:
            setattr(settings, name, job[name])
    for name in ("noise_target", "sampler", "use_adaptive"):
        if job.get(name) is not None:
            if job["engine"] == "CYCLES":
                raise JobError(f"{name.replace('_', ' ')} is a setting of Lambent's, not of Cycles'")
            setattr(settings, name, job[name])
    if job.get("integrator"):
        choose_integrator(settings, job["integrator"])

    image = render.image_settings
    if hasattr(image, "media_type"):  # a file that was saved for video output refuses PNG otherwise
        image.media_type = "IMAGE"
    image.file_format = FILE_FORMATS[Path(job["out"]).suffix.lower()]
    render.filepath = job["out"]
    render.use_file_extension = False
    render.use_lock_interface = True


def choose_integrator(settings, name):
    if "integrator" not in settings.bl_rna.properties:
        raise JobError("Cycles has no choice of integrators; they are Lambent's")
    items = [item.identifier for item in settings.bl_rna.properties["integrator"].enum_items]
    names = {item.lower().replace("_", "-"): item for item in items}
    if name.lower().replace("_", "-") not in names:
        raise JobError(f"there is no integrator {name}; there are: {', '.join(names)}")
    settings.integrator = names[name.lower().replace("_", "-")]


def on_stats(stats, _=None):
    """Blender's line of the status, such as `Mem:9.25M | Scene, RenderLayer | Sample 3/16`."""
    sample = re.search(r"Sample (\d+)/(\d+)", stats)
    parts = [part for part in stats.split(" | ") if not re.match(r"Fra:|Mem:|Time:", part)]
    tell("progress", int(sample.group(1)) / max(int(sample.group(2)), 1) if sample else None, " | ".join(parts))


if __name__ == "__main__":
    code = 1
    try:
        main(json.loads(sys.argv[sys.argv.index("--") + 1]))
        code = 0
    except JobError as error:
        tell("error", str(error).strip())
    except Exception as error:
        import traceback

        traceback.print_exc()
        tell("error", f"{type(error).__name__}: {error} (more with --verbose)")
    # not sys.exit: Blender 4.5 as a module can hang in its destructors when a process ends in the ordinary way
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
