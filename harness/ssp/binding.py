"""Dataclasses bound to XML elements: one declaration by which they are read and written.

    @dataclass(frozen=True, kw_only=True)
    class Unit(Element):
        TAGS = ("ssc:Unit",)
        name: str = attribute()
        base: BaseUnit = child(BaseUnit)

Fields stand in the order of the schema, which is the order in which children are written. What a
declaration does not name (attributes and elements of other standards) is kept as it is. This
module knows no element by name, and refuses values outside the XML schema's lexical forms.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, TypeVar

from lxml import etree

from harness.errors import ExperimentError, nearest
from harness.ssp import markup
from harness.ssp.lexical import FORMS

_XML = "xml"
_INDENT = "  "


@dataclass(frozen=True, kw_only=True)
class Element:
    """An XML element; `tag` is the one of `TAGS` that it has (the first unless said otherwise).

    `more_attributes` and `more` are what the declaration does not name: pairs, and canonical XML.
    `namespaces` are the prefixes of others that the root element declares.
    """

    TAGS: ClassVar[tuple[str, ...]] = ()
    tag: str = ""
    more_attributes: tuple[tuple[str, str], ...] = ()
    more: tuple[str, ...] = ()
    namespaces: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        """Fill in the tag."""
        if not self.tag:
            object.__setattr__(self, "tag", self.TAGS[0])


E = TypeVar("E", bound=Element)
Kinds = Callable[[], tuple[type[Element], ...]]


@dataclass(frozen=True)
class _Attribute:
    name: str
    form: str
    choices: tuple[str, ...]
    required: bool
    default: Any
    always: bool


@dataclass(frozen=True)
class _Children:
    kinds: Kinds
    many: bool
    wrapper: str
    always: bool


@dataclass(frozen=True)
class _Kept:
    tags: tuple[str, ...]


@dataclass(frozen=True)
class _Text:
    pass


def attribute(
    name: str = "",
    form: str = "string",
    *,
    choices: tuple[str, ...] = (),
    default: Any = dataclasses.MISSING,
    always: bool = False,
) -> Any:
    """An attribute of the field's name, or of `name`; `form` is one of `lexical.FORMS`. Required
    without a `default`; one that has the default is not written, unless it is to be `always`."""
    required = default is dataclasses.MISSING
    spec = _Attribute(name, form, choices, required, None if required else default, always)
    return field(default=default, metadata={_XML: spec})


def child(*kinds: type[Element], wrapper: str = "", optional: bool = True) -> Any:
    """At most one child element, inside an element `wrapper` if that is given."""
    spec = _Children(lambda: kinds, False, wrapper, not optional)
    return field(default=None if optional else dataclasses.MISSING, metadata={_XML: spec})


def children(kinds: Kinds, *, wrapper: str = "", always: bool = False) -> Any:
    """Any number of child elements; the `wrapper` is left out when there are none, unless it is
    to be there `always`."""
    return field(default=(), metadata={_XML: _Children(kinds, True, wrapper, always)})


def as_it_is(*tags: str) -> Any:
    """Child elements that are kept and not read, in their place."""
    return field(default=(), metadata={_XML: _Kept(tags)})


def text() -> Any:
    """The text of the element before its first child, without white space around it."""
    return field(default="", metadata={_XML: _Text()})


def read(kind: type[E], content: bytes, where: str) -> E:
    """A document; raises `ExperimentError` naming file and line."""
    root = markup.parse(content, where)
    if root.tag not in {markup.clark(tag) for tag in kind.TAGS}:
        raise ExperimentError(
            f"{where}: the root element is {markup.shown(root.tag)}, not {kind.TAGS[0]} "
            f"(of the namespace {markup.NAMESPACES[kind.TAGS[0].partition(':')[0]]})"
        )
    known = set(markup.NAMESPACES.values())
    others = [(p, uri) for p, uri in sorted(root.nsmap.items(), key=str) if p and uri not in known]
    others = [(p, uri) for p, uri in others if p not in markup.NAMESPACES]
    return dataclasses.replace(_from_xml(kind, root, where, 0), namespaces=tuple(others))


def write(element: Element) -> bytes:
    """The bytes of a document; raises `ExperimentError` for text that XML cannot hold."""
    used = {tag.partition(":")[0] for tag in _tags(element)}
    nsmap = {p: uri for p, uri in markup.NAMESPACES.items() if p in used}
    nsmap |= dict(element.namespaces)
    try:
        return markup.serialise(_to_xml(element, nsmap, 0))
    except ValueError as fault:
        raise ExperimentError(f"{element.tag} cannot be written as XML: {fault}") from fault


def _specs(kind: Any) -> tuple[tuple[str, Any], ...]:
    """Field names with their specs, in order."""
    return tuple((f.name, f.metadata[_XML]) for f in dataclasses.fields(kind) if _XML in f.metadata)


def _from_xml(kind: type[E], element: Any, where: str, depth: int) -> E:
    place = f"{where} line {element.sourceline}"
    if depth > markup.MAX_DEPTH:
        raise ExperimentError(f"{place}: elements are nested deeper than {markup.MAX_DEPTH}")
    attributes = dict(element.attrib)
    left = [one for one in element if isinstance(one.tag, str)]
    values: dict[str, Any] = {"tag": markup.shown(element.tag)}
    for name, spec in _specs(kind):
        if isinstance(spec, _Attribute):
            given = attributes.pop(spec.name or name, None)
            values[name] = _attribute_value(spec, spec.name or name, given, place, values["tag"])
        elif isinstance(spec, _Text):
            values[name] = (element.text or "").strip()
        elif isinstance(spec, _Kept):
            values[name] = tuple(markup.keep(one, place) for one in _take(left, spec.tags))
        else:
            values[name] = _child_values(spec, left, where, place, values["tag"], depth)
    values["more_attributes"] = tuple(attributes.items())
    values["more"] = tuple(markup.keep(one, place) for one in left)
    return kind(**values)


def _attribute_value(spec: _Attribute, name: str, given: str | None, place: str, tag: str) -> Any:
    if given is None:
        if spec.required:
            raise ExperimentError(f"{place}: {tag} lacks its attribute {name!r}")
        return spec.default
    if spec.choices and given not in spec.choices:
        raise ExperimentError(
            f"{place}: {tag}: {name}={given!r} is not legal; {nearest(given, spec.choices)}"
        )
    try:
        return FORMS[spec.form].read(given)
    except ValueError as fault:
        raise ExperimentError(f"{place}: {tag}: {name}={given!r} is {fault}") from fault


def _child_values(
    spec: _Children, left: list[Any], where: str, place: str, tag: str, depth: int
) -> Any:
    if spec.wrapper:
        wrappers = _take(left, (spec.wrapper,))
        pool = [one for wrapper in wrappers for one in wrapper if isinstance(one.tag, str)]
    else:
        pool = left
    by_tag = {markup.clark(t): kind for kind in spec.kinds() for t in kind.TAGS}
    found = _take(pool, tuple(by_tag), clark=True)
    if spec.wrapper and pool:
        raise ExperimentError(
            f"{where} line {pool[0].sourceline}: {markup.shown(pool[0].tag)} may not stand in "
            f"{spec.wrapper}"
        )
    made = tuple(_from_xml(by_tag[one.tag], one, where, depth + 1) for one in found)
    if spec.many:
        return made
    if len(made) > 1 or (spec.always and not made):
        wanted = " or ".join(t for kind in spec.kinds() for t in kind.TAGS[:3])
        count = "one" if spec.always else "at most one"
        raise ExperimentError(f"{place}: {tag} must hold {count} {wanted}, not {len(made)}")
    return made[0] if made else None


def _take(left: list[Any], tags: tuple[str, ...], *, clark: bool = False) -> list[Any]:
    """Remove the elements with these tags from `left` and return them."""
    wanted = set(tags) if clark else {markup.clark(tag) for tag in tags}
    found = [one for one in left if one.tag in wanted]
    left[:] = [one for one in left if one.tag not in wanted]
    return found


def _to_xml(element: Element, nsmap: Mapping[str, str], depth: int) -> Any:
    made = etree.Element(markup.clark(element.tag), nsmap=dict(nsmap))
    inner: list[Any] = []
    for name, spec in _specs(type(element)):
        value = getattr(element, name)
        if isinstance(spec, _Attribute):
            if spec.required or spec.always or value != spec.default:
                made.set(spec.name or name, FORMS[spec.form].write(value))
        elif isinstance(spec, _Text):
            made.text = value or None
        elif isinstance(spec, _Kept):
            inner += [markup.kept(one) for one in value]
        else:
            inner += _child_elements(spec, value, nsmap, depth + 1)
    for key, given in element.more_attributes:
        made.set(key, given)
    inner += [markup.kept(one) for one in element.more]
    _append(made, inner, depth)
    return made


def _child_elements(spec: _Children, value: Any, nsmap: Mapping[str, str], depth: int) -> list[Any]:
    given = value if spec.many else [value] if value is not None else []
    deeper = depth + bool(spec.wrapper)
    elements = [_to_xml(one, nsmap, deeper) for one in given]
    if not spec.wrapper or (not elements and not spec.always):
        return elements
    wrapper = etree.Element(markup.clark(spec.wrapper), nsmap=dict(nsmap))
    _append(wrapper, elements, depth)
    return [wrapper]


def _append(made: Any, inner: list[Any], depth: int) -> None:
    """Put children into an element, each on a line of its own, without touching their content."""
    if not inner:
        return
    if not made.text:
        made.text = "\n" + _INDENT * (depth + 1)
    for one in inner:
        one.tail = "\n" + _INDENT * (depth + 1)
        made.append(one)
    inner[-1].tail = "\n" + _INDENT * depth


def _tags(element: Element) -> set[str]:
    found = {element.tag}
    for name, spec in _specs(type(element)):
        if isinstance(spec, _Children):
            value = getattr(element, name)
            given = value if spec.many else [value] if value is not None else []
            found |= {spec.wrapper} if spec.wrapper and (given or spec.always) else set()
            found = found.union(*(_tags(one) for one in given))
    return found
