"""What a discrete-time block is, before its FMU exists: signals, values, times and one step.

The step comes as the text of an LLVM module without a target, which defines

    i32 block_step(double *p, double *x, double *u, double *y)

over parameters, state, inputs and outputs, and names no function but those of the C library's
mathematics and `block_reshape` (`c/reshape.c`). It returns 0, or another number where it cannot go
on.

A value reference is the variable's place in `time, inputs, outputs, parameters, states`. In the
FMU parameters are called `parameters.<name>` and states `state.<name>`, so that they never meet a
signal's name; where the block gives no names, numbers stand for them: `state[1]`.

This module refuses to know controllers, the harness, and how the step was compiled.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, isnan

from fmus.packaging.errors import PackagingError
from fmus.packaging.variables import VariableEntry

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


@dataclass(frozen=True)
class BlockVariable:
    """One scalar: `unit` "" where it is not stated; `tunable` matters for parameters only."""

    name: str
    start: float
    unit: str = ""
    description: str = ""
    tunable: bool = False


@dataclass(frozen=True)
class BlockModel:
    """A block as data. `name` is the model's identifier; sample k is due at `phase_ns` plus k times
    `sample_time_ns` after the start; `step` is the LLVM module of the module's docstring;
    `equations` says in words what it computes."""

    name: str
    description: str
    sample_time_ns: int
    inputs: tuple[BlockVariable, ...]
    outputs: tuple[BlockVariable, ...]
    parameters: tuple[BlockVariable, ...]
    states: tuple[BlockVariable, ...]
    step: str
    phase_ns: int = 0
    version: str = "1.0"
    equations: str = ""

    def __post_init__(self) -> None:
        """Raise PackagingError for what no FMU could carry."""
        where = f"Block {self.name!r}"
        if not _IDENTIFIER.fullmatch(self.name):
            raise PackagingError(
                f"{where}: the name is no identifier; use letters, digits and underscores, a digit "
                "not first."
            )
        if self.sample_time_ns <= 0 or not 0 <= self.phase_ns < 2**62:
            raise PackagingError(
                f"{where}: the sample time is {self.sample_time_ns} ns and the phase "
                f"{self.phase_ns} ns; the first must be above 0, the second not below."
            )
        names = [entry.name for entry in block_entries(self)]
        twice = sorted({name for name in names if names.count(name) > 1}) if _repeats(names) else []
        if twice:
            raise PackagingError(
                f"{where}: the name {twice[0]!r} is given to more than one variable; inputs and "
                "outputs need different names, and 'time' is taken."
            )
        for variable in (*self.inputs, *self.outputs, *self.states):
            if not isfinite(variable.start):
                raise PackagingError(
                    f"{where}: {variable.name!r} starts at {variable.start!r}; start values of "
                    "signals and states must be finite."
                )
        for variable in self.parameters:
            if isnan(variable.start):
                raise PackagingError(f"{where}: parameter {variable.name!r} is NaN.")


def _repeats(names: Sequence[str]) -> bool:
    return len(set(names)) < len(names)


def numbered(group: str, names: Sequence[str], count: int) -> list[str]:
    """Names in the FMU of a `group` of `count` values that are called `names`, or of no name."""
    if len(names) == count:
        return [f"{group}.{name}" for name in names]
    return [f"{group}[{i + 1}]" for i in range(count)]


def block_entries(model: BlockModel) -> list[VariableEntry]:
    """Every variable in the order of value references."""
    return [
        VariableEntry("time", "independent", "continuous", "s", "Simulation time"),
        *(_input(variable) for variable in model.inputs),
        *(_held(variable, "output") for variable in model.outputs),
        *(_parameter(variable) for variable in model.parameters),
        *(_held(variable, "local") for variable in model.states),
    ]


def _input(v: BlockVariable) -> VariableEntry:
    return VariableEntry(v.name, "input", "continuous", v.unit, v.description, None, v.start)


def _held(v: BlockVariable, causality: str) -> VariableEntry:
    return VariableEntry(v.name, causality, "discrete", v.unit, v.description, "exact", v.start)


def _parameter(v: BlockVariable) -> VariableEntry:
    """A tunable parameter, or a constant of the design. Infinity means a limit that is not there;
    as not every importer reads it, the description has the largest number in its place."""
    largest = sys.float_info.max
    causality, variability = ("parameter", "tunable") if v.tunable else ("local", "constant")
    start = min(max(v.start, -largest), largest)
    return VariableEntry(v.name, causality, variability, v.unit, v.description, "exact", start)
