"""Functions that are only ever inlined: compiled to LLVM's code, not to machine code.

Numba treats each function as one that may be called: with all that it calls it is optimised and
translated to machine code before it becomes part of a kernel, where the same is done again. With
functions in functions ten deep, the innermost would be compiled ten times. Here a function's code
is handed on as it is, and the kernel that it ends up in is optimised once. All kernels of the ready
models then take 59 s of CPU time to compile, and 82 s without (Numba 0.68, two busy cores): a first
run without this file would wait a third longer.

Two parts of Numba that are not public are used: the library that holds the code of a function
(``JITCodeLibrary``, whose optimisation and machine code are left out) and the list of passes of its
compiler (of which some are left out, and one counts no references). If a later Numba changes these,
importing this module or the first kernel fails; ``.ci/versions`` runs the tests with the newest
version. Without :class:`InlinedCompiler` kernels compute the same.
"""

# Numba's classes for compilation have no types.
# mypy: disable-error-code="misc, no-untyped-call, no-untyped-def"

from __future__ import annotations

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.targetconfig import ConfigStack
from numba.core.typed_passes import NativeLowering


class _NoEnvironment:
    """Numba's code generator, without the tables for calls from Python."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def set_env(self, name: str, environment: Any) -> None:
        """Leave the environment out: it serves calls from Python."""

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)


class _InlinedLibrary(JITCodeLibrary):
    """The code of a function that is linked into those of its callers, and never run by itself."""

    @property
    def codegen(self) -> Any:
        return _NoEnvironment(self._codegen)

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: there is no machine code."""
        self._ensure_finalized()
        return 0

    def _optimize_final_module(self) -> None:
        """Leave it to the kernel."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


# Passes for what no function in the loops of kernels has. Each takes its time, as Numba analyses a
# function anew after every pass that may change it.
_NOT_ASKED_FOR = {
    "WithLifting",  # with blocks
    "InlineClosureLikes",  # functions and comprehensions within it
    "MakeFunctionToJitFunction",
    "RewriteDynamicRaises",  # exceptions
    "InlineInlinables",  # inline="always"
    "InlineOverloads",
    "FindLiterallyCalls",  # literally(), literal_unroll()
    "LiteralUnroll",
    "LiteralPropagationSubPipelinePass",
    "NopythonRewrites",  # expressions of whole arrays
    "DumpParforDiagnostics",
}


# Operations on what is there: their result is held by whoever holds the operand.
_TAKES_APART = {"getitem", "static_getitem", "getiter", "iternext", "pair_first", "pair_second"}


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(NativeLowering):
    """Counts no references in a function that only uses arrays: its caller holds them.

    One that makes an array, or returns anything that may hold one, counts as any.
    """

    _name = "lowering_without_counts"

    def run_pass(self, state: Any) -> bool:
        made = (
            signature.return_type
            for expression, signature in state.calltypes.items()
            if signature is not None and _may_make(expression, state.typemap)
        )
        models = state.targetctx.data_model_manager
        kinds = (state.return_type, *made)
        if not any(models[kind].contains_nrt_meminfo() for kind in kinds):
            state.targetctx = state.targetctx.subtarget(enable_nrt=False)
        return bool(super().run_pass(state))


def _may_make(expression: Any, typemap: Any) -> bool:
    """Return whether an expression may have a result that nobody holds yet."""
    operation = getattr(expression, "op", "")
    if operation != "call":
        return operation not in _TAKES_APART
    called = getattr(typemap[expression.func.name], "typing_key", None)
    return not getattr(called, "owns_nothing", False)


class KernelCompiler(Compiler):
    """Numba's compiler for kernels, an option ``pipeline_class`` of them."""

    def define_pipelines(self) -> Any:
        """Choose how references are counted."""
        (before,) = super().define_pipelines()
        pipeline = PassManager("kernel")
        for one, words in before.passes:
            pipeline.add_pass(_Lowering if one is NativeLowering else one, words)
        pipeline.finalize()
        return [pipeline]


class InlinedCompiler(Compiler):
    """Numba's compiler for such functions, an option ``pipeline_class`` of them."""

    def define_pipelines(self) -> Any:
        """Choose the library that gets the code."""
        # What is compiled with it takes no option of this function that it does not say itself.
        ConfigStack().top().forceinline = False
        name = self.state.func_id.func_qualname
        self.state.library = _InlinedLibrary(self.state.targetctx.codegen(), name)
        (before,) = super().define_pipelines()
        pipeline = PassManager("inlined")
        for one, words in before.passes:
            if one.__name__ not in _NOT_ASKED_FOR:
                pipeline.add_pass(_Lowering if one is NativeLowering else one, words)
        pipeline.finalize()
        return [pipeline]
