"""What an FMU says that it can do, by kind of interface, and the experiment that it suggests.

Step sizes, tolerances and times that cannot be meant are None, and told.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any

from harness.fmi.description.document import Document
from harness.fmi.description.faults import Harm, quoted
from harness.fmi.description.model_description import Capabilities
from harness.fmi.description.numbers import boolean, integer, real
from harness.fmi.wording import has_control_characters

_SPELLED = {
    "can_be_instantiated_only_once": "can_be_instantiated_only_once_per_process",
    "can_handle_variable_step": "can_handle_variable_communication_step_size",
    "might_return_early": "might_return_early_from_do_step",
}
_PARSED: dict[Any, Callable[[str], Any]] = {
    "bool": boolean, "int": lambda text: integer(text) or 0,
}  # fmt: skip
"""Attributes by the type of their field."""


def judge_name(document: Document, element: Any, attribute: str, *, of_file: bool = False) -> None:
    """A model identifier is a file's name; one with a path would load any library there is."""
    name = element.get(attribute, "")
    if of_file and (re.search(r'[/\\:*?"<>|]', name) or not name.strip(". ")):
        wrong = f"has the {attribute} {quoted(name)}, which is no name of a file"
        document.tell(element, wrong, Harm.FORBIDDEN)
    elif has_control_characters(name):
        wrong = f"has control characters in its {attribute} {quoted(name)}"
        document.tell(element, wrong, Harm.FORBIDDEN)


def experiment(document: Document) -> dict[str, float | None]:
    """Start and stop time, step size and tolerance of <DefaultExperiment>, which may be None."""
    element = document.root.find("DefaultExperiment")
    element = {} if element is None else element
    start = _judged(document, element, "startTime", -math.inf)
    return {
        "start_time": start,
        "stop_time": _judged(document, element, "stopTime", start or 0.0, also_equal=True),
        "step_size": _judged(document, element, "stepSize", 0.0),
        "tolerance": _judged(document, element, "tolerance", 0.0),
    }


def _judged(
    document: Document, element: Any, attribute: str, above: float, *, also_equal: bool = False
) -> float | None:
    """A finite number above another; None where there is none."""
    value = real(element.get(attribute))
    if value is None or (
        math.isfinite(value) and (value > above or (also_equal and value == above))
    ):
        return value
    wanted = "finite" if above == -math.inf else f"finite and above {above:g}"
    text = f"says {attribute}={value:g}, which is disregarded: it must be {wanted}"
    document.tell(element, text)
    return None


def capabilities(document: Document, kind: str) -> Capabilities | None:
    """Those of <CoSimulation>, <ModelExchange> or <ScheduledExecution>; FMI 1 for co-simulation
    has an Implementation, FMI 1 for model exchange has none."""
    root, major = document.root, document.major
    named = element = root.find(kind)
    if major == 1:
        implemented = root.find("Implementation") is not None
        named = root if kind == ("CoSimulation" if implemented else "ModelExchange") else None
        element = next(root.iterfind("Implementation//Capabilities"), None)
    if named is None:
        return None
    judge_name(document, named, "modelIdentifier", of_file=True)
    stated: Mapping[str, str] = {} if element is None else element.attrib
    found: dict[str, Any] = {
        "model_identifier": named.get("modelIdentifier", ""),
        "can_handle_variable_step": kind != "CoSimulation",
        "needs_completed_integrator_step": major < 3 or kind != "ModelExchange",
    }
    for field in fields(Capabilities):
        attribute = _attribute(field.name, major)
        if attribute in stated and field.type in _PARSED:
            found[field.name] = _PARSED[field.type](stated[attribute])
    if major == 1:
        found["needs_execution_tool"] = root.find("Implementation/CoSimulation_Tool") is not None
    elif kind == "CoSimulation":
        step = _judged(document, element, "fixedInternalStepSize", 0.0)
        found["fixed_internal_step_size"] = step
    if boolean(stated.get("completedIntegratorStepNotNeeded")):
        found["needs_completed_integrator_step"] = False
    return Capabilities(**found)


def _attribute(field: str, major: int) -> str:
    """What the standard calls a field of `Capabilities`: mostly its name in camel case."""
    first, *others = _SPELLED.get(field, field).split("_")
    name = first + "".join(map(str.capitalize, others))
    if major < 3:
        name = name.replace("DirectionalDerivatives", "DirectionalDerivative")
    return name.replace("FmuState", "FMUState" if major == 3 else "FMUstate")
