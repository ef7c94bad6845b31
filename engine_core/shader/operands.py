# SPDX-License-Identifier: GPL-3.0-or-later
"""How operations read what they are given and write what they make."""

from ..jit import kernel
from ..linalg.registers import load_float, load_vector, store_float, store_vector
from ..linalg.vec3 import load3_at


@kernel
def number(op, registers, k):
    """Operand `k`, one float."""
    at = op.register[k]
    if at < 0:
        return op.constant[k, 0]
    return load_float(registers, at)


@kernel
def vector(op, registers, k):
    """Operand `k`, three floats."""
    at = op.register[k]
    if at < 0:
        return load3_at(op, "constant", k)
    return load_vector(registers, at)


@kernel
def give_number(op, registers, x):
    store_float(registers, op.out, x)


@kernel
def give_vector(op, registers, v):
    store_vector(registers, op.out, v)


@kernel
def give_both(op, registers, v, x):
    """A result of four floats: a colour and its alpha, a vector and its length."""
    store_vector(registers, op.out, v)
    store_float(registers, op.out + 3, x)
