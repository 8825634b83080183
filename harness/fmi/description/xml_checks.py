"""Judges modelDescription.xml as a document, before its content is believed.

FMPy validates against the schema of the standard; what it then follows without looking is judged
here first: the root and its version, references that lead nowhere or in circles, and names that
would leave their folder. Every fault is a phrase for an `FmuError`, without the file's name.

This module corrects nothing and reads no values; what they say is judged in `value_checks`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
from lxml import etree

from harness.fmi.wording import has_control_characters, shorten

ROOT = "fmiModelDescription"
_VERSIONS = re.compile(r"(1\.0|2\.0|3\.\d+(-[\w.]+)?)")
_INTERFACES = ("ModelExchange", "CoSimulation", "ScheduledExecution")
_FMI2_UNKNOWNS = "ModelStructure/*/Unknown"


def root_fault(root: Any) -> str:
    """What is wrong with the root of the document, or "" where FMPy may read it."""
    if root.tag != ROOT:
        return f"has the root element <{shorten(str(root.tag))}>, not <{ROOT}>"
    version = root.get("fmiVersion")
    if version is None:
        return "states no fmiVersion"
    if not _VERSIONS.fullmatch(version):
        return f"is of FMI version {shorten(version)!r}; versions 1.0, 2.0 and 3.0 are read"
    if root.find("ModelVariables") is None:
        return "has no ModelVariables"
    return ""


def schema_problems(root: Any) -> list[str]:
    """What the schema of the standard finds wrong, so that the checks below can rely on it."""
    schema = _schema(int(root.get("fmiVersion")[0]))
    if schema.validate(root):
        return []
    log: Any = schema.error_log
    return [f"line {one.line}: {one.message}" for one in log]


@cache
def _schema(fmi_major: int) -> etree.XMLSchema:
    name = "" if fmi_major == 1 else str(fmi_major)
    path = Path(fmpy.__file__).parent / "schema" / f"fmi{fmi_major}"
    return etree.XMLSchema(file=str(path / f"fmi{name}ModelDescription.xsd"))


def harmful_faults(root: Any) -> Iterator[str]:
    """What may not be followed even where faults are let pass: names that lead out of the FMU or
    would garble a terminal, and circles. Values that are none raise `ValueError`."""
    yield from _identifier_faults(root)
    variables = _variables(root)
    for variable in variables:
        if has_control_characters(variable.get("name")):
            yield f"has a variable whose name holds control characters: {_name(variable)}"
    if root.get("fmiVersion") == "2.0":
        yield from _fmi2_circles(variables)
    elif root.get("fmiVersion") != "1.0":
        yield from _fmi3_circles(variables)


def document_faults(root: Any) -> Iterator[str]:
    """What is wrong with references, as phrases; `root` has passed the schema, or values that are
    none raise `ValueError`."""
    variables = _variables(root)
    if root.get("fmiVersion") == "2.0":
        yield from _fmi2_faults(root, variables)
    elif root.get("fmiVersion") != "1.0":
        yield from _fmi3_faults(root, variables)


def _variables(root: Any) -> list[Any]:
    return [v for v in root.find("ModelVariables").iterchildren("*") if v.get("name")]


def circle(successors: Mapping[int, Iterable[int]]) -> list[int]:
    """The nodes of a circle in the graph, in order, or [] where there is none."""
    finished: set[int] = set()
    for start in successors:
        path: dict[int, None] = {}  # in order, and quick to look into
        stack = [iter((start,))]
        while stack:
            node = next((n for n in stack[-1] if n not in finished), None)
            if node is None:
                stack.pop()
                if path:
                    finished.add(path.popitem()[0])
            elif node in path:
                nodes = list(path)
                return nodes[nodes.index(node) :]
            else:
                path[node] = None
                stack.append(iter(successors.get(node, ())))
    return []


def _identifier_faults(root: Any) -> Iterator[str]:
    """A model identifier is a file's name; one with a path would load any library there is."""
    elements = [root, *(e for e in root.iterchildren("*") if e.tag in _INTERFACES)]
    for element in elements:
        identifier = element.get("modelIdentifier")
        if identifier is None:
            continue
        bad = re.search(r'[/\\:*?"<>|]', identifier) or has_control_characters(identifier)
        if bad or not identifier.strip(". "):
            yield f"has the modelIdentifier {shorten(identifier)!r}, which is no name of a file"
    if has_control_characters(root.get("modelName", "")):
        yield f"has control characters in its modelName {shorten(root.get('modelName'))!r}"


def _fmi2_rates(variables: list[Any]) -> Iterator[tuple[int, int]]:
    """Numbers of variables, and of those whose derivatives they are."""
    for position, variable in enumerate(variables, start=1):
        for value in variable.iterchildren("Real"):
            if value.get("derivative") is not None:
                yield position, int(value.get("derivative"))


def _fmi2_circles(variables: list[Any]) -> Iterator[str]:
    found = circle({position: [index] for position, index in _fmi2_rates(variables)})
    if found:
        names = " -> ".join(_name(variables[i - 1]) for i in found)
        yield f"has variables that are derivatives of one another in a circle: {names}"


def _fmi2_faults(root: Any, variables: list[Any]) -> Iterator[str]:
    count = len(variables)
    for position, index in _fmi2_rates(variables):
        if not 1 <= index <= count:
            variable = variables[position - 1]
            yield f"has {_name(variable)} as derivative of variable {index} of {count}"
    for unknown in root.iterfind(_FMI2_UNKNOWNS):
        for index in [unknown.get("index"), *(unknown.get("dependencies") or "").split()]:
            if not 1 <= int(index) <= count:
                yield (
                    f"refers to variable number {index} in its ModelStructure (line "
                    f"{unknown.sourceline}), but has the numbers 1 to {count}"
                )


def _fmi3_faults(root: Any, variables: list[Any]) -> Iterator[str]:
    known = {int(v.get("valueReference")): v for v in variables}
    for unknown in root.find("ModelStructure").iterchildren("*"):
        for text in [unknown.get("valueReference"), *(unknown.get("dependencies") or "").split()]:
            if int(text) not in known:
                yield (
                    f"refers to value reference {text} in its ModelStructure (line "
                    f"{unknown.sourceline}), which no variable has"
                )
    for attribute, wanted in (
        ("derivative", ("Float32", "Float64")),
        ("previous", ()),
        ("clocks", ("Clock",)),
    ):
        yield from _reference_faults(variables, known, attribute, wanted)
    for variable in variables:
        yield from _dimension_faults(variable, known)


def _reference_faults(
    variables: list[Any], known: Mapping[int, Any], attribute: str, wanted: tuple[str, ...]
) -> Iterator[str]:
    for variable in variables:
        for reference in _references(variable, attribute):
            target = known.get(reference)
            if target is None:
                yield f"has {_name(variable)} with {attribute}={reference}, which no variable has"
            elif wanted and target.tag not in wanted:
                yield (
                    f"has {_name(variable)} with {attribute}={reference}, but {_name(target)} "
                    f"is of type {target.tag}"
                )


def _references(variable: Any, attribute: str) -> list[int]:
    return [int(text) for text in (variable.get(attribute) or "").split()]


def _fmi3_circles(variables: list[Any]) -> Iterator[str]:
    known = {int(v.get("valueReference")): v for v in variables}
    for attribute in ("derivative", "clocks"):
        found = circle({key: _references(v, attribute) for key, v in known.items()})
        if found:
            names = " -> ".join(_name(known[r]) for r in found if r in known)
            yield f"has variables whose {attribute} go in a circle: {names}"


def _dimension_faults(variable: Any, known: Mapping[int, Any]) -> Iterator[str]:
    for dimension in variable.iterchildren("Dimension"):
        text = dimension.get("valueReference")
        if text is None:
            if dimension.get("start") is None:
                yield f"has {_name(variable)} with a dimension of no size"
            continue
        size = known.get(int(text))
        if size is None:
            yield f"has {_name(variable)} with a dimension given by {text}, which no variable has"
        elif size.tag != "UInt64" or size.get("causality") != "structuralParameter":
            yield (
                f"has {_name(variable)} with a dimension given by {_name(size)}, which is no "
                "structural parameter of type UInt64"
            )
        elif len((size.get("start") or "").split()) != 1:
            yield f"has {_name(variable)} with a dimension given by {_name(size)} without a start"


def _name(variable: Any) -> str:
    return repr(shorten(variable.get("name")))
