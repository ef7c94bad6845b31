# SPDX-License-Identifier: GPL-3.0-or-later
"""From what a SceneBuilder collected to the tables of a Scene.

Geometry that stands in the world once is moved there and shares one tree with all others of its kind, so a ray has one
tree to walk; what stands there several times keeps its object space, and a tree of its own behind each transform.
"""

import numpy as np

from ..accel import build as accel
from ..accel.instances import instance_boxes
from ..jit import builder_kernel
from ..light.bounds import is_far
from ..light.select import prepare_selection
from ..shape.dispatch import bounds
from ..tables import (
    CAMERA,
    INSTANCE,
    LIGHT,
    LOBE,
    MATERIAL,
    NODE,
    PACKET,
    SHAPE,
    SLOT,
    TRANSMITTING,
    TRIANGLE,
    WORLD,
    LightKind,
    LobeKind,
    MaterialFlag,
    Scene,
    TreeKind,
    Visibility,
)
from . import checks, shapes

NOTHING = np.zeros((0, 0, 0), np.float32)


def assemble(builder, progress):
    """The Scene of everything in `builder`."""
    return _Assembly(builder, progress).scene()


class _Assembly:
    def __init__(self, builder, progress):
        self.builder, self.progress = builder, progress
        self.placements = self._regular_placements()
        self.slots = []
        self.instances = np.zeros(len(self.placements), INSTANCE)
        self.nodes, self.packets, self.triangles, self.shapes = [], [], [], []
        self.counts = dict.fromkeys(("nodes", "packets", "triangles", "shapes"), 0)
        self.lights = list(builder.lights)

    def scene(self):
        self.progress(0.0, "Materials")
        materials, lobes = self._materials()
        world = np.zeros(1, WORLD)
        for field in ("triangle_root", "shape_root", "instance_root", "lamp_root", "background_light"):
            world[field] = -1
        self._place(materials, world)
        self.progress(0.9, "Lights")
        self._lamps(world)
        self._bounds(world)
        lights, light_nodes = self._lights(materials, world)
        world["transparent_shadows"] = int((materials["flags"] & MaterialFlag.TRANSPARENT).any())
        return Scene(
            nodes=_concatenate(self.nodes, NODE),
            packets=_concatenate(self.packets, PACKET),
            triangles=_concatenate(self.triangles, TRIANGLE),
            shapes=_concatenate(self.shapes, SHAPE),
            instances=_concatenate([self.instances], INSTANCE),
            slots=np.array([(m,) for m in self.slots], SLOT),
            materials=materials,
            lobes=lobes,
            lights=lights,
            light_nodes=light_nodes,
            camera=self.builder.camera_row,
            world=world,
        )

    # ---- Materials ----

    def _materials(self):
        rows, lobes = np.zeros(len(self.builder.materials), MATERIAL), []
        first = 0
        for row, material in zip(rows, self.builder.materials, strict=True):
            row["lobes"], row["lobe_count"] = first, len(material.lobes)
            row["emission"], row["pass_index"] = material.emission, material.pass_index
            see_through = material.lobes["kind"] == LobeKind.TRANSPARENT
            row["transparency"] = np.minimum(material.lobes["weight"][see_through].sum(axis=0), 1.0)
            transmits = np.isin(material.lobes["kind"], TRANSMITTING)
            row["flags"] = (
                material.flags
                | (MaterialFlag.TRANSPARENT if see_through.any() else 0)
                | (MaterialFlag.TRANSMITS if transmits.any() else 0)
            )
            lobes.append(material.lobes)
            first += len(material.lobes)
        return rows, _concatenate(lobes, LOBE)

    # ---- Geometry ----

    def _regular_placements(self):
        """The placements that have a volume; the others cannot be seen and are left out with a warning."""
        kept = []
        for placement in self.builder.placements:
            placement.matrix, regular = checks.transform(placement.name, placement.to_world)
            geometry = self.builder.geometries[placement.geometry]
            if not regular:
                self.builder._warn(placement.name, "is scaled to 0 in some direction; left out")
            elif _size(geometry) > 0:
                kept.append(placement)
        return kept

    def _place(self, materials, world):
        users = {}
        for number, placement in enumerate(self.placements):
            users.setdefault(placement.geometry, []).append(number)
            self._instance_row(number, placement)
        alone = {TreeKind.TRIANGLES: [], TreeKind.SHAPES: []}
        shared = []
        for geometry, numbers in users.items():
            self._mark_emissive(geometry, numbers, materials)
            first = self.placements[numbers[0]]
            kind = _kind(self.builder.geometries[geometry])
            in_world = len(numbers) == 1 and first.visibility == Visibility.ALL
            if in_world and (kind == TreeKind.TRIANGLES or self._keeps_shapes(geometry, first)):
                alone[kind].append(numbers[0])
            else:
                shared.append((geometry, numbers))
        for step, (geometry, numbers) in enumerate(shared):
            self.progress(0.1 + 0.4 * step / len(shared), self.builder.geometries[geometry].name)
            self.instances["root"][numbers] = self._tree(_kind(self.builder.geometries[geometry]), [(geometry, None)])
        self.progress(0.5, "Tree of the world")
        for kind, field in ((TreeKind.TRIANGLES, "triangle_root"), (TreeKind.SHAPES, "shape_root")):
            if alone[kind]:
                world[field] = self._tree(kind, [(self.placements[n].geometry, n) for n in alone[kind]])
        self._instance_tree(np.array([n for _, numbers in shared for n in numbers], np.int64), world)

    def _keeps_shapes(self, geometry, placement):
        return shapes.keeps_shapes(self.builder.geometries[geometry].rows, placement.matrix)

    def _instance_row(self, number, placement):
        row, geometry = self.instances[number], self.builder.geometries[placement.geometry]
        row["to_world"] = placement.matrix
        row["to_object"] = inverse(placement.matrix)
        row["kind"], row["root"], row["lights"] = _kind(geometry), -1, -1
        row["visibility"], row["pass_index"], row["random"] = (
            placement.visibility,
            placement.pass_index,
            placement.random,
        )
        row["slots"] = self._slots(placement.materials, _slot_count(geometry))

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
        geometry = self.builder.geometries[number]
        moved = placement is not None
        matrix = self.placements[placement].matrix if moved else np.eye(4)[:3]
        if kind == TreeKind.TRIANGLES:
            rows = np.empty(len(geometry.triangles), TRIANGLE)
            fill_triangles(
                rows,
                geometry.positions,
                geometry.triangles,
                NOTHING if geometry.normals is None else geometry.normals,
                NOTHING if geometry.uvs is None else geometry.uvs,
                np.zeros(0, np.int32) if geometry.slots is None else geometry.slots,
                np.ascontiguousarray(matrix),
                np.ascontiguousarray(inverse(matrix)),
                placement if moved else -1,
            )
        else:
            rows = shapes.moved(geometry.rows, matrix)
            rows["instance"] = placement if moved else -1
        rows["light"] = geometry.light_ranks
        return rows

    def _instance_tree(self, numbers, world):
        if not len(numbers):
            return
        low, high = np.empty((2, len(numbers), 3), np.float32)
        shared = self.instances[numbers]
        instance_boxes(
            _concatenate(self.nodes, NODE),
            _concatenate(self.packets, PACKET),
            np.ascontiguousarray(shared["root"]),
            shared["kind"] == TreeKind.TRIANGLES,
            np.ascontiguousarray(shared["to_world"]),
            low,
            high,
        )
        nodes, order = accel.build_boxes(low, high)
        # Leaves speak of rows of INSTANCE: put the shared ones first, in the order of the leaves.
        ordered = numbers[order]
        others = np.setdiff1d(np.arange(len(self.instances)), ordered)
        new_order = np.concatenate([ordered, others])
        self.instances = self.instances[new_order]
        self.placements = [self.placements[n] for n in new_order]
        renumbered = np.empty(len(new_order), np.int32)
        renumbered[new_order] = np.arange(len(new_order))
        for table in (*self.triangles, *self.shapes):
            moved = table["instance"] >= 0
            table["instance"][moved] = renumbered[table["instance"][moved]]
        accel.rebase(nodes, self.counts["nodes"], 0)
        world["instance_root"] = self.counts["nodes"]
        self._append("nodes", nodes)

    # ---- Light ----

    def _mark_emissive(self, number, users, materials):
        """Number the primitives of a geometry that emit, whatever material of its users makes them do so."""
        geometry = self.builder.geometries[number]
        emissive = (materials["flags"] & MaterialFlag.EMISSIVE) > 0
        slots = np.zeros(_size(geometry), np.int32) if _primitive_slots(geometry) is None else geometry.slots
        emits = np.zeros(_slot_count(geometry), bool)
        for n in users:
            first = self.instances[n]["slots"]
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

    def _lights(self, materials, world):
        """The table of lights: lamps, emissive primitives, the world; and the tree to select from."""
        tables = [np.array(self.lights, LIGHT)] if self.lights else []
        count = len(self.lights)
        for number, placement in enumerate(self.placements):
            geometry = self.builder.geometries[placement.geometry]
            if len(geometry.emitters):
                rows = self._emitters(number, placement, geometry, materials)
                if rows is not None:
                    self.instances[number]["lights"] = count
                    tables.append(rows)
                    count += len(rows)
        if self.builder.world_radiance.any():
            row = np.zeros(1, LIGHT)
            row["kind"], row["visibility"] = LightKind.BACKGROUND, self.builder.world_visibility
            row["emission"], row["instance"], row["prim"] = self.builder.world_radiance, -1, -1
            world["background"], world["background_visibility"] = row["emission"], row["visibility"]
            world["background_light"] = count
            tables.append(row)
        lights = _concatenate(tables, LIGHT)
        self._far_first(lights, world)
        world["light_count"] = len(lights)
        return lights, prepare_selection(lights, world)

    def _far_first(self, lights, world):
        """Suns are looked for by every ray that leaves the scene, and weighed with beams at every place that is lit:
        they stand first among the lamps."""
        lamps = len(self.lights)
        is_sun = lights["kind"][:lamps] == LightKind.SUN
        order = np.argsort(np.select([is_sun, is_far(lights[:lamps])], [0, 1], 2), kind="stable")
        lights[:lamps] = lights[:lamps][order]
        renumbered = np.empty(lamps, np.int32)
        renumbered[order] = np.arange(lamps)
        for table in self.shapes[-1:] if world["lamp_root"][0] >= 0 else []:
            table["light"] = renumbered[table["light"]]
        world["suns"], world["sun_count"] = 0, is_sun.sum()

    def _emitters(self, number, placement, geometry, materials):
        """Rows of LIGHT for the emissive primitives of an instance; None if they cannot be sampled."""
        matrix = placement.matrix
        if _kind(geometry) == TreeKind.SHAPES:
            if not shapes.stay_themselves(geometry.rows[geometry.emitters], matrix).all():
                text = "emits, and as it is scaled no sphere, box or rectangle; rays find its light by chance alone"
                self.builder._warn(placement.name, text)
                return None
            rows = shapes.lights(shapes.moved(geometry.rows[geometry.emitters], matrix))
        else:
            rows = _triangle_lights(geometry, matrix)
        slots = _primitive_slots(geometry)
        first = self.instances[number]["slots"]
        slots = np.zeros(len(rows), np.int32) if slots is None else slots[geometry.emitters]
        material = materials[np.array(self.slots)[first + slots]]
        rows["visibility"], rows["instance"], rows["prim"] = placement.visibility, number, geometry.emitters
        rows["emission"] = material["emission"]
        rows["two_sided"] = (material["flags"] & MaterialFlag.ONE_SIDED) == 0
        return rows

    def _bounds(self, world):
        """A ball around everything that a ray can hit."""
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        nodes = _concatenate(self.nodes, NODE)
        for field in ("triangle_root", "shape_root", "instance_root", "lamp_root"):
            root = int(world[field][0])
            if root >= 0:
                low = np.minimum(low, nodes[root]["bounds"][:3].min(axis=1))
                high = np.maximum(high, nodes[root]["bounds"][3:].max(axis=1))
        if (low <= high).all():
            world["centre"], world["radius"] = (low + high) / 2, np.linalg.norm(high - low) / 2


# ---- Geometry, plainly -----------------------------------------------------------------------------------------------


def inverse(matrix):
    """The inverse of an affine transform (3, 4)."""
    linear = np.linalg.inv(matrix[:, :3])
    return np.concatenate([linear, -linear @ matrix[:, 3:]], axis=1)


def _triangle_lights(geometry, matrix):
    rows = np.zeros(len(geometry.emitters), LIGHT)
    p = geometry.positions[geometry.triangles[geometry.emitters]] @ matrix[:, :3].T + matrix[:, 3]
    if np.linalg.det(matrix[:, :3]) < 0.0:
        p = p[:, [0, 2, 1]]
    u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    normal = np.cross(u, v)
    length = np.linalg.norm(normal, axis=1)
    rows["kind"], rows["p"], rows["u"], rows["v"] = LightKind.TRIANGLE, p[:, 0], u, v
    rows["area"] = length / 2.0
    rows["n"] = normal / np.maximum(length, 1e-30)[:, None]
    return rows


def _kind(geometry):
    return TreeKind.SHAPES if isinstance(geometry, shapes.Shapes) else TreeKind.TRIANGLES


def _size(geometry):
    return len(geometry.rows if isinstance(geometry, shapes.Shapes) else geometry.triangles)


def _primitive_slots(geometry):
    return getattr(geometry, "slots", None)


def _slot_count(geometry):
    slots = _primitive_slots(geometry)
    return 1 if slots is None or not len(slots) else int(slots.max()) + 1


def _concatenate(parts, dtype):
    rows = accel.aligned_rows(sum(len(part) for part in parts), dtype)
    return np.concatenate(parts, out=rows) if parts else rows


@builder_kernel
def fill_triangles(rows, positions, triangles, normals, uvs, slots, matrix, inverted, instance):
    """Fill rows of TRIANGLE: gather corners, move them by `matrix`, and normals by the transpose of `inverted`.

    A transform that mirrors would turn triangles inside out; their second and third corner change places. Moved normals
    keep their length, so that interpolating them gives the same direction here and behind an instance's transform.
    """
    determinant = (
        matrix[0, 0] * (matrix[1, 1] * matrix[2, 2] - matrix[1, 2] * matrix[2, 1])
        - matrix[0, 1] * (matrix[1, 0] * matrix[2, 2] - matrix[1, 2] * matrix[2, 0])
        + matrix[0, 2] * (matrix[1, 0] * matrix[2, 1] - matrix[1, 1] * matrix[2, 0])
    )
    mirrored = determinant < 0.0
    smooth = normals.shape[0] > 0
    p, n = np.zeros((3, 3)), np.zeros(3)
    for i in range(triangles.shape[0]):
        row = rows[i]
        for corner in range(3):
            source = 3 - corner if mirrored and corner > 0 else corner
            vertex = triangles[i, source]
            for k in range(3):
                p[corner, k] = (
                    matrix[k, 0] * positions[vertex, 0]
                    + matrix[k, 1] * positions[vertex, 1]
                    + matrix[k, 2] * positions[vertex, 2]
                    + matrix[k, 3]
                )
                row.p[corner, k] = p[corner, k]
            if uvs.shape[0] > 0:
                row.uv[corner, 0], row.uv[corner, 1] = uvs[i, source, 0], uvs[i, source, 1]
            else:
                row.uv[corner, 0], row.uv[corner, 1] = 0.0, 0.0
        ax, ay, az = p[1, 0] - p[0, 0], p[1, 1] - p[0, 1], p[1, 2] - p[0, 2]
        bx, by, bz = p[2, 0] - p[0, 0], p[2, 1] - p[0, 1], p[2, 2] - p[0, 2]
        n[0], n[1], n[2] = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        length = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
        for k in range(3):
            n[k] = n[k] / length if length > 0.0 else (1.0 if k == 2 else 0.0)
        for corner in range(3):
            source = 3 - corner if mirrored and corner > 0 else corner
            total = 0.0
            if smooth:
                for k in range(3):
                    moved = (
                        inverted[0, k] * normals[i, source, 0]
                        + inverted[1, k] * normals[i, source, 1]
                        + inverted[2, k] * normals[i, source, 2]
                    )
                    row.n[corner, k] = moved
                    total += moved * moved
            if total == 0.0:
                for k in range(3):
                    row.n[corner, k] = n[k]
        row.slot = slots[i] if slots.shape[0] > 0 else 0
        row.instance = instance
        row.light = -1


__all__ = ["CAMERA", "assemble"]
