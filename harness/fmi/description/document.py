"""The XML documents of an FMU: parsed without expanding or loading anything, and held against the
schemas of the standard. Documents with a DOCTYPE are refused, so no entity is ever expanded.
"""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from lxml import etree

from harness.errors import FmuError
from harness.fmi.description.faults import ANEW, DOCUMENT, Fault, Harm
from harness.fmi.description.rules import rule
from harness.fmi.wording import shorten

MAX_DOCUMENT = 2**28
"""Bytes of a document; it takes some ten times as many in memory."""

BUILD_DESCRIPTION = "sources/buildDescription.xml"
_ROOT = "fmiModelDescription"
_VERSIONS = re.compile(r"1\.0|2\.0|3\.(0|[1-9]\d*)(\.(0|[1-9]\d*))?(-.+)?")
_LONG = ("ModelVariables", "ModelStructure", "Outputs", "InitialUnknowns", "TypeDefinitions")
_PORTION = 1000
_UNUSED = ("generationDateAndTime", "variableNamingConvention", "dependenciesKind")
_LISTS = re.compile(
    r"Element '(UnitDefinitions|TypeDefinitions|LogCategories|InitialUnknowns|Outputs|Derivatives|"
    r"SourceFiles|VendorAnnotations)': Missing child"
    r"|Element '(Annotations|VendorAnnotations)': This element is not expected"
)


@dataclass(frozen=True)
class Document:
    """A modelDescription.xml that is being read, by its root element, and its `faults` so far."""

    root: Any
    faults: list[Fault]

    @cached_property
    def major(self) -> int:
        """1, 2 or 3."""
        return int(self.root.get("fmiVersion")[0])

    def tell(self, element: Any, text: str, harm: Harm = Harm.NONE, key: str = "") -> None:
        """`text` is wrong with an element; `key` names the sentence of the standard."""
        cited = rule(key, self.major) if key else ""
        self.faults.append(Fault(harm, text, element.sourceline or 0, cited))


def parse(path: Path, what: str) -> Any:
    """The root element of a document; `what` names it. Raises `FmuError` where it cannot be read
    or has a DOCTYPE."""
    try:
        if path.stat().st_size > MAX_DOCUMENT:
            raise FmuError(f"{what} is larger than {MAX_DOCUMENT} bytes; {ANEW}")
        parser = etree.XMLParser(
            resolve_entities=False, load_dtd=False, no_network=True, huge_tree=False
        )
        tree: Any = etree.parse(str(path), parser)
    except (OSError, etree.Error) as fault:
        reason = shorten(str(fault), 300) or type(fault).__name__
        raise FmuError(f"{what} cannot be read: {reason}; {ANEW}") from fault
    if tree.docinfo.doctype:
        raise FmuError(f"{what} has a DOCTYPE, which FMUs may not have; {ANEW}")
    return tree.getroot()


def model_description_root(folder: Path, source: Path) -> Any:
    """The root of modelDescription.xml, of a version that is read; raises `FmuError`.

    A buildDescription.xml must be readable, too, since compilers are told what it says.
    """
    build = folder / BUILD_DESCRIPTION
    if build.is_file():
        parse(build, f"{BUILD_DESCRIPTION} of {source}")
    place = f"{DOCUMENT} of {source}"
    root = parse(folder / DOCUMENT, place)
    if root.tag != _ROOT:
        found = shorten(str(root.tag))
        raise FmuError(f"{place} has the root element <{found}>, not <{_ROOT}>; {ANEW}")
    version = root.get("fmiVersion")
    if version is None:
        raise FmuError(f"{place} states no fmiVersion, such as 1.0, 2.0 or 3.0; {ANEW}")
    if not _VERSIONS.fullmatch(version):
        raise FmuError(
            f"{place} is of FMI version {shorten(version)!r}; versions 1.0, 2.0 and 3.x are read: "
            "have the FMU exported as one of them"
        )
    if root.find("ModelVariables") is None:
        raise FmuError(f"{place} has no ModelVariables; {ANEW}")
    return root


def schema_faults(root: Any, schema: str = "") -> Iterator[Fault]:
    """What the schema of the standard finds wrong, that of the model description's FMI version
    where none is named."""
    major = root.get("fmiVersion", "3")[0]
    name = schema or f"fmi{major}/fmi{major.strip('1')}ModelDescription.xsd"
    checked = _schema(name)
    told: set[tuple[int, str]] = set()
    for _ in _portions(root):
        log: Any = [] if checked.validate(root) else checked.error_log
        for one in log:
            if (one.line, one.message) not in told:
                told.add((one.line, one.message))
                harm = Harm.NONE if _is_harmless(one) else Harm.AMBIGUOUS
                text = f"is not valid: {shorten(one.message, 300)}"
                yield Fault(harm, text, one.line, f"schema {name}")


def _portions(root: Any) -> Iterator[None]:
    """The document with a part of its long lists at a time, since the place of a fault is found by
    counting the elements before it; it is whole again in the end."""
    lists = [(e, list(e)) for e in root.iter(*_LONG) if len(e) > _PORTION]
    for element, children in lists:
        element[:] = children[:_PORTION]
    yield
    for element, children in lists:
        for start in range(_PORTION, len(children), _PORTION):
            element[:] = children[start : start + _PORTION]
            yield
        element[:] = children[:_PORTION]
    for element, children in lists:
        element[:] = children


def _is_harmless(entry: Any) -> bool:
    """An attribute that the standard does not know or nobody reads, an empty list, or annotations
    in another place."""
    if entry.type_name == "SCHEMAV_CVC_COMPLEX_TYPE_3_2_1":
        return True
    return any(f"attribute '{name}'" in entry.message for name in _UNUSED) or bool(
        _LISTS.match(entry.message)
    )


@cache
def _schema(name: str) -> etree.XMLSchema:
    """A schema as FMPy ships it; FMPy itself is not imported."""
    found = importlib.util.find_spec("fmpy")
    assert found is not None and found.origin is not None
    return etree.XMLSchema(file=str(Path(found.origin).parent / "schema" / name))
