# SPDX-License-Identifier: GPL-3.0-or-later
"""Few or many of one kind: spheres, instances, lights."""

import colorsys
import math

import bpy
import numpy as np
from kit import (
    add,
    add_block,
    add_made,
    add_mesh,
    attribute,
    ball_group,
    camera,
    focus,
    instances_group,
    made_of_points,
    material,
    points_group,
    smooth_suzanne,
    spheres_at_points_group,
    world,
)

GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))
EARTH = 300.0  # radius of the ground under the random spheres


def three_spheres(scene):
    """After figure 5 of A. Desai, "Ray Tracing in Python", 2021, and P. Shirley, "Ray Tracing in One Weekend".

    Points of a point cloud are spheres in every engine. Cycles gives them no inside, though, so the glass is a fine
    mesh that is marked as a sphere for Lambent.
    """
    point, ball = points_group(), ball_group()
    ground = material("Ground", "BsdfDiffuse", Color=(0.18, 0.42, 0.06))
    matte = material("Matte", "BsdfDiffuse", Color=(0.12, 0.2, 0.5))
    metal = material("Metal", "BsdfMetallic", Base_Color=(0.8, 0.6, 0.2), Edge_Tint=(1, 0.9, 0.7), Roughness=0.0)
    glass = material("Glass", "BsdfGlass", IOR=1.5, Roughness=0.0)
    add_made("Ground", point, (0, 0, -100), 100.0, ground)
    add_made("Matte sphere", point, (0, 0, 0.5), 0.5, matte)
    add_made("Metal sphere", point, (1.05, 0, 0.5), 0.5, metal)
    add_made("Glass sphere", ball, (-1.05, 0, 0.5), 0.5, glass).lambent.shape = "SPHERE"
    world(scene, (0.5, 0.7, 1.0))
    camera(scene, (0, -6.0, 1.3), (0, 0, 0.42), field_of_view=34, size=(800, 450))


def random_spheres(scene):
    """After the cover of P. Shirley, "Ray Tracing in One Weekend", at dusk: 500 spheres, diffuse, metal of several
    roughnesses, glass, and some that shine."""
    random = np.random.default_rng(3)
    grid = np.mgrid[-11:11, -11:11].reshape(2, -1).T + random.uniform(0.1, 0.9, (484, 2))
    radius = random.uniform(0.14, 0.27, len(grid))
    big = np.array([(-4.0, 0.0), (0.0, 0.0), (4.0, 0.0)])
    grid, radius = np.vstack([grid, big]), np.append(radius, [1.0, 1.0, 1.0])
    apart = np.linalg.norm(grid[:, None] - big, axis=2).min(axis=1) > radius + 1.02
    apart[-3:] = True
    height = np.sqrt(EARTH**2 - (grid**2).sum(axis=1)) - EARTH
    extra = random.uniform([-11, -11, 1.4], [11, 8, 3.0], (500 - 1 - apart.sum(), 3))  # these hang in the air
    centres = np.vstack([np.column_stack([grid, height + radius])[apart], extra])
    radius = np.append(radius[apart], random.uniform(0.1, 0.18, len(extra)))

    count = len(centres)
    kind = random.choice(4, count, p=[0.5, 0.26, 0.16, 0.08])
    kind[: apart.sum()][-3:] = 0, 2, 1  # the big ones: diffuse, glass, metal
    kind[apart.sum() :] = 3
    looks = [
        [diffuse(f"Matte {i}", colorsys.hsv_to_rgb(i / 12, 0.75, 0.8 - 0.1 * (i % 3))) for i in range(12)],
        [metal(f"Metal {i}", random.uniform(0.5, 1, 3), (i % 4) * 0.12) for i in range(8)],
        [material("Glass", "BsdfGlass", IOR=1.5, Roughness=0.0)],
        [shining(f"Lamp {i}", color) for i, color in enumerate([(4, 1.6, 0.5), (4, 2.6, 1.2), (1.2, 2.0, 4)])],
    ]
    looks[0].append(diffuse("Big matte", (0.4, 0.2, 0.1)))
    looks[1].append(metal("Big metal", (0.7, 0.6, 0.5), 0.0))
    points, balls = spheres_at_points_group(), {}
    for k, materials in enumerate(looks):
        which = random.integers(0, max(len(materials) - (k < 2), 1), count)
        which[: apart.sum()][-3:] = len(materials) - 1
        for m, b_material in enumerate(materials):
            chosen = (kind == k) & (which == m)
            if not chosen.any():
                continue
            if k < 2:
                made_of_points(b_material.name, centres[chosen], radius[chosen], points, Material=b_material)
            else:  # a point has no inside, nor does Cycles aim at it as at a lamp: fine meshes, marked as spheres
                balls[b_material.name] = ball_collection(b_material, 512 if k == 2 else 96)
                group = instances_group(balls[b_material.name], has_radius=True)
                made_of_points(b_material.name, centres[chosen], radius[chosen], group)
    ground = diffuse("Ground", (0.4, 0.4, 0.4))
    add_made("Ground", points_group(), (0, 0, -EARTH), EARTH, ground)
    world(scene, (0.16, 0.24, 0.42))
    camera(scene, (12, -5.5, 2.4), (0, 0.3, 0.35), field_of_view=33, size=(960, 540))
    focus(scene, distance=9.6, lens_radius=0.05)


def diffuse(name, color):
    return material(name, "BsdfDiffuse", Color=tuple(map(float, color)))


def metal(name, color, roughness):
    return material(name, "BsdfGlossy", Color=tuple(map(float, color)), Roughness=roughness)


def shining(name, color):
    return material(name, "Emission", Color=tuple(map(float, color)), Strength=5.0)


def ball_collection(b_material, segments):
    """A collection with one ball of radius 1 in it, which Lambent takes for a sphere."""
    collection = bpy.data.collections.new(b_material.name)
    ball = add_made(f"Ball of {b_material.name}", ball_group(segments), (0, 0, 0), 1.0, b_material)
    ball.lambent.shape = "SPHERE"
    bpy.context.scene.collection.objects.unlink(ball)
    collection.objects.link(ball)
    return collection


def instances(scene):
    """Suzannes on the spiral of a sunflower (H. Vogel 1979): one mesh, materials by object."""
    looks = {
        "Ivory": {"Base_Color": (0.8, 0.72, 0.55), "Roughness": 0.45},
        "Coral": {"Base_Color": (0.75, 0.16, 0.08), "Roughness": 0.3, "Coat_Weight": 0.6, "Coat_Roughness": 0.2},
        "Petrol": {"Base_Color": (0.02, 0.2, 0.25), "Roughness": 0.35},
        "Gold": {"Base_Color": (0.9, 0.6, 0.2), "Metallic": 1.0, "Roughness": 0.25},
        "Steel": {"Base_Color": (0.55, 0.57, 0.6), "Metallic": 1.0, "Roughness": 0.4},
    }
    suzanne = smooth_suzanne()
    kinds = bpy.data.collections.new("Suzannes")
    for name, look in looks.items():
        b_object = bpy.data.objects.new(f"Suzanne {name}", suzanne)
        b_object.material_slots[0].link = "OBJECT"
        b_object.material_slots[0].material = material(name, "BsdfPrincipled", **look)
        kinds.objects.link(b_object)

    count, random = 10_000, np.random.default_rng(7)
    i = np.arange(count) + 0.5
    radius, angle = 0.62 * np.sqrt(i), GOLDEN_ANGLE * i
    height = 0.4 + 5.0 * np.exp(-((radius / 16.0) ** 2))
    positions = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height])
    tilt = random.normal(0.0, 0.2, (count, 2)) - (0.4, 0.0)
    turn = angle + math.pi / 2 + random.normal(0.0, 0.2, count)  # outwards
    spiral = bpy.data.meshes.new("Spiral")
    spiral.from_pydata(positions, [], [])
    attribute(spiral, "rotation", "FLOAT_VECTOR", np.column_stack([tilt, turn]))
    attribute(spiral, "kind", "INT", (i.astype(np.int32) % 55) // 11)
    add("Spiral", spiral).modifiers.new("Instances", "NODES").node_group = instances_group(kinds)

    side = 200
    ground = material("Ground", "BsdfDiffuse", Color=(0.35, 0.33, 0.3))
    add_mesh("Ground", [(-side, -side, 0), (side, -side, 0), (side, side, 0), (-side, side, 0)], [(0, 1, 2, 3)], ground)
    sun = add("Sun", bpy.data.lights.new("Sun", "SUN"), rotation_euler=(math.radians(50), 0, math.radians(-35)))
    sun.data.energy, sun.data.angle, sun.data.color = 3.5, math.radians(2.0), (1.0, 0.9, 0.75)
    world(scene, (0.22, 0.32, 0.5))
    camera(scene, (0, -44, 24), (0, -8, 1.5), field_of_view=46, size=(960, 540))


def many_lights(scene):
    """A thousand lights in a hall: 100 lamps along the walls and 900 lanterns on garlands between the columns, each of
    them eight shining triangles."""
    random = np.random.default_rng(11)
    w, length, h = 6.0, 36.0, 7.0  # half the width, length, height
    stone, floor = diffuse("Stone", (0.5, 0.46, 0.4)), diffuse("Floor", (0.42, 0.3, 0.22))
    corners = [(x, y, z) for z in (0.0, h) for x, y in ((-w, -4.0), (w, -4.0), (w, length), (-w, length))]
    add_mesh("Floor", corners, [(0, 1, 2, 3)], floor)
    add_mesh("Hall", corners, [(4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)], stone)
    rows = np.arange(1.0, 33.0, 4.0)
    angle = np.arange(24) * (2 * math.pi / 24)
    ring = 0.45 * np.column_stack([np.cos(angle), np.sin(angle)])
    for y in rows:
        for x in (-3.0, 3.0):
            add_block("Column", h, [(x + a, y + b) for a, b in ring], stone)

    colors = [(1, 0.62, 0.3), (1, 0.35, 0.12), (1, 0.8, 0.55), (0.5, 0.7, 1.0), (1, 0.3, 0.45)]
    lanterns = bpy.data.collections.new("Lanterns")
    for i, color in enumerate(colors):
        lantern = add_mesh(f"Lantern {i}", *OCTAHEDRON, material(f"Glow {i}", "Emission", Color=color, Strength=45.0))
        scene.collection.objects.unlink(lantern)
        lanterns.objects.link(lantern)
    hung = []
    for i in range(36):  # garlands of 25 lanterns
        side, row = divmod(i, 18)
        a = np.array([(-3.0, 3.0)[side], rows[row % 6], 5.2 + 0.6 * (row // 6)])
        b = a + [(0, 4, 0), (6.0 - 12.0 * side, 4, 0), (6.0 - 12.0 * side, 0, 0)][row // 6]
        t = (np.arange(25) + 0.5) / 25
        line = a + (b - a) * t[:, None]
        line[:, 2] -= (2.4 + 0.8 * side) * t * (1 - t) + random.uniform(0, 0.1, 25)
        hung.append(line)
    positions = np.vstack(hung)
    garlands = bpy.data.meshes.new("Garlands")
    garlands.from_pydata(positions, [], [])
    attribute(garlands, "rotation", "FLOAT_VECTOR", random.uniform(0, 3, positions.shape))
    attribute(garlands, "kind", "INT", random.integers(0, len(colors), len(positions)))
    group = instances_group(lanterns, scale=0.05)
    add("Garlands", garlands).modifiers.new("Lanterns", "NODES").node_group = group

    lamps = []
    for i, color in enumerate(colors):
        lamp = bpy.data.lights.new(f"Lamp {i}", "POINT")
        lamp.energy, lamp.color, lamp.shadow_soft_size = 12.0 + 8.0 * (i % 2), color, 0.04
        lamp.use_soft_falloff = False  # a ball, not a disk that turns to whoever looks
        lamps.append(lamp)
    for i in range(100):  # two lines of 25 along each wall
        side, place = divmod(i, 50)
        line, step = divmod(place, 25)
        location = ((-w + 0.2, w - 0.2)[side], -1.0 + 1.4 * step, 0.6 + 2.2 * line)
        add(f"Lamp {i}", lamps[(line + step) % len(lamps)], location=location)
    world(scene, (0, 0, 0))
    camera(scene, (-0.9, -3.4, 1.6), (0.15, 14, 2.9), field_of_view=64, size=(960, 540))


OCTAHEDRON = (
    [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1.4), (0, 0, -1.4)],
    [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)],
)
