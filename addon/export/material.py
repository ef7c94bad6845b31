# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of the slots of an object."""

from . import nodes


def export_materials(context, b_object):
    """Numbers of the materials of all slots, None for an empty slot (the builder then takes its default, Cycles' grey).

    Slots may be linked to the object or to its data, and geometry nodes may add some: the evaluated object knows.
    """
    override = context.view_layer.material_override
    if override:
        return (export_material(context, override),)
    return tuple(export_material(context, slot.material) for slot in b_object.material_slots)


def export_material(context, b_material):
    """Number of a material in the builder."""
    if b_material is None:
        return None
    key = b_material.as_pointer()
    if key not in context.materials:
        surface = nodes.material_surface(context, b_material)
        context.materials[key] = context.builder.material(b_material.name, surface, b_material.pass_index)
    return context.materials[key]
