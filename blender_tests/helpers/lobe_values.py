# SPDX-License-Identifier: GPL-3.0-or-later
"""What scatters from one direction into another in Cycles, without noise; and the table of `bsdf/sheen.py` by that.

Tilted squares are seen from above in parallel, and lit by a sun without size: each has the value of its BSDF in one
pixel. For processes where bpy is. `python -m blender_tests.helpers.lobe_values FILE` measures the table anew.
"""

import math
import os
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from .cycles import set_up_cycles
from .small_blend import enable_cycles, render

PIXELS = 3  # along a side of a square; the middle one counts
MIDDLE, FIRST_TRIANGLE = (1, 1), (0, 2)  # (row, column) of a pixel of these
NODES = 32  # of the table, along roughness and cosine


def cycles_values(closures, cosines, directions, pixel=MIDDLE):
    """(f |cos|, wo, wi) of shader nodes in Cycles, seen at each cosine and lit from each direction, seen from z.

    `closures` are functions that add a node to a tree and return its output. f is (directions, closures, cosines, 3),
    wo (cosines, 3) and wi (directions, cosines, 3), both in the frame whose x leads towards the viewer. The edges of
    the FIRST_TRIANGLE of each square lead along y, and towards the viewer.
    """
    (f,) = values_of_engines(closures, cosines, directions, ["CYCLES"], pixel)
    directions = np.asarray(directions, float)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    cos, sin = np.asarray(cosines), np.sqrt(1 - np.square(cosines))
    n, x = np.stack([0 * cos, sin, cos], axis=1), np.stack([0 * cos, -cos, sin], axis=1)
    frame = np.stack([x, np.cross(n, x), n], axis=1)  # rows
    return f, np.stack([sin, 0 * cos, cos], axis=1), np.einsum("cij,dj->dci", frame, directions)


def values_of_engines(closures, cosines, directions, engines, pixel=MIDDLE):
    """f |cos| of shader nodes as each engine renders them, (directions, closures, cosines, 3); see `cycles_values`."""
    scene, sun = _scene(closures, cosines)
    f = [[] for _ in engines]
    with tempfile.TemporaryDirectory() as folder:
        for own, engine in zip(f, engines, strict=True):
            scene.render.engine = engine
            for d in directions:
                sun.rotation_euler = Vector(d).to_track_quat("Z", "Y").to_euler()
                picture = render(Path(folder, "lobes.exr"), scene)
                own.append(picture[pixel[0] :: PIXELS, pixel[1] :: PIXELS, :3])
    return [np.array(own, float) for own in f]


def _scene(closures, cosines):
    """Squares in columns by cosine and rows by closure, whose tilt the view from above hides; and the sun."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene, mesh = bpy.context.scene, bpy.data.meshes.new("Squares")
    corners = [
        (column + a, row + b, -(b - 0.5) * math.sqrt(1 - cos * cos) / cos)
        for row in range(len(closures))
        for column, cos in enumerate(cosines)
        for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    mesh.from_pydata(corners, [], [range(i, i + 4) for i in range(0, len(corners), 4)])
    mesh.polygons.foreach_set("material_index", np.repeat(np.arange(len(closures)), len(cosines)))
    for closure in closures:
        material = bpy.data.materials.new("Closure")
        if not material.node_tree:  # Blender 4
            material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        tree.links.new(closure(tree), tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        mesh.materials.append(material)
    columns, rows = len(cosines), len(closures)
    camera, lamp = bpy.data.cameras.new("Camera"), bpy.data.lights.new("Sun", "SUN")
    camera.type, camera.ortho_scale, camera.clip_end = "ORTHO", max(columns, rows), 1000
    lamp.energy, lamp.angle = 1, 0
    scene.camera, sun = bpy.data.objects.new("Camera", camera), bpy.data.objects.new("Sun", lamp)
    scene.camera.location = (columns / 2, rows / 2, 100)
    for new in (scene.camera, sun, bpy.data.objects.new("Squares", mesh)):
        scene.collection.objects.link(new)
    new.visible_shadow = new.visible_diffuse = new.visible_glossy = False  # the squares stand in each other's way
    scene.render.resolution_x, scene.render.resolution_y = columns * PIXELS, rows * PIXELS
    enable_cycles()
    set_up_cycles(scene, samples=1)
    scene.cycles.pixel_filter_type, scene.cycles.max_bounces = "BOX", 0
    if hasattr(scene, "lambent"):
        ours = scene.lambent
        ours.samples, ours.use_adaptive, ours.filter_type, ours.filter_width, ours.max_bounces = (
            1,
            False,
            "BOX",
            0.01,
            0,
        )
    return scene, sun


def node(kind, settings=None, **inputs):
    """A closure for `cycles_values`."""

    def add(tree):
        new = tree.nodes.new(f"ShaderNodeBsdf{kind.replace('Glossy', 'Anisotropic')}")  # its name of old
        for name, value in (settings or {}).items():
            setattr(new, name, value)
        for name, value in inputs.items():
            new.inputs[name].default_value = value
        return new.outputs[0]

    return add


def around(heights, count):
    """Directions around the sphere, `count` at each height."""
    return [
        (math.sqrt(1 - z * z) * math.cos(phi), math.sqrt(1 - z * z) * math.sin(phi), z)
        for z in heights
        for phi in 2 * math.pi * (np.arange(count) + 0.3 * z) / count
    ]


def measure_sheen():
    """(3, roughness, cosine): A, B and the albedo of microfiber sheen (see `bsdf/sheen.py`), at both from 0 to 1.

    With q = sqrt(z / (pi f)), the distribution is q = c1 (x^2 + y^2) + c2 x z + c3 z^2: linear, and A, B and the albedo
    follow from the three numbers. Neither 0 can be measured itself, but as Cycles interpolates in its table of the
    same size, they follow from the values beside them.
    """
    at = np.linspace(0, 1, NODES)
    cosines, roughness = at.copy(), at.copy()
    cosines[0], roughness[0] = 0.5 * at[1], 1e-3
    white = (1, 1, 1, 1)
    closures = [node("Sheen", {"distribution": "MICROFIBER"}, Color=white, Roughness=r) for r in roughness]
    f, _, wi = cycles_values(closures, cosines, around((0.95, 0.7, 0.4, 0.15, -0.05, -0.12, -0.21, -0.29), 8))
    table = np.full((3, NODES, NODES), np.nan)
    for row, column in np.ndindex(NODES, NODES):
        (x, y, z), value = wi[:, column].T, f[:, row, column, 0]
        ok = (z > 0.02) & (value > 1e-12)
        if ok.sum() >= 6:
            q = np.sqrt(z[ok] / (math.pi * value[ok]))
            terms = np.stack([x**2 + y**2, x * z, z**2], axis=1)[ok]
            c1, c2, c3 = np.linalg.lstsq(terms / q[:, None], np.ones_like(q), rcond=None)[0]
            albedo = 1 / (c1 * c3 - 0.25 * c2 * c2)
            table[:, row, column] = c1 * math.sqrt(albedo), 0.5 * c2 * math.sqrt(albedo), albedo
    table[:, :, 0] = 2 * table[:, :, 0] - table[:, :, 1]
    table[:, 0] += (table[:, 0] - table[:, 1]) * (roughness[0] / at[1])
    for row, column in zip(*np.nonzero(np.isnan(table[0])), strict=True):  # too dark to be seen
        known = np.nonzero(np.isfinite(table[0, :, column]))[0]
        nearest = known[abs(known - row).argmin()]
        table[:, row, column] = *table[:2, nearest, column], 0
    table[0] = table[0].clip(1e-3, None)  # the little that is there may come from anywhere
    table[2] = table[2].clip(0, 1)
    return table.astype(np.float32)


if __name__ == "__main__":
    np.savez(sys.argv[1], microfiber=measure_sheen())
    sys.stdout.flush()
    os._exit(0)  # bpy 4.5 would wait for ever
