# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of the slots of an object."""

from . import nodes
from .volumes import owned_volume


def export_materials(context, b_object, is_holdout=False):
    """Numbers of the materials of all slots, at least one. `is_holdout`: the camera sees a hole where the object is.

    Slots may be linked to the object or to its data, and geometry nodes may add some: the evaluated object knows.
    """
    override = context.view_layer.material_override
    slots = [override] if override else [slot.material for slot in b_object.material_slots]
    return tuple(export_material(context, b_material, is_holdout) for b_material in slots or [None])


def export_material(context, b_material, is_holdout=False):
    """Number of a material in the builder. None, as in an empty slot, has one, too."""
    key = b_material.as_pointer() if b_material else None, is_holdout
    if key not in context.materials:
        context.materials[key] = _add_material(context, b_material, nodes.seen_as_hole if is_holdout else _as_it_is)
    return context.materials[key]


def _as_it_is(surface):
    return surface


def _add_material(context, b_material, seen):
    if b_material is None:
        return context.builder.material("(none)", seen(nodes.default_surface()))
    surface = seen(nodes.material_surface(context, b_material))
    displacement, keeps_normals = nodes.material_displacement(context, b_material) or (None, False)
    return context.builder.material(
        b_material.name,
        surface,
        b_material.pass_index,
        transparent_shadows=b_material.use_transparent_shadow,
        volume=owned_volume(context, b_material),
        displacement=displacement,
        keeps_normals=keeps_normals,
    )
