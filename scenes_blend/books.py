# SPDX-License-Identifier: GPL-3.0-or-later
"""The last pictures of P. Shirley's three books "Ray Tracing in One Weekend", "The Next Week" and "The Rest of Your
Life", after their descriptions. What is random there is random here, and so stands elsewhere."""

import math

import numpy as np
from boxes import cornell_walls, let_light_scatter, medium
from crowds import ball_collection, diffuse, metal
from kit import (
    add_block,
    add_made,
    add_mesh,
    arrange,
    ball_group,
    calculate,
    camera,
    focus,
    image,
    instances_group,
    made_of_points,
    material,
    plug,
    points_group,
    shader,
    sky,
    spheres_at_points_group,
    wired_material,
    world,
)
from paper import FULL_FUZZ, painted_material
from pictures import planet

GROUND = 300.0  # radius, in metres, of the ball that is the ground of the first book


def book(x, y, z, unit=1.0):
    """A place of the books, where y is up, in Blender's axes."""
    return -x * unit, z * unit, y * unit


# ---- In One Weekend --------------------------------------------------------------------------------------------------


def one_weekend(scene):
    """Some 480 small spheres at random, four in five diffuse, and three large ones: brown, glass and metal. The lens is
    open, so only what is as far away as those is sharp."""
    random = np.random.default_rng(12)
    grid = np.mgrid[-11:11, -11:11].reshape(2, -1).T
    places = grid + 0.9 * random.uniform(size=grid.shape)
    places = places[np.linalg.norm(places - (4.0, 0.0), axis=1) > 0.9]  # not where the metal one is
    choice, tone = random.uniform(size=(2, len(places)))
    centres = np.array([book(x, on_ground(x, z) + 0.2, z) for x, z in places])
    radii = np.full(len(places), 0.2)

    points = spheres_at_points_group()
    for number in range(16):  # colours are products of two random ones, so dark ones are frequent
        chosen = (choice < 0.8) & (tone * 16 // 1 == number)
        paint = diffuse(f"Diffuse {number}", random.uniform(size=3) * random.uniform(size=3))
        made_of_points(paint.name, centres[chosen], radii[chosen], points, Material=paint)
    for number in range(8):
        chosen = (choice >= 0.8) & (choice < 0.95) & (tone * 8 // 1 == number)
        shine = metal(f"Metal {number}", random.uniform(0.5, 1.0, 3), random.uniform(0.0, FULL_FUZZ / 2))
        made_of_points(shine.name, centres[chosen], radii[chosen], points, Material=shine)
    glass = material("Glass", "BsdfGlass", IOR=1.5, Roughness=0.0)
    chosen = choice >= 0.95
    small = instances_group(ball_collection(glass, 128), has_radius=True)
    made_of_points("Glass spheres", centres[chosen], radii[chosen], small)

    point = points_group()
    add_made("Ground", point, (0, 0, -GROUND), GROUND, diffuse("Ground", (0.5, 0.5, 0.5)))
    add_made("Large glass", ball_group(), book(0, 1, 0), 1.0, glass).lambent.shape = "SPHERE"
    add_made("Large diffuse", point, book(-4, 1, 0), 1.0, diffuse("Brown", (0.4, 0.2, 0.1)))
    add_made("Large metal", point, book(4, 1, 0), 1.0, metal("Large metal", (0.7, 0.6, 0.5), 0.0))
    sky(scene)
    camera(scene, book(13, 2, 3), (0, 0, 0), field_of_view=35, size=(960, 540))
    focus(scene, distance=10.0, lens_radius=0.05)


def on_ground(x, z):
    """How high the ground is."""
    return math.sqrt(GROUND**2 - x * x - z * z) - GROUND


# ---- The Next Week ---------------------------------------------------------------------------------------------------


def next_week(scene):
    """All there is in that book at once. Lengths are a hundredth of the book's."""

    def at(x, y, z):
        return book(x, y, z, 0.01)

    random = np.random.default_rng(6)
    ground = diffuse("Ground", (0.48, 0.83, 0.53))
    blocks(random.uniform(0.01, 1.01, (20, 20)), ground)
    lamp = material("Lamp", "Emission", Color=(1.0, 1.0, 1.0), Strength=7.0)
    corners = [at(123, 554, 147), at(423, 554, 147), at(423, 554, 412), at(123, 554, 412)]
    add_mesh("Lamp", corners, [(0, 1, 2, 3)], lamp)

    moving = add_made("Moving", ball_group(), at(400, 400, 200), 0.5, diffuse("Orange", (0.7, 0.3, 0.1)))
    moving.lambent.shape = "SPHERE"
    move(moving, at(430, 400, 200))
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    scene.render.motion_blur_position = "START"

    point = points_group()
    glass = material("Glass", "BsdfGlass", IOR=1.5, Roughness=0.0)
    fuzzy = metal("Fuzzy metal", (0.8, 0.8, 0.9), FULL_FUZZ)
    add_made("Glass", ball_group(), at(260, 150, 45), 0.5, glass).lambent.shape = "SPHERE"
    add_made("Metal", point, at(0, 150, 145), 0.5, fuzzy)
    blue = medium("Blue inside", (0.2, 0.4, 0.9), density=20.0)
    tree = blue.node_tree
    coat = shader(tree, "BsdfGlass", IOR=1.5, Roughness=0.0)
    plug(tree, coat.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    arrange(tree)
    add_made("Blue glass", ball_group(), at(360, 150, 145), 0.7, blue).lambent.shape = "SPHERE"
    mist = medium("Mist", (1.0, 1.0, 1.0), density=0.01)
    add_made("Mist", ball_group(128), (0, 0, 0), 50.0, mist).lambent.shape = "SPHERE"
    earth = add_made("Planet", point, at(400, 200, 400), 1.0, painted_material("Planet", image("Planet", planet())))
    earth.rotation_euler.z = 2.2
    add_made("Marble", point, at(220, 280, 300), 0.8, marble())

    white = diffuse("White", (0.73, 0.73, 0.73))
    many = random.uniform(0.0, 1.65, (1000, 3)) * (-1, 1, 1)
    cube = made_of_points("Thousand spheres", many, np.full(1000, 0.1), spheres_at_points_group(), Material=white)
    cube.location, cube.rotation_euler.z = at(-100, 270, 395), math.radians(15)
    world(scene, (0, 0, 0))
    let_light_scatter(scene)
    camera(scene, at(478, 278, -600), at(278, 278, 0), field_of_view=40, size=(512, 512))


def blocks(heights, b_material):
    """The ground: blocks of a metre's side, and as high as random numbers say, in one mesh."""
    positions, faces = [], []
    for (i, j), height in np.ndenumerate(heights):
        x, y = 9.0 - i, j - 10.0
        first = len(positions)
        positions += [(x + a, y + b, z) for z in (0.0, height) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        sides = [(k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4)]
        faces += [[first + corner for corner in face] for face in [(3, 2, 1, 0), (4, 5, 6, 7), *sides]]
    add_mesh("Blocks", positions, faces, b_material)


def move(b_object, target):
    """Let an object go to a place between frames 1 and 2, at an even pace."""
    b_object.keyframe_insert("location", frame=1)
    b_object.location = target
    b_object.keyframe_insert("location", frame=2)
    for curve in b_object.animation_data.action.fcurves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def marble():
    """Diffuse, with layers of light and dark that noise folds: 1/2 + 1/2 sin(10 z + 10 |noise|), in metres."""
    b_material, tree, surface = wired_material("Marble")
    place = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.noise_type, noise.normalize = "FBM", False
    for name, value in (("Scale", 2.0), ("Detail", 6.0), ("Roughness", 0.5), ("Lacunarity", 2.0)):
        noise.inputs[name].default_value = value
    plug(tree, place, noise.inputs["Vector"])
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    plug(tree, place, split.inputs[0])
    turbulence = calculate(tree, "Math", "ABSOLUTE", noise.outputs[0])
    layers = calculate(tree, "Math", "MULTIPLY", split.outputs["Y"], 10.0)
    folded = calculate(tree, "Math", "MULTIPLY_ADD", turbulence, 10.0, layers)
    wave = calculate(tree, "Math", "SINE", folded)
    diffuse_node = shader(tree, "BsdfDiffuse")
    plug(tree, calculate(tree, "Math", "MULTIPLY_ADD", wave, 0.5, 0.5), diffuse_node.inputs["Color"])
    plug(tree, diffuse_node.outputs[0], surface)
    arrange(tree)
    return b_material


# ---- The Rest of Your Life -------------------------------------------------------------------------------------------


def rest_of_your_life(scene):
    """The box of Cornell with a tall block and a glass ball. The integrator is the book's: half of the rays are aimed
    at the lamp or the ball."""
    white = cornell_walls(scene)
    block = [book(x, 0, z, 0.01) for x, z in ((0, 0), (165, 0), (165, 165), (0, 165))]
    turned = [rotated(x, y, math.radians(15)) for x, y, _ in block]
    add_block("Tall block", 3.3, [(x + 2.775 - 2.65, y + 2.95) for x, y in turned], white)
    glass = material("Glass", "BsdfGlass", IOR=1.5, Roughness=0.0)
    ball = add_made("Glass ball", ball_group(), (2.775 - 1.9, 1.9, 0.9), 0.9, glass)
    ball.lambent.shape, ball.lambent.aim = "SPHERE", "ALWAYS"
    scene.lambent.integrator = "MIXTURE"


def rotated(x, y, angle):
    """Counter-clockwise, in radians."""
    return x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)
