# SPDX-License-Identifier: GPL-3.0-or-later
"""A node tree as its meaning: groups, reroutes and muted nodes seen through.

Blender 5.1 and later resolve most of it themselves, and repeat zones, bundles and closures as well. For Blender 4.5,
and for what is left, wires are followed here. Nothing is said here about what any node means.
"""

import re
from typing import NamedTuple

import bpy

LONGEST_WIRE = 1000  # reroutes and groups in a row; more is a loop that Blender should not have allowed


class Source(NamedTuple):
    """Where the value of an input comes from."""

    node: bpy.types.Node | None  # None: not linked
    socket: bpy.types.NodeSocket  # the node's output; not linked: the input whose own value counts
    groups: tuple  # group nodes that `node` is in, outermost first


class Graph:
    """The node tree of a material, world or light. Keep it as long as nodes of it are in use."""

    def __init__(self, b_owner):
        # the active output node for an engine that reads Cycles' materials, or None
        self.output = b_owner.node_tree.get_output_node("CYCLES")
        if self.output and self.output.target == "ALL" and hasattr(b_owner, "inline_shader_nodes"):
            # Blender resolves what leads to outputs for all engines, drops the rest, and frees the tree with `_inline`
            self._inline = b_owner.inline_shader_nodes()
            self.output = self._inline.node_tree.get_output_node("CYCLES")


def has_nodes(b_owner):
    """Whether nodes define it: up to Blender 4.5 there is a switch, which later ones deprecate."""
    return b_owner.node_tree is not None and (bpy.app.version >= (5, 0) or b_owner.use_nodes)


def source(socket, groups):
    """Follow the wire that ends in an input socket to the node that makes its value.

    None: the output of a lamp that somebody put into a material has no such socket.
    """
    end = Source(None, socket, groups)  # a wire that leads nowhere leaves the value of the last real input
    if socket is None:
        return end
    for _ in range(LONGEST_WIRE):
        link = next((link for link in socket.links if link.is_valid and not link.is_muted), None)
        if link is None:
            return end
        node, output = link.from_node, link.from_socket
        if node.mute:
            socket = next((inner.from_socket for inner in node.internal_links if inner.to_socket == output), None)
        elif node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.type == "GROUP_INPUT" and groups:
            groups, group = groups[:-1], groups[-1]
            socket = by_identifier(group.inputs, output.identifier)
            end = Source(None, socket, groups) if socket else end
        elif node.type == "GROUP":
            inner_output = group_output(node)
            groups = (*groups, node)
            socket = by_identifier(inner_output.inputs, output.identifier) if inner_output else None
            end = Source(None, socket, groups) if socket else end
        else:
            return Source(node, output, groups)
        if socket is None:
            return end
    return end


def group_output(group):
    """The active output node inside a group, or None."""
    nodes = group.node_tree.nodes if group.node_tree else ()
    return next((n for n in nodes if n.type == "GROUP_OUTPUT" and n.is_active_output), None)


def by_identifier(sockets, identifier):
    """A socket by its identifier: names are translated, renamed by users, and not unique."""
    return next((s for s in sockets if s.identifier == identifier), None)


def label(node):
    """A node's name as the artist knows it. (Blender numbers the nodes of a resolved tree: "7_Mix Shader".)"""
    return re.sub(r"^\d+_", "", node.name)
