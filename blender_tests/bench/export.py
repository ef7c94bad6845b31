# SPDX-License-Identifier: GPL-3.0-or-later
"""How fast Blender's scene is read: from an evaluated object to arrays in a SceneBuilder.

The mesh has a million triangles, made from quads, with smooth normals, a UV map and three materials; each round it is
evaluated anew, so that Blender has none of its normals and triangles ready. Besides, 10,000 instances of Suzanne.
"""

import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
INSTANCES = 10_000


def run(quick=False):
    """{"triangles_per_s", "instances_per_s"}: medians. Measured in a process of its own, since it loads Blender."""
    command = [sys.executable, "-m", "blender_tests.bench.export", str(2 if quick else 9)]
    output = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True).stdout
    return json.loads(output.splitlines()[-1])


def measure(rounds):
    """The figures, in a process with bpy."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera

    big = big_mesh()
    triangles = [len(big.loop_triangles) / export_s(big) for _ in range(rounds)]
    bpy.data.meshes.remove(big)
    suzanne = instances_of_suzanne()
    instances = [INSTANCES / export_s(suzanne) for _ in range(rounds)]
    return {"triangles_per_s": statistics.median(triangles), "instances_per_s": statistics.median(instances)}


def export_s(b_mesh):
    """Seconds that one export of the open scene takes, `b_mesh` evaluated anew."""
    import bpy

    from addon.export import Report, export_scene

    b_mesh.update_tag()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    began = time.perf_counter()
    export_scene(depsgraph, Report(), 100, 100)
    return time.perf_counter() - began


def big_mesh():
    import bpy
    import numpy as np

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=708, y_subdivisions=708)
    b_mesh = bpy.context.object.data
    b_mesh.shade_smooth()
    for i in range(3):
        b_mesh.materials.append(bpy.data.materials.new(f"Material {i}"))
    b_mesh.polygons.foreach_set("material_index", np.arange(len(b_mesh.polygons), dtype=np.int32) % 3)
    return b_mesh


def instances_of_suzanne():
    """Suzanne on every vertex of a grid, by instancing on vertices."""
    import bpy

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=99, y_subdivisions=99, size=200)
    grid = bpy.context.object
    bpy.ops.mesh.primitive_monkey_add()
    bpy.context.object.parent = grid
    grid.instance_type = "VERTS"
    return bpy.context.object.data


if __name__ == "__main__":
    print(json.dumps(measure(int(sys.argv[1]))), flush=True)
    os._exit(0)  # bpy 4.5.15 hangs when it is unloaded: OpenVDB waits for a thread of its own
