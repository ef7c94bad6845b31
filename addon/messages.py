# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist is told: warnings once each, and the one error that ends a render.

Blender takes a render for failed only if the engine reports an ERROR: then no file is written and the exit code is not
0. A plain exception, or `error_set`, would give exit code 0 and an empty picture.
"""

import sys
import traceback

import bpy
from bpy.app.handlers import persistent

_told = set()  # warnings of this render job; an animation is one job


def tell_warnings(engine, warnings):
    for text in map(str, warnings):
        if text not in _told:
            _told.add(text)
            engine.report({"WARNING"}, text)


def fail(engine, error, expected=()):
    """End the render with an error. One of no `expected` type is a bug of ours: its traceback goes to stderr.

    The lack of memory is nobody's.
    """
    text = str(error)
    if isinstance(error, MemoryError):
        text = f"out of memory: {error}"
    elif not isinstance(error, expected):
        traceback.print_exception(error, file=sys.stderr)
        text = f"{type(error).__name__}: {error} (the console has the details)"
    engine.report({"ERROR"}, f"Lambent: {text}")


def show(engine, error):
    """Tell of an error in a 3D view, which has no reports: in the view, and on stderr."""
    traceback.print_exception(error, file=sys.stderr)
    engine.update_stats("Lambent", f"{type(error).__name__}: {error}")


@persistent
def _forget(*_):
    _told.clear()


def register():
    bpy.app.handlers.render_init.append(_forget)


def unregister():
    if _forget in bpy.app.handlers.render_init:
        bpy.app.handlers.render_init.remove(_forget)
