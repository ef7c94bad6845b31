# SPDX-License-Identifier: GPL-3.0-or-later
"""The machine: runs a program's steps over registers on the stack, and makes of them what was asked for.

Each family of operations, and the machine itself, is an entry point that is called through its address in
`scene.kernels` (see `link`): so kernels that render constant materials have none of it inside of them.
"""

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..linalg.records import copy_record, scratch_record
from ..linalg.registers import call, load_float, load_vector, store_float, store_vector
from ..linalg.vec3 import load3, store3
from ..program_tables import CLOSURE, REGISTERS
from ..shape.interaction import make_interaction, new_interaction
from ..tables import TreeKind
from .closures import add_closure
from .inputs import barycentrics_at
from .point import set_lamp, set_surface, set_world

ZERO = np.float32(0.0)
TRIANGLES = int(TreeKind.TRIANGLES)  # as a Hit holds it
new_registers, new_closure = scratch_record(REGISTERS), scratch_record(CLOSURE)


# ---- Entry points ----------------------------------------------------------------------------------------------------


def run_surface(scene, program, point, bsdf):
    """Lobes of a surface, and the frames they ask for."""
    registers, closure = new_registers(), new_closure()
    run_steps(scene, program, point, registers)
    bsdf.count = 0
    for i in range(program.closures, program.closures + program.closure_count):
        copy_record(closure, scene.closures[i])
        for j in range(closure.patches, closure.patches + closure.patch_count):
            patch = scene.patches[j]
            if patch.width == 3:
                store_vector(closure, patch.field, load_vector(registers, patch.register))
            else:
                store_float(closure, patch.field, load_float(registers, patch.register))
        if closure.weight > 0.0:
            add_closure(bsdf, closure)


def run_value(scene, program, point, unused):
    """A colour: to `point.result`."""
    registers = new_registers()
    run_steps(scene, program, point, registers)
    store3(point, "result", result(program, registers))


def run_light(scene, light, point, unused):
    """Radiance of a light with a program, or (gain > 0) its factor, to `point.result`. Set are, of the point: p on the
    light (for the world nothing), wo towards what is lit, ray_length, and visibility."""
    registers, wo = new_registers(), load3(point, "wo")
    program = scene.programs[light.program]
    gain = np.float32(1.0)
    if light.gain > 0.0:
        gain = light.gain
        set_lamp(scene, point, light, load3(point, "p"), wo, point.visibility, point.ray_length)
    elif light.instance < 0:
        set_world(point, -wo, point.visibility)
    else:
        p = load3(point, "p")
        instance = scene.instances[light.instance]
        row = scene.objects[light.instance].first_prim + light.prim
        through = light.instance if instance.root >= 0 else -1
        b1, b2 = barycentrics_at(scene, light.instance, row, p, ZERO)
        hit = SurfaceHit(point.ray_length, TRIANGLES, row, through, b1, b2)
        it = new_interaction()
        make_interaction(scene, it, hit, p + wo * point.ray_length, -wo, ZERO)
        set_surface(scene, point, it, hit, wo, point.visibility, ZERO)
    run_steps(scene, program, point, registers)
    store3(point, "result", result(program, registers) * gain)


# ---- Steps -----------------------------------------------------------------------------------------------------------


class SurfaceHit(NamedTuple):
    """As accel's Hit."""

    t: float
    kind: int
    prim: int
    instance: int
    b1: float
    b2: float


@kernel
def run_steps(scene, program, point, registers):
    for i in range(program.ops, program.ops + program.op_count):
        op = scene.ops[i]
        call(scene.kernels[op.family].address, scene, op, point, registers)


@kernel
def result(program, registers):
    return load3(program, "constant") if program.result < 0 else load_vector(registers, program.result)
