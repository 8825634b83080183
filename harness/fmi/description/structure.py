"""The model structure: which variables are unknowns, and on what they depend."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from typing import Any

from harness.fmi.description.document import Document
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
_REFERENCE = {2: "index", 3: "valueReference"}


def read_unknowns(document: Document, numbered: Mapping[int | None, Entry]) -> Iterator[Unknown]:
    """All unknowns in the order of the document. `numbered` are the variables by position
    (FMI 2) or value reference (FMI 3); references that lead nowhere are told."""
    for kind, element in _elements(document):
        variable, *_ = _named(document, element, _REFERENCE[document.major], numbered) or (None,)
        dependencies = _named(document, element, "dependencies", numbered)
        kinds = element.get("dependenciesKind")
        if variable is not None:
            yield Unknown(
                kind, variable, dependencies, None if kinds is None else tuple(kinds.split()),
                element.sourceline or 0,
            )  # fmt: skip


def _named(
    document: Document, element: Any, attribute: str, numbered: Mapping[int | None, Entry]
) -> tuple[str, ...] | None:
    """The variables to which an attribute refers, None where there is no such attribute."""
    text = element.get(attribute)
    if text is None:
        return None
    found = []
    for item in text.split():
        variable = numbered.get(integer(item))
        if variable is not None:
            found.append(variable.name)
            continue
        if document.major == 2:
            what = f"variable number {shorten(item)} in its ModelStructure, but has the numbers 1 "
            what += f"to {len(numbered)}"
        else:
            what = f"value reference {shorten(item)} in its ModelStructure, which no variable has"
        document.tell(element, f"refers to {what}", Harm.AMBIGUOUS)
    return tuple(found)


def _elements(document: Document) -> Iterator[tuple[str, Any]]:
    if document.major == 3:
        yield from ((str(one.tag), one) for one in document.root.iterfind("ModelStructure/*"))
    elif document.major == 2:
        for group in document.root.iterfind("ModelStructure/*"):
            kind = _KINDS.get(group.tag)
            yield from ((kind, one) for one in group.iterchildren("Unknown") if kind)


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
