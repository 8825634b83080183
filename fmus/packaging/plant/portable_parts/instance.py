"""One instance of a portable FMU: value references, state, stepping.

Value references are those of the native FMU: time, states, derivatives, inputs, outputs,
parameters. The module that pythonfmu loads delegates to this class and does not inherit from it:
pythonfmu's library drops a reference too many to the bases of that class each time the FMU is
loaded, which ends in a crash for a base that outlives the load.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any

from . import rodas5p
from .model import Model


@dataclass
class _Values:
    """Everything that a stored FMU state must hold."""

    time: float
    relative_tolerance: float
    substep: float
    x: list[float]
    u: list[float]
    p: list[float]
    running: bool = False


class StepError(Exception):
    """A step failed; the values are those before it. The message is for the log."""


class Instance:
    """A plant stepped by Rodas5P, with the values of one instance."""

    def __init__(self, model: Model) -> None:
        """Start values throughout."""
        self._model = model
        self._values = _Values(
            0.0, model.relative_tolerance, 0.0, [*model.x_start], [*model.u_start], [*model.p_start]
        )

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        """Take the tolerance over where one is given."""
        self._values.time = start_time
        if tolerance:
            self._values.relative_tolerance = tolerance

    def exit_initialization_mode(self) -> None:
        """From now on states and fixed parameters are not set any more.

        Raises ValueError when a derivative is not finite with the initial values."""
        values, model = self._values, self._model
        rates = self._derivatives()
        for name, rate in zip(model.names[1 + len(values.x) :], rates, strict=False):
            if not isfinite(rate):
                raise ValueError(f"{name!r} is {rate} with the initial values.")
        values.running = True

    def do_step(self, current_time: float, step_size: float) -> None:
        """Step, or raise StepError and keep the values as they were."""
        values, model = self._values, self._model
        invariants = model.invariants(values.u, values.p)
        problem = rodas5p.Problem(model, values.u, values.p, invariants, values.relative_tolerance)
        if values.x:
            try:
                values.x, values.substep = rodas5p.integrate(
                    problem, step_size, values.x, values.substep
                )
            except rodas5p.IntegrationError as failure:
                raise StepError(
                    f"The step from {current_time!r} s over {step_size!r} s failed {failure}. "
                    "The values are those before the step."
                ) from failure
        values.time = current_time + step_size

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values by value reference."""
        values, model = self._values, self._model
        table = [values.time, *values.x]
        table += self._derivatives()
        table += [*values.u, *model.outputs(values.x, values.u, values.p), *values.p]
        if unknown := [vr for vr in vrs if not 0 <= vr < len(table)]:
            raise ValueError(f"There is no variable with value reference {unknown[0]}.")
        return [table[reference] for reference in vrs]

    def _derivatives(self) -> list[float]:
        values, model = self._values, self._model
        invariants = model.invariants(values.u, values.p)
        return model.derivatives(values.x, values.u, values.p, invariants)

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set states, inputs and parameters; raises ValueError for anything else, changes nothing
        then."""
        places = [self._place(vr, value) for vr, value in zip(vrs, values, strict=True)]
        for (target, index), value in zip(places, values, strict=True):
            target[index] = value

    def _place(self, reference: int, value: float) -> tuple[list[float], int]:
        model, stored = self._model, self._values
        n_x, n_u, n_y = len(stored.x), len(stored.u), model.n_outputs
        name = model.names[reference] if 0 <= reference < len(model.names) else "?"
        if not isfinite(value):
            raise ValueError(f"{name!r} cannot be set to {value}, values must be finite.")
        if 1 <= reference <= n_x:
            if stored.running:
                raise ValueError(f"{name!r} cannot be set by value after initialization.")
            return stored.x, reference - 1
        index = reference - 1 - 2 * n_x
        if 0 <= index < n_u:
            return stored.u, index
        index -= n_u + n_y
        if not 0 <= index < len(stored.p):
            raise ValueError(f"{name!r} (value reference {reference}) cannot be set at all.")
        low, high = model.p_range[index]
        if stored.running and not model.p_tunable[index]:
            raise ValueError(f"{name!r} cannot be set after initialization, it is fixed.")
        if not low <= value <= high:
            raise ValueError(f"{name!r} = {value} lies outside of its range, {low} to {high}.")
        return stored.p, index

    def get_state(self) -> dict[str, Any]:
        """A copy of everything that a restored instance needs, ready for JSON."""
        values = self._values
        return {**vars(values), "x": [*values.x], "u": [*values.u], "p": [*values.p]}

    def set_state(self, state: dict[str, Any]) -> None:
        """Take a copy from `get_state` over."""
        vectors = {name: [*state[name]] for name in ("x", "u", "p")}
        self._values = _Values(**{**state, **vectors})
