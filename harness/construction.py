"""Controllers from classes and plain functions: what one takes is judged before it is called, so
that a fault names the component and the legal choices.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any

from harness.errors import ExperimentError, HarnessError, UsageError, nearest


def construct(name: str, kind: type[Any], parameters: Mapping[str, Any]) -> Any:
    """An object of a class with these parameters, lists as tuples, for the component `name`; raises
    `ExperimentError` for parameters that it has not, that it lacks, or that it refuses."""
    _check_parameters(name, kind, parameters)
    try:
        return kind(**{k: _tuples(v) for k, v in parameters.items()})
    except HarnessError:
        raise
    except (TypeError, ValueError, ArithmeticError, LookupError) as fault:
        raise ExperimentError(f"component {name}: {kind.__name__}: {fault}") from fault
    except Exception as fault:
        raise ExperimentError(f"component {name}: {fault}") from fault


def _check_parameters(name: str, kind: type[Any], parameters: Mapping[str, Any]) -> None:
    """Raises `ExperimentError` for parameters that a class has not, or that it lacks."""
    try:
        known = inspect.signature(kind).parameters.values()
    except (TypeError, ValueError):  # a class of a compiled module may not say
        return
    open_ended = any(p.kind is p.VAR_KEYWORD for p in known)
    named = {p.name: p for p in known if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}
    for key in parameters:
        if key not in named and not open_ended:
            raise ExperimentError(
                f"component {name}: {kind.__name__} has no parameter {key!r}; {nearest(key, named)}"
            )
    lacking = [key for key, p in named.items() if p.default is p.empty and key not in parameters]
    if lacking:
        raise ExperimentError(
            f"component {name}: {kind.__name__} needs the parameter {lacking[0]!r}, which is not "
            f"given; its parameters are {', '.join(named)}"
        )


def step_of_new(name: str, kind: type[Any], parameters: Mapping[str, Any]) -> Callable[..., Any]:
    """The function of a new object of a class."""
    made = construct(name, kind, parameters)
    function: Callable[..., Any] = getattr(made, "step", made)
    return function


def _tuples(value: Any) -> Any:
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value


def known_parameters(
    name: str, function: Callable[..., Any], given: Mapping[str, Any]
) -> dict[str, Any]:
    """Parameters of a plain Python function: its arguments that have a default."""
    signature = inspect.signature(function).parameters.values()
    legal = [p.name for p in signature if p.default is not p.empty or p.kind is p.KEYWORD_ONLY]
    for key in given:
        if key not in legal:
            raise UsageError(
                f"component {name}: {key!r} is no argument with a default of {function!r}, and so "
                f"no parameter; {nearest(key, legal)}"
            )
    return dict(given)


def input_names(name: str, function: Callable[..., Any]) -> list[str]:
    """The arguments of a plain Python function after the time, but for those with a default."""
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        raise UsageError(
            f"component {name}: {function!r} does not say what arguments it takes; wrap it, as in "
            f"lambda time, first, second: {getattr(function, '__name__', 'f')}(first, second)"
        ) from None
    free = [p for p in signature.parameters.values() if p.default is p.empty]
    plain = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    if not free or any(p.kind not in plain for p in free):
        raise UsageError(
            f"component {name}: a plain Python controller takes (time, input, input, …) by "
            f"position, not {signature}"
        )
    return [p.name for p in free[1:]]
