"""The variables of a plant's FMU: causality, variability, initial, start, bounds."""

from __future__ import annotations

from fmus.declaration import Parameter, State, Variable
from fmus.packaging.plant.interface import Interface
from fmus.packaging.variables import VariableEntry


def variable_entries(interface: Interface) -> list[VariableEntry]:
    """Every variable in the order of value references."""
    return [
        VariableEntry("time", "independent", "continuous", "s", "Simulation time"),
        *(_state(interface, state) for state in interface.plant.states),
        *(_derivative(interface, state) for state in interface.plant.states),
        *(_input(variable) for variable in interface.plant.inputs),
        *(_output(variable) for variable in interface.outputs),
        *(_parameter(parameter) for parameter in interface.plant.parameters),
    ]


def _state(interface: Interface, s: State) -> VariableEntry:
    return VariableEntry(
        s.name,
        "output" if s.name in interface.state_outputs else "local",
        "continuous",
        s.unit,
        s.description,
        "exact",
        s.start,
        s.nominal,
    )


def _derivative(interface: Interface, s: State) -> VariableEntry:
    return VariableEntry(
        f"der({s.name})",
        "local",
        "continuous",
        rate_unit(s.unit),
        f"Time derivative of {s.name}",
        "calculated",
        derivative_of=interface.value_references[s.name],
    )


def _input(v: Variable) -> VariableEntry:
    return VariableEntry(
        v.name, "input", "continuous", v.unit, v.description, None, v.start, v.nominal
    )


def _output(v: Variable) -> VariableEntry:
    return VariableEntry(
        v.name, "output", "continuous", v.unit, v.description, "calculated", nominal=v.nominal
    )


def _parameter(p: Parameter) -> VariableEntry:
    return VariableEntry(
        p.name,
        "parameter",
        "tunable" if p.tunable else "fixed",
        p.unit,
        p.description,
        "exact",
        p.value,
        minimum=p.minimum,
        maximum=p.maximum,
    )


def rate_unit(unit: str) -> str:
    """The unit of a time derivative."""
    if unit in ("1", "-", ""):
        return "1/s"
    return f"{unit}/s" if "/" not in unit else f"({unit})/s"
