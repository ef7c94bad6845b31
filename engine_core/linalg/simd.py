# SPDX-License-Identifier: GPL-3.0-or-later
"""SIMD in kernels: f32x4 and f32x8, four and eight float32 that live in one register of the machine.

They have operators and comparisons; a comparison gives a mask, and `bits` turns a mask into an integer with a bit for
each lane. Lanes are loaded from and stored to fields of rows, so nothing here touches an array object:

    t = (load8(node, "bounds", 0) - splat8(origin)) * splat8(inverse)
    hits = bits(t <= splat8(t_max))
    while hits != 0:
        i = lowest_bit(hits)
        hits = without_lowest_bit(hits)

For accel/, the lattices of texture/ and the sums of film/sharing alone: everything else is scalar code, which a GPU
could run. There is no plain Python behind it.
"""

import operator

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, models, register_model

from .vec3 import vec3

FLOAT, INT, BYTE, LONG, BIT = ir.FloatType(), ir.IntType(32), ir.IntType(8), ir.IntType(64), ir.IntType(1)


class LanesType(types.Type):
    """`width` numbers of one LLVM type in a register."""

    def __init__(self, name, element, width):
        super().__init__(name)
        self.width, self.llvm = width, ir.VectorType(element, width)


@register_model(LanesType)
class LanesModel(models.PrimitiveModel):
    def __init__(self, manager, fe_type):
        super().__init__(manager, fe_type, fe_type.llvm)


f32x4, f32x8 = LanesType("f32x4", FLOAT, 4), LanesType("f32x8", FLOAT, 8)
mask4, mask8 = LanesType("mask4", BIT, 4), LanesType("mask8", BIT, 8)


# ---- Operators -------------------------------------------------------------------------------------------------------


def _operator(op, operand, result, lower):
    @infer_global(op)
    class Template(AbstractTemplate):
        def generic(self, args, kws):
            if args == (operand, operand):
                return signature(result, operand, operand)

    lower_builtin(op, operand, operand)(lambda context, builder, sig, args: lower(builder, *args))


for _lanes, _mask in ((f32x4, mask4), (f32x8, mask8)):
    _operator(operator.add, _lanes, _lanes, lambda b, x, y: b.fadd(x, y))
    _operator(operator.sub, _lanes, _lanes, lambda b, x, y: b.fsub(x, y))
    _operator(operator.mul, _lanes, _lanes, lambda b, x, y: b.fmul(x, y))
    _operator(operator.truediv, _lanes, _lanes, lambda b, x, y: b.fdiv(x, y))
    _operator(operator.lt, _lanes, _mask, lambda b, x, y: b.fcmp_ordered("<", x, y))
    _operator(operator.le, _lanes, _mask, lambda b, x, y: b.fcmp_ordered("<=", x, y))
    _operator(operator.gt, _lanes, _mask, lambda b, x, y: b.fcmp_ordered(">", x, y))
    _operator(operator.ge, _lanes, _mask, lambda b, x, y: b.fcmp_ordered(">=", x, y))
    _operator(operator.and_, _mask, _mask, lambda b, x, y: b.and_(x, y))
    _operator(operator.or_, _mask, _mask, lambda b, x, y: b.or_(x, y))


@intrinsic
def minimum(typing_context, x, y):
    """The lesser in each lane; y where one is not a number."""
    return x(x, x), lambda context, b, sig, args: b.select(b.fcmp_ordered("<", *args), *args)


@intrinsic
def maximum(typing_context, x, y):
    """The greater in each lane; y where one is not a number."""
    return x(x, x), lambda context, b, sig, args: b.select(b.fcmp_ordered(">", *args), *args)


@intrinsic
def difference_of_products(typing_context, a, b, c, d):
    """a b - c d, each product rounded: swapping (a, b) with (c, d) gives exactly the negative.

    A fused multiply-add would round one product and not the other. The flag keeps numba from allowing that.
    """

    def lower(context, builder, sig, args):
        a, b, c, d = args
        flags = ("nsz",)
        return builder.fsub(builder.fmul(a, b, flags=flags), builder.fmul(c, d, flags=flags), flags=flags)

    return a(a, a, a, a), lower


# ---- Lanes and bits --------------------------------------------------------------------------------------------------


@intrinsic
def bits(typing_context, mask):
    """The mask as an integer, lane 0 lowest."""

    def lower(context, builder, sig, args):
        return builder.zext(builder.bitcast(args[0], ir.IntType(sig.args[0].width)), INT)

    return types.int32(mask), lower


@intrinsic
def lowest_bit(typing_context, x):
    """Index of the lowest bit that is set; undefined for 0."""
    return types.int32(types.int32), lambda context, b, sig, args: b.cttz(args[0], ir.Constant(BIT, 1))


@intrinsic
def without_lowest_bit(typing_context, x):
    """The integer with its lowest bit cleared."""

    def lower(context, builder, sig, args):
        return builder.and_(args[0], builder.sub(args[0], ir.Constant(INT, 1)))

    return types.int32(types.int32), lower


@intrinsic
def lane(typing_context, v, i):
    """The number in lane i."""
    return types.float32(v, types.int32), lambda context, b, sig, args: b.extract_element(*args)


def _in_all_lanes(builder, lanes, x):
    undefined = ir.Constant(lanes.llvm, ir.Undefined)
    one = builder.insert_element(undefined, x, ir.Constant(INT, 0))
    return builder.shuffle_vector(one, undefined, ir.Constant(ir.VectorType(INT, lanes.width), [0] * lanes.width))


def _splat(lanes):
    @intrinsic
    def splat(typing_context, x):
        """The same number in every lane."""
        return lanes(types.float32), lambda context, b, sig, args: _in_all_lanes(b, lanes, args[0])

    return splat


splat4, splat8 = _splat(f32x4), _splat(f32x8)


@intrinsic
def splat_axis(typing_context, v, axis):
    """One component of a Vec3, 0 to 2, in every lane."""
    return f32x8(vec3, types.int64), lambda context, b, sig, args: _in_all_lanes(b, f32x8, b.extract_element(*args))


@intrinsic
def lanes4(typing_context, x, y, z):
    """Three numbers, and 0 in the fourth lane."""

    def lower(context, builder, sig, args):
        v = ir.Constant(f32x4.llvm, [0.0] * 4)
        for i, x in enumerate(args):
            v = builder.insert_element(v, x, ir.Constant(INT, i))
        return v

    return f32x4(types.float32, types.float32, types.float32), lower


@intrinsic
def lanes_of(typing_context, v, w):
    """The three numbers of a Vec3, and a fourth."""
    lower = lambda context, b, sig, args: b.insert_element(*args, ir.Constant(INT, 3))  # noqa: E731
    return f32x4(vec3, types.float32), lower


@intrinsic
def vector_of(typing_context, v):
    """The first three lanes as a Vec3."""
    lower = lambda context, b, sig, args: b.insert_element(*args, ir.Constant(FLOAT, 0.0), ir.Constant(INT, 3))  # noqa: E731
    return vec3(f32x4), lower


@intrinsic
def lanes_of_bytes(typing_context, word):
    """The four bytes of an unsigned integer as floats, the lowest first."""

    def lower(context, builder, sig, args):
        numbers = builder.bitcast(args[0], ir.VectorType(BYTE, 4))
        return builder.sitofp(builder.zext(numbers, ir.VectorType(INT, 4)), f32x4.llvm)

    return f32x4(types.uint32), lower


@intrinsic
def xyz(typing_context, v):
    """The first three lanes, and 0 in the fourth."""

    def lower(context, builder, sig, args):
        return builder.insert_element(args[0], ir.Constant(FLOAT, 0.0), ir.Constant(INT, 3))

    return f32x4(f32x4), lower


# ---- Memory ----------------------------------------------------------------------------------------------------------


def _address(builder, row_type, row, name, llvm_type, index=None):
    """Address of element `index` of a field of a row, the field taken as one `llvm_type` after the other."""
    at = builder.gep(builder.bitcast(row, BYTE.as_pointer()), [ir.Constant(LONG, row_type.offset(name))])
    at = builder.bitcast(at, llvm_type.as_pointer())
    return at if index is None else builder.gep(at, [index])


def _load_and_store(element, llvm_type, doc):
    """Intrinsics load(row, name, i) and store(row, name, i, x); `element` gives the numba type for a row and a name."""

    @intrinsic(prefer_literal=True)
    def load(typing_context, row, name, i):
        def lower(context, builder, sig, args):
            t = llvm_type(context, sig.return_type)
            return builder.load(_address(builder, row, args[0], name.literal_value, t, args[2]), align=4)

        return element(row, name.literal_value)(row, name, types.int64), lower

    @intrinsic(prefer_literal=True)
    def store(typing_context, row, name, i, x):
        def lower(context, builder, sig, args):
            t = llvm_type(context, sig.args[3])
            builder.store(args[3], _address(builder, row, args[0], name.literal_value, t, args[2]), align=4)
            return context.get_dummy_value()

        return types.void(row, name, types.int64, element(row, name.literal_value)), lower

    load.__doc__ = f"{doc} `name` of a row: load(row, name, i). `i` is not negative."
    store.__doc__ = f"{doc} `name` of a row is set to `x`: store(row, name, i, x). `i` is not negative."
    return load, store


load1, store1 = _load_and_store(
    lambda row, name: row.typeof(name).dtype, lambda context, t: context.get_value_type(t), "Number i of the field"
)
load4, store4 = _load_and_store(
    lambda row, name: f32x4, lambda context, t: t.llvm, "Four floats, number i, of the field"
)
load8, store8 = _load_and_store(
    lambda row, name: f32x8, lambda context, t: t.llvm, "Eight floats, number i, of the field"
)


def _prefetch(builder, row, size):
    signature_ = ir.FunctionType(ir.VoidType(), [BYTE.as_pointer(), INT, INT, INT])
    call = cgutils.get_or_insert_function(builder.module, signature_, "llvm.prefetch.p0")
    for line in range(0, size, 64):
        at = builder.gep(row, [ir.Constant(LONG, line)])
        builder.call(call, [at, ir.Constant(INT, 0), ir.Constant(INT, 3), ir.Constant(INT, 1)])


@intrinsic
def prefetch(typing_context, row):
    """Have the row brought from memory."""

    def lower(context, builder, sig, args):
        _prefetch(builder, builder.bitcast(args[0], BYTE.as_pointer()), sig.args[0].size)
        return context.get_dummy_value()

    return types.void(row), lower


@intrinsic
def prefetch_either(typing_context, condition, row, other):
    """Have a row, or if the condition is false another one, brought from memory: four cache lines, without a branch."""

    def lower(context, builder, sig, args):
        condition, *rows = args
        row, other = (builder.bitcast(pointer, BYTE.as_pointer()) for pointer in rows)
        _prefetch(builder, builder.select(condition, row, other), 256)
        return context.get_dummy_value()

    return types.void(condition, row, other), lower


# ---- Keys: an integer and a distance in one number -------------------------------------------------------------------


@intrinsic
def make_key(typing_context, number, t):
    """An int64 that sorts by `t` >= 0, a float32, and carries an int32."""

    def lower(context, builder, sig, args):
        high = builder.shl(builder.zext(builder.bitcast(args[1], INT), LONG), ir.Constant(LONG, 32))
        return builder.or_(high, builder.zext(args[0], LONG))

    return types.int64(types.int32, types.float32), lower


@intrinsic
def key_number(typing_context, key):
    """The int32 that a key carries."""
    return types.int32(types.int64), lambda context, b, sig, args: b.trunc(args[0], INT)


@intrinsic(prefer_literal=True)
def store_keys(typing_context, row, name, numbers, t):
    """Eight keys to the field `name` of a row; `numbers` are int32 in the lanes of an f32x8, as `load8` finds them."""

    def lower(context, builder, sig, args):
        order = ir.Constant(ir.VectorType(INT, 16), [i // 2 + 8 * (i % 2) for i in range(16)])
        pairs = builder.shuffle_vector(args[2], args[3], order)
        builder.store(pairs, _address(builder, row, args[0], name.literal_value, pairs.type), align=8)
        return context.get_dummy_value()

    return types.void(row, name, f32x8, f32x8), lower
