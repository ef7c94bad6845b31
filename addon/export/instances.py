# SPDX-License-Identifier: GPL-3.0-or-later
"""All objects, and all instances of them by collections, geometry nodes and particles: each geometry is read once.

Blender hands everything out as one flat list. What is no mesh but has a surface (text, curves, metaballs) stands in it
a second time, as a mesh.
"""

from typing import NamedTuple

import numpy as np

from ..core import Aim, Terminator, Visibility
from .hair import read_curves, read_particle_hair
from .hashes import hash_of_name, unit
from .instance_values import InstanceValues
from .light import aim_of, export_light
from .material import export_materials
from .mesh import first_slot, mesh_arrays, point_arrays, without_broken_triangles
from .motion import deforms, hair_deforms, note_placement
from .shape import read_shape

RAYS = {
    "visible_camera": Visibility.CAMERA,
    "visible_diffuse": Visibility.DIFFUSE,
    "visible_glossy": Visibility.GLOSSY,
    "visible_transmission": Visibility.TRANSMISSION,
    "visible_volume_scatter": Visibility.SCATTER,
    "visible_shadow": Visibility.SHADOW,
}
NOT_RENDERED = {
    "VOLUME": "volume objects",
    "GREASEPENCIL": "grease pencil objects",
    "GPENCIL": "grease pencil objects",
}


class Source(NamedTuple):
    """What all instances of one object have in common."""

    geometry: int | None  # None: nothing to render
    materials: tuple
    name: str
    visibility: Visibility
    pass_index: int
    aim: Aim
    terminator: Terminator


def export_instances(context):
    """Objects and lamps. Nothing of an instance may be kept: Blender reuses it for the next one."""
    placing = _Placing(context)
    for b_instance in context.depsgraph.object_instances:
        placing.add(b_instance)


class _Placing:
    """Hands instances to the builder, and keeps what is read once for all of them."""

    def __init__(self, context):
        self.context, self.values = context, InstanceValues(context)
        self.geometries, self.sources, self.hairs, self.instancers = {}, {}, {}, {}

    def add(self, b_instance):
        b_object, visibility = b_instance.object, self.visibility_of_instancer(b_instance)
        if b_instance.show_particles and b_object.particle_systems and self.context.view_layer.use_strand:
            self.add_hair(b_instance, b_object, visibility)
        if not b_instance.show_self:
            return
        if b_object.type == "LIGHT":
            self.add_lamp(b_instance, b_object, visibility)
        elif b_object.data is not None:
            self.add_surface(b_instance, b_object, visibility)

    def visibility_of_instancer(self, b_instance):
        if not b_instance.is_instance:
            return Visibility.ALL
        key = b_instance.parent.as_pointer()
        if key not in self.instancers:
            self.instancers[key] = _visibility(self.context, b_instance.parent)
        return self.instancers[key]

    def add_lamp(self, b_instance, b_object, visibility):
        matrix, random = np.array(b_instance.matrix_world[:]), _random(b_instance, b_object.name)
        visibility &= _visibility(self.context, b_object)
        export_light(self.context, b_object, matrix, visibility, random, lambda: self.values.of(b_instance))

    def add_surface(self, b_instance, b_object, visibility):
        key = _source_object(b_instance).as_pointer(), b_object.data.as_pointer()
        source = self.sources.get(key)
        if source is None:
            source = self.sources[key] = _source(self.context, b_object, self.geometries)
        visibility = int(visibility & source.visibility)
        if source.geometry is not None and visibility:
            more = {"pass_index": source.pass_index, "aim": source.aim, "terminator": source.terminator}
            self.place(b_instance, source.geometry, source.materials, source.name, visibility, **more)

    def add_hair(self, b_instance, b_object, visibility):
        """What particle systems grow on an object, even where it is not shown itself."""
        key = _source_object(b_instance).as_pointer()
        if key not in self.hairs:
            grown = read_particle_hair(self.context, b_object)
            if grown and self.context.placed is not None and hair_deforms(b_object):
                self.context.warn(b_object.name, "the deformation of its hair is not blurred yet, only its movement")
            self.hairs[key] = grown, export_materials(self.context, b_object) if grown else ()
        grown, materials = self.hairs[key]
        visibility, index = int(visibility & _visibility(self.context, b_object)), b_object.pass_index
        for geometry, slot in grown if visibility else ():
            material = materials[min(slot, len(materials) - 1)]
            self.place(b_instance, geometry, (material,), b_object.name, visibility, pass_index=index)

    def place(self, b_instance, geometry, materials, name, visibility, **more):
        note_placement(self.context, b_instance, _source_object(b_instance))
        self.context.builder.instance(
            geometry,
            np.array(b_instance.matrix_world[:]),
            materials,
            name,
            visibility,
            random=_random(b_instance, name),
            color=b_instance.object.color,
            values=self.values.of(b_instance),
            **more,
        )


def _source_object(b_instance):
    """The object that there really is: geometry nodes hand all instances out in one and the same temporary object."""
    return b_instance.instance_object if b_instance.is_instance else b_instance.object


def _source(context, b_object, geometries):
    geometry = _geometry(context, b_object, geometries)
    if geometry is None:
        return Source(None, (), b_object.name, Visibility.ALL, 0, Aim.AUTOMATIC, Terminator())
    materials = export_materials(context, b_object, _is_holdout(context, b_object))
    if type(b_object.data).__name__ != "Mesh" or _shape(b_object) != "MESH":
        materials = (materials[min(first_slot(b_object.data), len(materials) - 1)],)
    if b_object.is_shadow_catcher:
        context.warn(b_object.name, "shadow catchers are not rendered yet; it is an ordinary object")
    if context.placed is not None and deforms(b_object):
        context.warn(b_object.name, "its deformation is not blurred yet, only its movement")
    visibility = _visibility(context, b_object)
    terminator = Terminator(b_object.shadow_terminator_geometry_offset, b_object.shadow_terminator_shading_offset)
    return Source(geometry, materials, b_object.name, visibility, b_object.pass_index, aim_of(b_object), terminator)


def _geometry(context, b_object, geometries):
    """Number of the object's geometry in the builder; None if it has no surface. Objects that share their evaluated
    data share it: a mesh that no modifier has changed, all instances of an object."""
    b_data, name = b_object.data, b_object.name
    shape = _shape(b_object)
    key = b_data.as_pointer(), shape
    if key in geometries:
        return geometries[key]
    geometry = None
    kind = type(b_data).__name__
    if kind == "Mesh":
        geometry = _read_mesh(context, name, b_data) if shape == "MESH" else read_shape(context, name, b_data, shape)
    elif kind == "PointCloud" and len(b_data.points):
        geometry = context.builder.spheres(name, *point_arrays(b_data))
    elif kind == "Curves" and context.view_layer.use_strand:
        geometry = read_curves(context, name, b_data)
    elif b_object.type in NOT_RENDERED:
        context.warn(name, f"{NOT_RENDERED[b_object.type]} are not rendered yet; it is left out")
    geometries[key] = geometry
    return geometry


def _shape(b_object):
    """What the artist wants it to be rendered as."""
    return getattr(getattr(b_object, "lambent", None), "shape", "MESH")


def _read_mesh(context, name, b_mesh):
    arrays = mesh_arrays(b_mesh, context.attribute_names)
    if arrays is None:
        return None
    arrays, broken = without_broken_triangles(arrays)
    if broken:
        context.warn(name, f"{broken} triangles have corners that are not finite numbers; they are left out")
    return context.builder.mesh(name, *arrays) if len(arrays.triangles) else None


def _visibility(context, b_object):
    """Rays that see an object, by its own switches and those of its collections in this view layer."""
    visibility = Visibility.ALL
    for name, ray in RAYS.items():
        if not getattr(b_object, name):
            visibility &= ~ray
    if b_object.indirect_only_get(view_layer=context.view_layer):
        visibility &= ~Visibility.CAMERA
    return visibility


def _is_holdout(context, b_object):
    return b_object.is_holdout or b_object.holdout_get(view_layer=context.view_layer)


def _random(b_instance, name):
    """A number from 0 to 1 that stays with an instance, or with the name of an object; the one that Cycles gives it."""
    number = b_instance.random_id if b_instance.is_instance else hash_of_name(name)
    return unit(number)
