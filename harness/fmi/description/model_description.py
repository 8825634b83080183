"""What an FMU says of itself, as frozen dataclasses; `reader` makes them of its documents."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from math import prod

import numpy as np

from harness.errors import FmuError, UsageError, nearest
from harness.system.units import Unit

_SIZED = frozenset(f"{sign}{bits}" for sign in ("Int", "UInt") for bits in (8, 16, 32, 64))
INTEGER_TYPES = _SIZED | {"Integer", "Enumeration"}
REAL_TYPES = frozenset({"Real", "Float64", "Float32"})
MAX_ELEMENTS = 10**7
"""Elements of an array, and of all that a description states, together."""
NUMERIC_TYPES = REAL_TYPES | INTEGER_TYPES | {"Boolean"}
_ELEMENT = re.compile(r"(.+)\[([1-9]\d{0,17}(?:,[1-9]\d{0,17})*)\]", re.ASCII | re.DOTALL)


@dataclass(frozen=True)
class DisplayUnit:
    """display value = `factor` * value + `offset`; where `inverse`, `factor` / value."""

    factor: float = 1.0
    offset: float = 0.0
    inverse: bool = False


@dataclass(frozen=True)
class Details:
    """What only some variables have.

    `alias_of`: the variable of which this is another name; `negated`: with the opposite sign
    (FMI 1). `relative`: a difference, such as of temperatures, whose unit conversion has no offset.
    `starts`: the start values of an array of strings or binaries. `items`: names of an
    enumeration by number. For clocks: `interval_variability`, `interval` and `shift` (s, as the
    fraction counter over resolution where given so), `can_be_deactivated`, and the `priority`
    (scheduled execution; lower is more urgent). `clocks`: the clocks of a clocked variable, by
    name; `previous`: the variable that holds its value of the tick before. `intermediate_update`:
    it may be accessed in intermediate update mode; `reinit`: a state that events may set anew.
    """

    alias_of: str | None = None
    negated: bool = False
    relative: bool = False
    display_unit: str | None = None
    declared_type: str | None = None
    starts: tuple[str, ...] = ()
    items: tuple[tuple[int, str], ...] = ()
    interval_variability: str | None = None
    interval: tuple[int, int] | float | None = None
    shift: tuple[int, int] | float = 0.0
    can_be_deactivated: bool = False
    clocks: tuple[str, ...] = ()
    has_start: bool = True
    multiple_sets: bool = True
    priority: int | None = None
    previous: str | None = None
    intermediate_update: bool = False
    reinit: bool = False


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU; `size` is the number of scalars (1, or more for an FMI 3 array of
    `shape`) as the file gives it. `dimensions` are the sizes of an array, a name where a
    structural parameter holds the size; `details` is what only some variables have."""

    name: str
    value_reference: int
    type: str
    causality: str
    variability: str
    initial: str | None
    start: str | None
    unit: str | None
    description: str
    minimum: float | None
    maximum: float | None
    nominal: float | None
    size: int = 1
    derivative_of: str | None = None
    shape: tuple[int, ...] = ()
    dimensions: tuple[int | str, ...] = ()
    details: Details = field(default_factory=Details)


@dataclass(frozen=True)
class Capabilities:
    """What the FMU can do in one kind of interface; `model_identifier` names its library."""

    model_identifier: str
    can_get_and_set_fmu_state: bool = False
    can_serialize_fmu_state: bool = False
    provides_directional_derivatives: bool = False
    provides_adjoint_derivatives: bool = False
    can_be_instantiated_only_once: bool = False
    can_handle_variable_step: bool = True
    fixed_internal_step_size: float | None = None
    has_event_mode: bool = False
    max_output_derivative_order: int = 0
    can_interpolate_inputs: bool = False
    needs_completed_integrator_step: bool = True
    might_return_early: bool = False
    needs_execution_tool: bool = False
    provides_intermediate_update: bool = False
    can_return_early_after_intermediate_update: bool = False
    recommended_intermediate_input_smoothness: int = 0
    provides_evaluate_discrete_states: bool = False


@dataclass(frozen=True)
class Unknown:
    """A variable that the FMU computes, as its model structure lists it.

    `kind`: "Output", "ContinuousStateDerivative", "ClockedState", "InitialUnknown" or
    "EventIndicator". `dependencies`: the variables on which it depends, by name, None where it does
    not say; `dependency_kinds`: how, one for each. `line` is that of the document.
    """

    kind: str
    variable: str
    dependencies: tuple[str, ...] | None
    dependency_kinds: tuple[str, ...] | None = None
    line: int = 0


@dataclass(frozen=True)
class Member:
    """A variable of a terminal by its name there (as a connector has it) and its kind, such as
    "signal", "inflow" or "outflow"."""

    variable: str
    name: str
    kind: str


@dataclass(frozen=True)
class Terminal:
    """Variables that are connected together; `matching_rule` ("plug", "bus", "sequence" or one of
    a tool) says how they find those of another terminal. `terminals` are those inside."""

    name: str
    matching_rule: str
    kind: str = ""
    description: str = ""
    members: tuple[Member, ...] = ()
    terminals: tuple[Terminal, ...] = ()


@dataclass(frozen=True)
class LayeredStandard:
    """A standard on top of FMI that the FMU follows, as its manifest names it."""

    name: str
    version: str
    description: str


@dataclass(frozen=True)
class ModelDescription:
    """Identity, capabilities, variables and structure of an FMU.

    `feedthrough` maps an output's name to the inputs on which it depends directly, or to None
    where the FMU does not say (then it may depend on all); `initial_feedthrough` holds those
    outputs for which it says something else for the initialisation. `states` are the names of the
    continuous states with their derivatives' names, in the order of the model structure.
    """

    name: str
    fmi_version: str
    token: str
    description: str
    generation_tool: str
    co_simulation: Capabilities | None
    model_exchange: Capabilities | None
    variables: Mapping[str, Variable]
    units: Mapping[str, Unit]
    feedthrough: Mapping[str, tuple[str, ...] | None]
    states: tuple[tuple[str, str], ...]
    start_time: float | None
    stop_time: float | None
    step_size: float | None
    tolerance: float | None
    initial_feedthrough: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    scheduled_execution: Capabilities | None = None
    number_of_event_indicators: int = 0
    number_of_continuous_states: int = 0
    display_units: Mapping[str, Mapping[str, DisplayUnit]] = field(default_factory=dict)
    event_indicators: tuple[str, ...] = ()
    structured_names: bool = False
    unknowns: tuple[Unknown, ...] = ()
    terminals: tuple[Terminal, ...] = ()
    layered_standards: tuple[LayeredStandard, ...] = ()

    @property
    def fmi_major(self) -> int:
        """1, 2 or 3."""
        return int(self.fmi_version.split(".")[0])

    @cached_property
    def inputs(self) -> tuple[Variable, ...]:
        """The input variables in the order of the file."""
        return tuple(v for v in self.variables.values() if v.causality == "input")

    @cached_property
    def outputs(self) -> tuple[Variable, ...]:
        """The output variables in the order of the file."""
        return tuple(v for v in self.variables.values() if v.causality == "output")

    @cached_property
    def elements(self) -> Mapping[str, tuple[Variable, int]]:
        """Array and place (from 0, the last index fastest) of each element: "a[1]", "a[2,3]"."""
        return _Elements(self.variables)

    def port(self, name: str) -> Variable:
        """The variable of that name, or the element of an array as a variable of its own.

        Raises `FmuError` like `variable`.
        """
        if name not in self.elements:
            return self.variable(name)
        array, place = self.elements[name]
        starts = str(array.start).split() if array.start is not None else []
        start = starts[place if len(starts) > 1 else 0] if starts else None
        return replace(array, name=name, size=1, dimensions=(), shape=(), start=start)

    def owner(self, name: str) -> str:
        """The array of which `name` is an element; `name` for anything else."""
        return self.elements[name][0].name if name in self.elements else name

    def scalars(self, name: str) -> tuple[str, ...]:
        """The elements of the array that `name` is, or is an element of; `name` for a scalar."""
        array = self.variables.get(self.owner(name))
        return (name,) if array is None else element_names(array.name, array.shape)

    def sizes(self, array: Variable) -> tuple[int, ...]:
        """The sizes of an array by the structural parameters; () for a scalar."""
        return tuple(
            one if isinstance(one, int) else int(self.variables[one].start or 0)
            for one in array.dimensions
        )

    def configured(self, structural: Mapping[str, int]) -> ModelDescription:
        """With other values of structural parameters, and arrays of the sizes that follow.

        Raises `UsageError` for an array of more than `MAX_ELEMENTS`.
        """
        if not structural:
            return self
        starts = {n: replace(self.variables[n], start=str(v)) for n, v in structural.items()}
        other = replace(self, variables={**self.variables, **starts})
        resized = {
            v.name: replace(v, shape=shape, size=prod(shape), start=v.start if keeps else None)
            for v in self.variables.values()
            if set(v.dimensions) & set(structural)
            for shape in (other.sizes(v),)
            for keeps in (len(str(v.start).split()) in (1, prod(shape)),)
        }
        for v in resized.values():
            if v.size > MAX_ELEMENTS:
                raise UsageError(
                    f"FMU {self.name}: array {v.name!r} would have {v.size} elements by its "
                    f"structural parameters; at most {MAX_ELEMENTS} are taken"
                )
        return replace(other, variables={**other.variables, **resized})

    def variable(self, name: str) -> Variable:
        """The variable of that name; raises `FmuError` with the nearest legal names."""
        try:
            return self.variables[name]
        except KeyError:
            hint = nearest(name, self.variables)
            raise FmuError(f"FMU {self.name} has no variable {name!r}; {hint}") from None


def element_names(name: str, shape: tuple[int, ...]) -> tuple[str, ...]:
    """The name of a scalar, or those of an array's elements in row-major order, such as "a[1,2]";
    indices begin at 1."""
    if not shape:
        return (name,)
    indices = product(*(range(1, 1 + length) for length in shape))
    return tuple(f"{name}[{','.join(map(str, index))}]" for index in indices)


class _Elements(Mapping[str, tuple[Variable, int]]):
    """Looked up by taking the name to pieces, since an array may have millions of elements."""

    def __init__(self, variables: Mapping[str, Variable]) -> None:
        self._variables = variables
        self._arrays = [v for v in variables.values() if v.shape]

    def __getitem__(self, name: str) -> tuple[Variable, int]:
        match = _ELEMENT.fullmatch(name)
        array = self._variables.get(match[1]) if match else None
        if match is None or array is None or name in self._variables:
            raise KeyError(name)
        try:
            index = [int(one) - 1 for one in match[2].split(",")]
            return array, int(np.ravel_multi_index(index, array.shape))
        except ValueError:
            raise KeyError(name) from None

    def __iter__(self) -> Iterator[str]:
        names = (name for v in self._arrays for name in element_names(v.name, v.shape))
        return (name for name in names if name not in self._variables)

    def __len__(self) -> int:
        return sum(1 for _ in self)


def outside(v: Variable, value: float) -> str:
    """How `value` lies outside the limits of a variable, as in "above its max 3", or ""."""
    if v.minimum is not None and value < v.minimum:
        return f"below its min {v.minimum:g}"
    if v.maximum is not None and value > v.maximum:
        return f"above its max {v.maximum:g}"
    return ""
