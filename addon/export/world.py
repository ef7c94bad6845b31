# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: its radiance, constant or by nodes."""

from ..core import Visibility
from . import nodes
from .volumes import owned_volume

# Cycles keeps these on the world; without Cycles they are all on
RAYS = {
    "camera": Visibility.CAMERA,
    "diffuse": Visibility.DIFFUSE,
    "glossy": Visibility.GLOSSY,
    "transmission": Visibility.TRANSMISSION,
    "scatter": Visibility.SCATTER,
}


def export_world(context):
    b_world = context.scene.world
    if b_world is None:
        return  # black
    rays = getattr(b_world, "cycles_visibility", None)
    visibility = Visibility.ALL
    for name, ray in RAYS.items():
        if not getattr(rays, name, True):
            visibility &= ~ray
    context.builder.background(nodes.world_radiance(context, b_world), visibility, owned_volume(context, b_world))
