"""An FMU under examination: one kind of its interfaces, the times, and the variables to watch.

Start time, step and tolerance are those with which `simulate` would run it. This module refuses
to judge.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.fmi.binding.instance import MODEL_EXCHANGE, InterfaceType, capabilities
from harness.fmi.description.model_description import NUMERIC_TYPES, REAL_TYPES, Variable
from harness.fmi.fmu import Fmu
from harness.participants.settings import Request, settle

Array = NDArray[np.float64]

FEWEST, MOST = 20, 100
"""Communication steps of a run of the examination."""
SLOW = 4
"""Those of an FMU whose steps take long."""

_WATCHED = 500  # variables at most


class Subject:
    """An opened FMU with the step size and the variables that the examination uses.

    `scratch` is a folder that outlives the process of the examination.
    """

    def __init__(self, fmu: Fmu, interface_type: InterfaceType, scratch: Path) -> None:
        """Raises `FmuError` where the FMU lacks this kind of interface."""
        self.fmu, self.description = fmu, fmu.description
        self.interface_type, self.scratch = interface_type, scratch
        self.capabilities = capabilities(fmu.description, interface_type)
        self.settings = settle(Request(interface_type=interface_type), fmu.description)

    @property
    def exchanges(self) -> bool:
        """Whether model exchange is examined."""
        return self.interface_type == MODEL_EXCHANGE

    @property
    def start(self) -> float:
        """Start time of the runs (s)."""
        return self.settings.start_time

    @cached_property
    def step(self) -> float:
        """Communication step (s): the FMU's own one where it states it, however many of them
        `simulate` would ask for at a time; in model exchange the distance of its rows."""
        s, own = self.settings, self.capabilities.fixed_internal_step_size
        step = s.output_interval if self.exchanges else own or s.step_size
        assert step is not None
        return step

    @cached_property
    def steps(self) -> int:
        """Communication steps of a run: to the stop time, within reason; what `shorten` said."""
        if self._shortened.exists():
            return int(self._shortened.read_text())
        wanted = (self.settings.stop_time - self.start) / self.step
        return int(min(max(wanted, FEWEST), MOST))

    def shorten(self, steps: int) -> None:
        """All runs from now on, also those of other processes, are of so many steps."""
        self._shortened.write_text(str(steps))
        self.steps = steps

    @property
    def slow(self) -> bool:
        """Whether a run was shortened since steps take long."""
        return self._shortened.exists()

    @property
    def _shortened(self) -> Path:
        return self.scratch / f"{self.interface_type}.steps"

    @property
    def half(self) -> int:
        """Steps until a snapshot is taken, and after it."""
        return self.steps // 2

    @cached_property
    def real_inputs(self) -> tuple[Variable, ...]:
        """Scalar real inputs that may be set at any time."""
        return tuple(
            v for v in self.description.inputs
            if _is_plain(v) and (not self.exchanges or v.variability == "continuous")
        )  # fmt: skip

    @cached_property
    def real_outputs(self) -> tuple[Variable, ...]:
        """Scalar real outputs."""
        return tuple(v for v in self.description.outputs if _is_plain(v))

    @cached_property
    def states(self) -> tuple[tuple[Variable, Variable], ...]:
        """Scalar continuous states and their derivatives, in the order of the model structure;
        empty where one of them is an array."""
        d = self.description
        pairs = tuple((d.variable(state), d.variable(rate)) for state, rate in d.states)
        return pairs if all(_is_plain(v) for pair in pairs for v in pair) else ()

    @cached_property
    def watched(self) -> tuple[Variable, ...]:
        """Numeric outputs and local variables, outputs first; nothing that a clock owns."""
        found = [
            v for v in self.description.variables.values()
            if v.type in NUMERIC_TYPES and v.causality in ("output", "local")
            and not v.details.clocks
        ]  # fmt: skip
        return tuple(sorted(found, key=lambda v: v.causality != "output")[:_WATCHED])

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """The name of each column of what is watched."""
        names = [v.name for v in self.watched for _ in range(v.size)]
        if self.exchanges:
            n = self._state_count
            known = [state for state, _ in self.description.states]
            states = known if len(known) == n else [f"continuous state {i + 1}" for i in range(n)]
            names += [*states, *(f"der({name})" for name in states)]
        return tuple(names)

    @property
    def _state_count(self) -> int:
        d = self.description
        if d.fmi_major < 3:
            return d.number_of_continuous_states
        return sum(d.variable(rate).size for _, rate in d.states)


def _is_plain(v: Variable) -> bool:
    return v.type in REAL_TYPES and not v.dimensions and not v.details.clocks
