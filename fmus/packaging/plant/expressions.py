"""The symbolic form of a plant: f, h and their joint Jacobian as CasADi expressions.

    dx/dt = f(x, u, p)        y = h(x, u, p)        J = d(f, h)/d(x, u, p)

This module refuses to know what the expressions are turned into.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import casadi as ca

from fmus.declaration import PlantModel
from fmus.packaging.errors import PackagingError
from fmus.packaging.plant.interface import Interface


@dataclass(frozen=True, eq=False)
class PlantExpressions:
    """CasADi columns of one plant: symbols x, u, p; derivatives dx; outputs y.

    `y` holds the outputs that are variables of their own (`Interface.outputs`); `h` holds all
    outputs in the plant's order.
    """

    interface: Interface
    x: Any
    u: Any
    p: Any
    dx: Any
    y: Any
    h: Any

    @cached_property
    def jacobian(self) -> Any:
        """J, (n_x + n_y) by (n_x + n_u + n_p), with its exact sparsity."""
        unknowns = ca.vertcat(self.dx, self.y)
        knowns = ca.vertcat(self.x, self.u, self.p)
        return ca.sparsify(ca.jacobian(unknowns, knowns))


def plant_expressions(plant: PlantModel) -> PlantExpressions:
    """Evaluate the plant's equations over symbols.

    Raises PackagingError when the equations fail, or return other names than the plant declares,
    or when an output that bears a state's name is not that state.
    """
    interface = Interface(plant)
    x = [ca.SX.sym(state.name) for state in plant.states]
    u = [ca.SX.sym(variable.name) for variable in plant.inputs]
    p = [ca.SX.sym(parameter.name) for parameter in plant.parameters]
    derivatives, outputs = plant.equations(
        _namespace(plant.states, x), _namespace(plant.inputs, u), _namespace(plant.parameters, p)
    )
    _check_keys(plant, "derivatives", derivatives, [state.name for state in plant.states])
    _check_keys(plant, "outputs", outputs, [variable.name for variable in plant.outputs])
    for state, symbol in zip(plant.states, x, strict=True):
        if state.name in interface.state_outputs:
            _check_is_state(plant, state.name, outputs[state.name], symbol)
    return PlantExpressions(
        interface,
        _column(x),
        _column(u),
        _column(p),
        _column([_scalar(plant, s.name, derivatives[s.name]) for s in plant.states]),
        _column([_scalar(plant, v.name, outputs[v.name]) for v in interface.outputs]),
        _column([_scalar(plant, v.name, outputs[v.name]) for v in plant.outputs]),
    )


def _namespace(variables: tuple[Any, ...], symbols: list[Any]) -> SimpleNamespace:
    return SimpleNamespace(**{v.name: s for v, s in zip(variables, symbols, strict=True)})


def _column(scalars: list[Any]) -> Any:
    return ca.densify(ca.vertcat(*scalars)) if scalars else ca.SX(0, 1)


def _scalar(plant: PlantModel, name: str, value: Any) -> Any:
    expression = ca.SX(value)
    if expression.shape != (1, 1):
        raise PackagingError(
            f"Plant {plant.name!r}: the equation of {name!r} has shape {expression.shape}, "
            "expected one scalar expression."
        )
    return expression


def _check_keys(
    plant: PlantModel, what: str, found: Mapping[str, Any], expected: list[str]
) -> None:
    missing = [name for name in expected if name not in found]
    surplus = [name for name in found if name not in expected]
    if missing or surplus:
        raise PackagingError(
            f"Plant {plant.name!r}: the equations must return {what} for exactly {expected}; "
            f"missing {missing}, not declared {surplus}."
        )


def _check_is_state(plant: PlantModel, name: str, value: Any, symbol: Any) -> None:
    if not ca.is_equal(_scalar(plant, name, value), symbol):
        raise PackagingError(
            f"Plant {plant.name!r}: output {name!r} bears the name of a state but is another "
            "expression; return the state itself or rename the output."
        )
