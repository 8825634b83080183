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
from harness.fmi.description.numbers import real, true, whole
from harness.fmi.wording import has_control_characters


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
    """Those of <CoSimulation>, <ModelExchange> or <ScheduledExecution>."""
    if major == 1:
        return _fmi1_capabilities(root, kind, faults)
    element = root.find(kind)
    if element is None:
        return None
    state = "FMUState" if major == 3 else "FMUstate"
    steps, exchanges = kind == "CoSimulation", kind == "ModelExchange"
    judge_name(element, "modelIdentifier", faults, of_file=True)

    def can(name: str) -> bool:
        return true(element.get(name))

    def count(name: str) -> int:
        return (whole(element.get(name)) or 0) if steps else 0

    completed = can("needsCompletedIntegratorStep")
    if major == 2:
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
            _judged(element, "fixedInternalStepSize", 0.0, faults) if steps else None
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
        recommended_intermediate_input_smoothness=(count("recommendedIntermediateInputSmoothness")),
        provides_evaluate_discrete_states=can("providesEvaluateDiscreteStates"),
    )


def _fmi1_capabilities(root: Any, kind: str, faults: list[Fault]) -> Capabilities | None:
    """FMI 1 for co-simulation has an Implementation, FMI 1 for model exchange has none."""
    implementation = root.find("Implementation")
    if kind != ("ModelExchange" if implementation is None else "CoSimulation"):
        return None
    judge_name(root, "modelIdentifier", faults, of_file=True)
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
