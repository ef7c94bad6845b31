# SPDX-License-Identifier: GPL-3.0-or-later
"""From sockets to values of engine_core's shader graphs: numbers where nothing is linked, else what the nodes say.

Each kind of node has its function in `node_values`, `node_inputs`, `node_textures` or `node_lights`. A node that has
none is told by name, and its place is taken by a stand-in.
"""

from ..core import graph, opcodes
from . import displacement, node_inputs, node_lights, node_probes, node_textures, node_values
from .graph import by_identifier, source

Op = opcodes.Op
DEEPEST, MOST_NODES = 150, 5000  # a tree may use a node many times over; beyond, nobody will look at it
FUNCTIONS = {
    **node_values.FUNCTIONS,
    **node_inputs.FUNCTIONS,
    **node_probes.FUNCTIONS,
    **node_textures.FUNCTIONS,
    **node_lights.FUNCTIONS,
    **displacement.FUNCTIONS,
}


class Values:
    """Translates one tree's value nodes. `warn(node, text)` tells of what is not rendered as it is."""

    def __init__(self, context, warn):
        self.context, self.warn = context, warn
        self.bump = None  # the normal that displacement makes, for all that have none linked
        self._known, self._depth, self._count = {}, 0, 0

    # ---- Inputs of a node, by identifier ----

    def number(self, node, groups, name):
        return self.socket(by_identifier(node.inputs, name), groups, "VALUE")

    def color(self, node, groups, name):
        return self.socket(by_identifier(node.inputs, name), groups, "RGBA")

    vector = color  # three numbers, either

    def is_linked(self, node, groups, name):
        return source(by_identifier(node.inputs, name), groups).node is not None

    def normal_or_none(self, node, groups, name="Normal"):
        """Value of a Normal input; if nothing is linked the normal of a displaced surface, or None."""
        socket = by_identifier(node.inputs, name)
        if socket and source(socket, groups).node:
            return self.socket(socket, groups, "VECTOR")
        return self.bump if name.endswith("Normal") else None

    def socket(self, socket, groups, kind):
        """Value of an input socket as `kind`: "VALUE" one number, "VECTOR" or "RGBA" three."""
        node, output, inner = source(socket, groups)
        if node is None:
            return converted(own_value(output), output.type, kind)
        key = (node.as_pointer(), output.identifier, tuple(g.as_pointer() for g in inner))
        if key not in self._known:
            self._known[key] = self._output(node, output, inner)
        value = self._known[key]
        if value is None:  # as if it were not linked
            return converted(own_value(socket), socket.type, kind)
        return converted(value, "VALUE" if graph.width(value) == 1 else output.type, kind)

    def _output(self, node, output, groups):
        """Value of a node's output; None: nobody knows."""
        self._count += 1
        function = FUNCTIONS.get(node.type)
        if self._depth >= DEEPEST or self._count > MOST_NODES:
            self.warn(node, f"more than {MOST_NODES} nodes, or {DEEPEST} in a row; what is behind is left out")
            return None
        if function is None:
            self.warn(node, f"{node.bl_label} is not rendered yet; using the socket's own value")
            return None
        self._depth += 1
        try:
            return function(self, node, output, groups)
        finally:
            self._depth -= 1


def own_value(socket):
    value = getattr(socket, "default_value", 0.0)
    return tuple(float(v) for v in value)[:3] if hasattr(value, "__len__") else float(value)


def converted(value, start, end):
    """As Blender's sockets do it: a colour becomes its luminance, a vector its mean."""
    is_number = graph.width(value) == 1
    if end == "VALUE":
        if is_number:
            return value
        return graph.luminance(value) if start == "RGBA" else graph.mean(value)
    return graph.splat(value) if is_number else value
