# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables: numpy record arrays that a kernel is handed as one pointer.

A kernel that takes `scene` reads `scene.lights[i].kind`. In Python `scene` is an object with a recarray for each table;
in a kernel it is one pointer to a list of pointers. Passing it on costs a register, and no array is ever counted.

The reason: a NamedTuple of recarrays spreads into seven values for each table at the border of each kernel, which the
compiler has to carry about; one pointer does not.

    class Scene(Tables):
        lights = LIGHT            # a numpy dtype
        triangles = TRIANGLE

    scene = Scene(lights=..., triangles=...)

`scratch_record(dtype)` makes a row on the stack of the kernel that calls it.
"""

import hashlib
import operator

import numpy as np
from llvmlite import ir
from numba import config, from_dtype, types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_getattr, infer_global, signature
from numba.extending import (
    NativeValue,
    intrinsic,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)

POINTER = ir.IntType(8).as_pointer()


class Tables:
    """A fixed set of record arrays, declared by a subclass: attribute name = numpy dtype.

    Raises TypeError for a table that is missing, unknown, of another dtype or not contiguous.
    """

    def __init__(self, **tables):
        dtypes = self.dtypes()
        if set(tables) != set(dtypes):
            raise TypeError(f"{type(self).__name__} needs the tables {sorted(dtypes)}, not {sorted(tables)}")
        addresses = []
        for name, dtype in dtypes.items():
            array = tables[name]
            if array.dtype != dtype or array.ndim != 1 or not array.flags.c_contiguous:
                raise TypeError(f"table {name} of {type(self).__name__} has to be one row of {dtype} after the other")
            setattr(self, name, array.view(np.recarray))
            addresses.append(array.ctypes.data)
        self._addresses = np.array(addresses, np.uint64)
        self._pointer = self._addresses.ctypes.data

    @classmethod
    def dtypes(cls):
        """{table name: dtype}, in the order of declaration."""
        return {name: value for name, value in vars(cls).items() if isinstance(value, np.dtype)}

    def tables(self):
        """{table name: recarray}"""
        return {name: getattr(self, name) for name in self.dtypes()}


class TablesType(types.Type):
    """numba's type of a subclass of Tables; named by its layout, which is what the machine code depends on."""

    def __init__(self, name, fields):
        self.fields = fields  # ((name, numba Record), ...)
        # by a digest: the name is part of the name of every kernel that takes the tables
        layout = ", ".join(f"{n}: {r.name}" for n, r in fields)
        super().__init__(name=f"{name}({hashlib.sha256(layout.encode()).hexdigest()[:16]})")


class TableType(types.Type):
    def __init__(self, record):
        self.record = record
        super().__init__(name=f"Table({record.name})")


@register_model(TablesType)
@register_model(TableType)
class PointerModel(models.PrimitiveModel):
    def __init__(self, manager, fe_type):
        super().__init__(manager, fe_type, POINTER)


_types = {}


@typeof_impl.register(Tables)
def _typeof_tables(value, context):
    return _typeof_tables_class(type(value))


def _typeof_tables_class(cls):
    if cls not in _types:
        _types[cls] = TablesType(cls.__name__, tuple((n, from_dtype(d)) for n, d in cls.dtypes().items()))
    return _types[cls]


@unbox(TablesType)
def _unbox_tables(fe_type, obj, c):
    address = c.pyapi.object_getattr_string(obj, "_pointer")
    value = c.builder.inttoptr(c.pyapi.long_as_ulonglong(address), POINTER)
    c.pyapi.decref(address)
    return NativeValue(value, is_error=cgutils.is_not_null(c.builder, c.pyapi.err_occurred()))


@infer_getattr
class TablesAttributes(AttributeTemplate):
    key = TablesType

    def generic_resolve(self, tables, name):
        for field, record in tables.fields:
            if field == name:
                return TableType(record)


@lower_getattr_generic(TablesType)
def _get_table(context, builder, fe_type, value, name):
    index = [field for field, _ in fe_type.fields].index(name)
    pointers = builder.bitcast(value, POINTER.as_pointer())
    load = builder.load(builder.gep(pointers, [ir.Constant(ir.IntType(64), index)]))
    # the list of pointers does not change while a kernel runs, so a loop need not read it again
    load.set_metadata("invariant.load", builder.module.add_metadata([]))
    return load


@infer_global(operator.getitem)
class TableRow(AbstractTemplate):
    def generic(self, args, kws):
        if isinstance(args[0], TableType) and isinstance(args[1], types.Integer):
            return signature(args[0].record, *args)


@lower_builtin(operator.getitem, TableType, types.Integer)
def _get_row(context, builder, sig, args):
    table_type, index_type = sig.args
    index = context.cast(builder, args[1], index_type, types.int64)
    offset = builder.mul(index, ir.Constant(ir.IntType(64), table_type.record.size))
    return builder.bitcast(builder.gep(args[0], [offset]), context.get_value_type(table_type.record))


def numba_type(dtype_or_tables):
    """numba's type of a row of a dtype, or of a subclass of Tables: for the signature of an entry point."""
    if isinstance(dtype_or_tables, np.dtype):
        return from_dtype(dtype_or_tables)
    return _typeof_tables_class(dtype_or_tables)


def scratch_record(dtype):
    """A function that gives one row of `dtype` on the stack of the kernel that calls it; its content is undefined."""
    if config.DISABLE_JIT:
        return lambda: np.recarray(1, dtype)[0]
    record = from_dtype(dtype)

    @intrinsic
    def scratch(typing_context):
        def lower(context, builder, sig, args):
            # not cgutils.alloca_once, which would fill the row with zeros on each call
            with builder.goto_entry_block():
                row = builder.alloca(ir.ArrayType(ir.IntType(8), record.size))
            row.align = 64
            return builder.bitcast(row, context.get_value_type(record))

        return record(), lower

    return scratch


@intrinsic
def copy_record(typing_context, target, source):
    """Copy all fields of the row `source` to the row `target`, of the same dtype."""
    if target != source:
        return None

    def lower(context, builder, sig, args):
        cgutils.raw_memcpy(builder, args[0], args[1], ir.Constant(ir.IntType(64), sig.args[0].size), 1)
        return context.get_dummy_value()

    return types.void(target, source), lower
