"""XML of strangers: parsed without entities, DOCTYPE or network.

What the harness does not understand of a document is held as canonical XML and written back.
Comments between elements that are understood are dropped.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

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
    """The root element; raises `ExperimentError` for what is no XML or not fit to be read."""
    if len(content) > MAX_XML_BYTES:
        raise ExperimentError(f"{where}: {len(content)} bytes; at most {MAX_XML_BYTES} are read")
    parser = etree.XMLParser(
        resolve_entities=False, load_dtd=False, no_network=True, huge_tree=False, remove_pis=True
    )
    try:
        root = etree.fromstring(content, parser)
    except (etree.XMLSyntaxError, ValueError) as fault:
        raise ExperimentError(f"{where} is no readable XML: {fault}") from fault
    docinfo: Any = root.getroottree().docinfo
    if docinfo.doctype:
        raise ExperimentError(f"{where} has a DOCTYPE, which SSP documents may not have")
    return root


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
            "absolute URI, such as urn:name"
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
