"""What stands beside modelDescription.xml: terminals, and the manifests of layered standards.

No run needs them, so whatever is wrong with them is told and they are left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
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
    schema = schema_faults(root, "fmi3/fmi3TerminalsAndIcons.xsd")
    faults += (replace(one, harm=Harm.NONE, text=f"{one.text} in {TERMINALS}") for one in schema)
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
        Member(name, one.get("memberName") or name, one.get("variableKind", ""))
        for one in element.iterchildren("TerminalMemberVariable")
        for name in (one.get("variableName", ""),)
    ]
    members += [
        Member(one.get(f"{way}VariableName", ""), one.get(f"{way}MemberName", ""), way)
        for one in element.iterchildren("TerminalStreamMemberVariable")
        for way in ("inStream", "outStream")
    ]
    keys = ("name", "matchingRule", "terminalKind", "description")
    name, rule, kind, description = (element.get(key, "") for key in keys)
    inner = tuple(map(_terminal, element.iterchildren("Terminal")))
    return Terminal(name, rule, kind, description, tuple(members), inner)


def _members(terminal: Terminal) -> Iterator[Member]:
    yield from terminal.members
    for inner in terminal.terminals:
        yield from _members(inner)


def read_layered_standards(folder: Path, faults: list[Fault]) -> Iterator[LayeredStandard]:
    """The layered standards of an unpacked FMU, by the manifests below its folder `extra`."""
    for path in sorted(islice((folder / "extra").rglob(MANIFEST), _MOST_MANIFESTS)):
        root = _root(folder, path, faults)
        if root is not None:
            keys = (f"{_NAMESPACE}fmi-ls-{key}" for key in ("name", "version", "description"))
            yield LayeredStandard(*(root.get(key, "") for key in keys))


def _root(folder: Path, path: Path, faults: list[Fault]) -> Any:
    if not path.is_file():
        return None
    what = shorten(path.relative_to(folder).as_posix())
    try:
        return parse(path, what)
    except FmuError as fault:
        faults.append(Fault(Harm.NONE, f"stands beside a document that is left out: {fault}"))
        return None
