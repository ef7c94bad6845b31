# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene files: a Scene and its Settings in one file, for benchmarks, bug reports and machines without Blender.

The file is a zip of numpy arrays (.npz), one for each table, and a header as JSON. Nothing in it is code or pickle, and
what is read is checked before a kernel sees it.
"""

import hashlib
import json
import zipfile
from pathlib import Path

import numpy as np

from ..accel.nodes import aligned_rows
from ..guide_tables import no_guide
from ..integrator.layers import entries_needed
from ..medium_tables import MAX_PHASES
from ..settings import Settings
from ..shader import link, verify
from ..tables import LIGHT_WIDTH, MAX_LOBES, MAX_PART_LEVEL, Scene, ShapeKind, TreeKind
from .checks import SceneError

FORMAT, VERSION = "lambent scene", 1


def save_scene(path, scene, settings):
    """Write `scene` and `settings` to the file `path`, compressed."""
    header = {"format": FORMAT, "version": VERSION, "layout": layout(), "settings": settings._asdict()}
    text = np.frombuffer(json.dumps(header, default=float).encode(), np.uint8)
    # as plain bytes with a row's size: a dtype with sub-arrays would need numpy to evaluate its description
    tables = {name: np.asarray(table).view(np.uint8) for name, table in scene.tables().items()}
    with open(path, "wb") as file:
        np.savez_compressed(file, header=text, **tables)


def load_scene(path):
    """Read (scene, settings) from the file `path`.

    Raises SceneError, with the name of the file, if it is not such a file, of another version, or damaged.
    """
    name = Path(path).name
    if Path(path).is_file() and not zipfile.is_zipfile(path):
        raise SceneError(f"{name}: not a scene file of Lambent, or a part of one")
    try:
        with np.load(path, allow_pickle=False) as stored:
            header = json.loads(stored["header"].tobytes().decode())
            if header.get("format") != FORMAT:
                raise SceneError(f"{name}: not a scene file of Lambent")
            if header.get("version") != VERSION:
                raise SceneError(f"{name}: written in version {header.get('version')}, this Lambent reads {VERSION}")
            if header.get("layout") != layout():
                raise SceneError(f"{name}: written by another Lambent, whose tables have other columns")
            tables = {}
            for table, dtype in Scene.dtypes().items():
                raw = stored[table]
                if raw.dtype != np.uint8 or raw.size % dtype.itemsize:
                    raise SceneError(f"{name}: table {table} is damaged")
                tables[table] = aligned_rows(raw.size // dtype.itemsize, dtype)
                tables[table].view(np.uint8)[:] = raw
            settings = Settings(**header["settings"])
    except (OSError, EOFError, KeyError, ValueError, TypeError, zipfile.BadZipFile) as error:
        if isinstance(error, (SceneError, FileNotFoundError)):
            raise
        raise SceneError(f"{name}: cannot be read as a scene file ({error})") from None
    check_tables(name, tables)
    families = {int(family) for family in tables["ops"]["family"]}
    # what the file says is of another process
    entries = entries_needed(tables["materials"])
    tables["kernels"] = link.kernels(families, len(tables["programs"]) > 1, entries)
    tables |= no_guide()  # a render makes its own
    return Scene(**tables), settings


def layout():
    """What tells whether a file's rows are ours: the fields of all tables, as a string."""
    digest = hashlib.sha256()
    for name, dtype in Scene.dtypes().items():
        digest.update(f"{name} {dtype.descr}".encode())
    return digest.hexdigest()[:16]


LEAF_TABLES = {
    TreeKind.TRIANGLES: "packets",
    TreeKind.SHAPES: "shapes",
    TreeKind.INSTANCES: "instances",
    TreeKind.TARGETS: "targets",
}


def check_tables(name, tables):
    """Refuse tables whose row numbers lead outside: kernels follow them without looking."""

    def within(what, numbers, table, none_allowed=True):
        low = -1 if none_allowed else 0
        if numbers.size and (numbers.min() < low or numbers.max() >= len(tables[table])):
            raise SceneError(f"{name}: {what} lead outside of the table {table}")

    if len(tables["world"]) != 1 or len(tables["camera"]) != 1:
        raise SceneError(f"{name}: a scene has one world and one camera")
    for kind, leaves in _leaves(name, tables).items():
        within("leaves", ~leaves, LEAF_TABLES[kind], none_allowed=False)
    within("packets", tables["packets"]["prim"], "triangles")
    for table in ("triangles", "shapes"):
        within(f"owners of {table}", tables[table]["instance"], "instances")
    hairs = tables["shapes"][tables["shapes"]["kind"] == ShapeKind.STRAND]
    within("hairs", hairs["strand"], "strands", none_allowed=False)
    within("slots", tables["slots"]["material"], "materials", none_allowed=False)
    within("lights of instances", tables["instances"]["lights"], "lights")
    _check_motion(name, tables)
    _check_materials(name, tables)
    _check_lights(name, tables, within)
    _check_light_tree(name, tables, within)
    _check_media(name, tables, within)
    _check_targets(name, tables, within)
    for fault in verify.faults(tables):
        raise SceneError(f"{name}: {fault}")


def _check_materials(name, tables):
    materials = tables["materials"]
    if len(materials) and (
        materials["lobe_count"].min() < 0
        or materials["lobe_count"].max() > MAX_LOBES
        or materials["lobes"].min() < 0
        or (materials["lobes"] + materials["lobe_count"]).max() > len(tables["lobes"])
    ):
        raise SceneError(f"{name}: lobes of materials lead outside of the table lobes")


def _check_lights(name, tables, within):
    world = tables["world"][0]
    if not 0 <= world["light_count"] <= len(tables["lights"]) or not (
        world["suns"] >= 0 and world["suns"] + world["sun_count"] <= len(tables["lights"])
    ):
        raise SceneError(f"{name}: lights of the world lead outside of the table lights")
    if not world["sun_count"] <= world["far_count"] <= len(tables["lights"]):
        raise SceneError(f"{name}: suns and beams lead outside of the table lights")
    for field, what, table in (
        ("background_light", "the world's background", "lights"),
        ("disk_light", "the sun in the sky", "lights"),
        ("only_light", "the only light", "lights"),
        ("light_root", "the tree of lights", "light_nodes"),
    ):
        within(what, world[field], table)
    level = tables["lights"]["level"]
    if level.min(initial=0) < 0 or level.max(initial=0) > MAX_PART_LEVEL:
        raise SceneError(f"{name}: lights are divided too finely")
    first = tables["lights"]["parts"][level > 0].astype(np.int64)
    within("parts of lights", np.concatenate([first, first + 4 ** level[level > 0] - 1]), "lights", none_allowed=False)


def _check_targets(name, tables, within):
    world = tables["world"][0]
    within("targets", tables["targets"]["light"], "lights", none_allowed=False)
    if not (
        0 <= world["far_targets"] <= world["target_count"]
        and world["delta_count"] >= 0
        and world["target_count"] + world["delta_count"] <= len(tables["targets"])
    ):
        raise SceneError(f"{name}: targets of the world lead outside of the table targets")


def _check_media(name, tables, within):
    """Refuse media and phase functions that are not there."""
    within("media of materials", tables["materials"]["medium"], "media")
    within("the world's medium", tables["world"]["medium"], "media")
    first, count = (tables["media"][field].astype(np.int64) for field in ("phases", "phase_count"))
    if (
        min(first.min(initial=0), count.min(initial=0)) < 0
        or count.max(initial=0) > MAX_PHASES
        or (first + count).max(initial=0) > len(tables["phases"])
    ):
        raise SceneError(f"{name}: phase functions of media lead outside of the table phases")


def _check_motion(name, tables):
    """Refuse poses that are not there, and times of a shutter that are none."""
    count, shutter = int(tables["world"]["pose_count"][0]), tables["camera"]["shutter"]
    first = np.concatenate([tables["instances"]["motion"], tables["camera"]["motion"]]).astype(np.int64)
    if first.min() < 0 or ((first > 0).any() and (count < 2 or first.max() + count > len(tables["poses"]))):
        raise SceneError(f"{name}: motions lead outside of the table poses")
    if not ((shutter >= 0.0) & (shutter <= 1.0)).all():
        raise SceneError(f"{name}: the shutter is open at times that are none")


def _check_light_tree(name, tables, within):
    """Refuse what would not lead down from the root to the lights, and from each of them up to it."""
    nodes = tables["light_nodes"]
    child, parent = nodes["child"].astype(np.int64), nodes["parent"].astype(np.int64)
    row = np.arange(len(nodes))
    within("leaves of the tree of lights", ~child[child < 0], "lights", none_allowed=False)
    only = tables["world"]["only_light"]
    first = np.concatenate([~child[child < 0], only[only >= 0]])
    within("pairs of lights", first + ~(tables["lights"]["share"][first] >= 1.0), "lights", none_allowed=False)
    within("leaves of lights", tables["lights"]["leaf"] // LIGHT_WIDTH, "light_nodes")
    if (
        child.max(initial=-1) >= len(nodes)
        or (child <= row[:, None])[(child > 0) | ((child == 0) & (nodes["intensity"] != 0.0))].any()
        or parent.min(initial=0) < -1
        or (parent // LIGHT_WIDTH >= row)[parent >= 0].any()
    ):
        raise SceneError(f"{name}: the tree of lights leads astray")


def _leaves(name, tables):
    """Walk all trees from their roots. Returns {TreeKind: leaves}; refuses cycles and numbers out of range."""
    world, instances, nodes = tables["world"][0], tables["instances"], tables["nodes"]
    leaves = {kind: np.zeros(0, np.int32) for kind in TreeKind}
    roots = {
        TreeKind.TRIANGLES: [world["triangle_root"], *instances["root"][instances["kind"] == TreeKind.TRIANGLES]],
        TreeKind.SHAPES: [
            world["shape_root"],
            world["lamp_root"],
            *instances["root"][instances["kind"] == TreeKind.SHAPES],
        ],
        TreeKind.INSTANCES: [world["instance_root"], world["moving_root"]],
        TreeKind.TARGETS: [world["target_root"]],
    }
    if not np.isin(instances["kind"], (TreeKind.TRIANGLES, TreeKind.SHAPES)).all():
        raise SceneError(f"{name}: an instance has a tree of an unknown kind")
    for kind, numbers in roots.items():
        level = np.unique(np.array(numbers, np.int64))
        level = level[level != -1]
        visited = 0
        while len(level):
            if level.min() < 0 or level.max() >= len(nodes):
                raise SceneError(f"{name}: a tree leads outside of the table nodes")
            visited += len(level)
            if visited > len(nodes):
                raise SceneError(f"{name}: a tree bites its own tail")
            used = nodes["bounds"][level][:, 0] <= nodes["bounds"][level][:, 3]
            children = nodes["child"][level][used]
            leaves[kind] = np.concatenate([leaves[kind], children[children < 0]])
            level = children[children >= 0]
    return leaves
