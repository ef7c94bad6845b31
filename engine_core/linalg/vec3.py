# SPDX-License-Identifier: GPL-3.0-or-later
"""Vec3: three float32 with real operators. Points, directions, normals and colours.

In a kernel it is one LLVM vector of four floats, so that `o + d * t` is two instructions and reads as the formula;
in plain Python it is a small class with the same operators. The product of two Vec3 is taken by component,
as colours need.

The rows of the scene's tables hold vectors as ("f4", (3,)); `load3` and `store3` move them in and out.
"""

import math
import operator

import numpy as np
from llvmlite import ir
from numba import config, float32, types
from numba.core import cgutils
from numba.core.imputils import lower_constant
from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_getattr, infer_global, signature
from numba.extending import (
    NativeValue,
    as_numba_type,
    box,
    intrinsic,
    lower_builtin,
    lower_getattr,
    models,
    register_model,
    type_callable,
    typeof_impl,
    unbox,
)

from ..jit import kernel


class Vec3:
    """Three float32 numbers x, y, z."""

    __slots__ = ("x", "y", "z")

    def __init__(self, x, y, z):
        self.x, self.y, self.z = np.float32(x), np.float32(y), np.float32(z)

    def __iter__(self):
        return iter((self.x, self.y, self.z))

    def __repr__(self):
        return f"Vec3({self.x}, {self.y}, {self.z})"

    def __add__(self, other):
        return Vec3(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other):
        return Vec3(self.x - other.x, self.y - other.y, self.z - other.z)

    def __mul__(self, other):
        if isinstance(other, Vec3):
            return Vec3(self.x * other.x, self.y * other.y, self.z * other.z)
        return Vec3(self.x * other, self.y * other, self.z * other)

    __rmul__ = __mul__

    def __truediv__(self, other):
        if isinstance(other, Vec3):
            return Vec3(self.x / other.x, self.y / other.y, self.z / other.z)
        return Vec3(self.x / other, self.y / other, self.z / other)

    def __neg__(self):
        return Vec3(-self.x, -self.y, -self.z)


# ---- The type as numba sees it ---------------------------------------------------------------------------------------


class Vec3Type(types.Type):
    def __init__(self):
        super().__init__(name="Vec3")


vec3 = Vec3Type()
as_numba_type.register(Vec3, vec3)
LLVM_FLOAT, LLVM_INT = ir.FloatType(), ir.IntType(32)
LLVM_VEC3 = ir.VectorType(LLVM_FLOAT, 4)  # the fourth lane is there for the machine, and 0


@register_model(Vec3Type)
class Vec3Model(models.PrimitiveModel):
    def __init__(self, manager, fe_type):
        super().__init__(manager, fe_type, LLVM_VEC3)


@typeof_impl.register(Vec3)
def _typeof_vec3(value, context):
    return vec3


@type_callable(Vec3)
def _type_constructor(context):
    def typer(x, y, z):
        if all(isinstance(t, types.Number) for t in (x, y, z)):
            return vec3

    return typer


@lower_builtin(Vec3, types.Any, types.Any, types.Any)
def _construct(context, builder, sig, args):
    v = ir.Constant(LLVM_VEC3, [0.0] * 4)
    for i, (arg, arg_type) in enumerate(zip(args, sig.args, strict=True)):
        x = context.cast(builder, arg, arg_type, float32)
        v = builder.insert_element(v, x, ir.Constant(LLVM_INT, i))
    return v


@lower_constant(Vec3Type)
def _constant(context, builder, fe_type, value):
    return ir.Constant(LLVM_VEC3, [float(value.x), float(value.y), float(value.z), 0.0])


@infer_getattr
class Vec3Attributes(AttributeTemplate):
    key = Vec3Type

    def resolve_x(self, v):
        return float32

    resolve_y = resolve_z = resolve_x


def _lower_lane(name, index):
    @lower_getattr(Vec3Type, name)
    def lower(context, builder, fe_type, value):
        return builder.extract_element(value, ir.Constant(LLVM_INT, index))


for _i, _name in enumerate("xyz"):
    _lower_lane(_name, _i)


def _splat(context, builder, value, value_type):
    x = context.cast(builder, value, value_type, float32)
    undefined = ir.Constant(LLVM_VEC3, ir.Undefined)
    one = builder.insert_element(undefined, x, ir.Constant(LLVM_INT, 0))
    return builder.shuffle_vector(one, undefined, ir.Constant(ir.VectorType(LLVM_INT, 4), [0] * 4))


def _binary_operator(op, instruction, with_numbers):
    """`op` of two Vec3, lane by lane, and of a Vec3 and a number where `with_numbers` allows it."""

    @infer_global(op)
    class Template(AbstractTemplate):
        def generic(self, args, kws):
            a, b = args
            if a == vec3 and (b == vec3 or (with_numbers and isinstance(b, types.Number))):
                return signature(vec3, a, b)
            if b == vec3 and op is operator.mul and isinstance(a, types.Number):
                return signature(vec3, a, b)

    def lower(context, builder, sig, args):
        a, b = (
            arg if arg_type == vec3 else _splat(context, builder, arg, arg_type)
            for arg, arg_type in zip(args, sig.args, strict=True)
        )
        return getattr(builder, instruction)(a, b)

    lower_builtin(op, vec3, vec3)(lower)
    lower_builtin(op, vec3, types.Number)(lower)
    lower_builtin(op, types.Number, vec3)(lower)


_binary_operator(operator.add, "fadd", with_numbers=False)
_binary_operator(operator.sub, "fsub", with_numbers=False)
_binary_operator(operator.mul, "fmul", with_numbers=True)
_binary_operator(operator.truediv, "fdiv", with_numbers=True)


@infer_global(operator.neg)
class NegateTemplate(AbstractTemplate):
    def generic(self, args, kws):
        if args == (vec3,):
            return signature(vec3, vec3)


@lower_builtin(operator.neg, vec3)
def _negate(context, builder, sig, args):
    return builder.fneg(args[0])


# ---- To and from Python ----------------------------------------------------------------------------------------------


@box(Vec3Type)
def _box(fe_type, value, c):
    cls = c.pyapi.unserialize(c.pyapi.serialize_object(Vec3))
    parts = [
        c.pyapi.float_from_double(
            c.builder.fpext(c.builder.extract_element(value, ir.Constant(LLVM_INT, i)), ir.DoubleType())
        )
        for i in range(3)
    ]
    result = c.pyapi.call_function_objargs(cls, parts)
    for part in (*parts, cls):
        c.pyapi.decref(part)
    return result


@unbox(Vec3Type)
def _unbox(fe_type, obj, c):
    v = ir.Constant(LLVM_VEC3, [0.0] * 4)
    for i, name in enumerate("xyz"):
        part = c.pyapi.object_getattr_string(obj, name)
        number = c.pyapi.number_float(part)
        x = c.builder.fptrunc(c.pyapi.float_as_double(number), LLVM_FLOAT)
        v = c.builder.insert_element(v, x, ir.Constant(LLVM_INT, i))
        c.pyapi.decref(number)
        c.pyapi.decref(part)
    return NativeValue(v, is_error=cgutils.is_not_null(c.builder, c.pyapi.err_occurred()))


# ---- To and from rows of tables --------------------------------------------------------------------------------------


def _field_pointer(context, builder, row_type, row, name, index=None):
    """Pointer to the first float of field `name` (of its sub-row `index`) of a record."""
    byte = ir.IntType(8)
    at = builder.gep(builder.bitcast(row, byte.as_pointer()), [ir.Constant(ir.IntType(64), row_type.offset(name))])
    at = builder.bitcast(at, LLVM_FLOAT.as_pointer())
    if index is not None:
        at = builder.gep(at, [builder.mul(index, ir.Constant(index.type, 3))])
    return at


def load_floats(builder, pointer):
    """A Vec3 from three floats; LLVM reads two of them at once."""
    v = ir.Constant(LLVM_VEC3, [0.0] * 4)
    for i in range(3):
        x = builder.load(builder.gep(pointer, [ir.Constant(LLVM_INT, i)]), align=4)
        v = builder.insert_element(v, x, ir.Constant(LLVM_INT, i))
    return v


def store_floats(builder, pointer, v):
    """Two floats and one, as they are read: who reads two at once waits until two stores have reached the cache."""
    two = builder.shuffle_vector(v, v, ir.Constant(ir.VectorType(LLVM_INT, 2), [0, 1]))
    builder.store(two, builder.bitcast(pointer, two.type.as_pointer()), align=4)
    builder.store(
        builder.extract_element(v, ir.Constant(LLVM_INT, 2)),
        builder.gep(pointer, [ir.Constant(LLVM_INT, 2)]),
        align=4,
    )


@intrinsic(prefer_literal=True)
def _load3(typing_context, row, name):
    """Field `name` of a row, ("f4", (3,)), as a Vec3."""
    field = name.literal_value

    def lower(context, builder, sig, args):
        return load_floats(builder, _field_pointer(context, builder, sig.args[0], args[0], field))

    return vec3(row, name), lower


@intrinsic(prefer_literal=True)
def _load3_at(typing_context, row, name, index):
    """Row `index` of field `name`, ("f4", (n, 3)), as a Vec3."""
    field = name.literal_value

    def lower(context, builder, sig, args):
        return load_floats(builder, _field_pointer(context, builder, sig.args[0], args[0], field, args[2]))

    return vec3(row, name, types.int64), lower


@intrinsic(prefer_literal=True)
def _store3(typing_context, row, name, v):
    """Write a Vec3 to field `name` of a row, ("f4", (3,))."""
    field = name.literal_value

    def lower(context, builder, sig, args):
        pointer = _field_pointer(context, builder, sig.args[0], args[0], field)
        store_floats(builder, pointer, args[2])
        return context.get_dummy_value()

    return types.void(row, name, vec3), lower


if config.DISABLE_JIT:  # kernels as plain Python, for a debugger

    def load3(row, name):
        return Vec3(*row[name])

    def load3_at(row, name, index):
        return Vec3(*row[name][index])

    def store3(row, name, v):
        row[name] = tuple(v)
else:
    load3, load3_at, store3 = _load3, _load3_at, _store3


# ---- Vector algebra --------------------------------------------------------------------------------------------------

BLACK = Vec3(0.0, 0.0, 0.0)
WHITE = Vec3(1.0, 1.0, 1.0)


@kernel
def dot(a, b):
    p = a * b
    return p.x + p.y + p.z


@kernel
def cross(a, b):
    return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@kernel
def length(a):
    return math.sqrt(dot(a, a))


@kernel
def normalize(a):
    """Unit vector along `a`; not a number for the zero vector."""
    return a * (1.0 / math.sqrt(dot(a, a)))


@kernel
def reflect(w, n):
    """Mirror image of `w` about `n`; both leave the surface."""
    return n * (2.0 * dot(w, n)) - w


@kernel
def lerp(a, b, t):
    """a at t = 0, b at t = 1; for vectors or numbers."""
    return a * (1.0 - t) + b * t


@kernel
def max_component(a):
    return max(a.x, max(a.y, a.z))


@kernel
def average(a):
    return (a.x + a.y + a.z) * np.float32(1.0 / 3.0)


@kernel
def luminance(a):
    """Relative luminance of a linear Rec.709 colour (ITU-R BT.709)."""
    return 0.2126 * a.x + 0.7152 * a.y + 0.0722 * a.z


@kernel
def is_black(a):
    return a.x == 0.0 and a.y == 0.0 and a.z == 0.0
