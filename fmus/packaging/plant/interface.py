"""The variables that an FMU shows, in one order with one numbering.

A value reference is the variable's place in the list `time, states, derivatives, inputs, outputs,
parameters`. The XML, the C tables and the portable module all take it from here. An output that
bears the name of a state *is* that state (causality output) and gets no second variable.

This module refuses to know equations, XML or C.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isfinite

from fmus.declaration import Parameter, PlantModel, State, Variable
from fmus.packaging.errors import PackagingError
from fmus.packaging.units import base_unit

# The solver's tolerance where the importer asks for none; that of state i is this times
# (nominal_i + |x_i|). Every state of every plant then stays within 1e-5 of its range, with a margin
# of two where the conformance tests excite it.
RELATIVE_TOLERANCE = 1e-6

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


@dataclass(frozen=True, eq=False)
class Interface:
    """The variables of `plant` with their value references; raises PackagingError when illegal."""

    plant: PlantModel

    def __post_init__(self) -> None:
        """Refuse names, start values and bounds that no FMU could carry."""
        _check_names(self)
        _check_values(self.plant)

    @cached_property
    def outputs(self) -> tuple[Variable, ...]:
        """The outputs that are variables of their own, in the plant's order."""
        states = {state.name for state in self.plant.states}
        return tuple(output for output in self.plant.outputs if output.name not in states)

    @cached_property
    def state_outputs(self) -> frozenset[str]:
        """Names of the states that are outputs too."""
        return frozenset(v.name for v in self.plant.outputs) & {s.name for s in self.plant.states}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Every variable's name; the index is the value reference."""
        return tuple(self._all_names())

    @cached_property
    def value_references(self) -> dict[str, int]:
        """Value reference by name."""
        return {name: reference for reference, name in enumerate(self.names)}

    def derivative_reference(self, state: State) -> int:
        """Value reference of the derivative of `state`."""
        return self.value_references[f"der({state.name})"]

    def _all_names(self) -> Iterator[str]:
        plant = self.plant
        yield "time"
        yield from (state.name for state in plant.states)
        yield from (f"der({state.name})" for state in plant.states)
        yield from (variable.name for variable in plant.inputs)
        yield from (variable.name for variable in self.outputs)
        yield from (parameter.name for parameter in plant.parameters)


def _check_names(interface: Interface) -> None:
    plant = interface.plant
    for name in (plant.name, *(n for n in interface.names if not n.startswith("der("))):
        if not _NAME.fullmatch(name):
            raise PackagingError(
                f"Plant {plant.name!r}: the name {name!r} is no identifier; use letters, digits "
                "and underscores, a digit not first."
            )
    output_names = [variable.name for variable in plant.outputs]
    names = [*interface.names, *(n for n in output_names if n in interface.state_outputs)]
    allowed = {name: 2 if name in interface.state_outputs else 1 for name in names}
    for name in names:
        if names.count(name) > allowed[name]:
            raise PackagingError(
                f"Plant {plant.name!r}: the name {name!r} is given to more than one variable; "
                "only an output may repeat a state's name, and 'time' is taken."
            )


def _check_values(plant: PlantModel) -> None:
    variables: tuple[State | Variable, ...] = (*plant.states, *plant.inputs, *plant.outputs)
    for variable in variables:
        if not (isfinite(variable.start) and isfinite(variable.nominal) and variable.nominal > 0):
            raise PackagingError(
                f"Plant {plant.name!r}: {variable.name!r} needs a finite start and a nominal above "
                f"0, got start={variable.start!r}, nominal={variable.nominal!r}."
            )
    for parameter in plant.parameters:
        _check_bounds(plant, parameter)
    named: dict[str, Sequence[State | Variable]] = {
        "state": plant.states,
        "input": plant.inputs,
        "output": plant.outputs,
    }
    for kind, own in named.items():
        for one in own:
            _check_unit(plant, f"{kind} {one.name!r}", one.unit)
    for parameter in plant.parameters:
        _check_unit(plant, f"parameter {parameter.name!r}", parameter.unit)


def _check_unit(plant: PlantModel, whose: str, unit: str) -> None:
    try:
        base_unit(unit)
    except PackagingError as fault:
        raise PackagingError(
            f"Plant {plant.name!r}: {whose}: {fault} Exponents are whole numbers; what "
            "has no unit, or one that FMI cannot write, has '1'."
        ) from fault


def _check_bounds(plant: PlantModel, parameter: Parameter) -> None:
    low = float("-inf") if parameter.minimum is None else parameter.minimum
    high = float("inf") if parameter.maximum is None else parameter.maximum
    if not (isfinite(parameter.value) and low <= parameter.value <= high):
        raise PackagingError(
            f"Plant {plant.name!r}: parameter {parameter.name!r} has the value {parameter.value!r}"
            f", which must be finite and between {low!r} and {high!r}."
        )
