"""Static faults of the model structure and of the names of variables, which no run asks for."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from harness.fmi.description.model_description import ModelDescription, Unknown
from harness.fmi.description.rules import rule
from harness.inspection.problem import PLACE, Problem, error, listed, note, warning

_QUOTED = r"'([\w !#$%&()*+,\-./:;<>=?@\[\]^{}|~\"]|\\['\"?\\abfnrtv])+'"
_NAME = rf"([A-Za-z_]\w*|{_QUOTED})(\[\d+(,\d+)*\])?"
_IDENTIFIER = rf"{_NAME}(\.{_NAME})*"
_STRUCTURED = re.compile(rf"{_IDENTIFIER}|der\({_IDENTIFIER}(,\d+)?\)", re.ASCII)


def structure_problems(d: ModelDescription) -> Iterator[Problem]:
    """What is wrong with the model structure of FMI 2 and 3, and with names of variables."""
    if d.structured_names:
        bad = [name for name in d.variables if not _STRUCTURED.fullmatch(name)]
        if bad:
            text = "no legal name of the naming convention 'structured'"
            yield warning(f"variables {listed(bad)}", text, rule("names", d.fmi_major))
    if d.fmi_major > 1:
        yield from _outputs(d)
        yield from _derivatives(d)
        yield from _initial_unknowns(d)
        yield from _kinds(d)


def _outputs(d: ModelDescription) -> Iterator[Problem]:
    expected = [v.name for v in d.outputs if d.fmi_major == 2 or not v.details.alias_of]
    found = [one.variable for one in d.unknowns if one.kind == "Output"]
    text = _difference("Outputs", found, expected)
    if text:
        yield error(PLACE, text, rule("outputs", d.fmi_major))


def _derivatives(d: ModelDescription) -> Iterator[Problem]:
    for one in d.unknowns:
        rate = one.kind == "ContinuousStateDerivative"
        if rate and d.variables[one.variable].derivative_of is None:
            listing = f"{one.variable} is listed as derivative (line {one.line})"
            text = f"{listing} and does not say of what"
            yield error(PLACE, text, rule("derivatives", d.fmi_major))


def _initial_unknowns(d: ModelDescription) -> Iterator[Problem]:
    """A clocked variable may be listed in FMI 3, and need not be."""
    states = {name for pair in d.states for name in pair}
    clocked = {v.name for v in d.variables.values() if v.type == "Clock" or v.details.clocks}
    expected = {
        v.name for v in d.variables.values()
        if v.causality == "calculatedParameter"
        or (v.initial in ("approx", "calculated") and (v.causality == "output" or v.name in states))
        if d.fmi_major == 2 or not v.details.alias_of
    }  # fmt: skip
    found = {one.variable for one in d.unknowns if one.kind == "InitialUnknown"}
    text = _difference("InitialUnknowns", found - clocked, expected - clocked)
    if text:
        yield note(PLACE, text, rule("initial unknowns", d.fmi_major))


def _difference(what: str, found: Iterable[str], expected: Iterable[str]) -> str:
    """What is missing in a list and what should not be in it, or ""."""
    missing, surplus = set(expected) - set(found), set(found) - set(expected)
    parts = [f"lacks {listed(sorted(missing))}"] if missing else []
    parts += [f"lists {listed(sorted(surplus))}, which it should not"] if surplus else []
    return f"ModelStructure/{what} {' and '.join(parts)}" if parts else ""


def _kinds(d: ModelDescription) -> Iterator[Problem]:
    bad = [one for one in d.unknowns if _mismatched(one)]
    if bad:
        names = listed([f"{one.kind} {one.variable} (line {one.line})" for one in bad])
        text = f"dependenciesKind and dependencies do not match for {names}"
        yield warning(PLACE, text, rule("dependencies kind", d.fmi_major))


def _mismatched(one: Unknown) -> bool:
    kinds, names = one.dependency_kinds, one.dependencies
    return kinds is not None and (names is None or len(names) != len(kinds))
