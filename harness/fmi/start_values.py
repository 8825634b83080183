"""Start values: judged before anything is loaded, converted to what an FMU is told, and set.

    2, "2"              in the variable's own unit
    (3, "ft"), "3 [ft]" in another one, converted by the FMU's units, display units, or known ones
    "1 0 0 1"           all elements of an array in row-major order; also (nested) lists and arrays
    "high", 7           an item of an enumeration, by name or number
    b"\\x01", "01"       a binary, as bytes or hexadecimal

A name is that of a variable, or of an element of an array ("A[2,1]") whose other elements are as
they would be without it. Differences (`relativeQuantity`) are converted without the offset: 20 °C
of heating are 20 K. Structural parameters give arrays their sizes: they are judged and set first.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.errors import UsageError, nearest
from harness.fmi.binding.fmi3 import Fmi3Instance
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.values import Value, element
from harness.fmi.description.model_description import NUMERIC_TYPES, ModelDescription, Variable
from harness.fmi.given_values import beyond_limits, elements_meant, sizes_text

_Index = tuple[int, ...]
_ELEMENT = re.compile(r"^(.*)\[(\d+(?:\s*,\s*\d+)*)\]$")


@dataclass(frozen=True)
class StartValues:
    """What an instance is told: sizes of `structural` parameters, then `values` (of an array: all
    elements in row-major order), then single `elements`, as array, place (from 0) and value, where
    the model description does not state the others. `notes` tell what is set although it is wrong.
    """

    structural: dict[str, int]
    values: dict[str, Any]
    elements: dict[str, tuple[str, int, Value]]
    notes: list[str]

    @property
    def told(self) -> dict[str, Any]:
        """All of it by name; elements only where the array is not told as a whole."""
        single = {name: value for name, (_, _, value) in self.elements.items()}
        return {**self.structural, **self.values, **single}

    def _put(self, name: str, v: Variable, place: int | None, items: list[Any]) -> None:
        if v.causality == "structuralParameter":
            self.structural[v.name] = items[0]
        elif place is None:
            self.values[v.name] = items if v.shape else items[0]
        elif whole := self.values.get(v.name) or _stated(v):
            whole[place] = items[0]
            self.values[v.name] = whole
        else:
            self.elements[re.sub(r"\s*,\s*", ",", name)] = v.name, place, items[0]


def judge_start_values(
    description: ModelDescription,
    given: Mapping[str, Any],
    *,
    component: str,
    validate: bool = True,
) -> StartValues:
    """What `given` means for the FMU of `component`; raises `UsageError` with one line a fault.

    Without `validate`, a value outside the variable's min and max is no fault but a note.
    """
    d = configured(description, given)
    judged = StartValues({}, {}, {}, [])
    faults: list[str] = []
    for name, value in given.items():
        if (target := find_target(d, name)) is None:
            hint = nearest(name, d.variables)
            faults.append(
                f"component {component}: no variable {name!r} to give a start value; {hint}"
            )
            continue
        label = f"component {component}: start value of {name!r}"
        variable, index = target
        try:
            _check_settable(d, variable)
            place = None if index is None else place_of(variable, index)
            items = elements_meant(d, variable, value, () if index else variable.shape)
        except ValueError as fault:
            faults.append(f"{label} {fault}")
            continue
        if beyond := next(filter(None, (beyond_limits(variable, one) for one in items)), ""):
            way_out = "; without validation (validate=False, --no-validate) it is set all the same"
            faults += [f"{label} {beyond}{way_out}"] if validate else []
            judged.notes.append(f"{label} {beyond}")
        judged._put(name, variable, place, items)
    if faults:
        raise UsageError("\n".join(faults))
    return judged


def apply_start_values(instance: FmuInstance, judged: StartValues) -> None:
    """Set judged values before initialisation, structural parameters in configuration mode first;
    raises `FmuError` where the FMU refuses one."""
    if judged.structural:
        assert isinstance(instance, Fmi3Instance), "only FMI 3 has structural parameters"
        instance.configure(judged.structural)
    instance.set(judged.values)
    for array, place, value in judged.elements.values():
        whole = np.array(instance.get(array))
        whole.flat[place] = value
        instance.set({array: whole})


def configured(description: ModelDescription, given: Mapping[str, Any]) -> ModelDescription:
    """`description` with the sizes that start values of structural parameters give its arrays.

    Values that mean nothing change no size; `judge_start_values` tells of them.
    """
    sizes = {}
    for name, value in given.items():
        variable = description.variables.get(name)
        if variable is not None and variable.causality == "structuralParameter":
            with suppress(ValueError):
                sizes[name] = elements_meant(description, variable, value, ())[0]
    return description.configured(sizes)


def parse_assignment(d: ModelDescription, text: str) -> tuple[str, str]:
    """Name and value of "name=value" or "name=value[unit]"; raises `UsageError`.

    It is parted at the "=" that leaves a name of the FMU before it; names may hold one themselves.
    """
    parts = [(text[:i].strip(), text[i + 1 :]) for i, letter in enumerate(text) if letter == "="]
    if not parts or not parts[0][0]:
        raise UsageError(f"start value {text!r} must have the form name=value or name=value[unit]")
    return next((part for part in parts if part[0] in d.variables), parts[0])


def find_target(d: ModelDescription, name: str) -> tuple[Variable, _Index | None] | None:
    """The variable called `name`, or an array and the indices of the element that it names."""
    if name in d.variables:
        return d.variables[name], None
    match = _ELEMENT.match(name)
    if match is None or match[1] not in d.variables:
        return None
    return d.variables[match[1]], tuple(int(one) for one in match[2].split(","))


def place_of(array: Variable, index: _Index) -> int:
    """Where the element of these indices (from 1) stands in row-major order (from 0); raises
    ValueError with a phrase."""
    shape = array.shape
    if len(index) == len(shape) and all(1 <= i <= n for i, n in zip(index, shape, strict=True)):
        return int(np.ravel_multi_index([i - 1 for i in index], shape))
    sizes = sizes_text(shape) or "those of a scalar"
    raise ValueError(f"is for no element of {array.name!r}, whose sizes are {sizes}")


def _check_settable(d: ModelDescription, v: Variable) -> None:
    if v.variability == "constant" or v.causality == "independent":
        what = "a constant" if v.variability == "constant" else "the independent variable"
        raise ValueError(f"cannot be set, for it is {what}")
    if v.initial == "calculated" or v.causality == "calculatedParameter":
        hint = nearest(v.name, [o.name for o in d.variables.values() if o.initial == "exact"])
        raise ValueError(f"cannot be set, for the FMU calculates it ({v.causality}); {hint}")


def _stated(array: Variable) -> list[Any]:
    """The elements that the model description states of an array of numbers, else none."""
    texts = str(array.start or "").split()
    stated = array.type in NUMERIC_TYPES and len(texts) == array.size
    return [element(array, text) for text in texts] if stated else []
