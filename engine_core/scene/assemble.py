# SPDX-License-Identifier: GPL-3.0-or-later
"""From what a SceneBuilder collected to the tables of a Scene.

Geometry that stands in the world once is moved there and shares one tree with all others of its kind, so a ray has one
tree to walk; what stands there several times keeps its object space, and a tree of its own behind each transform.
"""

import numpy as np

from ..accel import build as accel
from ..guide_tables import no_guide
from ..integrator.layers import entries_needed
from ..light.bounds import is_far
from ..light.select import prepare_selection
from ..program_tables import OBJECT, STRAND
from ..shape.dispatch import bounds
from ..tables import (
    CAMERA,
    INSTANCE,
    LIGHT,
    NODE,
    PACKET,
    SHAPE,
    SLOT,
    TRIANGLE,
    WORLD,
    LightKind,
    MaterialFlag,
    Scene,
    TreeKind,
    Visibility,
)
from . import checks, motion, shapes, targets
from .displace import add_generated, displace
from .emitters import bake_lights
from .geometry import kind_of, size_of, slot_count, slots_of
from .lamp_programs import bake_lamps, instance_rows
from .media import MediaTables
from .shading import Shading, needs_own_tree
from .targets import Aim
from .terminator import tell_terminators
from .triangles import inverse, scales, triangle_lights, triangle_rows
from .world import bake_world, light_rows


def assemble(builder, progress):
    """The Scene of everything in `builder`."""
    return _Assembly(builder, progress).scene()


class _Assembly:
    def __init__(self, builder, progress):
        self.builder, self.progress = builder, progress
        self.geometries = list(builder.geometries)
        self.placements, self.matrices = self._regular_placements()
        self.motions = [motion.moves(p.name, p.motion) for p in self.placements]
        self.slots = []
        self.instances = np.zeros(len(self.placements), INSTANCE)
        self.objects = np.zeros(len(self.placements), OBJECT)
        self.first_prims = {}  # number of a geometry: row of TRIANGLE, SHAPE or STRAND of its first one
        self.nodes, self.packets, self.triangles, self.shapes, self.strands = [], [], [], [], []
        self.counts = dict.fromkeys(("nodes", "packets", "triangles", "shapes"), 0)
        self.lights = [light.copy() for light in builder.lights]
        self.shading = Shading(builder._warn)

    def scene(self):
        self.progress(0.0, "Materials")
        shading, world = self.shading, np.zeros(1, WORLD)
        materials, lobes = shading.materials(self.builder.materials)
        shading.world(world, self.builder.world_radiance, materials)
        add_generated(self.placements, self.geometries, shading.displacements)
        attributes, self.attribute_rows = shading.attributes(self.geometries)
        world["attribute_count"] = len(attributes["attributes"])
        valued = [*self.placements, *self.builder.lamp_shaders]
        world["value_stride"], self.objects["number"] = len(valued), np.arange(len(self.placements))
        attributes |= shading.instance_values(valued)
        for root in ("triangle", "shape", "instance", "moving", "lamp", "target"):
            world[f"{root}_root"] = -1
        world["background_light"] = world["disk_light"] = -1
        camera, self.poses = self._poses(world)
        self._instance_rows()
        tables = {**attributes, "materials": materials, "camera": self.builder.camera_row, "world": world}
        rows = self.instances, self.objects, self.slots, self.builder._warn
        displace(self.placements, self.geometries, shading, tables, *rows)
        self._place(materials, world)
        self.progress(0.9, "Lights")
        self._lamps(world)
        self._lamp_programs()
        self._bounds(world)
        lights = self._lights(materials, world)
        tell_terminators(self.objects, self.placements, self.geometries, world)
        placed = self.placements, self.matrices, self.instances
        media = MediaTables(self.builder, self.geometries, materials, world, *placed)  # sets who sees instances
        scene = Scene(
            nodes=_concatenate(self.nodes, NODE),
            packets=_concatenate(self.packets, PACKET),
            triangles=_concatenate(self.triangles, TRIANGLE),
            shapes=_concatenate(self.shapes, SHAPE),
            strands=_concatenate(self.strands, STRAND),
            instances=_concatenate([self.instances], INSTANCE),
            objects=self.objects,
            slots=np.array([(m,) for m in self.slots], SLOT),
            poses=self.poses,
            materials=materials,
            lobes=lobes,
            lights=lights,
            **{name: np.zeros(0, Scene.dtypes()[name]) for name in ("light_nodes", "world_map", "targets")},
            camera=camera,
            world=world,
            **attributes | shading.instance_values(valued),  # lamps may ask for more
            **media.tables() | no_guide(),
            **shading.programs.tables(entries_needed(materials)),
        )
        return self._with_baked_light(scene)

    def _with_baked_light(self, scene):
        """The scene with the means of what programs emit, and what lights are selected by."""
        tables, world = scene.tables(), scene.world
        lights = bake_lights(scene)
        world["light_count"] = len(lights)
        if world["background_program"][0] > 0:
            self.progress(0.95, "World")
            tables["world_map"] = bake_world(scene, lights, max(scene.images["width"], default=0))
        bake_lamps(scene, lights)
        tables["light_nodes"] = prepare_selection(lights, world)
        tables["lights"], tables["targets"], tables["nodes"] = self._targets(lights, world, scene.nodes)
        return Scene(**{name: np.asarray(table) for name, table in tables.items()})

    # ---- Geometry ----

    def _regular_placements(self):
        """The placements that have a volume, and where they stand, float64 (n, 3, 4).

        The others cannot be seen and are left out with a warning.
        """
        placements = [p for p in self.builder.placements if size_of(self.geometries[p.geometry]) > 0]
        matrices, regular = checks.transforms([p.name for p in placements], [p.to_world for p in placements])
        for number in np.flatnonzero(~regular):
            self.builder._warn(placements[number].name, "is scaled to 0 in some direction; left out")
        return [p for p, is_regular in zip(placements, regular, strict=True) if is_regular], matrices[regular]

    def _place(self, materials, world):
        users = {}
        for number, placement in enumerate(self.placements):
            users.setdefault(placement.geometry, []).append(number)
        alone = {TreeKind.TRIANGLES: [], TreeKind.SHAPES: []}
        shared = []
        for geometry, numbers in users.items():
            self._mark_emissive(geometry, numbers, materials)
            first = self.placements[numbers[0]]
            kind = kind_of(self.geometries[geometry])
            alone_there = len(numbers) == 1 and self.motions[numbers[0]] is None
            in_world = alone_there and first.visibility == Visibility.ALL
            in_world = in_world and not needs_own_tree(materials, first.materials)
            if in_world and (kind == TreeKind.TRIANGLES or self._keeps_shapes(numbers[0])):
                alone[kind].append(numbers[0])
            else:
                shared.append((geometry, numbers))
        for step, (geometry, numbers) in enumerate(shared):
            self.progress(0.1 + 0.4 * step / len(shared), self.geometries[geometry].name)
            self.instances["root"][numbers] = self._tree(kind_of(self.geometries[geometry]), [(geometry, None)])
        self.progress(0.5, "Tree of the world")
        for kind, field in ((TreeKind.TRIANGLES, "triangle_root"), (TreeKind.SHAPES, "shape_root")):
            if alone[kind]:
                world[field] = self._tree(kind, [(self.placements[n].geometry, n) for n in alone[kind]])
        self.objects["first_prim"] = [self.first_prims[p.geometry] for p in self.placements]
        self._instance_trees(np.array([n for _, numbers in shared for n in numbers], np.int64), world)

    def _keeps_shapes(self, number):
        rows = self.geometries[self.placements[number].geometry].rows
        return shapes.keeps_shapes(rows, self.matrices[number])

    def _instance_rows(self):
        rows, placements = self.instances, self.placements
        rows["to_world"], rows["to_object"] = self.matrices, inverse(self.matrices)
        rows["root"], rows["lights"] = -1, -1
        for field in ("visibility", "pass_index", "random"):
            rows[field] = [getattr(p, field) for p in placements]
        if not placements:
            return
        geometries, used = self.geometries, [p.geometry for p in placements]
        rows["kind"] = np.array([kind_of(geometry) for geometry in geometries])[used]
        counts = [slot_count(geometry) for geometry in geometries]
        rows["slots"] = [self._slots(p.materials, counts[p.geometry]) for p in placements]
        told = self.objects
        told["color"] = [p.color for p in placements]
        told["scale"] = scales(self.matrices)
        told["attributes"] = [self.attribute_rows.get(number, -1) for number in used]
        spaces = {number: geometries[number].texture_space for number in set(used)}
        told["texture_scale"] = [spaces[number][0] for number in used]
        told["texture_offset"] = [spaces[number][1] for number in used]

    def _slots(self, materials, count):
        """Row of SLOT of slot 0; objects with the same materials share theirs."""
        materials = materials or (self.builder.default_material,)
        key = materials + (materials[-1],) * (count - len(materials))
        if not hasattr(self, "_slot_rows"):
            self._slot_rows = {}
        if key not in self._slot_rows:
            self._slot_rows[key] = len(self.slots)
            self.slots.extend(key)
        return self._slot_rows[key]

    def _tree(self, kind, parts):
        """Make a tree over `parts`: (geometry, number of the placement that moves it into the world, or None).

        Returns its root.
        """
        rows = [self._rows(kind, geometry, number) for geometry, number in parts]
        first = self.counts["triangles" if kind == TreeKind.TRIANGLES else "shapes"]
        for (geometry, _), own in zip(parts, rows, strict=True):
            self.first_prims.setdefault(geometry, first)
            first += len(own)
        rows = np.concatenate(rows) if len(rows) > 1 else rows[0]
        if kind == TreeKind.TRIANGLES:
            nodes, packets = accel.build_triangles(np.ascontiguousarray(rows["p"]))
            accel.rebase_packets(packets, self.counts["triangles"])
            accel.rebase(nodes, self.counts["nodes"], self.counts["packets"])
            self._append("packets", packets)
            self._append("triangles", rows)
        else:
            nodes, order = accel.build_boxes(*bounds(rows))
            accel.rebase(nodes, self.counts["nodes"], self.counts["shapes"])
            self._append("shapes", rows[order])
        root = self.counts["nodes"]
        self._append("nodes", nodes)
        return root

    def _append(self, table, rows):
        getattr(self, table).append(rows)
        self.counts[table] += len(rows)

    def _rows(self, kind, number, placement):
        """Rows of TRIANGLE or SHAPE of a geometry, in the world's space if a placement is given."""
        geometry = self.geometries[number]
        moved = placement is not None
        matrix = self.matrices[placement] if moved else np.eye(4)[:3]
        if kind == TreeKind.TRIANGLES:
            rows = triangle_rows(geometry, matrix, placement if moved else -1)
        else:
            rows = shapes.moved(geometry.rows, matrix)
            rows["instance"] = placement if moved else -1
            told = getattr(geometry, "strands", np.zeros(0, STRAND))
            if len(told):
                first = self.first_prims[number] = sum(map(len, self.strands))
                rows["strand"] += first
                self.strands.append(told)
        rows["light"] = geometry.light_ranks
        return rows

    def _instance_trees(self, numbers, world):
        """Trees over the instances with these numbers: those that stand still, and those that move."""
        if not len(numbers):
            return
        shared = self.instances[numbers]
        nodes, packets = _concatenate(self.nodes, NODE), _concatenate(self.packets, PACKET)
        low, high = motion.instance_bounds(shared, self.poses, int(world["pose_count"][0]), nodes, packets)
        moves = shared["motion"] > 0
        order = []
        for chosen, field in ((~moves, "instance_root"), (moves, "moving_root")):
            if not chosen.any():
                continue
            nodes, leaves = accel.build_boxes(low[chosen], high[chosen])
            accel.rebase(nodes, self.counts["nodes"], sum(map(len, order)))
            order.append(numbers[chosen][leaves])
            world[field] = self.counts["nodes"]
            self._append("nodes", nodes)
        # Leaves speak of rows of INSTANCE: put the shared ones first, in the order of the leaves.
        others = np.setdiff1d(np.arange(len(self.instances)), numbers)
        self._reorder_instances(np.concatenate([*order, others]))

    def _reorder_instances(self, order):
        """Let the rows of INSTANCE stand in another order: (n,) their numbers until now."""
        self.instances, self.objects = self.instances[order], self.objects[order]
        self.placements, self.motions = ([rows[n] for n in order] for rows in (self.placements, self.motions))
        self.matrices = self.matrices[order]
        renumbered = np.empty(len(order), np.int32)
        renumbered[order] = np.arange(len(order))
        for table in (*self.triangles, *self.shapes):
            moved = table["instance"] >= 0
            table["instance"][moved] = renumbered[table["instance"][moved]]

    def _poses(self, world):
        """The row of CAMERA and those of POSE; instances that move are told where theirs are."""
        camera = self.builder.camera_row.copy()
        camera["shutter"] = motion.shutter_times(self.builder.shutter_curve)
        of_camera = motion.moves("Camera", self.builder.camera_motion)
        moving = [number for number, poses in enumerate(self.motions) if poses is not None]
        motions = [self.motions[number] for number in moving] + ([] if of_camera is None else [of_camera])
        rows = motion.pose_rows(motions)
        if motions:
            world["pose_count"] = count = len(motions[0])
            self.instances["motion"][moving] = 1 + count * np.arange(len(moving))
            camera["motion"] = 0 if of_camera is None else 1 + count * len(moving)
        return camera, rows

    # ---- Light ----

    def _mark_emissive(self, number, users, materials):
        """Number the primitives of a geometry that emit, whatever material of its users makes them do so."""
        geometry = self.geometries[number]
        emissive = (materials["flags"] & MaterialFlag.EMISSIVE) > 0
        slots = np.zeros(size_of(geometry), np.int32) if slots_of(geometry) is None else geometry.slots
        emits = np.zeros(slot_count(geometry), bool)
        for first in np.unique(self.instances["slots"][users]):
            emits |= emissive[np.array(self.slots[first : first + len(emits)])]
        flags = emits[slots]
        geometry.light_ranks = np.where(flags, np.cumsum(flags) - 1, -1).astype(np.int32)
        geometry.emitters = np.flatnonzero(flags)

    def _lamps(self, world):
        shapes = self.builder.lamp_shapes
        if not shapes:
            return
        rows = np.array(shapes, SHAPE)
        nodes, order = accel.build_boxes(*bounds(rows))
        accel.rebase(nodes, self.counts["nodes"], self.counts["shapes"])
        world["lamp_root"] = self.counts["nodes"]
        self._append("shapes", rows[order])
        self._append("nodes", nodes)

    def _lamp_programs(self):
        """Programs of lamps, and rows of INSTANCE that tell of them: behind all others."""
        shaders = self.builder.lamp_shaders
        rows, told = instance_rows(shaders)
        first = len(self.instances)
        told["number"] = np.arange(first, first + len(told))
        for light in self.lights:
            if light["lamp"] >= 0:
                light["program"] = self.shading.lamp(shaders[light["lamp"]].factor)
                light["lamp"] += first
        self.instances, self.objects = np.concatenate([self.instances, rows]), np.concatenate([self.objects, told])

    def _lights(self, materials, world):
        """The table of lights: lamps, emissive primitives, the world; and the tree to select from."""
        background = light_rows(world, self.builder.world_radiance, self.builder.world_visibility)
        if background:
            world["background_light"] = len(self.lights)
            world["disk_light"] = len(self.lights) + 1 if len(background) > 1 else -1
            self.lights += background
        tables = [np.array(self.lights, LIGHT)] if self.lights else []
        count = len(self.lights)
        for number, placement in enumerate(self.placements):
            geometry = self.geometries[placement.geometry]
            if len(geometry.emitters):
                rows = self._emitters(number, placement, geometry, materials)
                if rows is not None:
                    self.instances[number]["lights"] = count
                    tables.append(rows)
                    count += len(rows)
        lights = _concatenate(tables, LIGHT)
        self._far_first(lights, world)
        world["light_count"] = len(lights)
        return lights

    def _far_first(self, lights, world):
        """Suns are looked for by every ray that leaves the scene, and weighed with beams at every place that is lit:
        they stand first among the lamps."""
        lamps = len(self.lights)
        is_sun = lights["kind"][:lamps] == LightKind.SUN
        is_sun[world["disk_light"][world["disk_light"] >= 0]] = False
        order = np.argsort(np.select([is_sun, is_far(lights[:lamps])], [0, 1], 2), kind="stable")
        lights[:lamps] = lights[:lamps][order]
        renumbered = np.empty(lamps, np.int32)
        renumbered[order] = np.arange(lamps)
        for table in self.shapes[-1:] if world["lamp_root"][0] >= 0 else []:
            table["light"] = renumbered[table["light"]]
        world["suns"], world["sun_count"] = 0, is_sun.sum()
        for field in ("background_light", "disk_light"):
            if world[field] >= 0:
                world[field] = renumbered[world[field]]

    def _emitters(self, number, placement, geometry, materials):
        """Rows of LIGHT for the emissive primitives of an instance; None if they cannot be sampled."""
        matrix = self.matrices[number]
        if self.motions[number] is not None:
            self.builder._warn(placement.name, "emits while it moves; rays find its light by chance alone")
            return None
        if kind_of(geometry) == TreeKind.SHAPES:
            if self._emits_by_program(number, materials):
                self.builder._warn(placement.name, "emits by a texture; rays find the light of a shape by chance alone")
                return None
            if not shapes.stay_themselves(geometry.rows[geometry.emitters], matrix).all():
                text = "emits, and is no sphere, box or rectangle as it is scaled; rays find its light by chance alone"
                self.builder._warn(placement.name, text)
                return None
            rows = shapes.lights(shapes.moved(geometry.rows[geometry.emitters], matrix))
        else:
            rows = triangle_lights(geometry, geometry.emitters, matrix)
        slots = slots_of(geometry)
        first = self.instances[number]["slots"]
        slots = np.zeros(len(rows), np.int32) if slots is None else slots[geometry.emitters]
        material = materials[np.array(self.slots)[first + slots]]
        rows["visibility"], rows["instance"], rows["prim"] = placement.visibility, number, geometry.emitters
        rows["emission"], rows["program"] = material["emission"], material["emission_program"]
        shines = rows["emission"].any(axis=1) | (rows["program"] > 0)
        rows["aimed_at"] = shines if placement.aim == Aim.AUTOMATIC else placement.aim == Aim.ALWAYS
        rows["two_sided"] = (material["flags"] & MaterialFlag.ONE_SIDED) == 0
        return rows

    def _emits_by_program(self, number, materials):
        return materials["emission_program"][self.slots[self.instances[number]["slots"]]] > 0

    def _targets(self, lights, world, nodes):
        """Lights, TARGET, NODE: behind the lights what is aimed at and does not shine; all that is aimed at; its tree
        behind all others."""
        geometries = [self.geometries[placement.geometry] for placement in self.placements]
        ranks = self.instances["lights"][: len(geometries)]
        dark = targets.dark_lights(self.placements, self.matrices, geometries, ranks)
        lights = _concatenate([lights, *dark], LIGHT)
        rows, tree = targets.make(lights, world)
        if len(tree):
            accel.rebase(tree, len(nodes), 0)
            world["target_root"] = len(nodes)
            nodes = _concatenate([nodes, tree], NODE)
        return lights, rows, nodes

    def _bounds(self, world):
        """A ball around everything that a ray can hit."""
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        nodes = _concatenate(self.nodes, NODE)
        for field in ("triangle_root", "shape_root", "instance_root", "moving_root", "lamp_root"):
            root = int(world[field][0])
            if root >= 0:
                low = np.minimum(low, nodes[root]["bounds"][:3].min(axis=1))
                high = np.maximum(high, nodes[root]["bounds"][3:].max(axis=1))
        if (low <= high).all():
            world["centre"], world["radius"] = (low + high) / 2, np.linalg.norm(high - low) / 2


def _concatenate(parts, dtype):
    if len(parts) == 1 and parts[0].ctypes.data % accel.CACHE_LINE == 0:
        return parts[0]
    rows = accel.aligned_rows(sum(len(part) for part in parts), dtype)
    return np.concatenate(parts, out=rows) if parts else rows


__all__ = ["CAMERA", "assemble"]
