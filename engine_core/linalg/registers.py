# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows as plain lists of floats, and kernels behind addresses: what a machine that runs programs is made of.

load_float(row, 3)                   # the float at byte 12 of a row
store_vector(row, 3, v)              # floats 3, 4 and 5
call(address, scene, op, point, registers)     # an entry point, see jit.entry_point
"""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from .vec3 import LLVM_FLOAT, load_floats, store_floats, vec3


def _at(builder, row, index):
    floats = builder.bitcast(row, LLVM_FLOAT.as_pointer())
    return builder.gep(floats, [index])


@intrinsic
def load_float(typing_context, row, index):
    """The float number `index` of a row."""

    def lower(context, builder, sig, args):
        return builder.load(_at(builder, args[0], args[1]), align=4)

    return types.float32(row, types.int64), lower


@intrinsic
def store_float(typing_context, row, index, x):
    def lower(context, builder, sig, args):
        builder.store(args[2], _at(builder, args[0], args[1]), align=4)
        return context.get_dummy_value()

    return types.void(row, types.int64, types.float32), lower


@intrinsic
def load_vector(typing_context, row, index):
    """Three floats of a row from number `index` on, as a Vec3."""

    def lower(context, builder, sig, args):
        return load_floats(builder, _at(builder, args[0], args[1]))

    return vec3(row, types.int64), lower


@intrinsic
def store_vector(typing_context, row, index, v):
    def lower(context, builder, sig, args):
        store_floats(builder, _at(builder, args[0], args[1]), args[2])
        return context.get_dummy_value()

    return types.void(row, types.int64, vec3), lower


@intrinsic
def bits_to_float(typing_context, bits):
    """The float32 whose bits those of an unsigned 32-bit integer are."""

    def lower(context, builder, sig, args):
        return builder.bitcast(args[0], LLVM_FLOAT)

    return types.float32(types.uint32), lower


@intrinsic
def call(typing_context, address, a, b, c, d):
    """Call the entry point at `address`, which takes these four arguments: tables, rows, integers."""

    def lower(context, builder, sig, args):
        kinds = [context.get_value_type(t) for t in sig.args[1:]]
        function = ir.FunctionType(ir.VoidType(), kinds).as_pointer()
        builder.call(builder.inttoptr(args[0], function), args[1:])
        return context.get_dummy_value()

    return types.void(types.uint64, a, b, c, d), lower
