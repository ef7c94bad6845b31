# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the time of a path goes: shares of rays, lights, materials and random numbers, in three scenes, on one thread.

Linux' `perf` tells at which addresses the processor was; the compiled kernel tells which of its functions stands there.
A function that LLVM has put into its caller counts as that: the trees are walked in `walk.advance`, and random numbers
are drawn in `path.trace`.

    python3 build.py bench profile
"""

import os
import shutil
import struct
import subprocess
import tempfile
from bisect import bisect_right
from collections import Counter
from pathlib import Path
from unittest.mock import patch

import bpy

import addon
from blender_tests.helpers.cycles import load
from blender_tests.helpers.exported import export
from engine_core.integrator import path
from engine_core.integrator.render import RENDER_TILE, render_tile
from engine_core.integrator.tiles import Render
from engine_core.jit import kernel, variant
from engine_core.linking import KernelLibrary
from engine_core.settings import IntegratorKind, Settings

SCENES = ("cornell_box", "three_spheres", "instances")
FOLDER = Path(__file__).parents[2] / "scenes_blend"
SIZE = 128
FREQUENCY = 1999  # looks a second
# What renders has most of its functions in one; in this they stay apart. About a tenth slower.
PROFILED = kernel(variant(render_tile, "profiled", trace=path.trace))
WITH_RAYS = ("integrator.walk.advance", "integrator.direct.shadow_transmittance")
# Part: beginnings of the names of its functions, below engine_core. The first that fits counts.
PARTS = {
    "rays": ("accel", "shape.box", "shape.quad", "shape.disk", "shape.sphere", "shape.dispatch", *WITH_RAYS),
    "lights": ("light", "sampling.spherical", "integrator.direct"),
    "materials": ("bsdf", "shader", "texture", "sampling.warp", "shape.interaction"),
    "path and random numbers": ("integrator.path", "integrator.walk", "sampling.sobol", "sampling.rng"),
    "camera and film": ("integrator.render", "camera", "film"),
}


def run(quick=False):
    """{scene: {"ns_per_sample": ..., part: share, ..., "functions": {the largest: share}}}"""
    if shutil.which("perf") is None:
        return {"skipped": "needs the program perf"}
    if not hasattr(bpy.types.Scene, "lambent"):
        addon.register()
    return {name: profile(name, 8 if quick else 256) for name in SCENES}


def profile(name, samples):
    RENDER_TILE[IntegratorKind.PATH] = PROFILED
    load(FOLDER / f"{name}.blend")
    scene = export((SIZE, SIZE))[0].build()
    settings = Settings(SIZE, SIZE, crop_width=SIZE, crop_height=SIZE, samples=samples, adaptive=0)
    with patch.object(KernelLibrary, "_own", lambda library, module: None):
        Render(scene, settings._replace(samples=1), threads=1).run()
    render = Render(scene, settings, threads=1)
    names = Counter(map(function_finder(PROFILED), addresses_of(render.run)))
    total = sum(names.values())
    parts = Counter()
    for function, looks in names.items():
        parts[part_of(function)] += looks
    return {
        "ns_per_sample": 1e9 * render.elapsed_s / (SIZE * SIZE * samples),
        **{part: parts[part] / total for part in (*PARTS, "other")},
        "functions": {function: looks / total for function, looks in names.most_common(12)},
    }


def part_of(function):
    for part, beginnings in PARTS.items():
        if any(f"{function}.".startswith(f"{beginning}.") for beginning in beginnings):
            return part
    return "other"


def addresses_of(work):
    """Where this process was while it did its `work`, each entry one look of perf."""
    with tempfile.TemporaryDirectory() as folder:
        record = ["perf", "record", "-q", "-e", "cpu-clock", "-F", str(FREQUENCY), "-o", f"{folder}/data"]
        perf = subprocess.Popen([*record, "-p", str(os.getpid())])
        work()
        perf.terminate()
        perf.wait()
        script = subprocess.run(
            ["perf", "script", "-i", f"{folder}/data", "-F", "ip"], capture_output=True, text=True, check=True
        )
    return [int(line, 16) for line in script.stdout.split()]


def function_finder(dispatcher):
    """A function from an address to the name of the kernel there, such as "bsdf.dispatch.sample"; or "other"."""
    ((signature, compiled),) = dispatcher.overloads.items()
    library, cache = compiled.library, dispatcher._cache
    # numba keeps the object file on disk alone; see numba.core.caching and JITCodeLibrary.serialize_using_object_code
    stored = cache._cache_file.load(cache._index_key(signature, library.codegen))
    _, _, (elf, _) = stored[0]
    # asked for one by one: the linker takes a function from whichever library of the process had it first
    functions = functions_of(elf).items()
    rows = sorted((library.get_pointer_to_function(name), size, readable(name)) for name, size in functions)
    begins = [row[0] for row in rows]

    def find(address):
        i = bisect_right(begins, address) - 1
        return rows[i][2] if i >= 0 and address < begins[i] + rows[i][1] else "other"

    return find


def functions_of(elf):
    """{name: size} of the functions in an object file of 64 bits."""
    table, count = struct.unpack_from("<Q", elf, 40)[0], struct.unpack_from("<H", elf, 60)[0]
    sections = [struct.unpack_from("<IIQQQQIIQQ", elf, table + 64 * i) for i in range(count)]
    found = {}
    for section in sections:
        if section[1] != 2:  # SHT_SYMTAB
            continue
        strings = sections[section[6]][4]
        for offset in range(section[4], section[4] + section[5], 24):
            name, info, _, _, _, size = struct.unpack_from("<IBBHQQ", elf, offset)
            if info & 15 == 2:  # STT_FUNC
                end = elf.index(b"\0", strings + name)
                found[elf[strings + name : end].decode()] = size
    return found


def readable(mangled):
    r"""_ZN11engine_core4bsdf8dispatch6sample... is bsdf.dispatch.sample."""
    words, rest = [], mangled.removeprefix("_ZN")
    while rest[:1].isdigit():
        digits = len(rest) - len(rest.lstrip("0123456789"))
        length = int(rest[:digits])
        words.append(rest[digits : digits + length])
        rest = rest[digits + length :]
    return ".".join(words[1:]) if words[:1] == ["engine_core"] else "other"


if __name__ == "__main__":
    import json

    print(json.dumps(run(), indent=2), flush=True)
    os._exit(0)  # Blender 4.5 as a module can hang when a process ends
