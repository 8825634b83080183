"""The model structure: which variables are unknowns, and on what they depend."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from typing import Any

from harness.fmi.description.entries import Entry
from harness.fmi.description.faults import Fault, Harm, quoted
from harness.fmi.description.model_description import Unknown, Variable
from harness.fmi.description.numbers import integer
from harness.fmi.wording import shorten

_KINDS = {
    "Outputs": "Output", "Derivatives": "ContinuousStateDerivative",
    "InitialUnknowns": "InitialUnknown",
}  # fmt: skip
"""What FMI 2 calls the lists, and FMI 3 their elements."""


def read_unknowns(
    root: Any, major: int, numbered: Mapping[int, Entry], faults: list[Fault]
) -> Iterator[Unknown]:
    """All unknowns in the order of the document. `numbered` are the variables by position
    (FMI 2) or value reference (FMI 3); references that lead nowhere become `faults`."""
    attribute = "index" if major == 2 else "valueReference"
    for kind, element in _elements(root, major):

        def named(text: str | None, line: int = element.sourceline or 0) -> str | None:
            found = numbered.get(-1 if integer(text) is None else int(text or ""))
            if found is None:
                what, known = shorten(str(text)), f"has the numbers 1 to {len(numbered)}"
                wrong = f"refers to variable number {what} in its ModelStructure, but {known}"
                if major == 3:
                    wrong = f"refers to value reference {what} in its ModelStructure, which no "
                    wrong += "variable has"
                faults.append(Fault(Harm.AMBIGUOUS, wrong, line))
            return None if found is None else found.name

        variable = named(element.get(attribute))
        given, kinds = element.get("dependencies"), element.get("dependenciesKind")
        names = None if given is None else tuple(filter(None, map(named, given.split())))
        if variable is not None:
            yield Unknown(
                kind, variable, names, None if kinds is None else tuple(kinds.split()),
                element.sourceline or 0,
            )  # fmt: skip


def _elements(root: Any, major: int) -> Iterator[tuple[str, Any]]:
    structure = root.find("ModelStructure")
    for element in structure.iterchildren("*") if structure is not None and major > 1 else ():
        if major == 3:
            yield str(element.tag), element
        elif element.tag in _KINDS:
            yield from ((_KINDS[element.tag], one) for one in element.iterchildren("Unknown"))


def direct_dependencies(
    root: Any, variables: Mapping[str, Variable]
) -> dict[str, tuple[str, ...] | None]:
    """FMI 1: the inputs on which each output depends, None where it does not say."""
    found: dict[str, tuple[str, ...] | None] = {}
    for element in root.find("ModelVariables").iterchildren("ScalarVariable"):
        stated = element.find("DirectDependency")
        if element.get("causality") == "output" and element.get("name") in variables:
            names = [] if stated is None else [str(one.text) for one in stated.iterchildren("Name")]
            found[element.get("name")] = None if stated is None else tuple(names)
    return found


def feedthrough(
    unknowns: Iterable[Unknown], kind: str, variables: Mapping[str, Variable]
) -> dict[str, tuple[str, ...] | None]:
    """The inputs on which each unknown of a kind depends, None where the FMU does not say."""
    return {
        one.variable: one.dependencies
        and tuple(n for n in one.dependencies if variables[n].causality == "input")
        for one in unknowns
        if one.kind == kind
    }


def circle_faults(variables: Mapping[str, Variable]) -> Iterator[Fault]:
    """Variables that are one another's derivatives or clocks, which nobody may follow."""
    graphs: dict[str, Mapping[str, Iterable[str]]] = {
        "derivative": {v.name: [v.derivative_of] for v in variables.values() if v.derivative_of},
        "clocks": {v.name: v.details.clocks for v in variables.values() if v.details.clocks},
    }
    for attribute, graph in graphs.items():
        try:
            TopologicalSorter(graph).prepare()
        except CycleError as fault:
            text = f"has variables whose {attribute} go in a circle: "
            found = reversed(fault.args[1][1:])  # the first stands at both ends
            yield Fault(Harm.FORBIDDEN, text + " -> ".join(map(quoted, found)))
