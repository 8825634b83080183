"""Reads an unpacked FMU's documents into a `ModelDescription`, with what is wrong with them.

The document is parsed once, held against the schema of the standard, and read; whatever the
numbers in it claim, nothing of their size is allocated, and those that cannot be meant (a step
size below 0, say) are left out and told.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from harness.fmi.description.additions import read_layered_standards, read_terminals
from harness.fmi.description.document import model_description_root, schema_faults
from harness.fmi.description.faults import Fault, Harm, notes, quoted
from harness.fmi.description.model_description import (
    Capabilities,
    DisplayUnit,
    ModelDescription,
    Variable,
)
from harness.fmi.description.numbers import real, true, whole
from harness.fmi.description.structure import (
    circle_faults,
    direct_dependencies,
    feedthrough,
    read_unknowns,
)
from harness.fmi.description.variables import MAX_ELEMENTS, VariableReader
from harness.fmi.wording import has_control_characters, shorten
from harness.system.units import Unit

_INTERFACES = ("CoSimulation", "ModelExchange", "ScheduledExecution")
_BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_Units = dict[str, Unit]
_DisplayUnits = dict[str, dict[str, DisplayUnit]]


def read_model_description(
    folder: Path, source: Path, *, validate: bool = True
) -> tuple[ModelDescription, tuple[Fault, ...]]:
    """Read the unpacked FMU in `folder`; `source` is the archive, for messages.

    Returns what it says and the faults that were let pass. Raises `FmuError` when the document is
    missing, malformed, of an unknown version, could do harm, or, where `validate`, leaves open
    what it means.
    """
    root = model_description_root(folder, source)
    faults = list(schema_faults(root))
    described = _Reader(root, faults).description(folder)
    faults += circle_faults(described.variables)
    notes(faults, source, validate)
    return described, tuple(faults)


class _Reader:
    def __init__(self, root: Any, faults: list[Fault]) -> None:
        self.root, self.faults = root, faults
        self.major = int(root.get("fmiVersion")[0])

    def description(self, folder: Path) -> ModelDescription:
        root, major = self.root, self.major
        self._judge_name("modelName", root, r"")
        units, display_units = self._units()
        reader = VariableReader(root, major, dict(_types(root)), display_units, self.faults)
        variables = reader.variables()
        unknowns = tuple(read_unknowns(root, major, reader.numbered, self.faults))
        described = {kind: self._capabilities(kind) for kind in _INTERFACES}
        of_outputs = feedthrough(unknowns, "Output", variables)
        initial = feedthrough(unknowns, "InitialUnknown", variables)
        rates = [u.variable for u in unknowns if u.kind == "ContinuousStateDerivative"]
        indicators = [u.variable for u in unknowns if u.kind == "EventIndicator"]
        return ModelDescription(
            name=root.get("modelName", ""),
            fmi_version=root.get("fmiVersion"),
            token=root.get("instantiationToken" if major == 3 else "guid", ""),
            description=root.get("description", ""),
            generation_tool=root.get("generationTool", ""),
            co_simulation=described["CoSimulation"],
            model_exchange=described["ModelExchange"],
            variables=variables,
            units=units,
            feedthrough=direct_dependencies(root, variables) if major == 1 else of_outputs,
            states=tuple(
                (state, rate) for rate in rates if (state := variables[rate].derivative_of)
            ),
            **self._experiment(),
            initial_feedthrough={n: names for n, names in initial.items() if names is not None},
            scheduled_execution=described["ScheduledExecution"],
            number_of_event_indicators=self._count("EventIndicators", indicators, variables),
            number_of_continuous_states=self._count("ContinuousStates", rates, variables),
            display_units=display_units,
            event_indicators=tuple(indicators),
            unknowns=unknowns,
            terminals=tuple(read_terminals(folder, variables, self.faults)),
            layered_standards=tuple(read_layered_standards(folder, self.faults)),
        )

    def _tell(self, harm: Harm, text: str, element: Any) -> None:
        self.faults.append(Fault(harm, text, element.sourceline or 0))

    def _judge_name(self, attribute: str, element: Any, forbidden: str) -> None:
        """A model identifier is a file's name; one with a path would load any library there is."""
        name = element.get(attribute, "")
        if forbidden and (re.search(forbidden, name) or not name.strip(". ")):
            text = f"has the {attribute} {quoted(name)}, which is no name of a file"
            self._tell(Harm.FORBIDDEN, text, element)
        if has_control_characters(name):
            text = f"has control characters in its {attribute} {shorten(name)!r}"
            self._tell(Harm.FORBIDDEN, text, element)

    def _count(self, what: str, unknowns: list[str], variables: Mapping[str, Variable]) -> int:
        """How many states or event indicators there are, each element of an array one."""
        if self.major == 3:
            return sum(variables[name].size for name in unknowns)
        stated = whole(self.root.get(f"numberOf{what}")) or 0
        if not 0 <= stated <= MAX_ELEMENTS:
            text = f"says numberOf{what}={stated}; at most {MAX_ELEMENTS} can be held"
            self._tell(Harm.FORBIDDEN, text, self.root)
        return len(unknowns) if (self.major, what) == (2, "ContinuousStates") else stated

    def _positive(self, element: Any, attribute: str) -> float | None:
        """A step size or tolerance; None where there is none that can be meant."""
        value = real(element.get(attribute))
        if value is None or (value > 0.0 and math.isfinite(value)):
            return value
        text = f"says {attribute}={value:g}, which is disregarded: it must be positive and finite"
        self._tell(Harm.NONE, text, element)
        return None

    def _experiment(self) -> dict[str, float | None]:
        element = self.root.find("DefaultExperiment")
        if element is None:
            return dict.fromkeys(("start_time", "stop_time", "step_size", "tolerance"))
        start, stop = real(element.get("startTime")), real(element.get("stopTime"))
        for name, value in (("startTime", start), ("stopTime", stop)):
            if value is not None and not math.isfinite(value):
                self._tell(Harm.NONE, f"says {name}={value:g}, which is disregarded", element)
        start = start if start is not None and math.isfinite(start) else None
        stop = stop if stop is not None and math.isfinite(stop) else None
        if stop is not None and stop < (start or 0.0):
            text = f"says stopTime={stop:g}, which is disregarded: it lies before its startTime"
            self._tell(Harm.NONE, text, element)
            stop = None
        return {
            "start_time": start,
            "stop_time": stop,
            "step_size": self._positive(element, "stepSize"),
            "tolerance": self._positive(element, "tolerance"),
        }

    def _capabilities(self, kind: str) -> Capabilities | None:
        if self.major == 1:
            return self._fmi1_capabilities(kind)
        element = self.root.find(kind)
        if element is None:
            return None
        state = "FMUState" if self.major == 3 else "FMUstate"
        steps, exchanges = kind == "CoSimulation", kind == "ModelExchange"
        self._judge_name("modelIdentifier", element, r'[/\\:*?"<>|]')

        def can(name: str) -> bool:
            return true(element.get(name))

        def count(name: str) -> int:
            return (whole(element.get(name)) or 0) if steps else 0

        completed = can("needsCompletedIntegratorStep")
        if self.major == 2:
            completed = not can("completedIntegratorStepNotNeeded")
        return Capabilities(
            model_identifier=element.get("modelIdentifier", ""),
            can_get_and_set_fmu_state=can(f"canGetAndSet{state}"),
            can_serialize_fmu_state=can(f"canSerialize{state}"),
            provides_directional_derivatives=(
                can("providesDirectionalDerivative") or can("providesDirectionalDerivatives")
            ),
            provides_adjoint_derivatives=can("providesAdjointDerivatives"),
            can_be_instantiated_only_once=can("canBeInstantiatedOnlyOncePerProcess"),
            can_handle_variable_step=not steps or can("canHandleVariableCommunicationStepSize"),
            fixed_internal_step_size=(
                self._positive(element, "fixedInternalStepSize") if steps else None
            ),
            has_event_mode=steps and can("hasEventMode"),
            max_output_derivative_order=count("maxOutputDerivativeOrder"),
            can_interpolate_inputs=steps and can("canInterpolateInputs"),
            needs_completed_integrator_step=completed or not exchanges,
            might_return_early=steps and can("mightReturnEarlyFromDoStep"),
            needs_execution_tool=can("needsExecutionTool"),
            provides_intermediate_update=steps
            and (can("providesIntermediateUpdate") or can("provideIntermediateState")),
            can_return_early_after_intermediate_update=(
                steps and can("canReturnEarlyAfterIntermediateUpdate")
            ),
            recommended_intermediate_input_smoothness=(
                count("recommendedIntermediateInputSmoothness")
            ),
            provides_evaluate_discrete_states=can("providesEvaluateDiscreteStates"),
        )

    def _fmi1_capabilities(self, kind: str) -> Capabilities | None:
        """FMI 1 for co-simulation has an Implementation, FMI 1 for model exchange has none."""
        root = self.root
        implementation = root.find("Implementation")
        if kind != ("ModelExchange" if implementation is None else "CoSimulation"):
            return None
        self._judge_name("modelIdentifier", root, r'[/\\:*?"<>|]')
        element = next(root.iterfind("Implementation//Capabilities"), None)
        stated: Mapping[str, str] = {} if element is None else element.attrib
        return Capabilities(
            root.get("modelIdentifier", ""), False, False, False, False,
            true(stated.get("canBeInstantiatedOnlyOncePerProcess")),
            can_handle_variable_step=(
                implementation is None or true(stated.get("canHandleVariableCommunicationStepSize"))
            ),
            max_output_derivative_order=whole(stated.get("maxOutputDerivativeOrder")) or 0,
            can_interpolate_inputs=true(stated.get("canInterpolateInputs")),
            needs_execution_tool=root.find("Implementation/CoSimulation_Tool") is not None,
        )  # fmt: skip

    def _units(self) -> tuple[_Units, _DisplayUnits]:
        """The units, and the display units of each by name."""
        units: _Units = {}
        shown: _DisplayUnits = {}
        for element in _children(self.root.find("UnitDefinitions")):
            name = str(element.get("unit" if self.major == 1 else "name"))
            base = element.find("BaseUnit") if self.major > 1 else None
            units[name] = Unit(name)
            if base is not None:
                exponents = tuple(whole(base.get(one)) or 0 for one in _BASES)
                factor, offset = self._conversion(base, "factor", f"unit {quoted(name)}")
                units[name] = Unit(name, exponents, factor, offset)
            of_unit = shown.setdefault(name, {})
            for one in _children(element):
                if one.tag in ("DisplayUnit", "DisplayUnitDefinition"):
                    label = str(one.get("displayUnit" if self.major == 1 else "name"))
                    what, gain = f"display unit {quoted(label)}", "factor"
                    numbers = self._conversion(one, "gain" if self.major == 1 else gain, what)
                    of_unit[label] = DisplayUnit(*numbers, true(one.get("inverse")))
        return units, shown

    def _conversion(self, element: Any, gain: str, what: str) -> tuple[float, float]:
        """Factor and offset; a factor of 0 or one that is not finite converts nothing."""
        factor, offset = real(element.get(gain, "1")), real(element.get("offset", "0"))
        if factor and math.isfinite(factor) and offset is not None and math.isfinite(offset):
            return factor, offset
        shown = f"factor {element.get(gain, '1')} and offset {element.get('offset', '0')}"
        text = f"has the {what} with {shorten(shown)}, by which nothing can be converted"
        self._tell(Harm.AMBIGUOUS, text, element)
        return 1.0, 0.0


def _types(root: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    """Attributes of declared types by name; "items" are those of enumerations."""
    for element in _children(root.find("TypeDefinitions")):
        inner = element
        if element.tag in ("Type", "SimpleType"):
            inner = next(_children(element), element)
        attributes: dict[str, Any] = dict(inner.attrib)
        items = enumerate(inner.iterchildren("Item"), start=1)
        numbers = ((whole(item.get("value", str(place))), item) for place, item in items)
        attributes["items"] = tuple(
            (number, str(item.get("name"))) for number, item in numbers if number is not None
        )
        yield str(element.get("name")), attributes


def _children(parent: Any) -> Iterator[Any]:
    """Child elements without comments and processing instructions."""
    return iter(()) if parent is None else iter(parent.iterchildren("*"))
