# SPDX-License-Identifier: GPL-3.0-or-later
"""The box of Cornell University: by round figures, empty but for four sets of things, and as it was measured."""

import math

from kit import (
    add_block,
    add_cuboid,
    add_made,
    add_mesh,
    arrange,
    ball_group,
    camera,
    material,
    plug,
    points_group,
    shader,
    wired_material,
    world,
)
from spectra import LAMP_REFLECTANCE, lamp_color, reflectance

TALL = [(-1.455, 2.47), (0.125, 2.96), (-0.365, 4.56), (-1.945, 4.06)]  # corners on the floor
SHORT = [(1.475, 0.65), (1.955, 2.25), (0.375, 2.72), (-0.125, 1.14)]
ALUMINIUM = (0.8, 0.85, 0.88)
AROUND = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]  # faces between corners 0 to 3 and a hole, 4 to 7


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


def cornell_smoke(scene):
    """A box of black smoke and a ball of white fog under a larger lamp (figure 14 of the paper), as dense as those in
    P. Shirley, "Ray Tracing: The Next Week": a hundredth in a unit of which the room is 555 wide, here 5.55."""
    cornell_walls(scene, lamp=((-1.65, 1.27), (1.65, 4.32)), strength=5.0)
    smoke = add_block("Smoke", 3.3, TALL, medium("Black smoke", (0.0, 0.0, 0.0), density=1.0))
    smoke.location.z = 0.01  # a floor and the end of a volume in one plane are two surfaces in one place
    add_made("Fog", ball_group(128), (1.0, 1.8, 0.95), 0.9, medium("White fog", (1.0, 1.0, 1.0), density=1.0))
    let_light_scatter(scene)


def medium(name, color, density):
    """A material without a surface. Light goes a way of 1 / density on average, in metres, until it meets a particle:
    `color` of it is then scattered in all directions alike, and the rest is gone."""
    b_material, tree, _ = wired_material(name)
    volume = shader(tree, "VolumePrincipled", Color=color, Density=density)
    plug(tree, volume.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
    arrange(tree)
    b_material.diffuse_color = (*color, 1.0)
    return b_material


def let_light_scatter(scene, times=12):
    """Light that scatters in a volume more than that often is lost, in Blender's default more than not at all."""
    for settings in (scene.cycles, scene.lambent):
        if hasattr(settings, "volume_bounces"):
            settings.volume_bounces = times


def cornell_measured(scene):
    """Corners and spectra as they were measured at Cornell University (www.graphics.cornell.edu/online/box/data.html):
    neither is the box a cuboid nor its white white. In decimetres; x goes to the left there, and y up."""

    def place(corners):
        return [((278 - x) / 100, z / 100, y / 100) for x, y, z in corners]

    white, red, green = (
        material(name.capitalize(), "BsdfDiffuse", Color=tuple(reflectance(name))) for name in ("white", "red", "green")
    )
    walls = [
        ("Floor", [(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)], white),
        ("Back wall", [(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)], white),
        ("Right wall", [(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)], green),
        ("Left wall", [(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)], red),
    ]
    for name, corners, b_material in walls:
        add_mesh(name, place(corners), [(0, 1, 2, 3)], b_material)
    ceiling = [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]
    hole = [(343, 548.8, 227), (343, 548.8, 332), (213, 548.8, 332), (213, 548.8, 227)]
    add_mesh("Ceiling", place([*ceiling, *hole]), AROUND, white)
    add_mesh("Lamp", place(hole), [(0, 1, 2, 3)], measured_lamp())
    for name, height, corners in (
        ("Short block", 165, [(130, 65), (82, 225), (240, 272), (290, 114)]),
        ("Tall block", 330, [(423, 247), (265, 296), (314, 456), (472, 406)]),
    ):
        on_floor = [place([(x, 0, z)])[0][:2] for x, z in corners]
        add_block(name, height / 100, on_floor, white)
    world(scene, (0, 0, 0))
    film, focal_length = 0.025, 0.035
    angle = math.degrees(2 * math.atan(film / 2 / focal_length))
    camera(scene, (0, -8.0, 2.73), (0, 0, 2.73), field_of_view=angle, size=(512, 512))


def measured_lamp():
    """It shines, and reflects light of its own from the walls."""
    b_material, tree, surface = wired_material("Lamp")
    both = shader(tree, "AddShader")
    glow = shader(tree, "Emission", Color=tuple(lamp_color()), Strength=16.0)
    glass = shader(tree, "BsdfDiffuse", Color=(LAMP_REFLECTANCE,) * 3)
    for node, socket in zip((glow, glass), both.inputs, strict=True):
        plug(tree, node.outputs[0], socket)
    plug(tree, both.outputs[0], surface)
    arrange(tree)
    return b_material


def add_mirror():
    """The tall block, turned further than the white one, so that it shows both walls instead of the dark before it."""
    mirror = material("Aluminium", "BsdfGlossy", Color=ALUMINIUM, Roughness=0.0)
    add_cuboid("Mirror block", (-0.825, -0.825, 0), (0.825, 0.825, 3.3), mirror, (-0.95, 3.5, 0), math.radians(33))


def cornell_walls(scene, lamp=((-0.65, 2.27), (0.65, 3.32)), strength=24.0):
    """Walls, lamp and camera; returns the white material. `lamp`: from x and y to x and y on the ceiling.

    Sizes as measured at Cornell University (www.graphics.cornell.edu/online/box/data.html), in decimetres; colours as
    in P. Shirley, "Ray Tracing: The Rest of Your Life".
    """
    white, red, green = (
        material(name, "BsdfDiffuse", Color=color)
        for name, color in (("White", (0.73, 0.73, 0.73)), ("Red", (0.65, 0.05, 0.05)), ("Green", (0.12, 0.45, 0.15)))
    )
    light = material("Light", "Emission", Color=(1.0, 0.82, 0.6), Strength=strength)
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
    (x0, y0), (x1, y1) = lamp
    hole = [(x0, y0, h), (x0, y1, h), (x1, y1, h), (x1, y0, h)]
    add_mesh("Ceiling", [*ceiling, *hole], AROUND, white)
    add_mesh("Light", hole, [(0, 1, 2, 3)], light)
    world(scene, (0, 0, 0))
    camera(scene, (0, -8.0, h / 2), (0, 0, h / 2), field_of_view=38, size=(512, 512))
    return white
