"""Functions that only other compiled functions call: lowered, and left to those to optimise.

numba makes of every function a library of its own: optimises it, makes machine code of it, and
optimises it again in each function that calls it. Of a part of a step nobody needs that machine
code, and one pass over the step with all that it calls gives the same. This more than halves the
time that a step takes to compile.
"""

from __future__ import annotations

from types import FunctionType
from typing import Any

from numba import njit, types
from numba._dynfunc import make_function
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.errors import NumbaError
from numba.core.typed_passes import NativeLowering


class _PartLibrary(JITCodeLibrary):  # type: ignore[misc]
    """Code to be linked into that of callers, which lacks nothing but optimisation."""

    def _optimize_final_module(self) -> None:
        """Whoever calls it does so."""

    def _finalize_final_module(self) -> None:
        """It gets no machine code."""
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class _LowerPart(NativeLowering):  # type: ignore[misc]
    """Lowering as usual; what becomes of the function in Python is a handle for its callers."""

    _name = "lower_part"

    def run_pass(self, state: Any) -> bool:
        context, flags = state.targetctx, state.flags
        state.library = _PartLibrary(context.codegen(), state.func_id.func_qualname)
        flags.no_compile = True
        super().run_pass(state)
        made = state["cr"]
        name = made.fndesc.qualname.rpartition(".")[2]
        handle = make_function(made.fndesc.lookup_module(), name, "", 0, made.env, (state.library,))
        context.insert_user_function(handle, made.fndesc, [state.library])
        state["cr"] = made._replace(cfunc=handle)
        return True


class _PartCompiler(CompilerBase):  # type: ignore[misc]
    """numba's usual passes with that lowering."""

    def define_pipelines(self) -> list[Any]:
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(_LowerPart, NativeLowering)
        passes.passes = [one for one in passes.passes if one[0] is not NativeLowering]
        passes.finalize()
        return [passes]


def part(function: FunctionType, **options: bool) -> Any:
    """`function` as a part of steps; `options` of numba's."""
    made = njit(
        function, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True,
        pipeline_class=_PartCompiler, **options,
    )  # fmt: skip
    resolve = made.get_call_template

    def resolve_without_literals(args: Any, kws: Any) -> Any:
        """One code for all constants that are handed over, unless their values decide types."""
        try:
            return resolve(
                tuple(map(types.unliteral, args)), {k: types.unliteral(t) for k, t in kws.items()}
            )
        except NumbaError:
            return resolve(args, kws)

    made.get_call_template = resolve_without_literals
    return made
