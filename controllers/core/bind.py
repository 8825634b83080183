"""Give a step function the model it works on: general code, particular functions, one plain result.

A step function names the functions that it calls, and closures are refused because compiled code
cannot follow them. So a general step (a *template*) names placeholders that fix the signature:

    def model_rate(p: Array, x: Array, u: Array, rate: Array) -> None:
        \"""dx/dt; bound by `bind`.\"""

    def step(p: Array, x: Array, u: Array, y: Array) -> None:
        model_rate(p, x, u, y)

    servo_step = bind(step, model_rate=servo_rate)

`bind` acts on the names in the template's own code alone. Where a helper of the template names a
placeholder, bind the helper first and then the template to it:

    bind(step, advance=bind(advance, model_rate=servo_rate))

This module refuses to know models, filters and the compiler.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import lru_cache
from types import FunctionType
from typing import Any, TypeVar

from controllers.core.errors import ControllerError, require

F = TypeVar("F", bound=Callable[..., Any])


def bind(template: F, **functions: Callable[..., Any]) -> F:
    """A plain function with the code of `template`, whose given names mean `functions`.

    The template is left as it is; the same binding gives the same function again. Each name must
    be a function that the template's code names, and the function given for it must take as many
    arguments. Raises `ControllerError` otherwise.
    """
    where = f"bind({getattr(template, '__qualname__', template)})"
    if not isinstance(template, FunctionType) or template.__closure__:
        raise ControllerError(
            f"{where}: expected a plain function without variables of an enclosing function, "
            f"received {template!r}."
        )
    scope = dict(template.__globals__)
    named = [n for n in template.__code__.co_names if isinstance(scope.get(n), FunctionType)]
    for name, function in functions.items():
        legal = "a function that the template names: " + ", ".join(named)
        require(name in named, where, legal, name)
        _require_same_arguments(f"{where}: {name}", scope[name], function)
    return _bound(template, tuple(sorted(functions.items())))  # type: ignore[return-value]


@lru_cache(maxsize=256)
def _bound(template: FunctionType, functions: tuple[tuple[str, FunctionType], ...]) -> FunctionType:
    """One object for one binding, so that whoever compiles it can remember having done so."""
    scope = {**template.__globals__, **dict(functions)}
    bound = FunctionType(template.__code__, scope, template.__name__, template.__defaults__)
    given = ", ".join(f"{name}={function.__name__}" for name, function in functions)
    bound.__qualname__ = f"{template.__qualname__}({given})"
    bound.__module__ = template.__module__
    bound.__doc__ = template.__doc__
    bound.__annotations__ = template.__annotations__
    return bound


def _require_same_arguments(where: str, placeholder: FunctionType, function: object) -> None:
    plain = isinstance(function, FunctionType) and not function.__closure__
    require(plain, where, "a plain function without variables of an enclosing function", function)
    wanted, got = (inspect.signature(f).parameters for f in (placeholder, function))  # type: ignore[arg-type]
    require(len(wanted) == len(got), where, f"the arguments ({', '.join(wanted)})", tuple(got))
