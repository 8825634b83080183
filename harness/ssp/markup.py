"""XML of strangers: parsed without entities, DOCTYPE or network.

What the harness does not understand of a document is held as canonical XML and written back.
Comments between elements that are understood are dropped.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any
from warnings import warn

from lxml import etree

from harness.errors import ExperimentError

NAMESPACES: Mapping[str, str] = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
    "ssm": "http://ssp-standard.org/SSP1/SystemStructureParameterMapping",
    "ssb": "http://ssp-standard.org/SSP1/SystemStructureSignalDictionary",
}
"""The namespaces of SSP 1.0 and 2.0 alike, by the prefix that they have here."""

OSP = "http://opensimulationplatform.com/SSP/OSPAnnotations"
_WELL_KNOWN: Mapping[str, str] = {**NAMESPACES, "osp": OSP}
"""What a prefix means that tools write without declaring it."""

_BOM = b"\xef\xbb\xbf"

_DRAFT = re.compile(rb"http://www\.pmsf\.net/xsd/(SystemStructure\w+)Draft(?=[\"'])")
# atomic: however many comments a hostile document has, they are tried once
_ROOT = re.compile(rb"\s*+(?>(?:<\?.*?\?>|<!--.*?-->)\s*+)*+<[^\s/>]+", re.DOTALL)

MAX_XML_BYTES = 256 * 2**20
MAX_DEPTH = 200


def clark(tag: str) -> str:
    """lxml's form of a name with one of our prefixes: "ssd:System" is "{http://…}System"."""
    prefix, _, local = tag.partition(":")
    return f"{{{NAMESPACES[prefix]}}}{local}"


def shown(clark_name: str) -> str:
    """A name as people write it."""
    namespace, _, local = clark_name.rpartition("}")
    prefixes = [prefix for prefix, known in NAMESPACES.items() if namespace == "{" + known]
    return f"{prefixes[0]}:{local}" if prefixes else clark_name


def parse(content: bytes, where: str) -> Any:
    """The root element; raises `ExperimentError` for what is no XML or not fit to be read.

    The namespaces of the drafts of SSP mean those of the standard, and a well-known prefix that
    is not declared means what it means elsewhere, with a warning.
    """
    if len(content) > MAX_XML_BYTES:
        raise ExperimentError(
            f"{where}: {len(content)} bytes, at most {MAX_XML_BYTES} are read; divide the document"
        )
    parser = etree.XMLParser(
        resolve_entities=False, load_dtd=False, no_network=True, huge_tree=False, remove_pis=True
    )
    standard = _DRAFT.sub(rb"http://ssp-standard.org/SSP1/\1", content)
    try:
        root = etree.fromstring(_declared(standard, where), parser)
    except (etree.XMLSyntaxError, ValueError) as fault:
        raise ExperimentError(
            f"{where} is no readable XML: {fault}; mend the document, or have it exported anew"
        ) from fault
    docinfo: Any = root.getroottree().docinfo
    if docinfo.doctype:
        raise ExperimentError(
            f"{where} has a DOCTYPE, which SSP documents may not have; leave it out"
        )
    drafts = [e for e in root.iter("*") if e.get("version", "").startswith("Draft")]
    if standard != content or drafts:
        warn(f"{where} is of a draft of SSP; it is read as SSP 1.0", stacklevel=2)
        for one in drafts:
            one.set("version", "1.0")
    return root


def _declared(content: bytes, where: str) -> bytes:
    """`content` with declarations of the well-known prefixes that it uses and does not declare
    anywhere."""
    used = [p for p in _WELL_KNOWN if f"<{p}:".encode() in content]
    missing = [p for p in used if f"xmlns:{p}=".encode() not in content]
    root = _ROOT.match(content.removeprefix(_BOM)) if missing else None
    if root is None:
        return content
    warn(f"{where} does not declare the prefix {' and '.join(missing)}; it is read as SSP's own",
         stacklevel=3)  # fmt: skip
    more = "".join(f' xmlns:{prefix}="{_WELL_KNOWN[prefix]}"' for prefix in missing)
    return root[0] + more.encode() + content.removeprefix(_BOM)[root.end() :]


def canonical(element: Any, where: str = "annotation") -> str:
    """An element as canonical XML that means the same wherever it is put back; raises
    `ExperimentError` for one that has no such form."""
    prefixes = [p for p in element.nsmap if p is not None and _is_used(element, f"{p}:")]
    try:
        text: bytes = etree.tostring(
            element, method="c14n", exclusive=True, with_comments=True, with_tail=False,
            inclusive_ns_prefixes=prefixes or None,
        )  # fmt: skip
    except etree.C14NError as fault:
        raise ExperimentError(
            f"{where}: {shown(element.tag)} has no canonical form: every namespace must be an "
            "absolute URI; give it one, such as urn:name"
        ) from fault
    return text.decode("utf-8")


def _is_used(element: Any, prefix: str) -> bool:
    """Whether an attribute or a text may hold a name with that prefix, such as an xsi:type."""
    return any(
        prefix in value
        for one in element.iter(etree.Element)
        for value in (one.text or "", *one.attrib.values())
    )


def parsed(text: str) -> Any:
    """The element of which `canonical` made a text."""
    return parse(text.encode("utf-8"), "canonical XML")
