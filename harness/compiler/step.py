"""From a block's step function to the address of a C function.

A step function is plain Python. Here it and every plain Python function that it names are rebuilt
as numba functions and wrapped as `int32 entry(double *p, double *x, double *u, double *y, const
int64 *sizes)`; one code serves blocks of all sizes. The machine code is cached on disk under a
fingerprint of all that code, so a change in a helper of another module is noticed, which numba's
own cache does not.

Every rebuilt function bears the fingerprint of its step in its name. Code from the cache shares
one space of symbols with all other code of the process, and of two equal symbols the first wins:
functions of one name in two steps (a template bound to two models) must not have the same symbol.

It refuses step functions that raise: a block reports that it cannot go on by writing NaN.
"""

from __future__ import annotations

import ast
import ctypes
import dis
import hashlib
import inspect
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import carray, types
from numba.core.errors import NumbaError
from numpy.typing import NDArray

from harness.compiler.machine_code import cached_callback
from harness.compiler.part import part
from harness.errors import HarnessError
from harness.system.block import Array, Block, StepFunction

_POINTER = types.CPointer(types.float64)
_SIGNATURE = types.int32(*[_POINTER] * 4, types.CPointer(types.int64))
_SCALARS = (bool, int, float, np.integer, np.floating)
_MODULES = ("math", "numpy")  # of other modules one cannot tell what a step function takes

_C_POINTER, _C_SIZES = ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_int64)


class CompileError(HarnessError):
    """A step function that cannot be compiled."""


@dataclass(frozen=True, eq=False)
class CompiledStep:
    """A compiled step function for one block: the `address` of its C function, the `sizes` that
    it takes, (4,) for p, x, u, y; the code itself, which lives as long as this; and whether it is
    certain that it leaves u as it is."""

    address: int
    sizes: NDArray[np.int64]
    code: Any
    leaves_inputs: bool

    def call(self, p: int, x: int, u: int, y: int) -> list[int]:
        """Its address and its arguments, for the arrays at these addresses."""
        return [self.address, p, x, u, y, self.sizes.ctypes.data]

    @property
    def inner(self) -> int:
        """The address of the function inside: its arguments follow two pointers, to its result and
        to an exception, of which neither says anything."""
        name = self.code._wrapper_name.removeprefix("cfunc.")
        return int(self.code._library.get_pointer_to_function(name))

    def __call__(self, p: Array, x: Array, u: Array, y: Array) -> None:
        """Call it as the step function that it was; arrays as long as those of the block."""
        self.code.ctypes(*(array.ctypes.data_as(_C_POINTER) for array in (p, x, u, y)),
                         self.sizes.ctypes.data_as(_C_SIZES))  # fmt: skip


def _entry(p: Any, x: Any, u: Any, y: Any, sizes: Any) -> Any:  # `step` is bound by _compile
    n = carray(sizes, (4,))
    arrays = carray(p, (n[0],)), carray(x, (n[1],)), carray(u, (n[2],)), carray(y, (n[3],))
    step(*arrays)  # type: ignore[name-defined]  # noqa: F821
    return np.int32(0)


def compile_step(block: Block) -> CompiledStep:
    """Compile `block.step`, or fetch it from the cache.

    Raises `CompileError` naming the function and the reason.
    """
    name = f"step_{step_fingerprint(block.step)[:24]}"
    if name not in _compiled:
        _compiled[name] = _compile(_plain(block.step), name)
    code = _compiled[name]
    array = _sizes(sizes(block))
    return CompiledStep(code.address, array, code, _only_reads(_plain(block.step).__code__, 2))


@cache
def _sizes(of: tuple[int, ...]) -> NDArray[np.int64]:
    """One array for all blocks of these sizes, which is read faster than one for each."""
    return np.array(of, dtype=np.int64)


def sizes(block: Block) -> tuple[int, ...]:
    """The lengths of p, x, u and y."""
    return tuple(map(len, (block.parameters, block.state, block.inputs, block.outputs)))


_compiled: dict[str, Any] = {}
_parts: dict[str, Any] = {}
"""What steps are made of, by fingerprint: what several have in common is compiled once."""


def _compile(function: FunctionType, name: str) -> Any:
    scope = {**globals(), "step": rebuilt(function, "", _parts)}
    entry = FunctionType(_entry.__code__, scope, name)
    entry.__qualname__, entry.__module__ = name, __name__
    entry.__dict__["called"] = f"{function.__module__}.{function.__name__}"
    try:
        return cached_callback(entry, _SIGNATURE, error_model="numpy")
    except NumbaError as fault:
        raise CompileError(
            f"{label(function)} cannot be compiled: {first_reason(fault)}; write "
            "it with scalars, loops and the math module only, or run it as a plain Python block"
        ) from fault


def _plain(function: Any) -> FunctionType:
    """The Python function itself, also of one that numba has decorated."""
    function = getattr(function, "py_func", function)
    if not isinstance(function, FunctionType):
        raise CompileError(f"{function!r} is no plain Python function, so it cannot be compiled")
    return function


def _is_function(value: Any) -> bool:
    return isinstance(value, FunctionType) or hasattr(value, "py_func")


def _named(function: FunctionType) -> dict[str, Any]:
    """The global values that a function names now, in itself or in functions inside it."""
    known = function.__globals__
    return {name: known[name] for name in _read(function.__code__).names if name in known}


def _helpers(function: FunctionType) -> dict[str, FunctionType]:
    """The plain Python functions among them."""
    return {name: _plain(one) for name, one in _named(function).items() if _is_function(one)}


@dataclass(frozen=True)
class _CodeFacts:
    """What never changes about a code object: the names that it uses, in itself or in functions
    inside it; whether it raises; the digest of its instructions and constants."""

    names: tuple[str, ...]
    raises: bool
    digest: bytes


@cache
def _read(code: CodeType) -> _CodeFacts:
    """Read once: taking instructions apart takes longer than many a run."""

    def names(code: CodeType) -> Iterator[str]:
        yield from code.co_names
        for constant in code.co_consts:
            if isinstance(constant, CodeType):
                yield from names(constant)

    digest = hashlib.sha256()
    _feed(digest, code)
    raises = any(one.opname == "RAISE_VARARGS" for one in dis.get_instructions(code))
    return _CodeFacts(tuple(dict.fromkeys(names(code))), raises, digest.digest())


@cache
def _only_reads(code: CodeType, place: int) -> bool:
    """Whether a function does nothing with that argument but `argument[constant]`, to read it."""
    name, found = code.co_varnames[place], list(dis.get_instructions(code))
    for i, one in enumerate(found):
        if one.argval == name or (isinstance(one.argval, tuple) and name in one.argval):
            use = [each.opname for each in found[i : i + 3]]
            if use != ["LOAD_FAST", "LOAD_CONST", "BINARY_SUBSCR"]:
                return False
    return True


def _fingerprint(
    function: FunctionType, callers: tuple[FunctionType, ...], seen: dict[int, int], digest: Any
) -> None:
    """Feed all that the machine code of `function` depends on; refuse what cannot be compiled."""
    if function in callers:
        raise CompileError(
            f"{label(function)} calls itself, which compiled blocks may not; write a loop"
        )
    known = id(function) in seen
    digest.update(f"function {seen.setdefault(id(function), len(seen))};".encode())
    if known:
        return
    _refuse(function)
    digest.update(_read(function.__code__).digest)
    digest.update(repr((function.__defaults__, function.__kwdefaults__)).encode())
    for name, value in _named(function).items():
        digest.update(f"{name}={_identity(function, name, value)};".encode())
        if _is_function(value):
            _fingerprint(_plain(value), (*callers, function), seen, digest)


def _identity(function: FunctionType, name: str, value: Any) -> str:
    """What stands for a global value in the fingerprint; raises where it may not be used."""
    if isinstance(value, (*_SCALARS, tuple)):
        return repr(value)
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {hashlib.sha256(value.tobytes()).hexdigest()}"
    if _is_function(value):
        return "function"
    if isinstance(value, ModuleType) and value.__name__ in _MODULES:
        return value.__name__
    if isinstance(value, (type, BuiltinFunctionType, np.ufunc)):
        return f"{getattr(value, '__module__', '')}.{value.__name__}"
    kind = f"module {value.__name__}" if isinstance(value, ModuleType) else type(value).__name__
    raise CompileError(
        f"{label(function)} uses {name}, a {kind}; it may use functions and numbers "
        "by name, and the modules math and numpy"
    )


def rebuilt(function: FunctionType, step: str, done: dict[str, Any], **options: bool) -> Any:
    """`function`, as a part of `step`, as a numba function whose helpers are numba functions;
    `options` of numba's apply to all of them, `done` are those that there are already, by their
    fingerprints. Without a `step` names are made of those: code that was cached by two processes
    meets in a third by its names."""
    key = step_fingerprint(function)
    if key not in done:
        helpers = {
            name: rebuilt(helper, step, done, **options)
            for name, helper in _helpers(function).items()
        }
        scope = {**function.__globals__, **helpers}
        own = f"{function.__name__}_in_{step or key[:24]}"
        plain = FunctionType(function.__code__, scope, own, function.__defaults__)
        plain.__qualname__ = own
        plain.__module__, plain.__kwdefaults__ = function.__module__, function.__kwdefaults__
        done[key] = part(plain, **options)
    return done[key]


def _refuse(function: FunctionType) -> None:
    if function.__closure__:
        raise CompileError(
            f"{label(function)} uses variables of an enclosing function; pass them "
            "through the block's parameters"
        )
    if _read(function.__code__).raises:
        line = function.__code__.co_firstlineno
        raise CompileError(
            f"{label(function)} (line {line}) raises an exception, which "
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


def label(function: FunctionType) -> str:
    """How errors name a step function or one that it calls."""
    return f"step function {function.__module__}.{function.__qualname__}"


def syntax(function: FunctionType) -> ast.stmt | None:
    """The function's source as a tree, None where there is none to see."""
    try:
        return ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
    except (OSError, TypeError, SyntaxError):
        return None


def first_reason(fault: Exception) -> str:
    """What the compiler says first."""
    lines = [line.strip() for line in str(fault).splitlines() if line.strip()]
    return next((line for line in lines if not line.startswith("Failed in")), "no reason given")


def step_functions(step: StepFunction) -> list[FunctionType]:
    """The step function itself and every plain Python function that it names, directly or not."""
    found = [_plain(step)]
    for function in found:  # which grows meanwhile
        helpers = dict.fromkeys(_helpers(function).values())
        found += [one for one in helpers if one not in found]
    return found


def step_fingerprint(step: StepFunction) -> str:
    """Hash of all that the machine code of `step` depends on; raises `CompileError` for what cannot
    be compiled."""
    digest = hashlib.sha256()
    _fingerprint(_plain(step), (), {}, digest)
    return digest.hexdigest()
