# SPDX-License-Identifier: GPL-3.0-or-later
"""What all panels of ours have in common."""

ENGINE = "LAMBENT"


class LambentPanel:
    """A panel of the properties editor that is there while Lambent is the engine. Subclasses set `bl_context`."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE

    def column(self, **options):
        """A column with names on the left and values on the right, as everywhere in Blender."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout.column(**options)
