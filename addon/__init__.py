# SPDX-License-Identifier: GPL-3.0-or-later
"""Lambent in Blender: a render engine that reads the scene, hands it to `engine_core` and shows its pixels.

Works as an extension (`bl_ext.<repository>.lambent`) and straight from the sources:

    import addon
    addon.register()
"""

from . import compile_cache, engine, messages, preferences, properties, ui

MODULES = (preferences, properties, messages, engine, ui, compile_cache)
_registered = []


def register():
    """May be called again at any time, also after a call that failed half way."""
    unregister()
    try:
        for module in MODULES:
            _registered.append(module)
            module.register()
    except Exception:
        unregister()
        raise


def unregister():
    while _registered:
        _registered.pop().unregister()
