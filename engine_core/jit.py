# SPDX-License-Identifier: GPL-3.0-or-later
"""The one place that names numba options: how a kernel is compiled, and where the machine code is kept.

A kernel is a Python function that numba compiles to machine code on first use:

    @kernel
    def square_to_disk(u0, u1): ...

Three rules hold for all kernels, so that none has to repeat them:

* Float literals are float32. Python has only float64, and one `0.5` would turn a whole line of float32 arithmetic into
  float64; so the decorator replaces the constants of the function. Constants of a module have to be `np.float32`.
* They run without the GIL, so Python threads render tiles side by side.
* Division by zero gives infinity as in C and numpy, it does not raise.
"""

import hashlib
import os
import types
from pathlib import Path

import numba
import numpy as np

from .linking import EntryPoint, KernelDispatcher

# Contraction into fused multiply-adds, reciprocals for repeated divisions, and no care for the sign of zero.
# Not "nnan" or "ninf": slabs of flat boxes and missing children count on infinities.
FASTMATH = {"contract", "arcp", "nsz"}
# No wrapper for calls from C, which nobody makes.
OPTIONS = {"nopython": True, "nogil": True, "error_model": "numpy", "fastmath": FASTMATH, "no_cfunc_wrapper": True}


def kernel(function):
    """Compile for the hot path: cached on disk, no GIL, float32 literals, C's rules of division."""
    return compiled(float32_literals(function))


def inlined_kernel(function):
    """As `kernel`, and always compiled into its callers: for what hands many SIMD registers in and out."""
    return compiled(float32_literals(function), forceinline=True)


def builder_kernel(function):
    """Compile for preparing a scene: as `kernel`, but literals keep Python's float64."""
    return compiled(function)


def compiled(function, **options):
    """A KernelDispatcher; the function itself where NUMBA_DISABLE_JIT asks for plain Python, for a debugger."""
    if numba.config.DISABLE_JIT:
        return function
    dispatcher = KernelDispatcher(function, targetoptions={**OPTIONS, **options})
    dispatcher.enable_caching()
    return dispatcher


def variant(function, name, **meanings):
    """The same function with other meanings for some of its global names, to be compiled and cached apart from it.

    For a kernel that differs in one kernel that it calls: numba cannot cache kernels that are made inside a function.
    """
    names = {**function.__globals__, **meanings}
    other = types.FunctionType(function.__code__, names, function.__name__, function.__defaults__)
    other.__doc__, other.__module__ = function.__doc__, function.__module__
    other.__qualname__ = f"{function.__qualname__}_{name}"
    return other


def entry_point(function, *argument_types):
    """Compile a kernel that others call through its address: `.address`, for `linalg.registers.call`.

    Such a call is a border for the compiler, too. What lies behind it is compiled once, and only in a process that asks
    for the address; callers need not be compiled anew with it inside of them, as with an ordinary kernel.
    Keep the returned object for as long as anybody may call.
    """
    options = {"nopython": True, "error_model": "numpy", "fastmath": FASTMATH}
    return EntryPoint(float32_literals(function), (argument_types, numba.void), options)


def float32_literals(function):
    """The same function with every float constant narrowed to float32."""
    code = function.__code__
    constants = tuple(np.float32(c) if type(c) is float else c for c in code.co_consts)
    narrowed = types.FunctionType(
        code.replace(co_consts=constants),
        function.__globals__,
        function.__name__,
        function.__defaults__,
        function.__closure__,
    )
    narrowed.__doc__, narrowed.__module__ = function.__doc__, function.__module__
    narrowed.__qualname__ = function.__qualname__
    return narrowed


def source_digest():
    """A digest of all sources of the engine: 16 hexadecimal digits.

    numba notices an edit in the file of a kernel, but not in the files of the kernels that it calls, and would go on
    running the old code. A folder for each state of the sources makes that impossible.
    """
    digest = hashlib.sha256(f"{numba.__version__} {np.__version__}".encode())
    folder = Path(__file__).parent
    for path in sorted((*folder.rglob("*.py"), *folder.rglob("*.npz"))):  # tables are frozen into kernels
        digest.update(str(path.relative_to(folder)).encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def use_cache(folder=None):
    """Keep machine code below `folder`, in a sub-folder for this state of the sources. Returns that sub-folder.

    Without an argument: the folder named by LAMBENT_CACHE, else `lambent` in the user's cache folder.
    Called when `engine_core` is imported, and again by the add-on with Blender's folder for extensions.
    """
    if folder is None:
        folder = os.environ.get("LAMBENT_CACHE") or Path(
            os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "lambent"
        )
    path = Path(folder) / source_digest()
    numba.config.CACHE_DIR = str(path)
    return path
