"""From a block's step function to the address of a C function.

A step function is plain Python. Here it and every plain Python function that it names are rebuilt
as numba functions and wrapped as `int32 entry(double *p, double *x, double *u, double *y)`, with
the array lengths fixed. The machine code is cached on disk under a fingerprint of all that code,
so a change in a helper of another module is noticed, which numba's own cache does not.

Every rebuilt function bears its fingerprint in its name, and the fingerprint covers the functions
that it names. Symbols of code from the cache share one space with all other code of the process,
and of two equal ones the first wins: functions of one name and different content (one template
bound to two models) must not have the same symbol.

It refuses step functions that raise: a block reports that it cannot go on by writing NaN.
"""

from __future__ import annotations

import dis
import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import carray, cfunc, njit, types
from numba.core.errors import NumbaError

from harness.errors import HarnessError
from harness.system.block import Block, StepFunction

_POINTER = types.CPointer(types.float64)
_SIGNATURE = types.int32(_POINTER, _POINTER, _POINTER, _POINTER)
_SCALARS = (bool, int, float, np.integer, np.floating)


class CompileError(HarnessError):
    """A step function that cannot be compiled."""


@dataclass(frozen=True)
class CompiledStep:
    """A compiled step function: its C address, and the object that keeps the code alive."""

    address: int
    keep: Any


def _entry(p: Any, x: Any, u: Any, y: Any) -> Any:  # names below are bound by compile_step
    arrays = carray(p, (N_P,)), carray(x, (N_X,)), carray(u, (N_U,)), carray(y, (N_Y,))  # type: ignore[name-defined]  # noqa: F821
    step(*arrays)  # type: ignore[name-defined]  # noqa: F821
    return np.int32(0)


def compile_step(block: Block) -> CompiledStep:
    """Compile `block.step` for the array lengths of `block`, or fetch it from the cache.

    Raises `CompileError` naming the function and the reason.
    """
    sizes = tuple(map(len, (block.parameters, block.state, block.inputs, block.outputs)))
    return _compile(block.step, sizes)


@lru_cache(maxsize=256)
def _compile(function: StepFunction, sizes: tuple[int, ...]) -> CompiledStep:
    step, fingerprint = _rebuild(function, {})
    scope = {
        **globals(),
        "step": step,
        **dict(zip(("N_P", "N_X", "N_U", "N_Y"), sizes, strict=True)),
    }
    name = f"step_{hashlib.sha256(f'{fingerprint}{sizes}'.encode()).hexdigest()[:24]}"
    entry = FunctionType(_entry.__code__, scope, name)
    entry.__qualname__, entry.__module__ = name, __name__
    try:
        compiled = cfunc(_SIGNATURE, cache=True, error_model="numpy")(entry)
    except NumbaError as fault:
        raise CompileError(
            f"step function {_label(function)} cannot be compiled: {_first_line(fault)}; write "
            "it with scalars, loops and the math module only, or run it as a plain Python block"
        ) from fault
    return CompiledStep(compiled.address, compiled)


def _rebuild(function: Any, done: dict[int, tuple[Any, str]]) -> tuple[Any, str]:
    """`function` as a numba function whose helpers are numba functions too, and its fingerprint."""
    if hasattr(function, "py_func"):
        function = function.py_func
    if id(function) in done:
        return done[id(function)]
    if not isinstance(function, FunctionType):
        raise CompileError(f"{function!r} is no plain Python function, so it cannot be compiled")
    if function.__closure__:
        raise CompileError(
            f"step function {_label(function)} uses variables of an enclosing function; pass them "
            "through the block's parameters"
        )
    _refuse_raise(function)
    digest = hashlib.sha256(repr(function.__defaults__).encode())
    _feed(digest, function.__code__)
    scope = dict(function.__globals__)
    for name in function.__code__.co_names:
        if name not in scope:
            continue
        value = scope[name]
        if isinstance(value, FunctionType) or hasattr(value, "py_func"):
            scope[name], fingerprint = _rebuild(value, done)
            digest.update(f"{name}={fingerprint};".encode())
        elif isinstance(value, (*_SCALARS, tuple)):
            digest.update(f"{name}={value!r};".encode())
        elif isinstance(value, np.ndarray):
            digest.update(name.encode() + value.tobytes())
        elif not isinstance(value, (ModuleType, type, BuiltinFunctionType, np.ufunc)):
            raise CompileError(
                f"step function {_label(function)} uses {name}, a {type(value).__name__}; it may "
                "use functions, numbers and the math module"
            )
    fingerprint = digest.hexdigest()
    own = f"{function.__name__}_{fingerprint[:24]}"
    plain = FunctionType(function.__code__, scope, own, function.__defaults__)
    plain.__qualname__, plain.__module__ = own, function.__module__
    done[id(function)] = njit(plain, error_model="numpy"), fingerprint
    return done[id(function)]


def _refuse_raise(function: Callable[..., Any]) -> None:
    for instruction in dis.get_instructions(function):
        if instruction.opname == "RAISE_VARARGS":
            line = function.__code__.co_firstlineno
            raise CompileError(
                f"step function {_label(function)} (line {line}) raises an exception, which "
                "compiled code cannot carry to the caller; write NaN to the outputs instead"
            )


def _feed(digest: Any, code: CodeType) -> None:
    digest.update(code.co_code)
    digest.update(repr(code.co_names + code.co_varnames).encode())
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            _feed(digest, constant)
        else:
            digest.update(repr(constant).encode())


def _label(function: StepFunction | Callable[..., Any]) -> str:
    return f"{getattr(function, '__module__', '?')}.{getattr(function, '__qualname__', function)}"


def _first_line(fault: Exception) -> str:
    lines = [line.strip() for line in str(fault).splitlines() if line.strip()]
    return lines[1] if len(lines) > 1 and lines[0].startswith("Failed in") else (lines or ["?"])[0]
