# SPDX-License-Identifier: GPL-3.0-or-later
"""Kernels that kernels call become machine code as a part of what Python calls, and not on their own."""

import numba
import numpy as np
import pytest

from engine_core.jit import OPTIONS, entry_point, inlined_kernel, kernel
from engine_core.linalg.records import numba_type
from engine_core.linalg.registers import call
from engine_core.linking import IS_NEAR, KernelDispatcher, codegen

ROW = np.dtype([("x", "f4")])


@kernel
def half(x):
    return 0.5 * x


@inlined_kernel
def one_more(x):
    return half(x) + 1.0


@kernel
def both(x):
    return one_more(x) * 10.0 + half(x)


@kernel
def many(x, count):
    for _ in range(count):
        x = both(x)
    return x


@kernel
def never_asked(x, count):
    return half(x) if count > count else x


@kernel
def asks_in_vain(x, count):
    """LLVM drops the first call before it links anything, and must not have left out what the second one needs."""
    return never_asked(both(x), count) + half(x)


def set_many(scene, row, unused, other):
    row.x = many(row.x, 1)


@kernel
def call_at(address, row):
    call(address, row, row, row, row)


def expected(x):
    return (0.5 * x + 1.0) * 10.0 + 0.5 * x


def test_only_what_python_calls_becomes_machine_code():
    root = KernelDispatcher(many.py_func, targetoptions=OPTIONS)  # without a cache, from which callees do not come
    assert root(np.float32(4.0), 1) == expected(4.0)
    for function in (half, one_more, both):
        libraries = [compiled.library for compiled in function.inner.overloads.values()]
        assert libraries
        for library in libraries:
            assert library._compiled_object is None
            assert len(list(library.get_defined_functions())) == 1, "what it calls would be optimised more than once"


def test_python_and_kernels_may_call_the_same():
    assert half(np.float32(3.0)) == 1.5
    assert both(np.float32(4.0)) == expected(4.0)
    assert many(np.float32(4.0), 2) == pytest.approx(expected(expected(4.0)))


def test_calls_that_are_never_made():
    assert asks_in_vain(np.float32(4.0), 2) == expected(4.0) + 2.0


def test_functions_of_plain_numba_call_kernels():
    @numba.njit
    def plain(x):
        return both(x) + half(x)

    assert plain(np.float32(4.0)) == expected(4.0) + 2.0


def test_entry_points_have_all_inside_of_them():
    rows = np.ones(1, ROW).view(np.recarray)
    entry = entry_point(set_many, *[numba_type(ROW)] * 4)
    call_at(np.uint64(entry.address), rows[0])
    assert rows.x[0] == expected(1.0)


@pytest.mark.skipif(not IS_NEAR, reason="on Linux with x86-64 alone")
def test_machine_code_names_its_constants_by_how_far_away_they_are():
    root = KernelDispatcher(many.py_func, targetoptions=OPTIONS)
    root(np.float32(4.0), 1)
    (text,) = root.inspect_asm().values()
    named = [line for line in text.splitlines() if ".LCPI" in line and not line.startswith(".LCPI")]
    assert named
    assert all("(%rip)" in line for line in named)


def test_other_users_of_numba_keep_their_way_of_compiling():
    @numba.njit
    def plain(x):
        return x + 1.0

    plain(1.0)
    (library,) = (compiled.library for compiled in plain.overloads.values())
    assert library.codegen is not codegen()
