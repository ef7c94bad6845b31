# SPDX-License-Identifier: GPL-3.0-or-later
"""What a point looks like: textures as functions of a point, without a graph around them.

`p` is a Vec3 in the texture's space and `w` the fourth coordinate. Where a node has the socket Scale, p and w are to be
multiplied by it before the call, but for `voronoi`, which takes the scale since its position output undoes it. What the
numbers mean, Blender's nodes say; kinds are enums with Blender's names and numbers.

    noise.noise(p, w, dimensions, kind, detail, roughness, lacunarity, offset, gain, distortion, normalize, colored)
        -> value, color
    voronoi.voronoi(p, w, dimensions, feature, metric, scale, detail, roughness, lacunarity, smoothness, exponent,
                    randomness, normalize, only_distance) -> distance, color, position, w, radius
    wave.wave(p, kind, direction, profile, distortion, detail, detail_scale, detail_roughness, phase) -> number
    magic.magic(p, depth, distortion) -> Vec3
    brick.brick(p, color_1, color_2, mortar_color, mortar_size, mortar_smooth, bias, width, height,
                offset, every, squash, squash_every) -> color, mortar
    checker.checker(p) -> 1 or 0
    gradient.gradient(p, kind) -> number
    white_noise.white_noise(p, w, dimensions) -> value, color
    gabor.gabor(p, dimensions, frequency, anisotropy, orientation_2d, orientation_3d) -> value, phase, intensity
    noise.turbulence(p, octaves) -> number
    checker.sine_checker(p) -> number

The last two have no node of their own. `perlin`, `cells`, `hash` and `hash8` are what the others are made of.
Arithmetic of nodes (Math, Vector Math, Mapping, Mix, colours) is in `linalg`: scalar_math, vector_math, color, blend.

Kinds and dimensions are arguments and not compiled for: one body of code for all costs a few branches that are always
taken the same way, and saves most of the time to compile.
"""
