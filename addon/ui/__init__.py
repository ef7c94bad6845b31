# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels by topic, and which of Blender's own panels stay."""

import bpy

from . import (
    blender_panels,
    copy_from_cycles,
    film,
    light,
    light_paths,
    motion_blur,
    passes,
    performance,
    sampling,
    shape,
    simplify,
    surface,
    visibility,
)

# In the order in which they stand in the properties editor.
TOPICS = (
    copy_from_cycles,
    sampling,
    light_paths,
    film,
    motion_blur,
    simplify,
    performance,
    passes,
    surface,
    light,
    shape,
    visibility,
)
CLASSES = tuple(cls for topic in TOPICS for cls in topic.CLASSES)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    blender_panels.register()


def unregister():
    blender_panels.unregister()
    for cls in reversed(CLASSES):
        if cls.is_registered:
            bpy.utils.unregister_class(cls)
