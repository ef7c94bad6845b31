# SPDX-License-Identifier: GPL-3.0-or-later
"""What every part of an export is handed."""

from dataclasses import dataclass, field
from functools import cached_property

import bpy

from ..core import SceneBuilder
from .attributes import wanted_names
from .report import Report


@dataclass
class Context:
    depsgraph: bpy.types.Depsgraph
    report: Report
    builder: SceneBuilder
    width: int  # of the whole frame, in pixels
    height: int
    engine: bpy.types.RenderEngine | None = None
    materials: dict = field(default_factory=dict)  # a material's address in Blender: its number in the builder
    images: dict = field(
        default_factory=dict
    )  # an image's address in Blender, frame, and whether in tiles: what is read of it
    placed: dict | None = None  # with motion blur, what names an instance: numbers of its parts in the builder

    value_names: set = field(default_factory=set)  # of values of instances that materials so far ask for

    @property
    def scene(self):
        return self.depsgraph.scene_eval

    @cached_property
    def attribute_names(self):
        """Names of the attributes that shader nodes ask for."""
        return wanted_names()

    @property
    def view_layer(self):
        return self.depsgraph.view_layer_eval

    def warn(self, owner, text):
        self.report.warn(owner, text)
