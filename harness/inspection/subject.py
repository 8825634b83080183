"""An FMU under examination: how to bring it up, move it and watch it.

Inputs move a little about their start values, the same way in every run, so that a fault which
needs a moving input shows. This module refuses to judge.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from math import sin

import numpy as np
from numpy.typing import NDArray

from harness.fmi.fmu import Fmu
from harness.fmi.instance import FmuInstance
from harness.fmi.model_description import NUMERIC_TYPES, REAL_TYPES, Variable

Array = NDArray[np.float64]

STEPS = 20
"""Communication steps of a run of the examination."""

_MOVE = 0.05  # of an input's scale
_WATCHED = 500  # variables at most
_DEFAULT_SPAN = 1.0  # s, where the FMU names neither step nor stop time
_DEFAULT_STEPS = 100


class Subject:
    """An opened FMU with the step size and the variables that the examination uses."""

    def __init__(self, fmu: Fmu) -> None:
        self.fmu = fmu
        self.description = fmu.description

    @cached_property
    def start(self) -> float:
        """Start time of the runs (s)."""
        return self.description.start_time or 0.0

    @cached_property
    def step(self) -> float:
        """Communication step (s): the FMU's fixed one, else its default experiment's, else a
        hundredth of the default run."""
        d = self.description
        fixed = d.co_simulation.fixed_internal_step_size if d.co_simulation else None
        given = fixed or d.step_size
        if given:
            return given
        stop = d.stop_time if d.stop_time is not None else self.start + _DEFAULT_SPAN
        return (stop - self.start or _DEFAULT_SPAN) / _DEFAULT_STEPS

    @cached_property
    def moved(self) -> tuple[Variable, ...]:
        """Scalar real inputs, which the runs move."""
        return tuple(v for v in self.description.inputs if v.type in REAL_TYPES and v.size == 1)

    @cached_property
    def watched(self) -> tuple[Variable, ...]:
        """Numeric outputs and local variables, outputs first."""
        found = [
            v
            for v in self.description.variables.values()
            if v.type in NUMERIC_TYPES and v.causality in ("output", "local")
        ]
        return tuple(sorted(found, key=lambda v: v.causality != "output")[:_WATCHED])

    @cached_property
    def real_outputs(self) -> tuple[Variable, ...]:
        """Scalar real outputs."""
        return tuple(v for v in self.description.outputs if v.type in REAL_TYPES and v.size == 1)

    @contextmanager
    def running(self, name: str = "subject") -> Iterator[FmuInstance]:
        """An instance after initialisation; freed on leaving."""
        with self.fmu.instantiate(name) as instance:
            self.initialise(instance)
            yield instance

    def initialise(self, instance: FmuInstance) -> None:
        """Bring a fresh or reset instance to the start of a run."""
        instance.enter_initialization_mode(self.start, None, None)
        instance.exit_initialization_mode()

    def advance(
        self, instance: FmuInstance, steps: int = STEPS, first: int = 0, step: float | None = None
    ) -> Array:
        """Move and step an instance; rows of the watched variables after each step, (steps, n).

        The run is at step number `first`; steps of another length begin at the same time.
        """
        length = self.step if step is None else step
        begin = self.start + first * self.step
        rows = []
        for k in range(steps):
            time = begin + k * length
            self.move(instance, time)
            instance.do_step(time, length)
            rows.append(self.watch(instance))
        return np.array(rows)

    def move(self, instance: FmuInstance, time: float) -> None:
        """Set the inputs as they are at `time`, constant within each communication step."""
        number = np.floor((time - self.start) / self.step + 1e-6)
        for i, variable in enumerate(self.moved):
            wave = sin(0.3 * number + i + 1)
            value = start_of(variable) + _MOVE * scale_of(variable) * wave
            instance.set({variable.name: within(variable, value)})

    def watch(self, instance: FmuInstance) -> Array:
        """The watched variables, arrays element by element."""
        values = [np.ravel(instance.get(v.name)).astype(float) for v in self.watched]
        return np.concatenate(values) if values else np.zeros(0)


def start_of(variable: Variable) -> float:
    """The start value of a real variable, 0 where it has none."""
    return float(variable.start.split()[0]) if variable.start else 0.0


def scale_of(variable: Variable) -> float:
    """A size that is no trifle and no extreme for a real variable."""
    return abs(variable.nominal or 0.0) or abs(start_of(variable)) or 1.0


def within(variable: Variable, value: float) -> float:
    """`value` brought into the declared range of a variable."""
    low = -np.inf if variable.minimum is None else variable.minimum
    high = np.inf if variable.maximum is None else variable.maximum
    return float(min(max(value, low), high))
