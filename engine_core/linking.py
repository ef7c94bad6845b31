# SPDX-License-Identifier: GPL-3.0-or-later
"""How kernels that call each other become machine code: once, where Python calls the first of them.

numba makes machine code of every function, with all in it that the function calls, optimises it each time, and keeps
it on disk. What `trace` calls would be optimised again as a part of `trace`, of `render_tile` and of all between: more
than half of the time that compiling took, and a cache ten times the size.

Here a kernel that is called by a kernel is an *inner* one, which gets as far as LLVM's language and no further. A
*root* is called by Python, or stands behind an address. It links all inner kernels that can be reached from it; it is
optimised, made into machine code, and kept on disk as one. So the inner functions in it are its own, and LLVM may
change how they are called, drop arguments that nobody reads, and put those with one caller into it.
"""

import functools
import platform
import sys

from llvmlite.binding import Linkage
from numba.core import compiler, config
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.registry import CPUDispatcher

IS_NEAR = sys.platform == "linux" and platform.machine() == "x86_64"  # where KernelCodegen's way is tried and tested


class KernelLibrary(JITCodeLibrary):
    """The module of a kernel; of an inner one, that function alone."""

    is_inner = is_entry = False

    def finalize(self):
        if self.is_inner:
            self._finalized = True
            return
        self._link(self._final_module)
        self._own(self._final_module)
        self._linking_libraries = []  # they are in it by now
        super().finalize()

    def _link(self, module):
        """Add to the module all that this library calls, and what is called by that.

        Callers come before what they call: LLVM leaves out what nothing in the module asks for.
        """
        callees_first = {}
        _visit(self, callees_first)
        for library in list(reversed(callees_first))[1:]:
            self._reload_init.update(library._reload_init)
            is_inner = getattr(library, "is_inner", False)
            module.link_in(library._own_module() if is_inner else library._get_module_for_linking(), preserve=True)

    def _own(self, module):
        """Tell LLVM that nobody else calls what has been linked, so that it need not keep to numba's way of calling.

        Under names of its own: the linker of a process hands what it knows by a name to all objects that ask for that.
        """
        for function in module.functions:
            if not function.is_declaration and function.linkage == Linkage.linkonce_odr:
                function.linkage = Linkage.internal
                if self.is_entry:
                    function.add_function_attribute("inlinehint")
                function.name = f"{function.name}.{self.name}"

    def _own_module(self):
        """The function alone, fit to be linked into several modules."""
        if self._shared_module is None:
            self._shared_module = super()._get_module_for_linking()
        return self._shared_module

    def _get_module_for_linking(self):
        """The function with all it calls, for numba's own libraries: those link what they call, and ask no further."""
        module = self._own_module()
        if self.is_inner:
            module = module.clone()
            self._link(module)
        return module


def _visit(library, found):
    """Add to the dictionary the libraries that can be reached from this one, and last of all itself."""
    for called in library._linking_libraries if isinstance(library, KernelLibrary) else ():
        if called not in found:
            _visit(called, found)
    found[library] = True


# ---- Machine code ----------------------------------------------------------------------------------------------------


class KernelCodegen(JITCPUCodegen):
    """Makes machine code that names its constants, and what it calls, by how far away they are: in 32 bits.

    numba's takes all 64 bits of each address, and a register to hold them, which costs 5 % where a lot is called. All
    parts of such code have to lie near each other: llvmlite takes the memory for a root in one piece, if told so.
    """

    _library_class = KernelLibrary

    def _init(self, module):
        usual = config.USE_LLVMLITE_MEMORY_MANAGER
        config.USE_LLVMLITE_MEMORY_MANAGER = 1 if IS_NEAR else usual
        try:
            super()._init(module)
        finally:
            config.USE_LLVMLITE_MEMORY_MANAGER = usual

    def _customize_tm_options(self, options):
        super()._customize_tm_options(options)
        if IS_NEAR:
            options["reloc"], options["codemodel"] = "pic", "small"


@functools.cache
def codegen():
    """That of all kernels; other users of numba in this process keep theirs."""
    return KernelCodegen("kernels")


class KernelContext:
    """Enough of numba's context of a target to load machine code from a cache, by our `codegen`."""

    codegen = staticmethod(codegen)

    def __init__(self, context):
        self.typing_context, self.get_executable = context.typing_context, context.get_executable


class KernelCacheImpl(CompileResultCacheImpl):
    """How KernelCache gets results back."""

    def rebuild(self, target_context, payload):
        return super().rebuild(KernelContext(target_context), payload)


class KernelCache(FunctionCache):
    """What has been compiled, on disk."""

    _impl_class = KernelCacheImpl


# ---- Compiling -------------------------------------------------------------------------------------------------------


class RootCompiler(compiler.Compiler):
    """numba's compiler, into a KernelLibrary."""

    is_inner = is_entry = False

    def _compile_bytecode(self):
        state = self.state
        state.library = KernelLibrary(codegen(), state.func_id.func_qualname)
        state.library.is_inner, state.library.is_entry = self.is_inner, self.is_entry
        state.library.enable_object_caching()
        state.flags.no_compile |= self.is_inner
        return super()._compile_bytecode()


class InnerCompiler(RootCompiler):
    is_inner = True


class InnerDispatcher(CPUDispatcher):
    """A kernel as other kernels call it."""

    def add_overload(self, cres):
        cres.library.finalize()
        name = object()  # callers find it by that, as they would by its address
        self.targetctx.insert_user_function(name, cres.fndesc, [cres.library])
        self.overloads[tuple(cres.signature.args)] = cres._replace(entry_point=name)


class EntryCompiler(RootCompiler):
    """For what is called so often, and is so small, that the calls within it cost more than its size."""

    is_entry = True


class EntryPoint(CFunc):
    """A root that machine code calls through its address."""

    def __init__(self, py_func, signature, options):
        super().__init__(py_func, signature, locals={}, options=options, pipeline_class=EntryCompiler)
        self._cache = KernelCache(py_func)
        self.compile()


class KernelDispatcher(CPUDispatcher):
    """A kernel as Python calls it; where kernels call it they get the inner one."""

    def __init__(self, py_func, locals=None, targetoptions=None, pipeline_class=RootCompiler):
        super().__init__(py_func, locals, targetoptions, pipeline_class)
        options = {**self.targetoptions, "no_cpython_wrapper": True}
        self.inner = InnerDispatcher(py_func, locals, options, InnerCompiler)

    def enable_caching(self):
        self._cache = KernelCache(self.py_func)

    def get_call_template(self, args, kws):
        return self.inner.get_call_template(args, kws)

    def get_overload(self, sig):
        return self.inner.get_overload(sig)

    @property
    def is_compiling(self):
        return self._compiling_counter or self.inner._compiling_counter
