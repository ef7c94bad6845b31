# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair: Blender's Curves objects, and hair that particle systems grow, as strands of the SceneBuilder."""

from typing import NamedTuple

import numpy as np

from .hashes import hash_of_number, unit
from .mesh import read

DEFAULT_RADIUS = 0.005  # of a curve without radii, in metres, as in Cycles
POLY, BEZIER, NURBS = 1, 2, 3


class StrandArrays(NamedTuple):
    """What SceneBuilder.strands takes."""

    keys: np.ndarray  # (n, 3), object space
    radii: np.ndarray  # (n,)
    counts: np.ndarray  # int (m,), keys of each strand
    randoms: np.ndarray  # (m,)
    uvs: np.ndarray | None  # (m, 2)


# ---- Curves objects --------------------------------------------------------------------------------------------------


def read_curves(context, name, b_curves):
    """The number of a Curves object's strands in the builder; None if it has none."""
    if not len(b_curves.curves):
        return None
    attributes = b_curves.attributes
    keys = read(attributes["position"].data, "vector", len(b_curves.points), np.float32, 3)
    radius = attributes.get("radius")
    radii = np.full(len(keys), DEFAULT_RADIUS, np.float32)
    if radius is not None and radius.domain == "POINT":
        radii = read(radius.data, "value", len(keys), np.float32)
    counts = np.diff(read(b_curves.curve_offset_data, "value", len(b_curves.curves) + 1, np.int32))
    kinds = attributes.get("curve_type")
    if kinds is not None and np.isin(read(kinds.data, "value", len(counts), np.int32), (BEZIER, NURBS)).any():
        context.warn(name, "Bezier and NURBS curves are rendered as smooth curves through their control points")
    arrays = StrandArrays(keys, radii, counts, random_numbers(len(counts)), _uvs(attributes, len(counts)))
    return add_strands(context, name, arrays)


def _uvs(attributes, count):
    """The first pair of numbers that each curve has: where it grows on its surface."""
    for attribute in attributes:
        if attribute.domain == "CURVE" and attribute.data_type == "FLOAT2":
            return read(attribute.data, "vector", count, np.float32, 2)
    return None


# ---- Particles -------------------------------------------------------------------------------------------------------


def read_particle_hair(context, b_object):
    """[(number in the builder, material slot)] of the hair that the particle systems of an object grow."""
    found = []
    for b_modifier in b_object.modifiers:
        if b_modifier.type != "PARTICLE_SYSTEM" or not b_modifier.show_render:
            continue
        b_system = b_modifier.particle_system
        b_settings = b_system.settings
        if b_settings.type == "HAIR" and b_settings.render_type == "PATH":
            is_final = context.depsgraph.mode == "RENDER"
            subdivisions = b_settings.render_step if is_final else b_settings.display_step
            arrays = _grown(b_object, b_modifier, b_system, subdivisions)
            geometry = add_strands(context, f"{b_object.name} ({b_system.name})", arrays)
            if geometry is not None:
                found.append((geometry, max(b_settings.material - 1, 0)))
    return found


def _grown(b_object, b_modifier, b_system, subdivisions):
    """The strands of a particle system: children instead of parents, where it has some."""
    b_settings = b_system.settings
    parents, children = len(b_system.particles), len(b_system.child_particles)
    first = parents if b_settings.child_type != "NONE" and children else 0
    numbers = range(first, parents + children)
    steps = 2**subdivisions + 1
    if b_settings.kink == "SPIRAL":
        steps += b_settings.kink_extra_steps
    grow = b_system.co_hair
    world = [grow(b_object, particle_no=number, step=step) for number in numbers for step in range(steps)]
    inverse = np.array(b_object.matrix_world.inverted_safe())
    keys = np.array(world, np.float64).reshape(-1, 3) @ inverse[:3, :3].T + inverse[:3, 3]
    radii = _radii(b_settings, keys.reshape(len(numbers), steps, 3))
    uvs = _emitter_uvs(b_object, b_modifier, b_system, numbers)
    counts = np.full(len(numbers), steps)
    return StrandArrays(keys, radii.ravel(), counts, random_numbers(len(numbers)), uvs)


def _radii(b_settings, keys):
    """Radii at the keys, (m, steps), by the particle settings' shape of a strand."""
    walked = np.zeros(keys.shape[:2])
    walked[:, 1:] = np.cumsum(np.linalg.norm(np.diff(keys, axis=1), axis=2), axis=1)
    rest = 1.0 - walked / np.maximum(walked[:, -1:], 1e-30)
    shape = b_settings.shape
    power = 1.0 + shape if shape < 0.0 else 1.0 / max(1.0 - shape, 1e-6)
    half = 0.5 * b_settings.radius_scale
    root, tip = half * b_settings.root_radius, half * b_settings.tip_radius
    radii = tip + (root - tip) * np.clip(rest, 0.0, 1.0) ** power
    if b_settings.use_close_tip:
        radii[:, -1] = 0.0
    return radii


def _emitter_uvs(b_object, b_modifier, b_system, numbers):
    """Coordinates of the places where strands grow, on the emitter's UV map; None if it has none."""
    layers = b_object.data.uv_layers
    if not layers or not len(b_system.particles):
        return None
    number = next((i for i, uv in enumerate(layers) if uv.active_render), 0)
    where, particles = b_system.uv_on_emitter, b_system.particles
    last = len(particles) - 1
    return np.array([where(b_modifier, particle=particles[min(n, last)], particle_no=n, uv_no=number) for n in numbers])


# ---- Both ------------------------------------------------------------------------------------------------------------


def add_strands(context, name, arrays):
    """Number in the builder, of those strands that have no keys at infinity or nowhere; None if there are none."""
    finite = np.isfinite(arrays.keys).all(axis=1) & np.isfinite(arrays.radii)
    if not finite.all():
        owners = np.repeat(np.arange(len(arrays.counts)), arrays.counts)
        kept = np.ones(len(arrays.counts), bool)
        kept[owners[~finite]] = False
        context.warn(name, f"{(~kept).sum()} strands have keys that are not finite numbers; they are left out")
        uvs = None if arrays.uvs is None else arrays.uvs[kept]
        held = kept[owners]
        arrays = StrandArrays(arrays.keys[held], arrays.radii[held], arrays.counts[kept], arrays.randoms[kept], uvs)
    if not len(arrays.keys):
        return None
    return context.builder.strands(name, arrays.keys, arrays.radii, arrays.counts, arrays.randoms, arrays.uvs)


def random_numbers(count):
    """A number from 0 to 1 for each strand, the one that Cycles gives it."""
    return unit(hash_of_number(np.arange(count)))
