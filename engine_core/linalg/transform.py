# SPDX-License-Identifier: GPL-3.0-or-later
"""Affine transforms that stand in rows of tables, as fields ("f4", (3, 4)): three rows of a 4 x 4 matrix.

    p_world = transform_point(instance, "to_world", p)
    d_object = transform_vector(instance, "to_object", d)
    n_world = transform_normal(instance, "to_object", n)     # note: the inverse of the transform that moves the points

None of them normalises.
"""

import numpy as np
from llvmlite import ir
from numba import config
from numba.extending import intrinsic

from .vec3 import LLVM_FLOAT, LLVM_INT, LLVM_VEC3, Vec3, vec3


def _vector(builder, matrix, first, stride):
    """Three elements of a matrix, `stride` apart, as a Vec3."""
    v = ir.Constant(LLVM_VEC3, [0.0] * 4)
    for i in range(3):
        at = builder.gep(matrix, [ir.Constant(LLVM_INT, first + i * stride)])
        v = builder.insert_element(v, builder.load(at, align=4), ir.Constant(LLVM_INT, i))
    return v


def _product(columns, with_translation):
    """An intrinsic of (row, field name, Vec3): the sum of three vectors of the matrix, weighted by x, y and z."""
    first, stride = (1, 4) if columns else (4, 1)

    @intrinsic(prefer_literal=True)
    def product(typing_context, row, name, v):
        field = name.literal_value

        def lower(context, builder, sig, args):
            offset = ir.Constant(ir.IntType(64), sig.args[0].offset(field))
            matrix = builder.gep(builder.bitcast(args[0], ir.IntType(8).as_pointer()), [offset])
            matrix = builder.bitcast(matrix, LLVM_FLOAT.as_pointer())
            result = _vector(builder, matrix, 3, 4) if with_translation else None
            for i in (2, 1, 0):
                lane = ir.Constant(ir.VectorType(LLVM_INT, 4), [i] * 4)
                weight = builder.shuffle_vector(args[2], args[2], lane)
                term = builder.fmul(_vector(builder, matrix, i * first, stride), weight)
                result = term if result is None else builder.fadd(term, result)
            return result

        return vec3(row, name, vec3), lower

    return product


if config.DISABLE_JIT:  # kernels as plain Python, for a debugger

    def transform_point(row, name, p):
        return Vec3(*(row[name] @ np.array([*p, 1.0], np.float32)))

    def transform_vector(row, name, w):
        return Vec3(*(row[name][:, :3] @ np.array([*w], np.float32)))

    def transform_normal(row, name, n):
        return Vec3(*(row[name][:, :3].T @ np.array([*n], np.float32)))
else:
    transform_point = _product(columns=True, with_translation=True)
    transform_vector = _product(columns=True, with_translation=False)
    transform_normal = _product(columns=False, with_translation=False)  # times the transpose
