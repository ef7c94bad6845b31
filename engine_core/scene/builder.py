# SPDX-License-Identifier: GPL-3.0-or-later
"""SceneBuilder: say what is in the scene, get the tables that kernels read.

    b = SceneBuilder()
    red = b.material("Red", Diffuse((0.8, 0.1, 0.1)))
    ball = b.spheres("Ball", centres=[(0, 0, 1)], radii=[1.0])
    b.instance(ball, materials=[red])
    b.background((0.5, 0.7, 1.0))
    b.camera(look_at((0, -6, 2), (0, 0, 1)), perspective_screen(40, 16 / 9))
    scene = b.build()

Every call checks what it is given and raises SceneError with the name of the culprit. What can be rendered, but not as
asked, is told in `warnings`.
"""

import math
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from ..shader.graph import is_constant
from ..tables import CameraKind, LightKind, Visibility
from . import assemble, checks, lamps, shapes, strands
from .flattening import Surface, flatten
from .materials import WHITE, Black, Diffuse, Transparent
from .targets import Aim
from .terminator import Terminator
from .volumes import Medium, medium_of

IDENTITY = np.eye(4)
EXACT = Terminator()


@dataclass
class Mesh:
    """Triangles in object space."""

    name: str
    positions: np.ndarray  # float32 (v, 3)
    triangles: np.ndarray  # int32 (n, 3)
    normals: np.ndarray | None  # float32 (n, 3, 3); None: flat
    uvs: np.ndarray | None  # float32 (n, 3, 2)
    slots: np.ndarray | None  # int32 (n,)
    attributes: dict  # name: float32 (n, 3, 4)
    texture_space: (
        tuple  # scale (3,), offset (3,): generated coordinates are the position times the one, plus the other
    )


@dataclass
class Placement:
    """A geometry that stands in the world."""

    geometry: int
    to_world: np.ndarray
    materials: tuple
    name: str
    visibility: int
    pass_index: int
    random: float
    color: tuple
    aim: Aim
    motion: np.ndarray | None  # float64 (n, 4, 4), see SceneBuilder.instance
    values: dict  # name: up to 4 floats
    terminator: Terminator


@dataclass
class Material:
    name: str
    surface: Surface
    medium: Medium | None  # inside
    is_boundary: bool  # of that medium, and no surface
    one_sided: bool  # emits from the front of its faces only
    pass_index: int
    transparent_shadows: bool  # light passes where it is transparent
    displacement: object  # value: how far it moves a mesh, world space; None: not at all
    keeps_normals: bool  # those of the mesh stay as if it were not moved


class LampShader(NamedTuple):
    """What a lamp's radiance is multiplied by: a value of `shader.graph`, evaluated in the lamp's own space."""

    factor: object
    to_world: np.ndarray  # (4, 4)
    random: float = 0.0
    color: tuple = (1.0, 1.0, 1.0, 1.0)
    pass_index: int = 0
    values: dict = MappingProxyType({})  # name: up to 4 floats, for its program


class SceneBuilder:
    """Collects a scene; `build` makes the tables. A builder may go on growing after `build` and be built again."""

    def __init__(self):
        self.materials, self.geometries, self.placements = [], [], []
        self.lights, self.lamp_shapes, self.lamp_shaders = [], [], []
        self.world_radiance, self.world_visibility = np.zeros(3), int(Visibility.ALL)
        self.world_medium = None
        self.camera_row = self.camera_motion = None
        self.shutter_curve = None
        self.warnings = []
        # what Blender shows where an object has no material
        self.default_material = self.material("(none)", Diffuse((0.8, 0.8, 0.8)))

    # ---- Materials ----

    def material(
        self,
        name,
        surface,
        pass_index=0,
        one_sided_emission=False,
        transparent_shadows=True,
        volume=None,
        displacement=None,
        keeps_normals=False,
    ):
        """Add a material. Returns its number, for `instance`.

        `surface` is a closure of `scene.materials`, `volume` of `scene.volumes`: what is inside of the object, where
        its faces' backs are. A `surface` of None is none: light goes through.
        `displacement`: a vector, or a value of `shader.graph`, by which it moves vertices of a mesh in world space;
        `keeps_normals`: shade it with the normals from before, where the surface is bumped by as much.
        """
        is_boundary = surface is None and volume is not None
        if surface is None:
            surface = Transparent() if is_boundary else Black()
        surface, medium = flatten(surface), medium_of(name, volume)
        for closure, _ in surface.closures:
            for field in closure.dtype.names:
                checks.array(name, field, np.atleast_1d(closure[field]), np.float64, None)
        if is_constant(surface.emission):
            checks.color(name, "emission", surface.emission)
        self.materials.append(
            Material(
                name,
                surface,
                medium,
                is_boundary,
                bool(one_sided_emission),
                int(pass_index),
                bool(transparent_shadows),
                displacement,
                bool(keeps_normals),
            )
        )
        return len(self.materials) - 1

    # ---- Geometry ----

    def mesh(self, name, positions, triangles, normals=None, uvs=None, slots=None, attributes=None, texture_space=None):
        """Add a triangle mesh in object space. Returns its number, for `instance`.

        Parameters
        ----------
        positions : float (v, 3), metres
        triangles : int (n, 3), corners counter-clockwise seen from the front
        normals : float (n, 3, 3) unit shading normals of the corners; None for flat shading
        uvs : float (n, 3, 2)
        slots : int (n,) material slot of each triangle
        attributes : dict, name: float (n, 3, up to 4), more values at the corners, for shader programs
        texture_space : (scale (3,), offset (3,)) from positions to generated coordinates; None: the bounding box
        """
        positions = checks.positions(name, "vertex positions", positions)
        triangles = checks.indices(name, "triangle corners", triangles, len(positions), None, 3)
        n = len(triangles)
        if normals is not None:
            normals = checks.array(name, "normals", normals, np.float32, n, 3, 3)
        if uvs is not None:
            uvs = checks.array(name, "UV coordinates", uvs, np.float32, n, 3, 2)
        if slots is not None:
            slots = checks.indices(name, "material slots", slots, 32768, n)
        attributes = {key: checks.four_floats(name, key, value, n, 3) for key, value in (attributes or {}).items()}
        texture_space = texture_space or bounding_texture_space(positions)
        return self._add(Mesh(name, positions, triangles, normals, uvs, slots, attributes, texture_space))

    def spheres(self, name, centres, radii):
        """Add analytic spheres in object space: float (n, 3) and (n,). Returns their number, for `instance`."""
        return self._add(shapes.spheres(name, centres, radii))

    def boxes(self, name, centres, half_sizes):
        """Add analytic boxes along the axes of object space: float (n, 3) both. Returns their number."""
        return self._add(shapes.boxes(name, centres, half_sizes))

    def quads(self, name, centres, u, v):
        """Add analytic parallelograms in object space by centres and half edges, float (n, 3) each; front along u x v.

        Those with right angles can be sampled as lights. Returns their number.
        """
        return self._add(shapes.quads(name, centres, u, v))

    def strands(self, name, keys, radii, counts, *told, **more):
        """Add hairs in object space, all of `scene.strands.strands`: curves through keys. Returns their number."""
        return self._add(strands.strands(name, keys, radii, counts, *told, **more))

    def _add(self, geometry):
        self.geometries.append(geometry)
        return len(self.geometries) - 1

    def instance(
        self,
        geometry,
        to_world=IDENTITY,
        materials=(),
        name=None,
        visibility=Visibility.ALL,
        pass_index=0,
        random=0.0,
        color=(1.0, 1.0, 1.0, 1.0),
        aim=Aim.AUTOMATIC,
        motion=None,
        values=None,
        terminator=EXACT,
    ):
        """Let a geometry stand in the world; any number of times.

        `materials` has a number for each material slot; a slot beyond the last uses the last, as in Blender.
        `aim`: whether the mixture integrator sends rays at it.
        `terminator`: how shadows set in on its far side, if it is a smooth mesh.
        `motion`: (n, 4, 4), where it stands at n >= 2 times, evenly from the opening of the shutter to its closing, n
        being the same for all that move. `to_world` is then where it stands in the middle.
        `values`: {name: up to 4 floats} of the instance, for shader programs.
        """
        if not 0 <= geometry < len(self.geometries):
            raise checks.SceneError(f"{name}: there is no geometry {geometry}")
        name = name or self.geometries[geometry].name
        materials = tuple(self.default_material if m is None else int(m) for m in materials)
        if any(not 0 <= m < len(self.materials) for m in materials):
            raise checks.SceneError(f"{name}: material numbers {materials}, there are {len(self.materials)}")
        self.placements.append(
            Placement(
                geometry,
                to_world,
                materials,
                name,
                int(visibility),
                int(pass_index),
                float(random),
                tuple(color),
                Aim(aim),
                motion,
                values or {},
                Terminator(*terminator),
            )
        )

    # ---- Light ----

    def point_light(
        self,
        name,
        position,
        power,
        radius=0.0,
        soft=True,
        visibility=Visibility.ALL,
        aim=Aim.AUTOMATIC,
        shader=None,
    ):
        """A lamp that shines all around. `power` (3,) W; `soft`: a disk that faces whoever looks, else a sphere.

        `shader`, of any lamp: a LampShader, by which its radiance is multiplied.
        """
        to_world = np.eye(4)
        to_world[:3, 3] = position
        self._add_lamp(lamps.point(name, to_world, power, radius, soft, visibility), aim, shader)

    def spot_light(
        self,
        name,
        to_world,
        power,
        radius,
        angle,
        blend,
        soft=True,
        visibility=Visibility.ALL,
        aim=Aim.AUTOMATIC,
        shader=None,
    ):
        """A point light in a cone of full `angle` about -z; `blend` 0 to 1 softens its edge."""
        self._add_lamp(lamps.spot(name, to_world, power, radius, angle, blend, soft, visibility), aim, shader)

    def sun_light(
        self, name, direction, irradiance, angle=0.0, visibility=Visibility.ALL, aim=Aim.AUTOMATIC, shader=None
    ):
        """Light that travels along `direction`, from a disk of full `angle`; `irradiance` (3,) W / m2 facing it."""
        self._add_lamp(lamps.sun(name, direction, irradiance, angle, visibility), aim, shader)

    def area_light(
        self,
        name,
        to_world,
        power,
        size_x,
        size_y,
        shape="RECTANGLE",
        spread=math.pi,
        visibility=Visibility.ALL,
        aim=Aim.AUTOMATIC,
        shader=None,
    ):
        """A rectangle or an ellipse in the xy plane that shines along -z. `power` (3,) W; `spread`: full angle."""
        self._add_lamp(lamps.area(name, to_world, power, size_x, size_y, shape, spread, visibility), aim, shader)

    def _add_lamp(self, lamp, aim, shader):
        light, shape = lamp
        if light is None:
            return
        light["aimed_at"] = aim != Aim.NEVER
        if shape is not None:
            shape["light"] = len(self.lights)
            self.lamp_shapes.append(shape)
        if shader is not None:
            light["lamp"] = len(self.lamp_shaders)  # for now: `assemble` knows rows of INSTANCE
            self.lamp_shaders.append(shader)
        self.lights.append(light)

    def background(self, radiance, visibility=Visibility.ALL, volume=None):
        """The world shines with `radiance`: (3,) the same from everywhere, or a value of `shader.graph`.

        `volume`, a closure of `scene.volumes`, fills all space.
        """
        self.world_medium = medium_of("World", volume, endless=True)
        self.world_radiance = checks.color("World", "radiance", radiance) if is_constant(radiance) else radiance
        self.world_visibility = int(visibility)

    # ---- Camera ----

    def camera(
        self,
        to_world,
        screen,
        kind="PERSPECTIVE",
        lens_radius=0.0,
        focus_distance=1.0,
        blades=0,
        blade_rotation=0.0,
        aperture_ratio=1.0,
        clip_start=0.0,
        clip_end=np.inf,
        motion=None,
    ):
        """Look along -z of `to_world`, y up. `screen`: left, right, bottom, top of the picture at distance 1 m
        (ORTHOGRAPHIC: in metres). `motion`: as that of an instance."""
        matrix, regular = checks.transform("Camera", to_world)
        if not regular:
            raise checks.SceneError("Camera: its transform is flat; the camera, or a parent, is scaled to 0")
        row = np.zeros(1, assemble.CAMERA)
        row["kind"] = CameraKind[kind]
        matrix[:, :3] /= np.linalg.norm(matrix[:, :3], axis=0)
        row["to_world"] = matrix
        row["screen"] = checks.array("Camera", "screen", screen, np.float32, 4)
        row["lens_radius"] = checks.number("Camera", "lens radius", lens_radius, 0.0)
        row["focus_distance"] = checks.number("Camera", "focus distance", focus_distance, 1e-9)
        row["blades"], row["blade_rotation"] = int(blades), blade_rotation
        row["aperture_ratio"] = checks.number("Camera", "aperture ratio", aperture_ratio, 1e-6)
        row["clip_start"], row["clip_end"] = max(clip_start, 0.0), clip_end
        self.camera_row, self.camera_motion = row, motion

    def shutter(self, openness):
        """How far the shutter is open while it is: numbers at times evenly from its opening to its closing."""
        openness = np.maximum(checks.array("Camera", "openness of the shutter", openness, np.float64, None), 0.0)
        if len(openness) < 2 or not openness.any():
            raise checks.SceneError("Camera: its shutter never opens")
        self.shutter_curve = openness

    # ---- The tables ----

    def build(self, progress=None):
        """Make the Scene. `progress(fraction, text)` is called now and then.

        Raises SceneError if there is no camera or a transform is not made of finite numbers.
        """
        if self.camera_row is None:
            raise checks.SceneError("The scene has no camera")
        return assemble.assemble(self, progress or (lambda fraction, text: None))

    def _warn(self, name, text):
        message = f"{name}: {text}"
        if message not in self.warnings:
            self.warnings.append(message)


def bounding_texture_space(positions):
    """(scale, offset) that make generated coordinates go from 0 to 1 over the box around `positions`."""
    if not len(positions):
        return np.ones(3), np.zeros(3)
    low, high = positions.min(axis=0).astype(np.float64), positions.max(axis=0).astype(np.float64)
    size = np.where(high > low, high - low, 1.0)
    return 1.0 / size, np.where(high > low, -low / size, 0.5 - low)


def look_at(eye, target, up=(0.0, 0.0, 1.0)):
    """Matrix (4, 4) of a camera at `eye` that looks at `target`."""
    eye, target, up = (np.asarray(v, float) for v in (eye, target, up))
    back = eye - target
    back /= np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = right, np.cross(back, right), back, eye
    return matrix


def perspective_screen(field_of_view, aspect=1.0):
    """Screen of a camera whose picture is `field_of_view` degrees wide and `aspect` times as wide as high."""
    half = math.tan(math.radians(field_of_view) / 2.0)
    return (-half, half, -half / aspect, half / aspect)


__all__ = ["WHITE", "LightKind", "SceneBuilder", "look_at", "perspective_screen"]
