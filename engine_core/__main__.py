# SPDX-License-Identifier: GPL-3.0-or-later
"""python -m engine_core render SCENE | info SCENE: scene files without Blender."""

import argparse
import sys
import time
from pathlib import Path

from .film.output import FORMATS, save_image
from .integrator import status
from .integrator.tiles import Render
from .scene.checks import SceneError
from .scene.files import load_scene
from .settings import IntegratorKind, SamplerKind


def main(arguments=None):
    """Run the command line; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m engine_core", description="Render Lambent's scene files.")
    commands = parser.add_subparsers(dest="command", required=True)
    render = commands.add_parser("render", help="render a scene file to a picture")
    render.add_argument("scene")
    render.add_argument("-o", "--output", help="picture: .png, .exr, .ppm or .npy (default: the scene's name, .png)")
    render.add_argument("--samples", type=int, help="samples per pixel")
    render.add_argument("--seed", type=int)
    render.add_argument("--sampler", choices=[kind.name.lower() for kind in SamplerKind])
    render.add_argument("--uniform", action="store_true", help="as many samples for each pixel: no adaptive sampling")
    render.add_argument("--guiding", action=argparse.BooleanOptionalAction, help="paths learn from those before them")
    render.add_argument("--noise-target", type=float, metavar="PERCENT", help="stop when the noise is that low")
    render.add_argument("--integrator", choices=[kind.name.lower() for kind in IntegratorKind])
    render.add_argument("--threads", type=int, default=0, help="default: one for each processor")
    render.add_argument("--time-limit", type=float, default=0.0, metavar="SECONDS")
    info = commands.add_parser("info", help="tell what is in a scene file")
    info.add_argument("scene")
    options = parser.parse_args(arguments)
    try:
        return render_file(options) if options.command == "render" else print_info(options.scene)
    except (SceneError, OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1


def render_file(options):
    scene, settings = load_scene(options.scene)
    changes = {name: getattr(options, name) for name in ("samples", "seed") if getattr(options, name) is not None}
    if options.integrator:
        changes["integrator"] = int(IntegratorKind[options.integrator.upper()])
    if options.sampler:
        changes["sampler"] = int(SamplerKind[options.sampler.upper()])
    if options.uniform:
        changes["adaptive"] = 0
    if options.guiding is not None:
        changes["guiding"] = int(options.guiding)
    if options.noise_target is not None:
        changes["noise_target"] = options.noise_target / 100.0
    output = options.output or options.scene.rsplit(".", 1)[0] + ".png"
    check_output(output)
    render = Render(scene, settings._replace(**changes), options.threads, options.time_limit)
    render.start()
    print("Compiling kernels, if this is the first time ...", file=sys.stderr)
    while render.is_running:
        if render.finished_tiles(timeout_s=1.0):
            print("\r" + progress_line(render), end="", file=sys.stderr, flush=True)
            time.sleep(0.2)
    render.wait()
    print("\r" + progress_line(render), file=sys.stderr)
    save_image(output, render.image("Combined"), status.metadata(render))
    print(f"{output}: {status.text(render)}, in {render.elapsed_s:.1f} s")
    return 0


def check_output(path):
    """Refuse before the render what could not be written after it. Raises ValueError."""
    path = Path(path)
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: a picture ends in one of {', '.join(FORMATS)}")
    if not path.parent.is_dir():
        raise ValueError(f"there is no folder {path.parent} to write {path.name} into")


def progress_line(render):
    remaining = render.remaining_s
    left = "" if remaining is None else f", {remaining:.0f} s left"
    return f"{render.progress:4.0%}  {status.text(render)}{left}      "


def print_info(path):
    scene, settings = load_scene(path)
    for name, table in scene.tables().items():
        print(f"{name:12} {len(table):9,} rows {table.nbytes / 2**20:9.1f} MiB")
    for name, value in settings._asdict().items():
        print(f"{name:24} {value}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
