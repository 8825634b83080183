"""What an FMU says that it can do, by kind of interface, and the experiment that it suggests.

Step sizes, tolerances and times that cannot be meant are None, and told.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from harness.fmi.description.faults import Fault, Harm, quoted
from harness.fmi.description.model_description import Capabilities
from harness.fmi.description.numbers import boolean, integer, real
from harness.fmi.wording import has_control_characters

_OF_ALL = {
    "can_get_and_set_fmu_state": ("canGetAndSetFMUState",),
    "can_serialize_fmu_state": ("canSerializeFMUState",),
    "provides_directional_derivatives": (
        "providesDirectionalDerivative",
        "providesDirectionalDerivatives",
    ),
    "provides_adjoint_derivatives": ("providesAdjointDerivatives",),
    "can_be_instantiated_only_once": ("canBeInstantiatedOnlyOncePerProcess",),
    "needs_execution_tool": ("needsExecutionTool",),
    "provides_evaluate_discrete_states": ("providesEvaluateDiscreteStates",),
}
_OF_STEPS = {
    "can_handle_variable_step": ("canHandleVariableCommunicationStepSize",),
    "has_event_mode": ("hasEventMode",),
    "can_interpolate_inputs": ("canInterpolateInputs",),
    "might_return_early": ("mightReturnEarlyFromDoStep",),
    "provides_intermediate_update": ("providesIntermediateUpdate", "provideIntermediateState"),
    "can_return_early_after_intermediate_update": ("canReturnEarlyAfterIntermediateUpdate",),
}
_ORDERS = {
    "max_output_derivative_order": "maxOutputDerivativeOrder",
    "recommended_intermediate_input_smoothness": "recommendedIntermediateInputSmoothness",
}


def judge_name(element: Any, attribute: str, faults: list[Fault], *, of_file: bool = False) -> None:
    """A model identifier is a file's name; one with a path would load any library there is."""
    name, wrong = element.get(attribute, ""), ""
    if of_file and (re.search(r'[/\\:*?"<>|]', name) or not name.strip(". ")):
        wrong = f"has the {attribute} {quoted(name)}, which is no name of a file"
    elif has_control_characters(name):
        wrong = f"has control characters in its {attribute} {quoted(name)}"
    if wrong:
        faults.append(Fault(Harm.FORBIDDEN, wrong, element.sourceline or 0))


def experiment(element: Any, faults: list[Fault]) -> dict[str, float | None]:
    """Start and stop time, step size and tolerance of <DefaultExperiment>, which may be None."""
    if element is None:
        return dict.fromkeys(("start_time", "stop_time", "step_size", "tolerance"))
    start = _judged(element, "startTime", -math.inf, faults)
    stop = _judged(element, "stopTime", start or 0.0, faults, also_equal=True)
    step = _judged(element, "stepSize", 0.0, faults)
    tolerance = _judged(element, "tolerance", 0.0, faults)
    return {"start_time": start, "stop_time": stop, "step_size": step, "tolerance": tolerance}


def _judged(
    element: Any, attribute: str, above: float, faults: list[Fault], *, also_equal: bool = False
) -> float | None:
    """A finite number above another; None where there is none."""
    value = real(element.get(attribute))
    if value is None or (
        math.isfinite(value) and (value > above or (also_equal and value == above))
    ):
        return value
    wanted = "finite" if above == -math.inf else f"finite and above {above:g}"
    text = f"says {attribute}={value:g}, which is disregarded: it must be {wanted}"
    faults.append(Fault(Harm.NONE, text, element.sourceline or 0))
    return None


def capabilities(root: Any, major: int, kind: str, faults: list[Fault]) -> Capabilities | None:
    """Those of <CoSimulation>, <ModelExchange> or <ScheduledExecution>; FMI 1 for co-simulation
    has an Implementation, FMI 1 for model exchange has none."""
    steps = kind == "CoSimulation"
    if major > 1:
        named = element = root.find(kind)
    else:
        implementation = root.find("Implementation")
        fits = kind == ("ModelExchange" if implementation is None else "CoSimulation")
        named = root if fits else None
        element = next(root.iterfind("Implementation//Capabilities"), None)
    if named is None:
        return None
    judge_name(named, "modelIdentifier", faults, of_file=True)
    stated: Mapping[str, str] = {} if element is None else element.attrib
    found: dict[str, Any] = {
        field: any(boolean(stated.get(_spelled(name, major))) for name in attributes)
        for field, attributes in (_OF_ALL | _OF_STEPS if steps else _OF_ALL).items()
    }
    if steps:
        found |= {field: integer(stated.get(name)) or 0 for field, name in _ORDERS.items()}
        if major > 1:
            step = _judged(element, "fixedInternalStepSize", 0.0, faults)
            found["fixed_internal_step_size"] = step
    if kind == "ModelExchange" and major == 2:
        completed = not boolean(stated.get("completedIntegratorStepNotNeeded"))
        found["needs_completed_integrator_step"] = completed
    elif kind == "ModelExchange" and major == 3:
        completed = boolean(stated.get("needsCompletedIntegratorStep"))
        found["needs_completed_integrator_step"] = completed
    if major == 1:
        tool = root.find("Implementation/CoSimulation_Tool")
        found["needs_execution_tool"] = tool is not None
    return Capabilities(model_identifier=named.get("modelIdentifier", ""), **found)


def _spelled(name: str, major: int) -> str:
    return name if major == 3 else name.replace("FMUState", "FMUstate")
