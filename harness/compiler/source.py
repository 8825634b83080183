"""A block's step function and all that it calls, as the text of one Python module.

The module imports `math` and `numpy` at most and defines `step(p, x, u, y)`. Every function that
the step reaches by name is copied from its source under a name of its own, every constant is
written out with the digits that read back to the same bits. So what a step means travels without
the package that it was written in, also for a template bound to its model.

It refuses functions without source (typed at a prompt, made by `exec`).
"""

from __future__ import annotations

import ast
import math
from types import BuiltinFunctionType, FunctionType, ModuleType
from typing import Any

import numpy as np

from harness.compiler.step import CompileError, label, step_functions, syntax
from harness.system.block import Block

_HEAD = "import math\n\nimport numpy\nfrom numpy import array, float64\n"


def python_source(block: Block) -> str:
    """The module's text; raises `CompileError` naming what cannot be written."""
    writer = _Writer()
    entry = writer.function(step_functions(block.step)[0])
    constants = (f"{name} = {text}" for text, name in writer.constants.items())
    arguments = "p, x, u, y"
    last = f"def step({arguments}):\n    {entry}({arguments})\n"
    return "\n\n".join([_HEAD, *constants, *writer.functions, last])


class _Writer:
    """Functions in the order in which they may stand, and the constants they name."""

    def __init__(self) -> None:
        self.names: dict[int, str] = {}
        self.constants: dict[str, str] = {}
        self.functions: list[str] = []

    def function(self, function: FunctionType) -> str:
        """Write a function after those it calls; returns its name in the module."""
        if id(function) not in self.names:
            self.names[id(function)] = f"{function.__name__}_{len(self.names)}"
            definition = _definition(function)
            _Renamer(self, function).visit(definition)
            definition.name = self.names[id(function)]
            self.functions.append(ast.unparse(ast.fix_missing_locations(definition)))
        return self.names[id(function)]

    def value(self, function: FunctionType, name: str, value: Any) -> str:
        """The expression for a global value that `function` names."""
        if isinstance(value, FunctionType) or hasattr(value, "py_func"):
            return self.function(getattr(value, "py_func", value))
        if isinstance(value, ModuleType) and value.__name__ in ("math", "numpy"):
            return value.__name__
        if isinstance(value, (BuiltinFunctionType, np.ufunc, type)):
            module = getattr(value, "__module__", None) or "numpy"
            if module in ("math", "numpy"):
                return f"{module}.{value.__name__}"
            if module == "builtins":
                return value.__name__
        text = _literal(value)
        if text is None:
            raise CompileError(
                f"{label(function)} uses {name}, a {type(value).__name__}, which cannot be written "
                "as Python text; use numbers, tuples of numbers, arrays and functions"
            )
        return self.constants.setdefault(text, f"{name}_c{len(self.constants)}")


class _Renamer(ast.NodeTransformer):
    """Puts the module's names in place of the globals that a function loads."""

    def __init__(self, writer: _Writer, function: FunctionType) -> None:
        self.writer, self.function = writer, function
        code = function.__code__
        self.local = {*code.co_varnames, *code.co_cellvars, *code.co_freevars}

    def visit_Name(self, node: ast.Name) -> ast.expr:
        known = self.function.__globals__
        if not isinstance(node.ctx, ast.Load) or node.id in self.local or node.id not in known:
            return node
        text = self.writer.value(self.function, node.id, known[node.id])
        return ast.parse(text, mode="eval").body


def _definition(function: FunctionType) -> ast.FunctionDef:
    """The syntax of a function without docstring, annotations and decorators."""
    found = syntax(function)
    if found is None:
        raise CompileError(f"{label(function)} has no source to copy; write it in a file")
    if not isinstance(found, ast.FunctionDef):
        raise CompileError(f"{label(function)} is no function written with def; write it with def")
    found.decorator_list, found.returns = [], None
    for argument in ast.walk(found.args):
        if isinstance(argument, ast.arg):
            argument.annotation = None
    if ast.get_docstring(found) is not None:
        found.body = found.body[1:] or [ast.Pass()]
    return found


def _literal(value: Any) -> str | None:
    """Python text for a number, a tuple of such, or an array; None for anything else."""
    if isinstance(value, (bool, np.bool_)):
        return repr(bool(value))
    if isinstance(value, (int, np.integer)):
        return repr(int(value))
    if isinstance(value, (float, np.floating)):
        number = float(value)
        return repr(number) if math.isfinite(number) else f"float('{number}')"
    if isinstance(value, tuple):
        parts = [_literal(item) for item in value]
        if any(part is None for part in parts):
            return None
        return f"({', '.join(map(str, parts))}{',' if len(parts) == 1 else ''})"
    if isinstance(value, np.ndarray) and value.dtype.kind in "fi":
        flat = ", ".join(str(_literal(item)) for item in value.ravel())
        return f"array([{flat}], dtype='{value.dtype.str}').reshape({value.shape!r})"
    return None
