# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the machine's entry points are in this process: compiled, or loaded, when the first scene needs them."""

import threading

import numpy as np

from ..jit import entry_point, kernel
from ..linalg.records import numba_type, scratch_record
from ..linalg.registers import call, load_float
from ..program_tables import CLOSURE, KERNEL, OP, POINT, PROGRAM, REGISTERS
from ..tables import BSDF, LIGHT, LOBE, Scene
from . import closures, color, inputs, lighting, lines, lookup, machine, maths, noises, patterns, vectors
from .opcodes import Entry

FAMILIES = {
    Entry.INPUT: inputs.run,
    Entry.MATHS: maths.run,
    Entry.COLOR: color.run,
    Entry.VECTOR: vectors.run,
    Entry.IMAGE: lookup.run,
    Entry.PATTERN: patterns.run,
    Entry.NOISE: noises.run_noise,
    Entry.VORONOI: noises.run_voronoi,
    Entry.VORONOI_OF_4: noises.run_voronoi_of_4,
    Entry.GABOR: noises.run_gabor,
    Entry.LIGHTING: lighting.run,
    Entry.LINES: lines.run,
}
MACHINE = {
    Entry.SURFACE: (machine.run_surface, PROGRAM, BSDF),
    Entry.VALUE: (machine.run_value, PROGRAM, POINT),
    Entry.LIGHT: (machine.run_light, LIGHT, POINT),
}
_others = {}  # provided by rooms above
_entries, _lock = {}, threading.Lock()


def provide(entry, function, subject, target):
    """Let an entry point be found here that takes (scene, row of dtype `subject`, point, row of dtype `target`)."""
    _others[entry] = (function, subject, target)


def provide_family(entry, function):
    """Let a family of operations be found here that a room above knows how to run."""
    FAMILIES[entry] = function


def address(entry):
    """The address of an entry point."""
    with _lock:
        if entry not in _entries:
            if entry in MACHINE or entry in _others:
                function, subject, target = MACHINE.get(entry) or _others[entry]
                types = (Scene, subject, POINT, target)
            else:
                function, types = FAMILIES[entry], (Scene, OP, POINT, REGISTERS)
            _entries[entry] = entry_point(function, *(numba_type(t) for t in types))
        return _entries[entry].address


def compile_all(but=()):
    """Have machine code of all entry points, so that no scene has to wait for it."""
    for entry in (*FAMILIES, *MACHINE, *_others):
        if entry not in but:
            address(entry)


def kernels(families, has_programs, others=()):
    """The table KERNEL for a scene whose programs use these families, and which needs those others."""
    table = np.zeros(len(Entry), KERNEL)
    for entry in (*(MACHINE if has_programs else ()), *families, *others):
        table["address"][entry] = address(Entry(entry))
    return table


# ---- The machine on its own, for what is constant --------------------------------------------------------------------


def tables_of(curves):
    """A scene with nothing in it but curves, for steps that look at nothing else."""
    empty = {name: np.zeros(0, dtype) for name, dtype in Scene.dtypes().items()}
    return Scene(**{**empty, "curves": np.ascontiguousarray(curves)})


new_registers, new_point = scratch_record(REGISTERS), scratch_record(POINT)


@kernel
def _run_step(scene, where, op, result):
    registers, point = new_registers(), new_point()
    call(where, scene, op, point, registers)
    for i in range(len(result)):
        result[i] = load_float(registers, i)


def run_step(op, curves):
    """The first floats of the result of a row of OP whose operands are constants."""
    result, rows = np.zeros(16, np.float32), np.array([op], OP)
    rows["out"] = 0
    where = np.uint64(address(Entry(int(op["family"]))))
    _run_step(tables_of(curves), where, rows.view(np.recarray)[0], result)
    return result


@kernel
def _add_closure(bsdf, closure):
    closures.add_closure(bsdf, closure)


def lobes_of(row):
    """Rows of LOBE of a row of CLOSURE."""
    bsdf, closure = np.zeros(1, BSDF).view(np.recarray), np.array([row], CLOSURE).view(np.recarray)
    bsdf["frame_count"] = 1
    _add_closure(bsdf[0], closure[0])
    count = int(bsdf["count"][0])
    return bsdf["lobes"][0][:count].astype(LOBE)
