# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes moved by their materials: the vertices by the program of the displacement, then the normals, as Cycles does.

A mesh is moved once for each set of materials that it has, as its first instance stands; whoever shares both shares the
moved mesh. A vertex that two materials share goes where the first triangle's takes it.
"""

from dataclasses import replace

import numpy as np

from ..jit import kernel
from ..linalg.transform import transform_vector
from ..linalg.vec3 import BLACK, load3
from ..shader import graph
from ..shader.evaluate import run_program
from ..shader.machine import SurfaceHit
from ..shader.opcodes import InputVector
from ..shader.point import new_point, set_surface
from ..shape.interaction import make_interaction, new_interaction
from ..tables import SLOT, Scene, TreeKind, Visibility
from .flattening import Surface
from .triangles import triangle_rows

TRIANGLES = int(TreeKind.TRIANGLES)
SAME = 1e-3  # largest distance of normals that are taken for the same
ONE, ZERO = np.float32(1.0), np.float32(0.0)
ALL = int(Visibility.ALL)
GENERATED = "<generated>"  # name of an attribute: generated coordinates from before; no attribute of an artist has it


def undisplaced(surface):
    """The Surface with generated coordinates as they were before it was displaced."""

    def before(value):
        return graph.from_attribute(value, InputVector.GENERATED, GENERATED)

    closures = [(row, {name: before(value) for name, value in varying.items()}) for row, varying in surface.closures]
    return Surface(closures, *map(before, surface[1:]))


def add_generated(placements, geometries, displacements):
    """Give meshes that will be displaced the attribute of their generated coordinates."""
    for placement in placements:
        mesh = geometries[placement.geometry]
        moves = any(material in displacements for material in placement.materials)
        if moves and hasattr(mesh, "triangles") and GENERATED not in mesh.attributes:
            values = np.ones((len(mesh.triangles), 3, 4), np.float32)
            scale, offset = mesh.texture_space
            values[..., :3] = (mesh.positions * scale + offset)[mesh.triangles]
            geometries[placement.geometry] = replace(mesh, attributes={**mesh.attributes, GENERATED: values})


def displace(placements, geometries, shading, tables, instances, objects, slots, warn):
    """Replace the geometries of placements whose materials displace them.

    Parameters
    ----------
    placements : list of Placement; those that are displaced are replaced by ones with another number of geometry
    geometries : list, to which displaced meshes are appended
    shading : Shading, which has the programs
    tables : tables of Scene that programs need beside their own, by name
    instances, objects, slots : rows of INSTANCE and OBJECT, one a placement, and numbers of materials by slot
    warn : function of an object's name and a text
    """
    if not shading.displacements:
        return
    made, displacements = {}, shading.displacements
    tables = {**tables, **shading.programs.tables()}
    for number, placement in enumerate(placements):
        if not any(material in displacements for material in placement.materials):
            continue
        key = placement.geometry, placement.materials
        if key not in made:
            mesh = geometries[placement.geometry]
            if not hasattr(mesh, "triangles"):
                warn(placement.name, "is no mesh, and is not displaced by its material")
                made[key] = placement.geometry
            else:
                made[key] = len(geometries)
                rows = instances[number : number + 1].copy(), objects[number : number + 1].copy()
                geometries.append(_displaced(mesh, displacements, tables, *rows, slots))
        placements[number] = replace(placement, geometry=made[key])


def _displaced(mesh, displacements, tables, instance, told, slots):
    """The mesh as its materials move it."""
    rows = triangle_rows(mesh, np.eye(4)[:3], -1)
    told["first_prim"], instance["motion"] = 0, 0
    empty = {name: np.zeros(0, dtype) for name, dtype in Scene.dtypes().items()}
    own = {"triangles": rows, "instances": instance, "objects": told, "slots": np.array([(m,) for m in slots], SLOT)}
    scene = Scene(**{**empty, **tables, **own})
    programs = np.zeros(len(tables["materials"]), np.int32)
    for material, (program, _) in displacements.items():
        programs[material] = program
    offsets = np.zeros((len(mesh.positions), 3), np.float32)
    _fill_offsets(scene, programs, mesh.triangles, offsets, np.zeros(len(offsets), np.bool_))
    positions = mesh.positions + np.where(np.isfinite(offsets), offsets, 0.0).astype(np.float32)
    moved = replace(mesh, positions=positions)
    if mesh.normals is None:
        return moved
    of_triangle = np.array(slots)[instance["slots"][0] + rows["slot"]]
    changes = np.array([m in displacements and not displacements[m][1] for m in range(len(programs))])[of_triangle]
    return replace(moved, normals=_normals(mesh, moved, changes))


@kernel
def _fill_offsets(scene, programs, triangles, offsets, done):
    """How far each vertex is moved, object space; `programs`: rows of PROGRAM by material, 0 for none."""
    point, it, instance = new_point(), new_interaction(), scene.instances[0]
    for i in range(len(triangles)):
        program = programs[scene.slots[instance.slots + scene.triangles[i].slot].material]
        if program <= 0:
            continue
        for corner in range(3):
            vertex = triangles[i, corner]
            if done[vertex]:
                continue
            done[vertex] = True
            hit = SurfaceHit(ZERO, TRIANGLES, i, 0, ONE if corner == 1 else ZERO, ONE if corner == 2 else ZERO)
            make_interaction(scene, it, hit, BLACK, BLACK, ZERO)
            set_surface(scene, point, it, hit, load3(it, "ns"), ALL, ZERO)
            offset = transform_vector(instance, "to_object", run_program(scene, program, point))
            offsets[vertex, 0], offsets[vertex, 1], offsets[vertex, 2] = offset.x, offset.y, offset.z


def _normals(mesh, moved, changes):
    """Normals of the corners of the moved mesh, float32 (n, 3, 3), where `changes` (n,) says that they change.

    Of smooth triangles, the means of the faces around a vertex; if corners of a vertex differ, at sharp edges, what
    they have beside those means stays. Triangles at such vertices with the normal of their face are flat ones.
    """
    faces, faces_after = _unit(_face_normals(mesh)), _unit(_face_normals(moved))
    first = np.zeros((len(mesh.positions), 3), np.float32)
    first[mesh.triangles] = mesh.normals
    splits = np.zeros(len(first), np.bool_)
    splits[mesh.triangles[np.abs(first[mesh.triangles] - mesh.normals).max(axis=-1) > SAME]] = True
    is_flat = np.abs(mesh.normals - faces[:, None]).max(axis=(1, 2)) < SAME
    is_flat &= splits[mesh.triangles].any(axis=1)
    before, after = (_vertex_normals(mesh, n)[mesh.triangles] for n in (faces, faces_after))
    smooth = _unit(mesh.normals + after - before) if splits.any() else after
    normals = np.where(is_flat[:, None, None], faces_after[:, None], smooth)
    return np.where(changes[:, None, None], normals, mesh.normals).astype(np.float32)


def _face_normals(mesh):
    p = mesh.positions.astype(np.float64)[mesh.triangles]
    return np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])


def _vertex_normals(mesh, faces):
    """Unit means of the unit normals of the faces around each vertex."""
    corners, sums = mesh.triangles.ravel(), np.repeat(faces, 3, axis=0)
    total = [np.bincount(corners, sums[:, axis], len(mesh.positions)) for axis in range(3)]
    return _unit(np.stack(total, axis=1))


def _unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-30)
