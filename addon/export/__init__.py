# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's evaluated scene to a SceneBuilder. The only room that reads Blender's scene; it writes nothing there.

    report = Report()
    builder, overrides = export_scene(depsgraph, report, width, height, engine)
    scene = builder.build()
    settings = settings._replace(**overrides)

What cannot be rendered as it is in Blender gets a stand-in, and a line in the report that names it.
"""

from ..core import SceneBuilder
from .camera import export_camera
from .context import Context
from .instances import export_instances
from .motion import middle_of_exposure
from .report import Report
from .world import export_world


def export_scene(depsgraph, report, width, height, engine=None):
    """Read everything that a render needs out of `depsgraph`; afterwards no data of Blender is needed any more.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph, evaluated
    report : Report, collects the warnings
    width, height : size of the whole frame in pixels, border or not
    engine : bpy.types.RenderEngine that renders, if one does: it knows the camera of each stereo view

    Returns
    -------
    builder : SceneBuilder
    overrides : dict, fields of Settings that the scene decides

    Raises SceneError if there is nothing to look through, or data that no picture can be made of.
    """
    context = Context(depsgraph, report, SceneBuilder(), width, height, engine)
    with middle_of_exposure(context):
        export_camera(context)
        export_world(context)
        export_instances(context)
    return context.builder, {"transparent_background": int(context.scene.render.film_transparent)}


__all__ = ["Report", "export_scene"]
