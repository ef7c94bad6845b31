# SPDX-License-Identifier: GPL-3.0-or-later
"""Eight integers of 32 bits in one register: for hashes of eight points of a lattice at once.

The type is i32x8, beside the f32x8 of `simd`. Sums and products wrap around, and comparisons are of signed numbers.
"""

import operator

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from .simd import INT, LanesType, _operator, f32x4, f32x8, mask8

i32x8 = LanesType("i32x8", INT, 8)


def _constant(numbers):
    return ir.Constant(i32x8.llvm, list(numbers))


for _op, _instruction in (
    (operator.add, "add"),
    (operator.sub, "sub"),
    (operator.mul, "mul"),
    (operator.xor, "xor"),
    (operator.and_, "and_"),
    (operator.or_, "or_"),
):
    _operator(_op, i32x8, i32x8, lambda b, x, y, instruction=_instruction: getattr(b, instruction)(x, y))
_operator(operator.lt, i32x8, mask8, lambda b, x, y: b.icmp_signed("<", x, y))
_operator(operator.eq, i32x8, mask8, lambda b, x, y: b.icmp_signed("==", x, y))


@intrinsic
def splat_int8(typing_context, x):
    """The same integer in every lane."""

    def lower(context, builder, sig, args):
        undefined = ir.Constant(i32x8.llvm, ir.Undefined)
        one = builder.insert_element(undefined, args[0], ir.Constant(INT, 0))
        return builder.shuffle_vector(one, undefined, _constant([0] * 8))

    return i32x8(types.int32), lower


@intrinsic(prefer_literal=True)
def lane_bit(typing_context, n):
    """Bit `n`, a constant, of each lane's number: 0, 1, 0, 1 ... for n = 0."""
    bit = n.literal_value
    return i32x8(n), lambda context, b, sig, args: _constant([i >> bit & 1 for i in range(8)])


@intrinsic
def lane_numbers(typing_context):
    """0, 1 ... 7."""
    return i32x8(), lambda context, b, sig, args: _constant(range(8))


@intrinsic(prefer_literal=True)
def rotate(typing_context, v, n):
    """The bits of each integer, moved up by a constant number of places; the top ones come in at the bottom."""
    places = n.literal_value

    def lower(context, builder, sig, args):
        up = builder.shl(args[0], _constant([places] * 8))
        return builder.or_(up, builder.lshr(args[0], _constant([32 - places] * 8)))

    return i32x8(v, n), lower


@intrinsic(prefer_literal=True)
def shift_right(typing_context, v, n):
    """Each integer over 2 ** n, a constant power, rounded down."""
    places = n.literal_value
    return i32x8(v, n), lambda context, b, sig, args: b.ashr(args[0], _constant([places] * 8))


@intrinsic(prefer_literal=True)
def shift_down(typing_context, v, n):
    """The bits of each integer, moved down by a constant number of places; zeros come in at the top."""
    places = n.literal_value
    return i32x8(v, n), lambda context, b, sig, args: b.lshr(args[0], _constant([places] * 8))


@intrinsic
def reverse_bits8(typing_context, v):
    """The bits of each integer in the other order: bit 0 becomes bit 31."""

    def lower(context, builder, sig, args):
        function_type = ir.FunctionType(i32x8.llvm, [i32x8.llvm])
        return builder.call(
            cgutils.get_or_insert_function(builder.module, function_type, "llvm.bitreverse.v8i32"), args
        )

    return i32x8(v), lower


@intrinsic(prefer_literal=True)
def negate_where_bit(typing_context, v, h, n):
    """The floats `v`, negative in the lanes in which bit `n`, a constant, of the integer `h` is set."""
    bit = n.literal_value

    def lower(context, builder, sig, args):
        flag = builder.and_(args[1], _constant([1 << bit] * 8))
        sign = builder.shl(flag, _constant([31 - bit] * 8))
        return builder.bitcast(builder.xor(builder.bitcast(args[0], i32x8.llvm), sign), f32x8.llvm)

    return f32x8(v, h, n), lower


@intrinsic
def choose(typing_context, mask, x, y):
    """`x` in the lanes where the mask is set, else `y`."""
    return x(mask, x, x), lambda context, b, sig, args: b.select(*args)


@intrinsic
def to_floats(typing_context, v):
    """The integers as floats."""
    return f32x8(i32x8), lambda context, b, sig, args: b.sitofp(args[0], f32x8.llvm)


@intrinsic
def to_integers(typing_context, v):
    """Floats as integers, rounded towards 0."""
    return i32x8(f32x8), lambda context, b, sig, args: b.fptosi(args[0], i32x8.llvm)


@intrinsic
def unsigned_to_floats(typing_context, v):
    """The integers, taken for unsigned ones, as floats."""
    return f32x8(i32x8), lambda context, b, sig, args: b.uitofp(args[0], f32x8.llvm)


@intrinsic
def bits_of_floats(typing_context, v):
    """The 32 bits of each float."""
    return i32x8(f32x8), lambda context, b, sig, args: b.bitcast(args[0], i32x8.llvm)


@intrinsic
def least_lane(typing_context, v):
    """The least of eight floats, none of which is not a number."""

    def lower(context, builder, sig, args):
        v = args[0]
        for half in (4, 2, 1):
            low = ir.Constant(ir.VectorType(INT, half), list(range(half)))
            high = ir.Constant(ir.VectorType(INT, half), list(range(half, 2 * half)))
            undefined = ir.Constant(v.type, ir.Undefined)
            x, y = builder.shuffle_vector(v, undefined, low), builder.shuffle_vector(v, undefined, high)
            v = builder.select(builder.fcmp_ordered("<", x, y), x, y)
        return builder.extract_element(v, ir.Constant(INT, 0))

    return types.float32(f32x8), lower


@intrinsic
def interpolated(typing_context, v, t):
    """From eight floats at the corners of a cube, numbered as by `lane_bit`, to the one at the place `t` in it."""

    def lower(context, builder, sig, args):
        v, t = args
        for axis, half in ((2, 4), (1, 2), (0, 1)):
            low = ir.Constant(ir.VectorType(INT, half), list(range(half)))
            high = ir.Constant(ir.VectorType(INT, half), list(range(half, 2 * half)))
            undefined = ir.Constant(v.type, ir.Undefined)
            share = builder.shuffle_vector(t, t, ir.Constant(low.type, [axis] * half))
            here, there = builder.shuffle_vector(v, undefined, low), builder.shuffle_vector(v, undefined, high)
            v = builder.fadd(here, builder.fmul(share, builder.fsub(there, here)))
        return builder.extract_element(v, ir.Constant(INT, 0))

    return types.float32(f32x8, f32x4), lower


@intrinsic(prefer_literal=True)
def spread(typing_context, v, axis):
    """Lane `axis`, a constant, of four in all of eight lanes."""
    places = _constant([axis.literal_value] * 8)
    return f32x8(f32x4, axis), lambda context, b, sig, args: b.shuffle_vector(args[0], args[0], places)


@intrinsic
def square_roots(typing_context, v):
    """Of each lane."""
    return v(v), lambda context, b, sig, args: _call(b, "llvm.sqrt", args)


@intrinsic
def floors(typing_context, v):
    """The next integer below each float, as a float."""
    return v(v), lambda context, b, sig, args: _call(b, "llvm.floor", args)


@intrinsic
def truncated(typing_context, v):
    """The integer part of each float, as a float."""
    return v(v), lambda context, b, sig, args: _call(b, "llvm.trunc", args)


@intrinsic
def absolutes(typing_context, v):
    """The distance of each float from 0."""
    return v(v), lambda context, b, sig, args: _call(b, "llvm.fabs", args)


@intrinsic
def powers(typing_context, v, exponents):
    """Each float to the power in the lane of the other."""
    return v(v, v), lambda context, b, sig, args: _call(b, "llvm.pow", args)


def _call(builder, name, args):
    lanes = args[0].type
    function_type = ir.FunctionType(lanes, [lanes] * len(args))
    full_name = f"{name}.v{lanes.count}f32"
    return builder.call(cgutils.get_or_insert_function(builder.module, function_type, full_name), args)
