#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lambent's front door: makes its environment, renders, tests, measures and packs. Needs nothing but Python 3.8."""

import argparse
import json
import os
import re
import subprocess
import sys
from pathlib import Path

from tools import environment, extension
from tools.environment import PYTHON_OF_BLENDER, ROOT, UserError, say
from tools.progress import Progress

TESTS = ROOT / "blender_tests"
LEVELS = ["core", "radiance", "structure", "blender", "window", "against_cycles"]
LEVELS_OF_EACH_BLENDER = ["blender"]  # run once with every supported Blender, the others with one
MARK = "lambent> "  # of the lines in which tools/render_driver.py speaks to us
PICTURES = [".png", ".exr", ".jpg", ".jpeg", ".tif", ".tiff"]

EXAMPLES = """\
examples:
  python3 build.py render scenes_blend/cornell_box.blend
  python3 build.py render shot.blend -o shot.png --samples 64 --size 640x480
  python3 build.py render shot.blend --blender "flatpak run org.blender.Blender"
  python3 build.py test                            every test; add pytest's own arguments as you like
  python3 build.py test --level core -k sobol      one level, and of that what has "sobol" in its name
  python3 build.py bench rays --json rays.json     how fast, one part or all
  python3 build.py compare shot.blend --samples 64 --reference 1024       beside Cycles, with errors
  python3 build.py bench noise --scenes cornell_box,interior              how soon is a picture free of noise?
  python3 build.py figures                         the pictures and plots of docs/figures.md
  python3 build.py gallery --only cornell_box      the worlds of docs/gallery, beside Cycles
  python3 build.py fuzz --minutes 60               random programs and node trees, in search of one that fails
  python3 build.py package                         dist/lambent-*.zip, to install in Blender

Each command makes what it needs first: a virtual environment in .venv with Blender 5.2 LTS as a Python module
(Python 3.13), or in .venv-4.5 with Blender 4.5 LTS (Python 3.11). That takes some minutes once, and nothing later.
python3 build.py COMMAND --help says more about one command."""


# ---- setup, check ----------------------------------------------------------------------------------------------------


def command_setup(arguments, _):
    for version in versions(arguments.blender_version) or [environment.default_version()]:
        python = environment.environment(version)
        say(f"Blender {version} LTS as a Python module: {python}")


def command_check(_, rest):
    """Formatting and lint, as the tests of the project ask for."""
    ruff = [str(environment.environment()), "-m", "ruff"]
    failed = subprocess.call([*ruff, "format", "--check", *rest], cwd=str(ROOT))
    failed |= subprocess.call([*ruff, "check", *rest], cwd=str(ROOT))
    return failed


def versions(choice):
    """Of a --blender-version."""
    return list(PYTHON_OF_BLENDER) if choice == "both" else [choice] if choice else []


# ---- render ----------------------------------------------------------------------------------------------------------


def command_render(arguments, _):
    job = render_job(arguments)
    driver = str(ROOT / "tools" / "render_driver.py")
    variables = dict(os.environ)
    if arguments.blender:
        blender = extension.split_command(arguments.blender)
        if job["engine"] == "LAMBENT":
            variables.update(extension.install_into(blender))
        command = [*blender, "-b", "--python", driver, "--", json.dumps(job)]
    else:
        python = environment.environment(arguments.blender_version)
        command = [str(python), driver, "--", json.dumps(job)]
    say(f"Rendering {arguments.file} with {job['engine'].capitalize()}")
    return run_render(command, variables, arguments.verbose)


def render_job(arguments):
    """What tools/render_driver.py is asked for. Paths are absolute, since it may run in another folder."""
    file = blend_file(arguments.file)
    number = "" if arguments.frame is None else f"_{arguments.frame:04d}"
    out = Path(arguments.output or ".")
    if out.is_dir():
        out = out / f"{file.stem}{number}.png"
    if out.suffix.lower() not in PICTURES:
        raise UserError(f"{out}: the name of the picture has to end in one of {', '.join(PICTURES)}")
    if not out.parent.is_dir():
        raise UserError(f"there is no folder {out.parent} to write {out.name} into")
    width, height = arguments.size or (None, None)
    return {
        "file": str(file.resolve()),
        "out": str(out.resolve()),
        "engine": arguments.engine,
        "width": width,
        "height": height,
        "frame": arguments.frame,
        "samples": arguments.samples,
        "seed": arguments.seed,
        "threads": arguments.threads,
        "time_limit": arguments.time_limit,
        "integrator": arguments.integrator,
        "noise_target": arguments.noise_target,
        "sampler": arguments.sampler and arguments.sampler.upper(),
        "use_adaptive": False if arguments.uniform else None,
    }


def blend_file(name):
    file = Path(name)
    if not file.is_file():
        raise UserError(f"there is no file {file}")
    if file.suffix.lower() != ".blend":
        raise UserError(f"{file} is no .blend file")
    return file


def run_render(command, variables, verbose):
    """Start Blender, show its progress and warnings, and hand on its exit code."""
    variables["PYTHONUNBUFFERED"] = "1"
    progress, tail, error, done = Progress(), [], None, None
    try:
        process = subprocess.Popen(
            command,
            env=variables,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            universal_newlines=True,
            errors="replace",
        )
    except OSError as failure:
        raise UserError(f"cannot start {command[0]}: {failure.strerror}") from None
    try:
        for line in process.stdout:
            kind, *rest = json.loads(line[len(MARK) :]) if line.startswith(MARK) else ["text", line.rstrip()]
            if kind == "progress":
                progress.show(*rest)
            elif kind == "done":
                done = rest
            elif kind == "error":
                error = rest[0]
            elif verbose or re.match(r"(Warning|Info): ", rest[0]):
                progress.clear()
                say(rest[0])
            else:
                tail = [*tail[-19:], rest[0]]
        code = process.wait()
    except KeyboardInterrupt:
        process.kill()
        process.wait()
        raise
    progress.clear()
    if code == 0 and done:
        they_are = "The picture is" if len(done) == 1 else "The pictures are"
        say(f"{progress.elapsed():.1f} s. {they_are} {', '.join(str(relative(path)) for path in done)}")
        return 0
    if error is None:
        error = f"Blender ended with exit code {code} and no picture. Its last words:\n" + "\n".join(tail)
    raise UserError(error)


def relative(path):
    """Short, where the picture lies below the present folder."""
    try:
        return Path(path).relative_to(Path.cwd())
    except ValueError:
        return path


# ---- test, bench, package --------------------------------------------------------------------------------------------


def command_test(arguments, rest):
    """pytest in the default environment; the levels that differ between Blenders in the other ones too, if set up."""
    for level in arguments.level:
        if not (TESTS / level).is_dir():
            raise UserError(f"there are no tests of level {level} yet")
    if arguments.blender:
        os.environ["LAMBENT_BLENDER"] = arguments.blender
    wanted = versions(arguments.blender_version)
    first = wanted[0] if wanted else environment.default_version()
    others = wanted[1:] if wanted else [v for v in PYTHON_OF_BLENDER if v != first and environment.is_ready(v)]

    rest = [str(Path(word).resolve()) if Path(word.split("::")[0]).exists() else word for word in rest]
    if any(Path(word.split("::")[0]).is_absolute() for word in rest):  # the tests are named: those, and once
        return run_pytest(first, [], rest)
    failed = run_pytest(first, arguments.level, rest)
    again = [level for level in LEVELS_OF_EACH_BLENDER if level in (arguments.level or LEVELS)]
    for version in others if again else []:
        failed |= run_pytest(version, again, rest)
    return failed


def run_pytest(version, levels, rest):
    python = environment.environment(version)
    say(f"---- Tests with Blender {version} LTS as a module ----")
    paths = [str(TESTS / level) for level in levels]
    return subprocess.call([str(python), "-m", "pytest", *paths, *rest], cwd=str(ROOT))


def command_bench(arguments, rest):
    python = environment.environment(arguments.blender_version)
    output = ["--json", str(Path(arguments.json).resolve())] if arguments.json else []
    quick = ["--quick"] if arguments.quick else []
    scenes = ["--scenes", arguments.scenes] if arguments.scenes else []
    command = [str(python), "-m", "blender_tests.bench", *arguments.parts, *output, *quick, *scenes, *rest]
    return subprocess.call(command, cwd=str(ROOT))


def command_compare(arguments, _):
    file, out = blend_file(arguments.file), Path(arguments.output or ".")
    if out.exists() and not out.is_dir():
        raise UserError(f"{out} is no folder")
    words = [str(file.resolve()), "--output", str(out.resolve()), "--seed", str(arguments.seed)]
    for name in ("samples", "seconds", "reference", "frame"):
        if getattr(arguments, name) is not None:
            words += [f"--{name}", str(getattr(arguments, name))]
    if arguments.size:
        words += ["--size", *map(str, arguments.size)]
    python = environment.environment(arguments.blender_version)
    return subprocess.call([str(python), "-m", "blender_tests.bench.compare", *words], cwd=str(ROOT))


def command_figures(arguments, _):
    python = environment.environment(arguments.blender_version)
    words = [*arguments.names, "--output", str(Path(arguments.output).resolve()), *["--quick"] * arguments.quick]
    return subprocess.call([str(python), "-m", "blender_tests.bench.figures", *words], cwd=str(ROOT))


def command_gallery(arguments, _):
    python = environment.environment(arguments.blender_version)
    words = ["--output", str(Path(arguments.output).resolve())]
    words += [word for name in arguments.only for word in ("--only", name)]
    if arguments.samples:
        words += ["--samples", str(arguments.samples)]
    return subprocess.call([str(python), "-m", "blender_tests.bench.gallery", *words], cwd=str(ROOT))


def command_fuzz(arguments, _):
    words = ["--minutes", str(arguments.minutes), "--seed", str(arguments.seed)]
    words += ["--only", str(arguments.only)] if arguments.only is not None else []
    return subprocess.call([str(environment.environment()), "-m", "blender_tests.fuzz", *words], cwd=str(ROOT))


def command_package(arguments, _):
    targets = list(extension.PLATFORMS) if "all" in arguments.platform else arguments.platform
    for target in targets or [extension.this_platform()]:
        package = extension.make_package(target, arguments.python or extension.PYTHONS, ROOT / "dist")
        extension.validate(package)
        say(f"{package.relative_to(ROOT)}  {package.stat().st_size / 1e6:.0f} MB, checked by Blender's own validator")


# ---- The command line ------------------------------------------------------------------------------------------------


class Parser(argparse.ArgumentParser):
    def error(self, message):
        self.exit(2, f"{self.prog}: {message}\nMore: python3 {self.prog} --help\n")


def size(text):
    found = re.fullmatch(r"(\d+)[xX](\d+)", text)
    if not found or not all(4 <= int(side) <= 65536 for side in found.groups()):
        raise argparse.ArgumentTypeError(
            f"'{text}' is no size; write width x height in pixels, such as 640x480; at least 4, at most 65536"
        )
    return int(found.group(1)), int(found.group(2))


def at_least(lowest, number=int):
    def parse(text):
        try:
            value = number(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"'{text}' is no number") from None
        if not lowest <= value < 2**31:  # also refuses nan
            raise argparse.ArgumentTypeError(f"{text} is out of range: at least {lowest}")
        return value

    return parse


def parser():
    top = Parser(
        prog="build.py",
        description=__doc__,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = top.add_subparsers(title="commands", metavar="COMMAND", dest="command", parser_class=Parser)

    def add(name, function, text):
        sub = commands.add_parser(name, help=text, description=text, allow_abbrev=False)
        sub.set_defaults(function=function)
        return sub

    lts = dict(choices=[*PYTHON_OF_BLENDER], help="which Blender LTS as a module (default: 5.2)")
    lts_or_both = dict(choices=[*PYTHON_OF_BLENDER, "both"])

    sub = add("setup", command_setup, "make the environment, without anything else")
    sub.add_argument("--blender-version", help="which Blender LTS as a module (default: 5.2)", **lts_or_both)

    sub = add("render", command_render, "render a picture of a .blend file")
    sub.add_argument("file", metavar="FILE", help="a .blend file; its scripts are not run")
    sub.add_argument("-o", "--output", metavar="OUT", help="the picture, .png or .exr (default: ./FILE's name.png)")
    sub.add_argument("--samples", type=at_least(1), metavar="N", help="per pixel (default: what the file says)")
    sub.add_argument("--size", type=size, metavar="WxH", help="in pixels (default: what the file says)")
    sub.add_argument("--frame", type=at_least(-(2**20)), metavar="N", help="(default: the one the file was saved at)")
    sub.add_argument("--integrator", metavar="NAME", help="path, mixture or brute-force (default: what the file says)")
    sub.add_argument(
        "--engine", type=str.upper, choices=["LAMBENT", "CYCLES"], default="LAMBENT", help="LAMBENT or CYCLES"
    )
    sub.add_argument(
        "--time-limit", type=at_least(0, float), metavar="S", help="stop after so many seconds of rendering"
    )
    sub.add_argument(
        "--noise-target", type=at_least(0, float), metavar="PERCENT", help="stop when the picture's noise is that low"
    )
    sub.add_argument("--uniform", action="store_true", help="as many samples for each pixel: no adaptive sampling")
    sub.add_argument("--sampler", choices=["sobol", "random"], help="(default: what the file says)")
    sub.add_argument("--threads", type=at_least(1), metavar="N", help="(default: one for each core)")
    sub.add_argument("--seed", type=at_least(0), metavar="N", help="another seed, another pattern of noise")
    sub.add_argument("--blender", metavar="COMMAND", help="an installed Blender, 4.5 or later, instead of the module")
    sub.add_argument("--blender-version", **lts)
    sub.add_argument("--verbose", action="store_true", help="show all that Blender prints")

    sub = add("test", command_test, "run the tests; arguments that are not known here go to pytest")
    sub.add_argument("--level", action="append", default=[], choices=LEVELS, help="only this level; may be repeated")
    sub.add_argument(
        "--blender-version",
        help=f"which Blender as a module (default: {' and '.join(PYTHON_OF_BLENDER)} as far as set up; "
        "both: sets them up)",
        **lts_or_both,
    )
    sub.add_argument("--blender", metavar="COMMAND", help="an installed Blender, for the tests with a window")

    sub = add("bench", command_bench, "measure how fast Lambent is")
    sub.add_argument(
        "parts",
        nargs="*",
        metavar="PART",
        help="rays, scaling, noise, volumes, integrators, profile, textures, materials, compile, export, build, "
        "large, leaks (default: all)",
    )
    sub.add_argument("--json", metavar="FILE", help="write the figures to a file")
    sub.add_argument("--quick", action="store_true", help="small and coarse, to see that it runs")
    sub.add_argument("--scenes", metavar="A,B", help="for noise and volumes: some of scenes_blend (default: all)")
    sub.add_argument("--blender-version", **lts)

    sub = add("compare", command_compare, "render a scene with Lambent and with Cycles, and measure the difference")
    sub.add_argument("file", metavar="FILE", help="a .blend file; its scripts are not run")
    sub.add_argument("-o", "--output", metavar="DIR", help="for FILE's name_compare.png and .json (default: here)")
    effort = sub.add_mutually_exclusive_group()
    effort.add_argument("--samples", type=at_least(1), metavar="N", help="per pixel (default: what the file says)")
    effort.add_argument("--seconds", type=at_least(0.01, float), metavar="S", help="of rendering, for each engine")
    sub.add_argument(
        "--reference",
        type=at_least(2),
        metavar="N",
        help="also render converged pictures with N samples, and measure errors against them; they are kept for the "
        "next time",
    )
    sub.add_argument("--size", type=size, metavar="WxH", help="in pixels (default: what the file says)")
    sub.add_argument("--frame", type=at_least(-(2**20)), metavar="N", help="(default: the one the file was saved at)")
    sub.add_argument("--seed", type=at_least(0), default=0, metavar="N", help="another seed, another pattern of noise")
    sub.add_argument("--blender-version", **lts)

    sub = add("figures", command_figures, "make the pictures and plots of docs/figures.md")
    sub.add_argument("names", nargs="*", metavar="NAME", help="worlds, time, rays (default: all)")
    sub.add_argument("-o", "--output", metavar="DIR", default=str(ROOT / "docs" / "figures"), help="(docs/figures)")
    sub.add_argument("--quick", action="store_true", help="small and coarse, to see that it runs")
    sub.add_argument("--blender-version", **lts)

    sub = add("gallery", command_gallery, "render the paper's worlds beside Cycles, for docs/gallery")
    sub.add_argument("--samples", type=at_least(1), metavar="N", help="per pixel (default: 64)")
    sub.add_argument("--only", action="append", default=[], metavar="NAME", help="of scenes_blend; may be repeated")
    sub.add_argument("-o", "--output", metavar="DIR", default=str(ROOT / "docs" / "gallery"), help="(docs/gallery)")
    sub.add_argument("--blender-version", **lts)

    sub = add(
        "fuzz",
        command_fuzz,
        "render random programs, damaged ones and node trees, and tell the seeds of those that fail",
    )
    sub.add_argument("--minutes", type=at_least(0.01, float), default=60.0, metavar="N", help="(default: 60)")
    sub.add_argument("--seed", type=at_least(0), default=0, metavar="S", help="of the first one (default: 0)")
    sub.add_argument("--only", type=at_least(0), metavar="S", help="that seed alone")

    sub = add("package", command_package, "pack the extension for Blender into dist/")
    sub.add_argument(
        "--platform",
        action="append",
        default=[],
        choices=[*extension.PLATFORMS, "all"],
        help="may be repeated (default: this machine's)",
    )
    sub.add_argument(
        "--python",
        action="append",
        default=[],
        metavar="VERSION",
        help=f"of Blender, may be repeated (default: {' and '.join(extension.PYTHONS)}, of Blender 4.5 and 5.2 LTS)",
    )

    add("check", command_check, "formatting and lint of all Python files (ruff)")
    return top


def main():
    top = parser()
    if len(sys.argv) == 1:
        top.print_help()
        return 0
    arguments, rest = top.parse_known_args()
    if rest and arguments.command not in ("test", "check"):
        top.error(f"unknown argument {rest[0]}")
    try:
        return arguments.function(arguments, rest) or 0
    except UserError as error:
        sys.stderr.write(f"build.py: {error}\n")
        return 1
    except KeyboardInterrupt:
        sys.stderr.write("\nbuild.py: stopped\n")
        return 130


if __name__ == "__main__":
    sys.exit(main())
