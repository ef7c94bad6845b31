# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's worlds in Lambent and in Cycles, as small pictures on a page: `python3 build.py gallery`.

What was measured is kept in `gallery.json` beside the page, so that single worlds can be rendered anew (`--only`).
"""

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image
from rich.console import Console

from blender_tests.helpers.engines import open_for_both, render

from .compare import mean
from .gallery_worlds import BOOKS, FIGURES, SHADERS, WORLDS
from .quiet import leave, progress_bar, quiet_blender
from .sheet import flip, shown

SCENES = Path(__file__).parents[2] / "scenes_blend"
WIDE, SQUARE = 320, 240  # pixels across
SAMPLES, SEED = 64, 1
NAMES = {"PATH": "path", "MIXTURE": "mixture PDF", "BRUTE_FORCE": "brute force"}

HEAD = """# Gallery

The figures of A. Desai, *Ray Tracing in Python* (2021), and the last pictures of the three books of P. Shirley that it
follows, rendered by Lambent and by Cycles from the same files, those in [scenes_blend](../../scenes_blend). Open one of
them in Blender, and press F12. All on this page is made by

    python3 build.py gallery

and single worlds by `--only NAME`. Seconds are those of all processors together, for the whole picture and not for the
same noise, so they tell an order of magnitude; [figures.md](../figures.md) has measurements. The difference is
[FLIP](https://research.nvidia.com/publication/2020-07_flip): how different the two pictures look, black not at all.
Both are noisy, each by its own noise, so it is nowhere 0; means of the pictures tell whether they shine alike.
"""


# ---- Rendering -------------------------------------------------------------------------------------------------------


def render_world(world, folder, samples, tell):
    """Write the pictures of a world; returns what was measured of them, for `page`."""
    scene = open_for_both(SCENES / f"{world.scene}.blend", size_of(world))
    samples, pictures, measured = world.samples or samples, {}, {}
    jobs = [("LAMBENT", kind) for kind in world.integrators or (scene.lambent.integrator,)] + [("CYCLES", "")]
    with tempfile.TemporaryDirectory() as temporary:
        for number, (engine, integrator) in enumerate(jobs):
            name = picture_name(engine, integrator)
            tell(number / len(jobs), name)
            scene.lambent.integrator = integrator or "PATH"
            render(engine, scene, 1)  # what is done once, such as compiling, shall not count
            path = Path(temporary, f"{name}.png")

            def progress(fraction, number=number, name=name):
                tell((number + fraction) / len(jobs), name)

            uniform = bool(world.integrators)  # a figure that compares ways to sample
            done = render(engine, scene, samples, SEED, progress=progress, display=path, adaptive=not uniform)
            pictures[name] = shown(path)
            measured[name] = {"samples": samples, "cpu_s": round(done.cpu_s, 2), "mean": mean(done.picture)}
    ours, theirs = pictures[picture_name(*jobs[0])], pictures["cycles"]
    pictures["flip"], value = flip(theirs, ours)
    measured["flip"] = {"mean": value}
    for name, picture in pictures.items():
        save(folder / f"{world.stem}_{name}.png", picture)
    return measured


def picture_name(engine, integrator):
    return "cycles" if engine == "CYCLES" else f"lambent_{integrator.lower()}"


def size_of(world):
    """Pixels, by the format of the file."""
    scene = open_for_both(SCENES / f"{world.scene}.blend")
    aspect = scene.render.resolution_y / scene.render.resolution_x
    width = SQUARE if aspect == 1.0 else WIDE
    return width, round(width * aspect)


def save(path, picture):
    """A PNG of 256 colours, which are enough for a small picture, and a third of the bytes."""
    pixels = Image.fromarray((np.clip(picture, 0, 1) * 255 + 0.5).astype(np.uint8))
    palette = pixels.quantize(256)
    pixels.quantize(256, palette=palette, dither=Image.Dither.FLOYDSTEINBERG).save(path, optimize=True)


# ---- The page --------------------------------------------------------------------------------------------------------


def page(measured, groups=(("The paper", FIGURES), ("The books", BOOKS), ("Shaders", SHADERS))):
    """Markdown with the worlds that were rendered, in the paper's order."""
    parts = [HEAD]
    for title, worlds in groups:
        parts.append(f"## {title}\n")
        parts += [section(world, measured[world.stem]) for world in worlds if world.stem in measured]
    return "\n".join(parts)


def section(world, measured):
    """A world with its caption, a table of its pictures, and a note."""
    columns = [name for name in measured if name != "flip"]
    ours, theirs = measured[columns[0]], measured["cycles"]
    bias = ours["mean"] / theirs["mean"] - 1.0
    heads, pictures, lines = [], [], []
    for name in columns:
        heads.append(head(name))
        pictures.append(f"![{world.scene}, {head(name)}]({world.stem}_{name}.png)")
        lines.append(f"{measured[name]['samples']} samples, {measured[name]['cpu_s']:.3g} s")
    heads.append("difference")
    pictures.append(f"![{world.scene}, difference]({world.stem}_flip.png)")
    lines.append(f"FLIP {measured['flip']['mean']:.3f}, means {bias:+.2%}")
    rows = [heads, ["---"] * len(heads), pictures, lines]
    table = "\n".join(f"| {' | '.join(row)} |" for row in rows)
    file = f"`{world.scene}.blend`"
    note = f"{world.note} " if world.note else ""
    return f"### {world.title}\n\n> {world.caption}\n\n{table}\n\n{note}({file})\n"


def head(name):
    return "Cycles" if name == "cycles" else f"Lambent, {NAMES[name.removeprefix('lambent_').upper()]}"


# ---- The command -----------------------------------------------------------------------------------------------------


def main():
    options = parse()
    chosen = [world for world in WORLDS if not options.only or {world.scene, world.stem} & set(options.only)]
    kept = options.output / "gallery.json"
    measured = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
    with quiet_blender() as blender:
        console = Console(file=blender.terminal, highlight=False)
        with progress_bar(console) as tell:
            for number, world in enumerate(chosen):

                def progress(fraction, text, number=number, world=world):
                    tell((number + fraction) / len(chosen), f"{world.stem}, {text}")

                measured[world.stem] = render_world(world, options.output, options.samples, progress)
                ordered = {world.stem: measured[world.stem] for world in WORLDS if world.stem in measured}
                kept.write_text(json.dumps(ordered, indent=1) + "\n", encoding="utf-8")
                (options.output / "README.md").write_text(page(measured), encoding="utf-8")
        for warning in blender.warnings():
            console.print(f"[yellow]{warning}", soft_wrap=True)
        console.print(f"{options.output / 'README.md'}", soft_wrap=True)
    return 0


def parse():
    parser = argparse.ArgumentParser(prog="python3 build.py gallery", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--samples", type=int, default=SAMPLES)
    parser.add_argument("--only", action="append", default=[])
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    known = {name for world in WORLDS for name in (world.scene, world.stem)}
    for name in options.only:
        if name not in known:
            parser.error(f"there is no world {name}; there are {', '.join(sorted({w.scene for w in WORLDS}))}")
    return options


if __name__ == "__main__":
    leave(main)
