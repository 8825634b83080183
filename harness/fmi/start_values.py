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

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.errors import UnitError, UsageError, nearest
from harness.fmi.binding.fmi3 import Fmi3Instance
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.values import Value, flat, item_names, parse_item
from harness.fmi.description.model_description import (
    INTEGER_TYPES,
    NUMERIC_TYPES,
    REAL_TYPES,
    ModelDescription,
    Variable,
)
from harness.fmi.description.value_checks import outside
from harness.fmi.wording import shorten
from harness.system.units import conversion, parse_unit

_Index = tuple[int, ...]
_SEQUENCES = (list, tuple, np.ndarray)
_FLOAT32 = float(np.finfo(np.float32).max)
_ELEMENT = re.compile(r"^(.*)\[(\d+(?:\s*,\s*\d+)*)\]$")
_WITH_UNIT = re.compile(r"^(.*?)\s*\[([^\]]+)\]\s*$")
_EXPECTED = {
    "Boolean": "true or false", "Clock": "true or false", "String": "text",
    "Binary": "bytes or hexadecimal text",
}  # fmt: skip
_BITS = {"Integer": (True, 32), "Enumeration": (True, 64)} | {
    f"{sign}Int{bits}": (not sign, bits) for sign in ("", "U") for bits in (8, 16, 32, 64)
}


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

    def _put(self, v: Variable, index: _Index | None, items: list[Any]) -> None:
        if v.causality == "structuralParameter":
            self.structural[v.name] = items[0]
        elif index is None:
            self.values[v.name] = items if v.shape else items[0]
        elif whole := self.values.get(v.name) or _stated(v):
            whole[_place(v, index)] = items[0]
            self.values[v.name] = whole
        else:
            name = f"{v.name}[{','.join(map(str, index))}]"
            self.elements[name] = v.name, _place(v, index), items[0]


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
            if index is not None:
                _place(variable, index)
            items = _items(d, variable, value, () if index else variable.shape)
        except ValueError as fault:
            faults.append(f"{label} {fault}")
            continue
        if beyond := next(filter(None, (_beyond(variable, one) for one in items)), ""):
            way_out = "; without validation (validate=False, --no-validate) it is set all the same"
            faults += [f"{label} {beyond}{way_out}"] if validate else []
            judged.notes.append(f"{label} {beyond}")
        judged._put(variable, index, items)
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
                sizes[name] = _items(description, variable, value, ())[0]
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


def _place(array: Variable, index: _Index) -> int:
    shape = array.shape
    if len(index) != len(shape) or not all(1 <= i <= n for i, n in zip(index, shape, strict=True)):
        sizes = _sizes(shape) if shape else "those of a scalar"
        raise ValueError(f"is for no element of {array.name!r}, whose sizes are {sizes}")
    return int(np.ravel_multi_index([i - 1 for i in index], shape))


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
    return [parse_item(array, text) for text in texts] if stated else []


def _items(d: ModelDescription, v: Variable, value: Any, shape: tuple[int, ...]) -> list[Any]:
    """The elements that `value` means for `v`, in its type and unit; raises ValueError."""
    value, unit = _without_unit(v, value, shape)
    if isinstance(value, str) and shape:
        value = value.replace(",", " ").split()
    nested = np.shape(np.array(value, dtype=object)) if isinstance(value, _SEQUENCES) else ()
    items = [_item(v, one) for one in flat(value)]
    if len(items) != math.prod(shape) or (len(nested) > 1 and nested != shape):
        received = _sizes(nested) if len(nested) > 1 else len(items)
        raise ValueError(f"must have {_sizes(shape) or 1} element(s), not {received}")
    if unit is not None:
        items = [_in_unit_of(d, v, one, unit) for one in items]
    return [_in_range(v, one) for one in items]


def _without_unit(v: Variable, value: Any, shape: tuple[int, ...]) -> tuple[Any, str | None]:
    """Value and unit of a pair (value, unit) or of a text "value [unit]"."""
    if v.type in ("String", "Binary"):
        return value, None
    if isinstance(value, str):
        match = _WITH_UNIT.match(value)
        named = value in dict(v.details.items).values()
        return (match[1], match[2].strip()) if match and not named else (value, None)
    pair = isinstance(value, (tuple, list)) and len(value) == 2 and isinstance(value[1], str)
    if pair and not (shape and _means(v, value[1])):
        return value[0], value[1]
    return value, None


def _means(v: Variable, text: str) -> bool:
    try:
        return parse_item(v, text) is not None
    except (KeyError, ValueError, OverflowError):
        return False


def _item(v: Variable, item: Any) -> Any:
    """One element in the type of `v`, whatever its range; raises ValueError."""
    made = item.item() if isinstance(item, np.generic) else item
    try:
        if v.type in ("Boolean", "Clock"):
            return parse_item(v, str(made))
        if isinstance(made, str):
            return parse_item(v, made if v.type == "String" else made.strip())
        if v.type == "Binary" and isinstance(made, (bytes, bytearray)):
            return bytes(made)
        if v.type in NUMERIC_TYPES and isinstance(made, (int, float)) and type(made) is not bool:
            return made
        raise TypeError(v.type)
    except (KeyError, TypeError, ValueError, OverflowError):
        raise ValueError(f"must be {_expected(v)}, not {_shown(made)}") from None


def _in_range(v: Variable, value: Any) -> Any:
    """A number as the type of `v` holds it, others as they are; raises ValueError."""
    if v.type in REAL_TYPES:
        with suppress(OverflowError):
            number = float(value)
            if math.isfinite(number) and v.type == "Float32" and abs(number) > _FLOAT32:
                raise ValueError(f"must fit Float32, not {value!r}")
            if math.isfinite(number):
                return number
        raise ValueError(f"must be finite, not {_shown(value)}")
    if v.type in INTEGER_TYPES:
        if not math.isfinite(value):
            raise ValueError(f"must be finite, not {value}")
        items = dict(v.details.items)
        if value != int(value) or (items and value not in items):
            raise ValueError(f"must be {_expected(v)}, not {_shown(value)}")
        signed, bits = _BITS[v.type]
        first, last = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else (0, 2**bits - 1)
        if not first <= value <= last:
            raise ValueError(f"must be between {first} and {last} ({v.type}), not {_shown(value)}")
        return int(value)
    return value


def _beyond(v: Variable, value: Any) -> str:
    if v.type not in REAL_TYPES and v.type not in INTEGER_TYPES:
        return ""
    fault = outside(v, value)
    return f"is {repr(value).removesuffix('.0')}, {fault}" if fault else ""


def _in_unit_of(d: ModelDescription, v: Variable, value: Any, unit: str) -> float:
    """`value` in `unit`, converted to the unit of `v`; raises ValueError where it cannot be."""
    if v.type not in REAL_TYPES:
        raise ValueError(f"of type {v.type} has no unit, but {unit!r} was given")
    if not v.unit:
        raise ValueError(f"has no unit, but {unit!r} was given")
    if unit == v.unit:
        return float(value)
    shown = d.display_units.get(v.unit, {})
    if unit in shown:
        one = shown[unit]
        if one.inverse:
            return one.factor / value if value else math.inf
        return float((value - (0.0 if v.details.relative else one.offset)) / one.factor)
    try:
        factor, offset = conversion(parse_unit(unit, d.units), parse_unit(v.unit, d.units))
    except UnitError as fault:
        known = f"; it is shown in {', '.join(shown)}" if shown else ""
        raise ValueError(f"cannot be in {unit!r}: {fault}{known}") from fault
    return float(factor * value + (0.0 if v.details.relative else offset))


def _expected(v: Variable) -> str:
    if v.details.items:
        return f"one of {item_names(v)}"
    number = "a number" if v.type in REAL_TYPES else "a whole number"
    return _EXPECTED.get(v.type, f"{number} ({v.type})")


def _shown(value: Any) -> str:
    if isinstance(value, int) and value.bit_length() > 400:
        return f"a number of {int(value.bit_length() * math.log10(2)) + 1} digits"
    return shorten(repr(value))


def _sizes(shape: tuple[int, ...]) -> str:
    return " by ".join(map(str, shape))
