# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair: Blender's Curves objects, and hair that particle systems grow, as strands of the SceneBuilder."""

from typing import NamedTuple

import numpy as np

from . import attributes as named
from .hashes import hash_of_number, unit
from .mesh import read, texture_space
from .pixels import srgb_to_linear

DEFAULT_RADIUS = 0.005  # of a curve without radii, in metres, as in Cycles
POLY, BEZIER, NURBS = 1, 2, 3


class StrandArrays(NamedTuple):
    """What SceneBuilder.strands takes."""

    keys: np.ndarray  # (n, 3), object space
    radii: np.ndarray  # (n,)
    counts: np.ndarray  # int (m,), keys of each strand
    randoms: np.ndarray  # (m,)
    uvs: np.ndarray | None  # (m, 2)
    generated: np.ndarray | None  # (m, 3)
    attributes: dict  # name: (n, 3 or 4), at the keys
    is_smooth: bool


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
    kinds = np.zeros(len(counts), np.int32) if kinds is None else read(kinds.data, "value", len(counts), np.int32)
    if np.isin(kinds, (BEZIER, NURBS)).any():
        context.warn(
            name, "Bezier and NURBS curves are rendered as smooth curves through their control points, as in Cycles"
        )
    asked = _attributes(attributes, counts, context.attribute_names)
    randoms, uvs = random_numbers(len(counts)), _uvs(attributes, len(counts))
    return add_strands(context, name, StrandArrays(keys, radii, counts, randoms, uvs, None, asked, kinds[0] != POLY))


def _uvs(attributes, count):
    """The first pair of numbers that each curve has: where it grows on its surface."""
    for attribute in attributes:
        if attribute.domain == "CURVE" and attribute.data_type == "FLOAT2":
            return read(attribute.data, "vector", count, np.float32, 2)
    return None


def _attributes(attributes, counts, names):
    """Those of the names that the curves have, at their keys."""
    found = {}
    for name in names:
        attribute = attributes.get(name)
        values = named.owned_values(attribute)
        if values is not None:
            found[name] = np.repeat(values, counts, axis=0) if attribute.domain == "CURVE" else values
    return found


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
            arrays = _grown(b_object, b_modifier, b_system, subdivisions, context.attribute_names)
            geometry = add_strands(context, f"{b_object.name} ({b_system.name})", arrays)
            if geometry is not None:
                found.append((geometry, max(b_settings.material - 1, 0)))
    return found


def _grown(b_object, b_modifier, b_system, subdivisions, names):
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
    uvs, asked = _of_emitter(b_object, b_modifier, b_system, numbers, names)
    asked = {name: np.repeat(named.three_at_least(values), steps, axis=0) for name, values in asked.items()}
    scale, offset = texture_space(b_object.data)
    generated = keys[::steps] * scale + offset
    counts, randoms = np.full(len(numbers), steps), random_numbers(len(numbers))
    return StrandArrays(keys, radii.ravel(), counts, randoms, uvs, generated, asked, is_smooth=True)


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


def _of_emitter(b_object, b_modifier, b_system, numbers, names):
    """What the emitter's UV map says where each strand grows, (m, 2) or None; and of the names {name: values} of those
    UV maps and colours at corners, in bytes, that it has."""
    b_mesh, particles = b_object.data, b_system.particles
    if not len(particles):
        return None, {}
    owners = [particles[min(number, len(particles) - 1)] for number in numbers]

    def at_roots(function, **layer):
        told = [function(b_modifier, particle=b, particle_no=n, **layer) for b, n in zip(owners, numbers, strict=True)]
        return np.array(told, np.float32).reshape(len(numbers), -1)

    uvs, found = None, {}
    for layer, b_map in enumerate(b_mesh.uv_layers):
        if b_map.active_render or b_map.name in names:
            values = at_roots(b_system.uv_on_emitter, uv_no=layer)
            uvs = values if b_map.active_render else uvs
            found |= {b_map.name: values} if b_map.name in names else {}
    colors = [b for b in b_mesh.color_attributes if b.data_type == "BYTE_COLOR" and b.domain == "CORNER"]
    for layer, b_color in enumerate(colors):
        if b_color.name in names:
            found[b_color.name] = srgb_to_linear(at_roots(b_system.mcol_on_emitter, vcol_no=layer))
    return uvs, found


# ---- Both ------------------------------------------------------------------------------------------------------------


def add_strands(context, name, arrays):
    """Number in the builder, of those strands that have no keys at infinity or nowhere; None if there are none."""
    finite = np.isfinite(arrays.keys).all(axis=1) & np.isfinite(arrays.radii)
    if not finite.all():
        owners = np.repeat(np.arange(len(arrays.counts)), arrays.counts)
        kept = np.ones(len(arrays.counts), bool)
        kept[owners[~finite]] = False
        context.warn(name, f"{(~kept).sum()} strands have keys that are not finite numbers; they are left out")
        held = kept[owners]
        arrays = arrays._replace(
            **{field: getattr(arrays, field)[held] for field in ("keys", "radii")},
            **{field: getattr(arrays, field)[kept] for field in ("counts", "randoms")},
            **{field: values[kept] for field in ("uvs", "generated") if (values := getattr(arrays, field)) is not None},
            attributes={key: values[held] for key, values in arrays.attributes.items()},
        )
    return context.builder.strands(name, *arrays) if len(arrays.keys) else None


def random_numbers(count):
    """A number from 0 to 1 for each strand, the one that Cycles gives it."""
    return unit(hash_of_number(np.arange(count)))
