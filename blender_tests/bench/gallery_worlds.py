# SPDX-License-Identifier: GPL-3.0-or-later
"""What the gallery shows: the figures of A. Desai, "Ray Tracing in Python", 2021, with their captions, and the last
pictures of P. Shirley's three books. `note`: what to look for, and where the engines differ and why."""

from typing import NamedTuple

BOTH = ("MIXTURE", "BRUTE_FORCE")  # the paper's two ways to sample, as its figures have them from left to right


class World(NamedTuple):
    title: str
    scene: str  # of scenes_blend
    caption: str
    note: str = ""
    integrators: tuple = ()  # one picture for each; the file's own, if there is none
    samples: int = 0  # 0: as many as the others

    @property
    def stem(self):
        """What the names of its pictures begin with."""
        return f"{self.scene}_{self.samples}" if self.samples else self.scene


FIGURES = (
    World(
        "Figure 2",
        "normals_as_colors",
        "Here a very large green sphere is used as the ground, the background color defaults to a sky-like color, and "
        "the sphere in the middle has its surface normals mapped as a gradient.",
        "Both spheres have the same material: the ground is green because its normals point up, and up is green. "
        "Lambent warns that light of these shapes is found by chance; here nothing is lit by it.",
    ),
    World(
        "Figure 3",
        "two_diffuse_spheres",
        "Here are two lambertian spheres (one acting as the ground) rendered using a diffuse scattering method.",
    ),
    World(
        "Figure 4",
        "metals_and_fuzz",
        "Here are two metal spheres and a diffuse sphere (center) on top of a large green diffuse sphere acting as the "
        "ground. The one on the right is with a maximum fuzziness value, and the one on the left has a minimum "
        "fuzziness value.",
        "Blender has roughness instead of fuzz. A fuzz of 1 turns a mirrored ray by 33.8 degrees on average, which a "
        "roughness of 0.53 does as well.",
    ),
    World(
        "Figure 5",
        "three_spheres",
        "Here are three spheres on top of a large green diffuse sphere acting as the ground. The one on the right is a "
        "metal with a minimum fuzziness value, the one in the middle is a diffuse sphere and the one on the left is a "
        "glass sphere with index of refraction 1.5.",
    ),
    World(
        "Figure 6",
        "checkered_spheres",
        "Two checkered spheres",
        "One colour where sin 10x sin 10y sin 10z is above 0, another where it is below, by Math nodes.",
    ),
    World("Figure 7", "turbulent_noise", "Turbulent Noise", "The absolute value of seven octaves of Perlin's noise."),
    World(
        "Figure 8",
        "picture_around_sphere",
        "An random image I got off of a free wallpaper site mapped around a sphere",
        "The picture is ours, and in the file.",
    ),
    World(
        "Figure 9, and the last picture of *Ray Tracing in One Weekend*",
        "one_weekend",
        "A bunch of random spheres",
        "The lens is open: what is nearer or farther than the three large spheres is blurred.",
    ),
    World("Figure 10", "light_in_the_world", "Lighting a sphere from inside the world"),
    World(
        "Figure 11",
        "picture_as_light",
        "Using a an image as a light source to light other images.",
        "The screen on the left is all the light there is. Lambent samples it where it is bright.",
    ),
    World(
        "Figure 12",
        "cornell_box",
        "The Cornell Box: a standard test used by scientists at Cornell when they were developing ray tracers was to "
        "compare a rendered image to a real life box where they could take an image and compare it to the rendered "
        "image.",
    ),
    World(
        "Figure 12, as it was measured",
        "cornell_measured",
        "The real box",
        "Corners, reflectances and the lamp's spectrum as published by Cornell University; what colours the spectra "
        "come to is computed in `scenes_blend/spectra.py`.",
    ),
    World(
        "Figure 13",
        "cornell_mirror",
        "Using a mirror to make sure reflections still work if a box is translated and rotated. This was also used as "
        "a test case for comparing the probability distribution function implementation to see if noise was reduced.",
    ),
    World(
        "Figure 14",
        "cornell_smoke",
        "A box and ball made out of smoke",
        "The box takes light away and the ball scatters it in all directions, both as densely as in the book.",
    ),
    World(
        "Figure 15",
        "cornell_glass",
        "A mirrored box, a glass ball, and a smaller metal ball. This was also used as a test case for comparing the "
        "probability distribution function implementation to see if noise was reduced.",
        "Light by way of mirror and glass is found by luck in both engines, and leaves specks.",
    ),
    World(
        "Figure 16",
        "cornell_mirror",
        "Depicted here is world 11, the one on the right is the standard implementation whereas the one on the left is "
        "the pdf implementation. Both images used 5 samples per pixel",
        "Cycles samples lights and materials at each bounce, as Lambent's own default does, so its picture is cleaner. "
        "What the three converge to is the same; [figures.md](../figures.md) has the comparison.",
        integrators=BOTH,
        samples=5,
    ),
    World(
        "Figure 17",
        "cornell_mirror",
        "Same as above, except both images used 200 samples per pixel",
        integrators=BOTH,
        samples=200,
    ),
    World(
        "Figure 18",
        "cornell_glass",
        "Depicted here is world 13, the one on the right is the standard implementation whereas the one on the left is "
        "the pdf implementation. Both images used 5 samples per pixel",
        integrators=BOTH,
        samples=5,
    ),
    World(
        "Figure 19",
        "cornell_glass",
        "Same as above, except both images used 200 samples per pixel",
        integrators=BOTH,
        samples=200,
    ),
)
BOOKS = (
    World(
        "The last picture of *Ray Tracing: The Next Week*",
        "next_week",
        "Everything in that book at once: a ground of blocks, a sphere that moves while the shutter is open, glass, "
        "metal, a glass ball with blue smoke inside, mist over all, a planet, marble, and a cube of 1000 spheres.",
    ),
    World(
        "The last picture of *Ray Tracing: The Rest of Your Life*",
        "rest_of_your_life",
        "The Cornell box with a tall block and a glass ball, and rays aimed at lamp and ball.",
        "The file asks for the book's integrator, and for the glass ball as one of its targets: that finds the bright "
        "spot below it, and has fewer rays left for the walls than Cycles.",
    ),
)
SHADERS = (
    World(
        "What shader nodes do",
        "materials",
        "A field of balls, each of one shader. Rows from the front: matt and layered, metals, what lets light through, "
        "and shaders that are mixed or bent.",
    ),
)
WORLDS = FIGURES + BOOKS + SHADERS
