# SPDX-License-Identifier: GPL-3.0-or-later
"""How fast Lambent is: `python3 build.py bench [PART ...] [--json FILE]`.

Each part is a module here with `run(quick) -> dict`: figures, or dicts of figures. Nothing is asserted about times;
what can be compared is measured side by side in one run and given as a ratio.
"""

import argparse
import importlib
import json
import os
import sys
import time
import traceback
from pathlib import Path

from rich.console import Console
from rich.table import Table

from .quiet import progress_bar, quiet_blender

SCENES = Path(__file__).parents[2] / "scenes_blend"
WITH_SCENES = ("noise", "volumes")
PARTS = (
    "rays",
    "scaling",
    "noise",
    "volumes",
    "integrators",
    "profile",
    "textures",
    "materials",
    "compile",
    "export",
    "build",
    "large",
    "leaks",
)


def main():
    options = parse()
    with quiet_blender() as blender:
        return measure(options, Console(file=blender.terminal))


def measure(options, console):
    results, failed = {}, []
    for part in options.parts or PARTS:
        console.print(f"[bold]{part}[/] ...")
        began = time.perf_counter()
        try:
            results[part] = run(part, options, console)
        except Exception:
            traceback.print_exc()
            failed.append(part)
        else:
            console.print(table(part, results[part]), f"{time.perf_counter() - began:.0f} s\n")
        if options.json:  # after each part, so that a late failure takes nothing away
            options.json.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    if options.json:
        console.print(f"The figures are in {options.json}")
    if failed:
        console.print(f"[red]failed: {', '.join(failed)}")
    return 1 if failed else 0


def run(part, options, console):
    module = importlib.import_module(f".{part}", __package__)
    if part not in WITH_SCENES:
        return module.run(options.quick)
    with progress_bar(console) as tell:
        return module.run(options.quick, options.scenes, tell)


def parse():
    parser = argparse.ArgumentParser(prog="python3 build.py bench", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}; all without any")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--quick", action="store_true", help="small and coarse, to see that it runs")
    parser.add_argument(
        "--scenes", default="", metavar="A,B", help=f"for {' and '.join(WITH_SCENES)}: of scenes_blend, all without any"
    )
    options = parser.parse_args()
    options.scenes = [name for name in options.scenes.split(",") if name]
    for part in options.parts:
        if part not in PARTS:
            parser.error(f"there is no part {part}; there are {', '.join(PARTS)}")
    for name in options.scenes:
        if not (SCENES / f"{name}.blend").is_file():
            there = ", ".join(sorted(path.stem for path in SCENES.glob("*.blend")))
            parser.error(f"there is no scene {name}; there are {there}")
    if options.json and not options.json.resolve().parent.is_dir():
        parser.error(f"there is no folder {options.json.parent} to write {options.json.name} into")
    return options


def table(part, figures):
    result = Table(box=None, header_style="dim")
    result.add_column("figure")
    result.add_column("value", justify="right")
    for name, value in flatten(figures, part):
        result.add_row(name, f"{value:,.4g}" if isinstance(value, float) else f"{value}")
    return result


def flatten(figures, name):
    """{"a": {"b": 1}} named x gives ("x.a.b", 1)."""
    if not isinstance(figures, dict):
        yield name, figures
        return
    for key, value in figures.items():
        yield from flatten(value, f"{name}.{key}")


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)  # not sys.exit: where parts load Blender 4.5 as a module, it can hang when a process ends
