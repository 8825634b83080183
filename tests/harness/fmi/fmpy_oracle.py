"""What FMPy's reader says of a description, compared with ours field by field.

FMPy shares the schema with the reader, and no code. Where FMPy 0.3 leaves something out or calls it
otherwise, the comparison names it.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import fmpy

from harness.errors import FmuError
from harness.fmi.description.model_description import ModelDescription, Variable
from harness.fmi.description.reader import read_model_description
from tests.fuzz.place import written

REALS = ("Real", "Float32", "Float64")


def both(content: bytes) -> tuple[ModelDescription, Any] | None:
    """What each of them makes of a document, None where one of them refuses it."""
    path = written("modelDescription.xml", content)
    try:
        ours, _ = read_model_description(path.parent, Path("compared.fmu"))
        return ours, fmpy.read_model_description(str(path), validate=False)
    except FmuError:
        return None
    except Exception:  # FMPy raises what it likes
        return None


def number(text: Any) -> float | None:
    return None if text is None else float(text)


def same(a: Any, b: Any) -> bool:
    return a == b or (isinstance(a, float) and isinstance(b, float) and math.isnan(a + b))


def variable_of(v: Variable) -> dict[str, Any]:
    """What both of them know of a variable."""
    return {
        "name": v.name, "reference": v.value_reference, "type": v.type, "causality": v.causality,
        "variability": v.variability, "initial": v.initial, "start": v.start,
        "unit": v.unit, "description": v.description, "shape": v.shape,
        "derivative": v.derivative_of, "clocks": v.details.clocks,
    }  # fmt: skip


def theirs_of(v: Any) -> dict[str, Any]:
    discrete = v.variability == "continuous" and v.type not in REALS
    declared = v.declaredType.unit if v.declaredType is not None and v.type in REALS else None
    return {
        "name": " ".join(v.name.splitlines()) if v.name.isprintable() else v.name,
        "reference": v.valueReference, "type": v.type, "causality": v.causality,
        "variability": "discrete" if discrete else v.variability, "initial": v.initial,
        "start": v.start, "unit": declared if v.unit is None else v.unit,
        "description": v.description or "", "shape": tuple(v.shape),
        "derivative": None if v.derivative is None else v.derivative.name,
        "clocks": tuple(one.name for one in v.clocks or ()),
    }  # fmt: skip


def compare(ours: ModelDescription, theirs: Any) -> None:
    assert ours.name == (theirs.modelName or "") and ours.fmi_version == theirs.fmiVersion
    assert ours.token == (theirs.guid or "")
    assert list(ours.variables) == list(dict.fromkeys(v.name for v in theirs.modelVariables))
    for v in theirs.modelVariables:
        mine, expected = variable_of(ours.variables[v.name]), theirs_of(v)
        assert mine == expected, {k: (mine[k], expected[k]) for k in mine if mine[k] != expected[k]}
        if v.declaredType is None:
            limits = ours.variables[v.name].minimum, ours.variables[v.name].maximum
            if not v.type.startswith("UInt"):  # FMPy reads no limits of them
                assert all(map(same, limits, (number(v.min), number(v.max))))
    units = {u.name: u.baseUnit for u in theirs.unitDefinitions}
    assert list(ours.units) == list(units)
    for name, base in units.items():
        exact = base and (base.kg, base.m, base.s, base.A, base.K, base.mol, base.cd, base.rad)
        assert ours.units[name].exponents == exact
        assert base is None or ours.units[name].factor == base.factor
    compare_structure(ours, theirs)
    compare_capabilities(ours, theirs)


def compare_structure(ours: ModelDescription, theirs: Any) -> None:
    lists = {
        "Output": theirs.outputs, "ContinuousStateDerivative": theirs.derivatives,
        "InitialUnknown": theirs.initialUnknowns, "EventIndicator": theirs.eventIndicators,
        "ClockedState": theirs.clockedStates,
    }  # fmt: skip
    for kind, unknowns in lists.items():
        expected = [
            (u.variable.name, u.dependencies and [v.name for v in u.dependencies]) for u in unknowns
        ]
        mine = [u for u in ours.unknowns if u.kind == kind]
        assert [
            (u.variable, None if u.dependencies is None else list(u.dependencies)) for u in mine
        ] == expected
    assert ours.number_of_continuous_states == theirs.numberOfContinuousStates
    assert ours.number_of_event_indicators == theirs.numberOfEventIndicators


def compare_capabilities(ours: ModelDescription, theirs: Any) -> None:
    kinds = (
        (ours.co_simulation, theirs.coSimulation), (ours.model_exchange, theirs.modelExchange),
        (ours.scheduled_execution, theirs.scheduledExecution),
    )  # fmt: skip
    for mine, other in kinds:
        assert (mine is None) == (other is None)
        if mine is None or ours.fmi_major == 1:  # FMPy reads none of FMI 1
            continue
        assert mine.model_identifier == other.modelIdentifier
        assert mine.can_get_and_set_fmu_state == other.canGetAndSetFMUstate
        assert mine.can_serialize_fmu_state == other.canSerializeFMUstate
        assert mine.needs_execution_tool == other.needsExecutionTool
        assert mine.can_be_instantiated_only_once == other.canBeInstantiatedOnlyOncePerProcess
        if other is theirs.modelExchange:
            assert mine.needs_completed_integrator_step == other.needsCompletedIntegratorStep
        if other is theirs.coSimulation:
            assert mine.can_handle_variable_step == other.canHandleVariableCommunicationStepSize
            assert mine.has_event_mode == other.hasEventMode
            assert mine.max_output_derivative_order == other.maxOutputDerivativeOrder
            assert mine.can_interpolate_inputs == other.canInterpolateInputs
            assert mine.provides_intermediate_update == other.providesIntermediateUpdate
