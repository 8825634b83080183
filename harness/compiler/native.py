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

import hashlib
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import llvmlite
import llvmlite.binding as llvm
import numba
import numpy as np
from numba import carray, njit, types
from numba.core import config
from numba.core.compiler_lock import global_compiler_lock
from numba.core.errors import NumbaError, NumbaWarning

from harness.compiler.diagnosis import foreign_sentence, refuse_constructs, sentence
from harness.compiler.step import (
    CompileError,
    rebuilt,
    sizes,
    step_fingerprint,
    step_functions,
)
from harness.system.block import Block

_POINTER = types.CPointer(types.float64)
_SIGNATURE = types.int32(_POINTER, _POINTER, _POINTER, _POINTER)
ENTRY = "block_step"
# What the C libraries of all platforms have, of the same meaning.
LIBRARY = frozenset(
    (
        "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "ceil",
        "copysign", "cos", "cosh", "erf", "erfc", "exp", "exp2", "expm1", "fabs", "floor",
        "fma", "fmax", "fmin", "fmod", "frexp", "hypot", "ldexp", "lgamma", "log",
        "log10", "log1p", "log2", "memcpy", "memmove", "memset", "nearbyint", "pow",
        "rint", "round", "sin", "sinh", "sqrt", "tan", "tanh", "tgamma", "trunc",
    )
)  # fmt: skip
RESHAPE = "block_reshape"  # what numba_attempt_nocopy_reshape does, for rows that lie in order
KNOWN = LIBRARY | {ENTRY, RESHAPE}
_COUNTING = ("NRT_incref", "NRT_decref")
_TARGET = re.compile(r"^(target (?:triple|datalayout)|source_filename) = .*\n", re.MULTILINE)
_ATTRIBUTE = re.compile(r' "(?:target-cpu|target-features|tune-cpu)"="[^"]*"')
_DEFINITION = re.compile(r"^define [^@\n]*@([\w.$]+)\(.*?\n(.*?)^}", re.MULTILINE | re.DOTALL)
_CALL = re.compile(r"call [^@\n]*@([\w.$]+)\([^\n]*?(?:!dbg !(\d+))?$", re.MULTILINE)
_LOCATION = re.compile(r"^!(\d+) = !DILocation\(line: (\d+)", re.MULTILINE)
_NAME = re.compile(r'@"[^"]+"|@[-\w.$]+|_ZN[-\w.$]+')


def native_step(block: Block) -> str:
    """The LLVM module of `block.step` for the array lengths of `block`, as text.

    Raises `CompileError` naming the function, the line and the construct that cannot be.
    """
    step = step_functions(block.step)[0]
    refuse_constructs(step)
    step_fingerprint(step)  # which refuses what no compiled step may be
    lowered, inner = _lowered(step, block, debug=False)
    module = llvm.parse_assembly(_detached(lowered, inner))
    for value in (*module.functions, *module.global_variables):
        if not value.is_declaration and value.name != ENTRY:
            value.linkage = llvm.Linkage.internal
    _simplify(module)
    text = _ATTRIBUTE.sub("", _TARGET.sub("", str(module)))
    foreign = sorted(
        f.name
        for f in module.functions
        if f.is_declaration and not f.name.startswith("llvm.") and f.name not in KNOWN
    )
    if foreign:
        raise CompileError(foreign_sentence(step, foreign, _leading_to(step, block, foreign)))
    return _renamed(text)


def native_key(block: Block) -> str:
    """Changes with the module that `native_step` makes; raises `CompileError` as it does."""
    step = step_functions(block.step)[0]
    refuse_constructs(step)
    versions = (numba.__version__, llvmlite.__version__, _own_code())
    parts = (step_fingerprint(step), repr(sizes(block)), *versions)
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]


@cache
def _own_code() -> str:
    return hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


def _entry(p: Any, x: Any, u: Any, y: Any) -> Any:  # names below are bound by _lowered
    arrays = carray(p, (N_P,)), carray(x, (N_X,)), carray(u, (N_U,)), carray(y, (N_Y,))  # type: ignore[name-defined]  # noqa: F821
    step(*arrays)  # type: ignore[name-defined]  # noqa: F821
    return np.int32(0)


def _lowered(step: FunctionType, block: Block, *, debug: bool) -> tuple[str, str]:
    """What numba makes of the step, not optimised, and the name of its entry in there."""
    try:
        with global_compiler_lock, _no_optimisation():
            options = {"debug": debug, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
            scope = {
                **globals(),
                "step": rebuilt(step, "native", {}, debug=debug),
                **dict(zip(("N_P", "N_X", "N_U", "N_Y"), sizes(block), strict=True)),
            }
            entry = FunctionType(_entry.__code__, scope, "native_entry")
            make = njit(_SIGNATURE, error_model="numpy", **options)
            function = make(entry)
    except NumbaError as fault:
        raise CompileError(sentence(step, fault)) from fault
    (result,) = function.overloads.values()
    return result.library.get_llvm_str(), result.fndesc.llvm_func_name


def _leading_to(step: FunctionType, block: Block, foreign: list[str]) -> list[str]:
    """The lines of the step and its helpers, as "file:line", that lead to the foreign functions."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NumbaWarning)  # of lines that numba has made itself
        lowered, _ = _lowered(step, block, debug=True)
    calls = _calls(lowered)
    reaching = set(foreign)
    while more := {name for name, made in calls.items() if reaching & {c for c, _ in made}} - (
        reaching
    ):
        reaching |= more
    places = {int(number): line for number, line in _LOCATION.findall(lowered)}
    found = set()
    for function in step_functions(step):
        own = {name for name in calls if f"{function.__name__}_in_native" in name}
        for name in own:
            for callee, location in calls[name]:
                theirs = any(f"{f.__name__}_in_native" in callee for f in step_functions(step))
                if callee in reaching and not theirs and location in places:
                    found.add((function.__code__.co_filename, int(places[location])))
    return [f"{path}:{line}" for path, line in sorted(found)]


def _calls(lowered: str) -> dict[str, list[tuple[str, int]]]:
    """By function, what it calls and the number of the place from which it does."""
    return {
        name: [(callee, int(place or 0)) for callee, place in _CALL.findall(body)]
        for name, body in _DEFINITION.findall(lowered)
    }


@contextmanager
def _no_optimisation() -> Iterator[None]:
    """numba would optimise for the processor of this machine."""
    names = ("OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE")
    before = {name: getattr(config, name) for name in names}
    config.OPT, config.LOOP_VECTORIZE, config.SLP_VECTORIZE = type(config.OPT)(0), 0, 0
    try:
        yield
    finally:
        for name, value in before.items():
            setattr(config, name, value)


def _detached(lowered: str, inner: str) -> str:
    """The module with an entry of C's kind, and without the runtime's counting."""
    for name in _COUNTING:
        pattern = re.compile(rf"^define [^\n]*@{name}\(.*?^}}\n", re.MULTILINE | re.DOTALL)
        lowered = pattern.sub(f"define void @{name}(ptr %p) {{\n  ret void\n}}\n", lowered)
    lowered = lowered.replace("@numba_attempt_nocopy_reshape(", f"@{RESHAPE}(")
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
        if name.startswith("llvm.") or name in KNOWN:
            return match.group()
        known = names.setdefault(name, f"part_{len(names)}")
        return f"@{known}" if match.group().startswith("@") else known

    body = "\n".join(line for line in text.splitlines() if not line.startswith("; ModuleID"))
    return _NAME.sub(short, body).strip() + "\n"
