"""modelDescription.xml from bytes to what FMPy makes of it, judged before and after.

The document is parsed here without expanding or loading anything, judged by its root, by the
schema of the standard and by `xml_checks`, and only then read by FMPy, whose findings and
exceptions become an `FmuError` of one sentence. Documents with a DOCTYPE are refused.

Who wants an FMU in spite of its faults passes a list for them (`Faults`): what is invalid and can
be read all the same goes there. What could do harm is refused all the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any

import fmpy
from fmpy.model_description import ValidationError
from fmpy.validation import validate_model_description
from lxml import etree

from harness.errors import FmuError
from harness.fmi.description.xml_checks import (
    document_faults,
    harmful_faults,
    root_fault,
    schema_problems,
)
from harness.fmi.wording import shorten

_BUILD = "sources/buildDescription.xml"
_SHOWN_FAULTS = 3

Faults = list[str]
"""Sentences about faults that were let pass."""

MAX_DOCUMENT = 2**28
"""Bytes of a document; it takes some ten times as many in memory."""


def read_document(folder: Path, source: Path, passed: Faults | None = None) -> tuple[Any, Any]:
    """The root element and FMPy's reading of the unpacked FMU in `folder`.

    `source` is the archive, for messages. Raises `FmuError` when the document is missing,
    malformed, invalid or of an unknown version.
    """
    root = _root(folder / "modelDescription.xml", source)
    _judge_problems(schema_problems(root), source, passed)
    with faults_of(source):
        judge(harmful_faults(root), source)
        judge(document_faults(root), source, passed)
        description = fmpy.read_model_description(str(folder), validate=False)
        problems = validate_model_description(description)
    _judge_problems(problems, source, passed)
    return root, description


def judge(faults: Iterable[str], source: Path, passed: Faults | None = None) -> None:
    """Raise `FmuError` with the first few of `faults`, phrases about the document, if any; where
    there is a list `passed` they are added to it."""
    found = list(islice(faults, _SHOWN_FAULTS + 1))
    if not found:
        return
    more = " (and more)" if len(found) > _SHOWN_FAULTS else ""
    told = f"{_place(source)} {'; '.join(found[:_SHOWN_FAULTS])}{more}"
    if passed is None:
        raise FmuError(told)
    passed.append(told)


def _judge_problems(problems: Sequence[Any], source: Path, passed: Faults | None) -> None:
    """The same for what a validator finds."""
    if not problems:
        return
    told = f"{_place(source)} is not valid: {_problems(problems)}"
    if passed is None:
        raise FmuError(told)
    if told not in passed:
        passed.append(told)


@contextmanager
def faults_of(source: Path) -> Iterator[None]:
    """Whatever is raised while the document is read becomes an `FmuError`."""
    try:
        yield
    except ValidationError as fault:
        raise FmuError(f"{_place(source)} is not valid: {_problems(fault.problems)}") from fault
    except FmuError:
        raise
    except Exception as fault:  # FMPy raises bare Exception, lxml its own tree
        raise FmuError(f"{_place(source)} cannot be read: {_reason(fault)}") from fault


def _root(document: Path, source: Path) -> Any:
    """The root element of a document that FMPy may read; raises `FmuError`."""
    with faults_of(source):
        build = document.parent / _BUILD
        if build.is_file() and _parse(build).docinfo.doctype:
            raise FmuError(f"{_BUILD} of {source} has a DOCTYPE, which FMUs may not have")
        if document.stat().st_size > MAX_DOCUMENT:
            raise FmuError(f"{_place(source)} is larger than {MAX_DOCUMENT} bytes")
        tree = _parse(document)
    if tree.docinfo.doctype:
        raise FmuError(f"{_place(source)} has a DOCTYPE, which FMUs may not have")
    root = tree.getroot()
    unreadable = root_fault(root)
    if unreadable:
        raise FmuError(f"{_place(source)} {unreadable}")
    return root


def _parse(document: Path) -> Any:
    """The document tree, parsed without expanding or loading anything."""
    parser = etree.XMLParser(
        resolve_entities=False, load_dtd=False, no_network=True, huge_tree=False
    )
    return etree.parse(str(document), parser)


def _place(source: Path) -> str:
    return f"modelDescription.xml of {source}"


def _problems(problems: Sequence[Any]) -> str:
    shown = "; ".join(shorten(str(one), 300) for one in problems[:_SHOWN_FAULTS])
    left = len(problems) - _SHOWN_FAULTS
    return shown + (f" (and {left} more)" if left > 0 else "")


def _reason(fault: Exception) -> str:
    if isinstance(fault, KeyError):
        return f"it refers to {shorten(repr(fault.args[0]))}, which it does not define"
    return shorten(str(fault), 300) or type(fault).__name__
