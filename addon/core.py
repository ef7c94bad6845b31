# SPDX-License-Identifier: GPL-3.0-or-later
"""The only door to engine_core: a sub-package of the installed extension, a neighbour of the add-on in the sources.

Importing this module loads numba, which takes some 0.3 s. So the add-on does it when a render starts, not when Blender
starts, and Blender opens as fast as without it.
"""

import importlib
import os
from pathlib import Path

import bpy

# An extension's own folder is wiped at every upgrade and may be read-only; Blender gives it another one to write to.
# numba asks for the folder once, while kernels are defined: hence before the import. A user's own choice wins.
if __package__.startswith("bl_ext.") and "LAMBENT_CACHE" not in os.environ:
    os.environ["LAMBENT_CACHE"] = bpy.utils.extension_path_user(__package__, path="kernels", create=True)

PACKAGE = f"{__package__}.engine_core" if Path(__file__).with_name("engine_core").is_dir() else "engine_core"


def _import(name):
    return importlib.import_module(f"{PACKAGE}.{name}")


jit = _import("jit")
materials, volumes = _import("scene.materials"), _import("scene.volumes")
flatten = _import("scene.flattening").flatten
graph, opcodes = _import("shader.graph"), _import("shader.opcodes")
atmosphere, daylight = _import("texture.atmosphere"), _import("texture.daylight")
CURVE_SIZE = _import("program_tables").CURVE_SIZE
ProgramTables = _import("shader.program").ProgramTables
FilterKind, IntegratorKind, SamplerKind, Settings = (
    getattr(_import("settings"), name) for name in ("FilterKind", "IntegratorKind", "SamplerKind", "Settings")
)
status = _import("integrator.status")
Scene, Visibility = (getattr(_import("tables"), name) for name in ("Scene", "Visibility"))
SceneBuilder, LampShader = (getattr(_import("scene.builder"), name) for name in ("SceneBuilder", "LampShader"))
SceneError = _import("scene.checks").SceneError
compile_all_programs = _import("shader.link").compile_all
Aim, Terminator = _import("scene.targets").Aim, _import("scene.terminator").Terminator
Render = _import("integrator.tiles").Render
