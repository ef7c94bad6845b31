# SPDX-License-Identifier: GPL-3.0-or-later
"""The box of Cornell University, empty but for three sets of things."""

import math

from kit import add_block, add_cuboid, add_made, add_mesh, ball_group, camera, material, points_group, world

TALL = [(-1.455, 2.47), (0.125, 2.96), (-0.365, 4.56), (-1.945, 4.06)]  # corners on the floor
SHORT = [(1.475, 0.65), (1.955, 2.25), (0.375, 2.72), (-0.125, 1.14)]
ALUMINIUM = (0.8, 0.85, 0.88)


def cornell_box(scene):
    """Two white blocks."""
    white = cornell_walls(scene)
    add_block("Tall block", 3.3, TALL, white)
    add_block("Short block", 1.65, SHORT, white)


def cornell_mirror(scene):
    """The first of the two worlds in which A. Desai, "Ray Tracing in Python", 2021, compares ways to sample: the tall
    block, moved and turned, is a mirror (his figure 13)."""
    white = cornell_walls(scene)
    add_mirror()
    add_block("Short block", 1.65, SHORT, white)


def cornell_glass(scene):
    """The second of them: a mirror block, a glass ball, and a smaller ball of metal (his figure 15)."""
    cornell_walls(scene)
    metal = material("Brass", "BsdfGlossy", Color=(0.85, 0.62, 0.3), Roughness=0.25)
    glass = material("Glass", "BsdfGlass", IOR=1.5, Roughness=0.0)
    add_mirror()
    add_made("Glass ball", ball_group(), (0.95, 1.75, 0.9), 0.9, glass).lambent.shape = "SPHERE"
    add_made("Metal ball", points_group(), (-1.0, 1.2, 0.5), 0.5, metal)


def add_mirror():
    """The tall block, turned further than the white one, so that it shows both walls instead of the dark before it."""
    mirror = material("Aluminium", "BsdfGlossy", Color=ALUMINIUM, Roughness=0.0)
    add_cuboid("Mirror block", (-0.825, -0.825, 0), (0.825, 0.825, 3.3), mirror, (-0.95, 3.5, 0), math.radians(33))


def cornell_walls(scene):
    """Walls, light and camera; returns the white material. Sizes as measured at Cornell University
    (www.graphics.cornell.edu/online/box/data.html), in decimetres; colours as in P. Shirley, "Ray Tracing: The Rest of
    Your Life"."""
    white, red, green = (
        material(name, "BsdfDiffuse", Color=color)
        for name, color in (("White", (0.73, 0.73, 0.73)), ("Red", (0.65, 0.05, 0.05)), ("Green", (0.12, 0.45, 0.15)))
    )
    light = material("Light", "Emission", Color=(1.0, 0.82, 0.6), Strength=24.0)
    w, d, h = 5.5, 5.6, 5.5  # width, depth, height
    left, right = -w / 2, w / 2
    box = [
        ("Floor", [(left, 0, 0), (right, 0, 0), (right, d, 0), (left, d, 0)], white),
        ("Back wall", [(left, d, 0), (right, d, 0), (right, d, h), (left, d, h)], white),
        ("Left wall", [(left, 0, 0), (left, d, 0), (left, d, h), (left, 0, h)], red),
        ("Right wall", [(right, 0, 0), (right, 0, h), (right, d, h), (right, d, 0)], green),
    ]
    for name, corners, b_material in box:
        add_mesh(name, corners, [(0, 1, 2, 3)], b_material)
    # the ceiling leaves a hole for the light, whose back therefore shines on nothing
    ceiling = [(left, 0, h), (left, d, h), (right, d, h), (right, 0, h)]
    hole = [(-0.65, 2.27, h), (-0.65, 3.32, h), (0.65, 3.32, h), (0.65, 2.27, h)]
    around = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    add_mesh("Ceiling", [*ceiling, *hole], around, white)
    add_mesh("Light", hole, [(0, 1, 2, 3)], light)
    world(scene, (0, 0, 0))
    camera(scene, (0, -8.0, h / 2), (0, 0, h / 2), field_of_view=38, size=(512, 512))
    return white
