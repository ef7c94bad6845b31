# SPDX-License-Identifier: GPL-3.0-or-later
"""What shader nodes ask of an object or an instance as a whole: custom properties, particles, the instancer.

Each has a name that no attribute of an artist has. Translating a material's nodes notes the names that it asks for, so
values are read for what is used alone.
"""

import numpy as np

from .hashes import hash_of_number, unit
from .mesh import read

OBJECT, INSTANCER = "<object> ", "<instancer> "  # what follows is the name of a property
INSTANCER_GENERATED, INSTANCER_UV = "<generated of instancer>", "<uv of instancer>"
PARTICLE = "<particle>"  # number, age, lifetime and size; the following have a vector, and the first a random number
PARTICLE_LOCATION, PARTICLE_VELOCITY, PARTICLE_SPIN = "<particle location>", "<particle velocity>", "<particle spin>"
PARTICLES = (PARTICLE, PARTICLE_LOCATION, PARTICLE_VELOCITY, PARTICLE_SPIN)
NONE = (0.0, 0.0, 0.0, 0.0)


class InstanceValues:
    """Reads values of instances, as Blender hands them out."""

    def __init__(self, context):
        self.context = context
        self._particles, self._attributes = {}, {}  # read once for a system, and for an instancer

    def of(self, b_instance):
        """{name: up to 4 floats} of those that materials so far ask for."""
        values = {}
        for name in self.context.value_names:
            if name == INSTANCER_GENERATED:
                values[name] = tuple(0.5 * x - 0.5 for x in b_instance.orco) if b_instance.is_instance else NONE
            elif name == INSTANCER_UV:
                values[name] = (*b_instance.uv, 0.0) if b_instance.is_instance else NONE
            elif name.startswith(OBJECT):
                values[name] = _of_object(b_instance.object, name.removeprefix(OBJECT))
            elif name.startswith(INSTANCER):
                values[name] = self._of_instancer(b_instance, name.removeprefix(INSTANCER))
        if not self.context.value_names.isdisjoint(PARTICLES):
            values.update(self._of_particle(b_instance))
        return values

    def _of_instancer(self, b_instance, name):
        if not b_instance.is_instance:
            return _of_object(b_instance.object, name)
        system = b_instance.particle_system
        found = custom_value(system.settings, name) if system else None
        if found is None:
            found = self._of_geometry(b_instance, name)
        if found is None:
            found = custom_value(b_instance.parent, name)
        return _of_object(b_instance.object, name) if found is None else found

    def _of_geometry(self, b_instance, name):
        """An attribute that geometry nodes gave to the instance."""
        key = b_instance.parent.as_pointer(), name
        if key not in self._attributes:
            self._attributes[key] = _instance_attribute(b_instance.parent, name)
        if self._attributes[key] is None:
            return None
        numbers, rows = self._attributes[key]
        identity = [i for i in b_instance.persistent_id if i != 0x7FFFFFFF]
        row = numbers.get(identity[-1]) if identity else None
        return None if row is None else tuple(rows[row].tolist())

    def _of_particle(self, b_instance):
        nobody = {PARTICLE_LOCATION: (0.0, 0.0, 0.0, unit(hash_of_number(0)))}  # what Cycles takes for all the rest
        system = b_instance.particle_system if b_instance.is_instance else None
        if system is None:
            return nobody
        key = b_instance.parent.as_pointer(), system.name
        if key not in self._particles:
            self._particles[key] = _particles(system.particles, self.context.scene.frame_current_final)
        number = b_instance.persistent_id[0]
        table = self._particles[key]
        if number >= len(table[PARTICLE]):  # children are none, as in Cycles
            return nobody
        return {name: tuple(rows[number].tolist()) for name, rows in table.items()}


def layer_value(context, name):
    """A property of the view layer, or else of the scene or its world: four floats."""
    owners = (context.view_layer, context.scene, context.scene.world)
    return _first(owner and custom_value(owner, name) for owner in owners)


def custom_value(owner, name):
    """A custom property, or one of Blender's by its path, as four floats; None if there is none that is numbers."""
    if name in owner:  # its custom properties
        value = owner[name]
    else:
        try:
            value = owner.path_resolve(name)
        except ValueError:
            return None
    if isinstance(value, (bool, int, float)):
        return (float(value),) * 3 + (1.0,)
    try:
        numbers = [float(x) for x in value]
    except (TypeError, ValueError):
        return None
    return (*numbers, *(0.0, 0.0, 0.0, 1.0)[len(numbers) :]) if 1 <= len(numbers) <= 4 else None


def _of_object(b_object, name):
    return _first(owner and custom_value(owner, name) for owner in (b_object, b_object.data))


def _first(values):
    return next((value for value in values if value is not None), NONE)


def _instance_attribute(b_parent, name):
    """({number of an instance: its row}, float32 (n, 4)) of what geometry nodes gave to instances; None if nothing."""
    geometry = b_parent.evaluated_geometry()  # which owns the points
    points = geometry.instances_pointcloud()
    attribute = points.attributes.get(name) if points else None
    if attribute is None:
        return None
    count = len(attribute.data)
    values = np.zeros((count, 4), np.float32)
    values[:, 3] = 1.0
    kind = attribute.data_type
    if kind in ("FLOAT", "INT", "BOOLEAN", "INT8"):
        values[:, :3] = read(attribute.data, "value", count, np.float32)[:, None]
    elif kind in ("FLOAT_COLOR", "BYTE_COLOR"):
        values[:] = read(attribute.data, "color", count, np.float32, 4)
    elif kind in ("FLOAT_VECTOR", "FLOAT2"):
        size = 3 if kind == "FLOAT_VECTOR" else 2
        values[:, :size] = read(attribute.data, "vector", count, np.float32, size)
    else:
        return None
    ids = points.attributes.get("id")
    numbers = read(ids.data, "value", count, np.int32) if ids else np.arange(count)
    return {int(number): row for row, number in enumerate(numbers)}, values


def _particles(particles, frame):
    """{name: float32 (n, 4)}"""
    count = len(particles)
    names = ("birth_time", "lifetime", "size")
    birth, lifetime, size = (read(particles, name, count, np.float32) for name in names)
    vectors = (read(particles, name, count, np.float32, 3) for name in ("location", "velocity", "angular_velocity"))
    location, velocity, spin = (np.concatenate([v, np.zeros((count, 1), "f4")], axis=1) for v in vectors)
    location[:, 3] = [unit(hash_of_number(number)) for number in range(count)]
    numbers = np.stack([np.arange(count), frame - birth, lifetime, size], axis=1).astype(np.float32)
    return dict(zip(PARTICLES, (numbers, location, velocity, spin), strict=True))
