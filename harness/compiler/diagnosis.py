"""Why a step function cannot be native code: which line, which construct, what to write instead.

What the source shows is found before anything is compiled. What only types show, such as the sum
of two slices, which allocates, is found in what the compiler made: the lines of the step that lead
to a call of the runtime.
"""

from __future__ import annotations

import ast
import linecache
import re
from collections.abc import Sequence
from types import FunctionType

from numba.core.errors import NumbaError

from harness.compiler.step import CompileError, first_reason, label, step_functions, syntax

_ROOM = "give the block's state room for it and work on a slice of x"
_LOOP = "write a loop over the elements, with room for the result in the block's state"
_CONSTRUCTS: dict[tuple[type[ast.AST], ...], tuple[str, str]] = {
    (ast.Raise,): ("raises an exception", "write NaN to the outputs instead, which ends the run"),
    (ast.Assert,): ("asserts", "check when the controller is made, or write NaN to the outputs"),
    (ast.Try,): ("catches exceptions", "test for the case with `if` before it occurs"),
    (ast.With,): ("has a `with` block", "do what it does when the controller is made"),
    (ast.List, ast.ListComp): ("makes a list", _ROOM),
    (ast.Dict, ast.DictComp): ("makes a dictionary", "number the entries and keep them in p or x"),
    (ast.Set, ast.SetComp): ("makes a set", _ROOM),
    (ast.GeneratorExp,): ("has a generator", "write a `for` loop"),
    (ast.Yield,): ("is a generator", "keep what it remembers in x"),
    (ast.JoinedStr,): ("makes text", "write numbers to the outputs instead"),
    (ast.Lambda, ast.FunctionDef): (
        "defines a function", "move it to the module and call it by name",
    ),
    (ast.ClassDef,): ("defines a class", "keep what it holds in p and x"),
    (ast.Import, ast.ImportFrom): ("imports a module", "import it at the head of the file"),
    (ast.Global,): ("changes a global variable", "keep what it remembers in x"),
    (ast.Nonlocal,): ("changes an outer variable", "keep what it remembers in x"),
}  # fmt: skip
_ALLOCATING = frozenset(
    (
        "append", "arange", "array", "asarray", "astype", "concatenate", "copy", "cross",
        "diag", "dot", "empty", "empty_like", "eye", "flatten", "full", "full_like",
        "hstack", "identity", "inv", "kron", "linspace", "list", "matmul", "matrix_power",
        "ones", "ones_like", "outer", "pinv", "repeat", "solve", "sort",
        "sorted", "stack", "tile", "vstack", "zeros", "zeros_like",
    )
)  # fmt: skip
_OUTSIDE = {
    "print": "offer the value as an output of the block and look at that",
    "open": "read files when the controller is made",
    "input": "make it an input of the block",
}


def refuse_constructs(step: FunctionType) -> None:
    """Raise `CompileError` at the first construct of the step, or of a function that it calls,
    that an FMU without Python cannot have."""
    for function in step_functions(step):
        for node in _nodes(syntax(function)):
            if fault := _fault(node, function):
                construct, instead = fault
                line = function.__code__.co_firstlineno + getattr(node, "lineno", 1) - 1
                place = _place(step, function, line)
                raise CompileError(f"{place} {construct}; {instead}")


def _nodes(tree: ast.stmt | None) -> list[ast.AST]:
    """What runs when the function does, in the order of lines: not its annotations."""
    body = tree.body if isinstance(tree, ast.FunctionDef) else []
    inside = [node for statement in body for node in ast.walk(statement)]
    annotations = {
        id(inner)
        for node in inside
        if isinstance(node, ast.AnnAssign)
        for inner in ast.walk(node.annotation)
    }
    running = [node for node in inside if id(node) not in annotations]
    return sorted(running, key=lambda node: getattr(node, "lineno", 0))


def _fault(node: ast.AST, function: FunctionType) -> tuple[str, str] | None:
    if isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.MatMult):
        return "multiplies matrices with @", _LOOP
    if isinstance(node, ast.Call):
        name = _called(node, function)
        if name in _OUTSIDE:
            return f"calls {name}()", _OUTSIDE[name]
        if name in _ALLOCATING:
            return f"calls {ast.unparse(node.func)}(), which allocates memory", _ROOM
    return next((words for kinds, words in _CONSTRUCTS.items() if isinstance(node, kinds)), None)


def _called(node: ast.Call, function: FunctionType) -> str:
    """The name of what is called, "" for a function of one's own."""
    if isinstance(node.func, ast.Attribute):
        return node.func.attr
    if not isinstance(node.func, ast.Name):
        return ""
    own = isinstance(function.__globals__.get(node.func.id), FunctionType)
    return "" if own else node.func.id


def _place(step: FunctionType, function: FunctionType, line: int) -> str:
    """The subject of the sentence."""
    caller = label(step).removeprefix("step function ")
    through = "" if function is step else f", called by {caller},"
    where = f"{function.__code__.co_filename}:{line}"
    return f"{label(function)}{through} cannot be native code: {where}"


def sentence(step: FunctionType, fault: NumbaError) -> str:
    """What the compiler says against a step, as one sentence with the line."""
    text = str(fault)
    said = first_reason(fault)
    where = re.findall(r'File "([^"]+)", line (\d+)', text)
    files = {function.__code__.co_filename: function for function in step_functions(step)}
    for path, line in where:
        for name, function in files.items():
            if name.endswith(path.lstrip("./")):
                source = linecache.getline(name, int(line)).strip()
                return (
                    f"{_place(step, function, int(line))} ({source}) is nothing the compiler "
                    f"knows: {said}; write it with scalars, loops, slices and the math module"
                )
    return (
        f"{label(step)} cannot be native code: {said}; write it with scalars, "
        "loops, slices and the math module"
    )


def foreign_sentence(step: FunctionType, foreign: Sequence[str], places: Sequence[str]) -> str:
    """For a step that calls functions which no C library has; `places` as "file:line"."""
    allocates = any(name.startswith("NRT_") for name in foreign)
    below = label(step).removeprefix("step function ")
    where = ", ".join(places) or f"somewhere below {below}"
    if allocates:
        return (
            f"{label(step)} cannot be native code: {where} allocates memory (as "
            f"the sum of two slices does, or a function that returns an array); {_LOOP}"
        )
    return (
        f"{label(step)} cannot be native code: {where} calls {', '.join(foreign)}, "
        "which only Python's runtime has; write it with scalars, loops and the math module"
    )
