# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether tables that come from a file hold programs that the machine may run: it follows their numbers blindly."""

import numpy as np

from ..program_tables import CLOSURE, CURVE_SIZE, MAX_REGISTERS, ClosureKind, TexelFormat
from .opcodes import SIGNATURES

MATERIAL_PROGRAMS = ("program", "emission_program", "transparency_program", "holdout_program")
FIRST_FLOAT = CLOSURE.fields["weight"][1] // 4  # the fields before it are not for programs to set


def faults(tables):
    """What is wrong with the programs of a scene, as texts; empty if nothing is. `tables`: by name, as in Scene."""
    checks = (_programs, _ops, _closures, _images, _users)
    return [text for check in checks for text in check(tables)]


def _ranges(first, count, length, what):
    first, count = first.astype(np.int64), count.astype(np.int64)
    if (first < 0).any() or (count < 0).any() or (first + count > length).any():
        yield f"{what} lead outside of their table"


def _programs(tables):
    programs = tables["programs"]
    if not len(programs):
        yield "there is no program 0"
    yield from _ranges(programs["ops"], programs["op_count"], len(tables["ops"]), "steps of programs")
    yield from _ranges(programs["closures"], programs["closure_count"], len(tables["closures"]), "closures of programs")
    if len(programs) and (programs["result"].min() < -1 or programs["result"].max() > MAX_REGISTERS - 3):
        yield "results of programs lie in no register"


def _ops(tables):
    ops = tables["ops"]
    known = np.zeros(len(ops), bool)
    for code, signature in SIGNATURES.items():
        rows = ops[ops["code"] == code]
        known |= ops["code"] == code
        if (rows["family"] != signature.family).any():
            yield f"{code.name} is in another family"
        if ((rows["mode"] < 0) | (rows["mode"] >= signature.modes)).any():
            yield f"{code.name} has no such mode"
        if ((rows["out"] < 0) | (rows["out"] > MAX_REGISTERS - signature.width)).any():
            yield f"the result of {code.name} lies in no register"
        for k, width in enumerate(signature.operands):
            register = rows["register"][:, k]
            if ((register < -1) | (register > MAX_REGISTERS - width)).any():
                yield f"an operand of {code.name} lies in no register"
        if signature.table == "curves":
            yield from _ranges(rows["data"], np.full(len(rows), CURVE_SIZE), len(tables["curves"]), "curves")
        elif signature.table == "images":
            yield from _ranges(rows["data"], np.ones(len(rows)), len(tables["images"]), "images of steps")
        elif signature.table == "attribute":
            used = tables["objects"]["attributes"]
            most = rows["data"].max(initial=-1)
            if rows["data"].min(initial=0) < 0 or most + used.max(initial=-1) >= max(len(tables["attribute_maps"]), 1):
                yield "attributes lead outside of their table"
        elif signature.table == "instance_values" and len(rows):
            stride, numbers = int(tables["world"]["value_stride"][0]), tables["objects"]["number"]
            most = (int(rows["data"].max()) + 1) * stride
            if rows["data"].min() < 0 or stride < 0 or most > len(tables["instance_values"]):
                yield "values of instances lead outside of their table"
            if len(numbers) and not 0 <= numbers.min() <= numbers.max() < stride:
                yield "instances have no values of their own"
    if not known.all():
        yield "there are steps of no known operation"


def _closures(tables):
    closures, patches = tables["closures"], tables["patches"]
    if not np.isin(closures["kind"], list(ClosureKind)).all():
        yield "there are closures of no known kind"
    yield from _ranges(closures["patches"], closures["patch_count"], len(patches), "patches of closures")
    outside = (patches["field"] < FIRST_FLOAT) | (patches["field"] + patches["width"] > CLOSURE.itemsize // 4)
    if outside.any() or not np.isin(patches["width"], (1, 3)).all():
        yield "patches fit no field"
    if ((patches["register"] < 0) | (patches["register"] > MAX_REGISTERS - patches["width"])).any():
        yield "patches read no register"


def _images(tables):
    images = tables["images"]
    formats, channels = images["format"], images["channels"]
    if not (np.isin(formats, list(TexelFormat)).all() and np.isin(channels, (1, 4)).all()):
        yield "there are images of no known format"
    if (images["width"] < 1).any() or (images["height"] < 1).any():
        yield "there are images without pixels"
    is_tiled = formats == TexelFormat.TILES
    tiles, images = images[is_tiled], images[~is_tiled]
    counts = tiles["width"].astype(np.int64) * tiles["height"]
    yield from _ranges(tiles["first"], counts, len(is_tiled), "images side by side")
    if any(is_tiled[first : first + count].any() for first, count in zip(tiles["first"], counts, strict=True)):
        yield "images side by side are such themselves"
    formats, channels = images["format"], images["channels"]
    size = np.select([formats == TexelFormat.HALF, formats >= TexelFormat.FLOAT], [2, 4], 1).astype(np.int64)
    numbers = images["width"].astype(np.int64) * images["height"] * channels
    yield from _ranges(images["first"], (numbers * size + 3) // 4, len(tables["texels"]), "pixels of images")


def _users(tables):
    count = len(tables["programs"])
    world = tables["world"]
    used = [tables["lights"]["program"], world["background_program"]]
    used += [tables["materials"][name] for name in MATERIAL_PROGRAMS]
    if any(len(rows) and (rows.min() < 0 or rows.max() >= count) for rows in used):
        yield "there are users of no program"
    width, height = int(world["map_width"][0]), int(world["map_height"][0])
    if width < 0 or height < 0 or (width and len(tables["world_map"]) < (height + 1) + height * (width + 1)):
        yield "the map of the world is too small"
    if not 0 <= world["attribute_count"][0] <= len(tables["attributes"]):
        yield "attributes lead outside of their table"
    objects, lights = tables["objects"], tables["lights"]
    if len(objects) != len(tables["instances"]):
        yield "there are instances of which nothing is told"
    shaded = (lights["program"] > 0) & (lights["gain"] > 0.0)
    if not ((lights["lamp"][shaded] >= 0) & (lights["lamp"][shaded] < len(objects))).all():
        yield "lamps have no space of their own"
    textured = lights[(lights["program"] > 0) & (lights["instance"] >= 0) & ~shaded]
    if (textured["instance"] >= len(objects)).any():
        yield "lights belong to no instance"
    elif len(textured):
        prim = objects["first_prim"][textured["instance"]].astype(np.int64) + textured["prim"]
        if prim.min() < 0 or prim.max() >= len(tables["triangles"]):
            yield "lights are no triangles"
