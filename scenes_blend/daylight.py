# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from outside and from pictures: under a sky, through a window, from a screen."""

import math

import bpy
import numpy as np
from kit import (
    add,
    add_cuboid,
    add_made,
    add_mesh,
    camera,
    image,
    image_node,
    material,
    points_group,
    shader,
    smooth_suzanne,
    world,
)


def mesh_hdri(scene):
    """A million triangles under a photograph of a sky, as a picture of all directions, that we paint ourselves: a sun,
    a blue sky, and the bright windows of a house behind the camera."""
    plaster = bpy.data.materials.new("Plaster")
    plaster.use_nodes = True
    tree = plaster.node_tree
    tree.nodes.clear()
    matte = shader(tree, "BsdfDiffuse", Color=(0.62, 0.24, 0.12))
    gloss = shader(tree, "BsdfGlossy", Color=(0.95, 0.85, 0.7), Roughness=0.3)
    mix, output = shader(tree, "MixShader"), tree.nodes.new("ShaderNodeOutputMaterial")
    mix.inputs["Fac"].default_value = 0.22
    tree.links.new(matte.outputs[0], mix.inputs[1])
    tree.links.new(gloss.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])

    suzanne = smooth_suzanne(levels=0)
    suzanne.materials[0] = plaster
    monkey = add("Monkey", suzanne, location=(0, 0, 0.45), rotation_euler=(math.radians(-38), 0, math.radians(18)))
    subdivision = monkey.modifiers.new("Million", "SUBSURF")
    subdivision.levels, subdivision.render_levels = 3, 5  # 500 faces, each cut in four five times: 1 007 616 triangles
    grain = bpy.data.textures.new("Grain", "CLOUDS")
    grain.noise_scale, grain.noise_depth = 0.06, 3
    dents = monkey.modifiers.new("Dents", "DISPLACE")
    dents.texture, dents.strength, dents.mid_level = grain, 0.035, 0.5
    side = 400.0
    corners = [(-side, -side, 0), (side, -side, 0), (side, side, 0), (-side, side, 0)]
    add_mesh("Ground", corners, [(0, 1, 2, 3)], material("Ground", "BsdfDiffuse", Color=(0.4, 0.38, 0.34)))

    world(scene, (1, 1, 1))
    tree = scene.world.node_tree
    panorama = image("Sky", sky_and_windows(512), is_float=True)
    node = image_node(tree, panorama, "TexEnvironment")
    tree.links.new(node.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    camera(scene, (1.0, -5.4, 1.5), (0.05, 0, 0.55), field_of_view=34, size=(640, 480))


def sky_and_windows(width):
    """Radiance from all directions, float32 (width / 2, width, 3): rows from the nadir up, columns from -x by y to x.

    The sun is a disk of 2.4 degrees, four pixels, in a haze; below the horizon there is dark ground.
    """
    height = width // 2
    latitude = (np.arange(height) + 0.5) / height * math.pi - math.pi / 2
    longitude = (np.arange(width) + 0.5) / width * 2 * math.pi - math.pi  # 0 in the middle is x, then comes -y
    up = np.sin(latitude)[:, None]
    x, y = np.cos(latitude)[:, None] * np.cos(longitude), -np.cos(latitude)[:, None] * np.sin(longitude)
    fade = np.clip(up, 0, 1) ** 0.45
    picture = (1 - fade)[..., None] * np.array([0.85, 0.82, 0.78]) + fade[..., None] * np.array([0.12, 0.27, 0.62])
    picture = np.repeat(picture, width, axis=1)
    picture[up[:, 0] < 0] = (0.11, 0.1, 0.09)
    sun = direction(azimuth=-75, elevation=34)
    cos = x * sun[0] + y * sun[1] + up * sun[2]
    picture += np.exp((cos - 1) / 0.012)[..., None] * np.array([0.9, 0.7, 0.45])
    picture[cos > math.cos(math.radians(1.2))] = (2600.0, 2200.0, 1650.0)
    azimuth, elevation = np.degrees(np.arctan2(x, y)), np.degrees(latitude)[:, None]
    house = (azimuth > 95) & (azimuth < 160) & (elevation > -1) & (elevation < 42)
    picture[house] = (0.05, 0.045, 0.05)
    for left in (101, 129):
        for low in (6, 25):
            window = (azimuth > left) & (azimuth < left + 24) & (elevation > low) & (elevation < low + 13)
            picture[window] = (13.0, 8.0, 4.0)
    return picture.astype(np.float32)


def direction(azimuth, elevation):
    """Unit vector; degrees, azimuth from y towards x."""
    a, e = math.radians(azimuth), math.radians(elevation)
    return math.sin(a) * math.cos(e), math.cos(a) * math.cos(e), math.sin(e)


def interior(scene):
    """A room that the sun and the sky light through one small window; all else is light from wall to wall."""
    wall, wood = (
        material(name, "BsdfDiffuse", Color=color)
        for name, color in (("Wall", (0.78, 0.74, 0.67)), ("Wood", (0.36, 0.19, 0.09)))
    )
    floor, rug = (
        material(name, "BsdfDiffuse", Color=color)
        for name, color in (("Floor", (0.48, 0.34, 0.22)), ("Rug", (0.5, 0.09, 0.07)))
    )
    cloth = material("Cloth", "BsdfDiffuse", Color=(0.12, 0.3, 0.36))
    silver = material("Silver", "BsdfGlossy", Color=(0.9, 0.88, 0.85), Roughness=0.2)
    x, y, z, thick = 2.4, 5.2, 2.7, 0.25
    add_cuboid("Floor", (-x, 0, -thick), (x, y, 0), floor)
    add_cuboid("Ceiling", (-x, 0, z), (x, y, z + thick), wall)
    add_cuboid("Back wall", (-x, y, 0), (x, y + thick, z), wall)
    add_cuboid("Front wall", (-x, -thick, 0), (x, 0, z), wall)
    add_cuboid("Right wall", (x, -thick, -thick), (x + thick, y + thick, z + thick), wall)
    window = (2.5, 3.6, 0.95, 2.05)  # from and to: y, z
    for name, y0, y1, z0, z1 in (
        ("Wall before the window", -thick, window[0], -thick, z + thick),
        ("Wall behind the window", window[1], y + thick, -thick, z + thick),
        ("Wall under the window", window[0], window[1], -thick, window[2]),
        ("Wall over the window", window[0], window[1], window[3], z + thick),
    ):
        add_cuboid(name, (-x - thick, y0, z0), (-x, y1, z1), wall)
    add_cuboid("Rug", (-1.2, 1.5, 0), (1.3, 3.9, 0.02), rug)
    add_cuboid("Table top", (-0.65, 2.3, 0.72), (0.75, 3.2, 0.77), wood)
    for a in (-0.6, 0.64):
        for b in (2.36, 3.1):
            add_cuboid("Table leg", (a, b, 0.02), (a + 0.06, b + 0.06, 0.72), wood)
    for a, b, turn in ((-0.1, 1.75, 0.3), (1.35, 2.8, 1.3)):
        add_cuboid("Stool", (-0.22, -0.22, 0.42), (0.22, 0.22, 0.47), wood, (a, b, 0), turn)
        for c in (-0.2, 0.16):
            for d in (-0.2, 0.16):
                add_cuboid("Stool leg", (c, d, 0), (c + 0.04, d + 0.04, 0.42), wood, (a, b, 0), turn)
    add_cuboid("Seat", (-0.9, 4.3, 0.0), (1.1, 5.1, 0.42), cloth)
    add_cuboid("Back rest", (-0.9, 4.95, 0.42), (1.1, 5.18, 0.95), cloth)
    for a in (-1.05, 1.1):
        add_cuboid("Arm rest", (a, 4.3, 0.0), (a + 0.15, 5.18, 0.62), cloth)
    add_made("Silver ball", points_group(), (0.3, 2.7, 0.92), 0.15, silver)
    add_made("Clay ball", points_group(), (-0.25, 2.75, 0.88), 0.11, rug)
    sun = add("Sun", bpy.data.lights.new("Sun", "SUN"), rotation_euler=(0, math.radians(-52), math.radians(-24)))
    sun.data.energy, sun.data.angle, sun.data.color = 90.0, math.radians(0.8), (1.0, 0.86, 0.66)
    world(scene, (12.0, 16.5, 24.0))
    for settings in (scene.lambent, scene.cycles):
        settings.max_bounces = settings.diffuse_bounces = 12
    camera(scene, (1.95, 0.25, 1.5), (-0.55, 3.6, 1.0), field_of_view=68, size=(640, 480))


def textured_emitter(scene):
    """A dark stage in the light of one picture: bright panes in a dark frame, on a screen."""
    glow = bpy.data.materials.new("Screen")
    glow.use_nodes = True
    tree = glow.node_tree
    tree.nodes.clear()
    emission, output = shader(tree, "Emission", Strength=60.0), tree.nodes.new("ShaderNodeOutputMaterial")
    panes = image_node(tree, image("Panes", stained_glass(192, 144)), "TexImage")
    tree.links.new(panes.outputs["Color"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    screen = add_mesh(
        "Screen", [(-3.0, 0.4, 0.3), (-3.0, 4.4, 0.3), (-3.0, 4.4, 3.3), (-3.0, 0.4, 3.3)], [(0, 1, 2, 3)], glow
    )
    uv = screen.data.uv_layers.new(name="UVMap")
    uv.data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
    black = material("Case", "BsdfDiffuse", Color=(0.03, 0.03, 0.03))
    add_cuboid("Case", (-3.2, 0.3, 0.2), (-3.02, 4.5, 3.4), black)

    grey = material("Stage", "BsdfDiffuse", Color=(0.5, 0.5, 0.5))
    white = material("White", "BsdfDiffuse", Color=(0.8, 0.8, 0.8))
    steel = material("Steel", "BsdfGlossy", Color=(0.9, 0.9, 0.92), Roughness=0.12)
    add_mesh("Floor", [(-7, -6, 0), (7, -6, 0), (7, 6, 0), (-7, 6, 0)], [(0, 1, 2, 3)], grey)
    add_mesh("Back", [(-7, 6, 0), (7, 6, 0), (7, 6, 8), (-7, 6, 8)], [(0, 1, 2, 3)], grey)
    suzanne = smooth_suzanne(levels=0)
    suzanne.materials[0] = white
    head = add("Suzanne", suzanne, location=(0.2, 2.2, 1.7), rotation_euler=(math.radians(-8), 0, math.radians(-20)))
    smoothing = head.modifiers.new("Subdivision", "SUBSURF")
    smoothing.levels = smoothing.render_levels = 2
    add_cuboid("Plinth", (-0.6, -0.6, 0), (0.6, 0.6, 0.85), white, (0.2, 2.3, 0), 0.35)
    add_made("Steel ball", points_group(), (-1.15, 0.4, 0.5), 0.5, steel)
    add_made("White ball", points_group(), (1.9, 1.0, 0.55), 0.55, white)
    world(scene, (0, 0, 0))
    camera(scene, (3.2, -5.2, 2.1), (-0.5, 2.0, 1.2), field_of_view=52, size=(640, 480))


def stained_glass(width, height):
    """Cells of a Voronoi diagram in bright colours between dark lead: float32 (height, width, 3)."""
    random = np.random.default_rng(5)
    seeds = random.uniform(0, 1, (30, 2)) * (width, height)
    colors = np.array([(0.95, 0.2, 0.08), (1.0, 0.7, 0.1), (0.1, 0.35, 0.95), (0.1, 0.7, 0.3), (1, 0.95, 0.8)])
    y, x = np.mgrid[0:height, 0:width] + 0.5
    distances = np.hypot(x[..., None] - seeds[:, 0], y[..., None] - seeds[:, 1])
    nearest = np.sort(distances, axis=2)
    picture = colors[np.arange(30) % len(colors)][distances.argmin(axis=2)]
    picture = picture * np.where(np.arange(30) % 7 == 3, 1.0, 0.45)[distances.argmin(axis=2)][..., None]
    picture[nearest[..., 1] - nearest[..., 0] < 5.0] = 0.01
    return picture.astype(np.float32)
