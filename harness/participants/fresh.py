"""Plain Python controllers as they were handed over: every run works on copies of its own.

A worker that is forked has such copies already; here they are made wherever a run begins, so that
the first and the second run of a bench give the same bits with and without a worker. What the user
changes between two runs counts, what a run changes does not.

Copied is what an object holds, and of a function its closure, its default arguments, and the global
variables that it, and the functions of its module that it calls, name. What two controllers share
they share in the run. A function without outputs observes: it is left as it is, unless it shares
with a controller.
"""

from __future__ import annotations

import copy
import io
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from threading import Lock, RLock
from types import CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

from harness.errors import UsageError
from harness.system.graph import PythonComponent, SampledComponent

_STATELESS = (ModuleType, type, io.IOBase, type(Lock()), type(RLock()))


def fresh(components: Iterable[SampledComponent]) -> Iterator[SampledComponent]:
    """The components of one run, plain Python as it was handed over.

    Raises `UsageError` for the second run of what cannot be copied.
    """
    components, copies = tuple(components), _Copies()
    makers = [c for c in components if isinstance(c, PythonComponent) and c.outputs]
    functions = {c.name: copies.function(c) for c in makers}
    for c in components:
        if isinstance(c, PythonComponent) and (c.outputs or copies.shares(c.function)):
            c = replace(c, function=functions.get(c.name) or copies.function(c))
        yield c


class _Copies:
    """The copies of one run, by what they are copies of."""

    def __init__(self) -> None:
        self._memo: dict[int, Any] = {}
        self._spaces: dict[int, dict[str, Any]] = {}

    def function(self, component: PythonComponent) -> Callable[..., Any]:
        """The function of a component for one run."""
        self._refusal = ""
        made: Callable[..., Any] = self._of(component.function, component.name)
        if self._refusal and component.make is not None:
            return component.make()
        if self._refusal and component.uncopied:
            raise UsageError(
                f"component {component.name}: a second run would go on with what the first one "
                f"left, since {component.uncopied[0]}; give the class itself with its parameters, "
                "or an object that defines __deepcopy__"
            )
        if self._refusal:
            component.uncopied.append(self._refusal)
        return made

    def shares(self, function: Callable[..., Any]) -> bool:
        """Whether it holds what was copied already."""
        cells = getattr(function, "__closure__", None) or ()
        held = [getattr(function, "__self__", function), *cells]
        held += [cell.cell_contents for cell in cells if _filled(cell)]
        return any(id(one) in self._memo for one in held)

    def _of(self, value: Any, name: str) -> Any:
        """The copy of `value`, or itself where it holds nothing or cannot be copied."""
        if isinstance(value, FunctionType):
            return self._clone(value)
        if isinstance(value, _STATELESS) or type(value).__module__.startswith("numba"):
            return value
        if isinstance(value, MethodType):
            return MethodType(value.__func__, self._of(value.__self__, name))
        if type(value) is partial:
            given = self._of((value.args, value.keywords), name)
            return partial(self._of(value.func, name), *given[0], **given[1])
        held = getattr(value, "__dict__", {})
        self._memo.update((id(one), one) for one in held.values() if isinstance(one, _STATELESS))
        try:
            made = copy.deepcopy(value, self._memo)
        except Exception as fault:  # whatever a class of the user raises
            kind = type(value).__qualname__
            self._refusal = f"its {name!r} ({kind}) cannot be copied: {fault}"
            return value
        functions = {key: one for key, one in held.items() if isinstance(one, FunctionType)}
        if functions and made is not value:
            vars(made).update({key: self._clone(one) for key, one in functions.items()})
        return made

    def _clone(self, function: FunctionType) -> FunctionType:
        """A function with a closure, defaults and global variables of its own."""
        if id(function) in self._memo:
            found: FunctionType = self._memo[id(function)]
            return found
        space = self._spaces.setdefault(id(function.__globals__), dict(function.__globals__))
        cells = function.__closure__
        clone = FunctionType(
            function.__code__, space, function.__name__, function.__defaults__,
            None if cells is None else tuple(map(self._cell, cells)),
        )  # fmt: skip
        self._memo[id(function)] = clone
        for cell, name in zip(cells or (), function.__code__.co_freevars, strict=True):
            new = self._memo[id(cell)]
            if _filled(cell) and not _filled(new):
                new.cell_contents = None  # it may hold itself
                new.cell_contents = self._of(cell.cell_contents, name)
        clone.__defaults__ = self._of(function.__defaults__, f"defaults of {function.__name__}")
        clone.__kwdefaults__ = self._of(function.__kwdefaults__, function.__name__)
        clone.__dict__.update(function.__dict__)
        for name in _names(function.__code__):
            value = function.__globals__.get(name)
            foreign = isinstance(value, FunctionType) and value.__globals__ is not (
                function.__globals__
            )
            if value is not None and space.get(name) is value and not foreign:
                space[name] = self._of(value, name)
        return clone

    def _cell(self, cell: CellType) -> CellType:
        new: CellType = self._memo.setdefault(id(cell), CellType())
        return new


def _filled(cell: CellType) -> bool:
    try:
        return cell.cell_contents is not cell
    except ValueError:  # a variable that has no value yet
        return False


def _names(code: CodeType) -> set[str]:
    """The names that code looks up, also that of functions within it."""
    inner = (one for one in code.co_consts if isinstance(one, CodeType))
    return set(code.co_names).union(*map(_names, inner))
