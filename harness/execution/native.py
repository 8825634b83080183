"""From a block's step function to an LLVM module that needs nothing but the C library.

The module defines `int32 block_step(double *p, double *x, double *u, double *y)`, the very code
that runs in the loop: the same rebuilt functions, lowered by numba, without its wrappers, without
its counting of references (a step allocates nothing, so there is nothing to count) and without the
texts of exceptions (a status says that there was one). It names no target: neither a processor nor
an operating system, and is the same text wherever it is made.

It refuses what the loop can still run and an FMU without Python cannot: `diagnosis.py` says which
line, which construct, and what to write instead.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from types import FunctionType
from typing import Any

import llvmlite.binding as llvm
from numba import njit
from numba.core import config
from numba.core.compiler_lock import global_compiler_lock
from numba.core.errors import NumbaError

from harness.execution.compile import CompileError, c_entry, SIGNATURE, plain_function, rebuilt
from harness.execution.diagnosis import refuse_constructs, sentence, foreign_sentence
from harness.system.block import Block

ENTRY = "block_step"
# What the C libraries of all platforms have, of the same meaning.
LIBRARY = frozenset(
    "acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 "
    "fabs floor fma fmax fmin fmod frexp hypot ldexp lgamma log log10 log1p log2 memcpy memmove "
    "memset nearbyint pow rint round sin sinh sqrt tan tanh tgamma trunc".split()
)
_COUNTING = ("NRT_incref", "NRT_decref")
_TARGET = re.compile(r"^(target (?:triple|datalayout)|source_filename) = .*\n", re.MULTILINE)
_ATTRIBUTE = re.compile(r' "(?:target-cpu|target-features|tune-cpu)"="[^"]*"')
_NAME = re.compile(r'@"[^"]+"|@[-\w.$]+|_ZN[-\w.$]+')


def native_step(block: Block) -> str:
    """The LLVM module of `block.step` for the array lengths of `block`, as text.

    Raises `CompileError` naming the function, the line and the construct that cannot be.
    """
    step = plain_function(block.step)
    refuse_constructs(step)
    lowered, inner = _lowered(step, block)
    module = llvm.parse_assembly(_detached(lowered, inner))
    for value in (*module.functions, *module.global_variables):
        if not value.is_declaration and value.name != ENTRY:
            value.linkage = llvm.Linkage.internal
    _simplify(module)
    text = _ATTRIBUTE.sub("", _TARGET.sub("", str(module)))
    foreign = sorted(
        f.name
        for f in module.functions
        if f.is_declaration and not f.name.startswith("llvm.") and f.name not in LIBRARY
    )
    if foreign:
        raise CompileError(foreign_sentence(step, foreign))
    return _renamed(text)


@global_compiler_lock
def _lowered(step: FunctionType, block: Block) -> tuple[str, str]:
    """What numba makes of the step, not optimised, and the name of its entry in there."""
    sizes = tuple(map(len, (block.parameters, block.state, block.inputs, block.outputs)))
    try:
        with _no_optimisation():
            entry = c_entry(rebuilt(step, "native"), sizes, "native_entry")
            options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
            function = njit(SIGNATURE, error_model="numpy", **options)(entry)
    except NumbaError as fault:
        raise CompileError(sentence(step, fault)) from fault
    (result,) = function.overloads.values()
    return result.library.get_llvm_str(), result.fndesc.llvm_func_name


@contextmanager
def _no_optimisation() -> Iterator[None]:
    """numba would optimise for the processor of this machine."""
    names = ("OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE")
    kept = {name: getattr(config, name) for name in names}
    config.OPT, config.LOOP_VECTORIZE, config.SLP_VECTORIZE = type(config.OPT)(0), 0, 0
    try:
        yield
    finally:
        for name, value in kept.items():
            setattr(config, name, value)


def _detached(lowered: str, inner: str) -> str:
    """The module with an entry of C's kind, and without the runtime's counting."""
    for name in _COUNTING:
        pattern = re.compile(rf"^define [^\n]*@{name}\(.*?^}}\n", re.MULTILINE | re.DOTALL)
        lowered = pattern.sub(f"define void @{name}(ptr %p) {{\n  ret void\n}}\n", lowered)
    arguments = "ptr %p, ptr %x, ptr %u, ptr %y"
    entry = (
        f"\ndefine hidden i32 @{ENTRY}({arguments}) {{\n"
        "  %result = alloca i32\n  %fault = alloca ptr\n"
        f"  %status = call i32 @{inner}(ptr %result, ptr %fault, {arguments})\n"
        "  ret i32 %status\n}\n"
    )
    return lowered + entry


def _simplify(module: llvm.ModuleRef) -> None:
    """Inline and clean up, without anything that depends on the machine it will run on."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple(module.triple).create_target_machine(cpu="", features="")
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = False
    options.loop_unrolling = options.loop_interleaving = False
    builder = llvm.create_pass_builder(machine, options)
    manager = builder.getModulePassManager()
    manager.add_global_dead_code_eliminate_pass()
    manager.add_strip_dead_prototype_pass()
    manager.run(module, builder)


def _renamed(text: str) -> str:
    """Names in the order in which they come: numba's hold counters and addresses."""
    names: dict[str, str] = {}

    def short(match: re.Match[str]) -> str:
        name = match.group().removeprefix("@").strip('"')
        if name == ENTRY or name.startswith("llvm.") or name in LIBRARY:
            return match.group()
        known = names.setdefault(name, f"part_{len(names)}")
        return f"@{known}" if match.group().startswith("@") else known

    body = "\n".join(line for line in text.splitlines() if not line.startswith("; ModuleID"))
    return _NAME.sub(short, body).strip() + "\n"
