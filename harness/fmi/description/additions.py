"""What stands beside modelDescription.xml: terminals, and the manifests of layered standards.

No run needs them, so whatever is wrong with them is told and they are left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any

from harness.errors import FmuError
from harness.fmi.description.document import parse, schema_faults
from harness.fmi.description.faults import Fault, Harm, quoted
from harness.fmi.description.model_description import (
    LayeredStandard,
    Member,
    Terminal,
    Variable,
)
from harness.fmi.wording import shorten

TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
MANIFEST = "fmi-ls-manifest.xml"
_NAMESPACE = "{http://fmi-standard.org/fmi-ls-manifest}"
_MOST_MANIFESTS = 100


def read_terminals(
    folder: Path, variables: Mapping[str, Variable], faults: list[Fault]
) -> Iterator[Terminal]:
    """The terminals of an unpacked FMU; `faults` grows by what is wrong with them."""
    root = _root(folder, folder / TERMINALS, faults)
    if root is None:
        return
    faults += (
        Fault(Harm.NONE, f"{one.text} in {TERMINALS}", one.line, one.rule)
        for one in schema_faults(root, "fmi3/fmi3TerminalsAndIcons.xsd")
    )
    for element in root.iterfind("Terminals/Terminal"):
        terminal = _terminal(element)
        for member in _members(terminal):
            if member.variable not in variables:
                text = f"has a terminal {quoted(terminal.name)} with the variable "
                text += f"{quoted(member.variable)}, which does not exist"
                faults.append(Fault(Harm.NONE, text, element.sourceline or 0))
        yield terminal


def _terminal(element: Any) -> Terminal:
    members = [
        Member(
            one.get("variableName", ""),
            one.get("memberName") or one.get("variableName", ""),
            one.get("variableKind", ""),
        )
        for one in element.iterchildren("TerminalMemberVariable")
    ]
    members += [
        Member(one.get(f"{way}VariableName", ""), one.get(f"{way}MemberName", ""), way)
        for one in element.iterchildren("TerminalStreamMemberVariable")
        for way in ("inStream", "outStream")
    ]
    return Terminal(
        element.get("name", ""),
        element.get("matchingRule", ""),
        element.get("terminalKind", ""),
        element.get("description", ""),
        tuple(members),
        tuple(map(_terminal, element.iterchildren("Terminal"))),
    )


def _members(terminal: Terminal) -> Iterator[Member]:
    yield from terminal.members
    for inner in terminal.terminals:
        yield from _members(inner)


def read_layered_standards(folder: Path, faults: list[Fault]) -> Iterator[LayeredStandard]:
    """The layered standards of an unpacked FMU, by the manifests below its folder `extra`."""
    for path in sorted(islice((folder / "extra").rglob(MANIFEST), _MOST_MANIFESTS)):
        root = _root(folder, path, faults)
        if root is not None:
            keys = ("name", "version", "description")
            yield LayeredStandard(
                **{key: str(root.get(f"{_NAMESPACE}fmi-ls-{key}", "")) for key in keys}
            )


def _root(folder: Path, path: Path, faults: list[Fault]) -> Any:
    if not path.is_file():
        return None
    what = shorten(path.relative_to(folder).as_posix())
    try:
        return parse(path, what)
    except FmuError as fault:
        faults.append(Fault(Harm.NONE, f"stands beside a document that is left out: {fault}"))
        return None
