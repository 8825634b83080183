"""What an FMU says of itself, read and validated by FMPy, offered as frozen dataclasses.

All that the harness knows of an FMU's XML goes through this adapter. Documents with a DOCTYPE are
refused, so no entity is ever expanded.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from math import prod
from pathlib import Path
from typing import Any

from harness.errors import FmuError, UsageError, nearest
from harness.fmi.description.details import (
    Details,
    DisplayUnit,
    fmi1_capabilities,
    read_details,
    read_display_units,
)
from harness.fmi.description.document import Faults, faults_of, judge, read_document
from harness.fmi.description.value_checks import unit_faults, variable_faults
from harness.system.units import Unit

_SIZED = frozenset(f"{sign}{bits}" for sign in ("Int", "UInt") for bits in (8, 16, 32, 64))
INTEGER_TYPES = _SIZED | {"Integer", "Enumeration"}
REAL_TYPES = frozenset({"Real", "Float64", "Float32"})
MAX_ELEMENTS = 10**7
NUMERIC_TYPES = REAL_TYPES | INTEGER_TYPES | {"Boolean"}


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
    can_get_and_set_fmu_state: bool
    can_serialize_fmu_state: bool
    provides_directional_derivatives: bool
    provides_adjoint_derivatives: bool
    can_be_instantiated_only_once: bool
    can_handle_variable_step: bool = True
    fixed_internal_step_size: float | None = None
    has_event_mode: bool = False
    max_output_derivative_order: int = 0
    can_interpolate_inputs: bool = False
    needs_completed_integrator_step: bool = True
    might_return_early: bool = False
    needs_execution_tool: bool = False


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
    scheduled_execution: bool = False
    number_of_event_indicators: int = 0
    number_of_continuous_states: int = 0
    display_units: Mapping[str, Mapping[str, DisplayUnit]] = field(default_factory=dict)
    event_indicators: tuple[str, ...] = ()

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
        return {
            name: (variable, place)
            for variable in self.variables.values()
            if variable.shape
            for place, name in enumerate(element_names(variable))
            if name not in self.variables
        }

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

    def whole(self, name: str) -> tuple[str, ...]:
        """The elements of the array that `name` is, or is an element of; `name` for a scalar."""
        array = self.variables.get(self.owner(name))
        return element_names(array) if array is not None and array.shape else (name,)

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
        return replace(other, variables={**other.variables, **resized}) if structural else self

    def variable(self, name: str) -> Variable:
        """The variable of that name; raises `FmuError` with the nearest legal names."""
        try:
            return self.variables[name]
        except KeyError:
            hint = nearest(name, self.variables)
            raise FmuError(f"FMU {self.name} has no variable {name!r}; {hint}") from None


def element_names(array: Variable) -> tuple[str, ...]:
    """The names of an array's elements in the order of their values; indices begin at 1."""
    indices = product(*(range(1, 1 + length) for length in array.shape))
    return tuple(f"{array.name}[{','.join(map(str, index))}]" for index in indices)


def read_model_description(
    folder: Path, source: Path, passed: Faults | None = None
) -> ModelDescription:
    """Read the unpacked FMU in `folder`; `source` is the archive, for messages.

    Raises `FmuError` when the document is missing, malformed, invalid or of an unknown version.
    Where there is a list `passed`, faults that do not keep it from being read go there instead.
    """
    root, description = read_document(folder, source, passed)
    with faults_of(source):
        adapted = _adapt(description, root)
        judge(variable_faults(adapted.variables, adapted.fmi_major), source, passed)
        judge(unit_faults(adapted.units), source, passed)
    return adapted


def _directional(root: Any) -> frozenset[str]:
    """Interfaces with directional derivatives; FMPy 0.3.32 does not read FMI 3's spelling of it."""
    names = ("providesDirectionalDerivative", "providesDirectionalDerivatives")
    return frozenset(
        str(element.tag)
        for element in root.iterchildren("*")  # comments are no interfaces
        if any(element.get(name, "").strip() in ("true", "1") for name in names)
    )


def _adapt(d: Any, root: Any) -> ModelDescription:
    directional, details = _directional(root), read_details(root)
    names = {v.valueReference: v.name for v in reversed(d.modelVariables)}
    variables = {
        v.name: _variable(v, details.get(v.name, Details()), names) for v in d.modelVariables
    }
    fmi1 = fmi1_capabilities(root)
    experiment = d.defaultExperiment
    outputs = {u.variable.name: u for u in d.outputs if u.variable is not None}
    return ModelDescription(
        name=d.modelName,
        fmi_version=d.fmiVersion,
        token=d.instantiationToken or "",
        description=d.description or "",
        generation_tool=d.generationTool or "",
        co_simulation=_capabilities(d.coSimulation, "CoSimulation" in directional, fmi1),
        model_exchange=_capabilities(
            d.modelExchange,
            "ModelExchange" in directional,
            None if fmi1 is None else {"needs_completed_integrator_step": True},
        ),
        variables=variables,
        units={u.name: _unit(u) for u in d.unitDefinitions},
        feedthrough={name: _feedthrough(u, variables) for name, u in outputs.items()},
        states=tuple(
            (u.variable.derivative.name, u.variable.name)
            for u in d.derivatives
            if u.variable is not None and u.variable.derivative is not None
        ),
        start_time=_number(experiment and experiment.startTime),
        stop_time=_number(experiment and experiment.stopTime),
        step_size=_number(experiment and experiment.stepSize),
        tolerance=_number(experiment and experiment.tolerance),
        initial_feedthrough={
            u.variable.name: tuple(_feedthrough(u, variables) or ())
            for u in d.initialUnknowns
            if u.variable is not None and u.dependencies is not None
        },
        scheduled_execution=d.scheduledExecution is not None,
        number_of_event_indicators=d.numberOfEventIndicators,
        number_of_continuous_states=d.numberOfContinuousStates,
        display_units=read_display_units(root),
        event_indicators=tuple(u.variable.name for u in d.eventIndicators if u.variable),
    )


def _variable(v: Any, details: Details, names: Mapping[int, str]) -> Variable:
    shape = tuple(
        int(dimension.start if dimension.variable is None else dimension.variable.start)
        for dimension in v.dimensions
    )
    declared = v.declaredType
    return Variable(
        name=v.name,
        value_reference=v.valueReference,
        type=v.type,
        causality=v.causality or "local",
        variability=v.variability or "continuous",
        initial=v.initial,
        start=v.start,
        unit=v.unit or (declared.unit if declared is not None else None),
        description=v.description or "",
        minimum=_number(v.min),
        maximum=_number(v.max),
        nominal=_number(v.nominal),
        size=prod(shape),
        shape=shape,
        derivative_of=v.derivative.name if v.derivative is not None else None,
        dimensions=tuple(
            int(d.start) if d.variable is None else d.variable.name for d in v.dimensions
        ),
        details=replace(
            details,
            alias_of=v.alias.name if v.alias is not None else details.alias_of,
            clocks=tuple(names.get(int(one), one) for one in details.clocks),
        ),
    )


def _feedthrough(unknown: Any, variables: Mapping[str, Variable]) -> tuple[str, ...] | None:
    if unknown.dependencies is None:
        return None
    names = [v.name for v in unknown.dependencies]
    return tuple(name for name in names if variables[name].causality == "input")


def _capabilities(
    c: Any, directional: bool, fmi1: Mapping[str, Any] | None = None
) -> Capabilities | None:
    if c is None:
        return None
    found = Capabilities(
        model_identifier=c.modelIdentifier,
        can_get_and_set_fmu_state=bool(c.canGetAndSetFMUstate),
        can_serialize_fmu_state=bool(c.canSerializeFMUstate),
        provides_directional_derivatives=directional,
        provides_adjoint_derivatives=bool(c.providesAdjointDerivatives),
        can_be_instantiated_only_once=bool(c.canBeInstantiatedOnlyOncePerProcess),
        can_handle_variable_step=bool(getattr(c, "canHandleVariableCommunicationStepSize", True)),
        fixed_internal_step_size=_number(getattr(c, "fixedInternalStepSize", None)),
        has_event_mode=bool(getattr(c, "hasEventMode", False)),
        max_output_derivative_order=int(getattr(c, "maxOutputDerivativeOrder", 0) or 0),
        can_interpolate_inputs=bool(getattr(c, "canInterpolateInputs", False)),
        needs_completed_integrator_step=bool(getattr(c, "needsCompletedIntegratorStep", True)),
        might_return_early=bool(getattr(c, "mightReturnEarlyFromDoStep", False)),
        needs_execution_tool=bool(c.needsExecutionTool),
    )
    return replace(found, **fmi1) if fmi1 else found


def _unit(u: Any) -> Unit:
    if u.baseUnit is None:
        return Unit(u.name)
    b = u.baseUnit
    exponents = tuple(
        int(getattr(b, name)) for name in ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
    )
    return Unit(u.name, exponents, float(b.factor), float(b.offset))


def _number(text: Any) -> float | None:
    return None if text is None else float(text)
