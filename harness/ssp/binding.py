"""Dataclasses bound to XML elements: one declaration by which they are read and written.

    class Unit(Element, tags="ssc:Unit"):
        name: str
        generation_tool: str | None = None
        base: BaseUnit
        annotations: tuple[Annotation, ...] = wrapped("Annotations")

A field is what its type says: numbers, texts and `Annotated[str, choices]` are attributes, by
default of the field's name in camel case; elements and tuples of elements are children. Fields
stand in the order of the schema, which is the order in which children are written. What a
declaration does not name (attributes and elements of other standards) goes through unchanged. This
module knows no element by name, and refuses values outside the XML schema's lexical forms.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field
from functools import cache
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    ClassVar,
    TypeVar,
    Union,
    dataclass_transform,
    get_args,
    get_origin,
    get_type_hints,
)

from lxml import etree

from harness.errors import ExperimentError, nearest
from harness.ssp import markup
from harness.ssp.lexical import FORMS

_INDENT = "  "


def attribute(name: str = "", *, default: Any = MISSING, always: bool = False) -> Any:
    """An attribute of another `name` than the field's; one that has the default is not written,
    unless it is to be `always`."""
    return field(default=default, metadata={"name": name, "always": always})


def wrapped(wrapper: str, *, default: Any = (), always: bool = False, last: bool = False) -> Any:
    """Children inside an element `wrapper`, which has the prefix of the parent and is left out
    without children unless it is to be there `always`; `last` are written after all others."""
    return field(default=default, metadata={"wrapper": wrapper, "always": always, "last": last})


def verbatim(*tags: str, last: bool = False) -> Any:
    """Child elements that are not read but written back, in their place."""
    return field(default=(), metadata={"verbatim": tags, "last": last})


def text() -> Any:
    """The text of the element before its first child, without white space around it."""
    return field(default="", metadata={"text": True})


@dataclass_transform(frozen_default=True, kw_only_default=True)
class _Bound:
    TAGS: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls, tags: str = "") -> None:
        cls.TAGS = tuple(tags.split())
        dataclass(frozen=True, kw_only=True)(cls)


class Element(_Bound):
    """An XML element; `tag` is the one of `tags` that it has (the first unless said otherwise).

    `more_attributes` and `more` are what the declaration does not name: pairs, and canonical XML.
    `namespaces` are the prefixes of others that the root element declares.
    """

    tag: str = ""
    more_attributes: tuple[tuple[str, str], ...] = ()
    more: tuple[str, ...] = ()
    namespaces: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        """Fill in the tag."""
        if not self.tag:
            object.__setattr__(self, "tag", self.TAGS[0])

    @classmethod
    @cache
    def _specs(cls) -> tuple[_Spec, ...]:
        """The fields in the order in which they are written."""
        hints = get_type_hints(cls, include_extras=True)
        own = {f.name for f in dataclasses.fields(Element)}
        found = [_spec(f, hints[f.name]) for f in dataclasses.fields(cls) if f.name not in own]
        return tuple(sorted(found, key=lambda spec: bool(spec.options.get("last"))))


E = TypeVar("E", bound=Element)


@dataclass(frozen=True)
class _Spec:
    """What a field is in XML: a child of `kinds` by tag, else an attribute in the form of `type`,
    unless `options`, those of the functions above, say otherwise."""

    field: str
    default: Any
    options: Mapping[str, Any]
    kinds: Mapping[str, type[Element]]
    many: bool
    type: type
    choices: tuple[str, ...]

    @property
    def required(self) -> bool:
        return self.default is MISSING

    @property
    def attribute(self) -> str:
        first, *others = self.field.split("_")
        return self.options.get("name") or first + "".join(map(str.capitalize, others))

    def wrapper_in(self, parent: Any) -> str:
        """The tag of the element around the children, "" for none."""
        name = self.options.get("wrapper")
        return f"{parent.tag.rpartition('}')[0]}}}{name}" if name else ""


def _spec(given: dataclasses.Field[Any], hint: Any) -> _Spec:
    leaves = [leaf for leaf in _leaves(hint) if leaf not in (NoneType, ...)]
    many = get_origin(hint) is tuple
    elements = [one for one in leaves if isinstance(one, type) and issubclass(one, Element)]
    kinds = {markup.clark(tag): one for one in elements for tag in one.TAGS}
    choices = leaves[0].__metadata__[0] if get_origin(leaves[0]) is Annotated else ()
    form = tuple if many else str if choices else leaves[0]
    return _Spec(given.name, given.default, given.metadata, kinds, many, form, choices)


def _leaves(hint: Any) -> list[Any]:
    """The types of which a union or tuple is made."""
    if get_origin(hint) in (Union, UnionType, tuple):
        return [leaf for one in get_args(hint) for leaf in _leaves(one)]
    return [hint]


def read(kind: type[E], content: bytes, where: str) -> E:
    """A document; raises `ExperimentError` naming file and line."""
    root = markup.parse(content, where)
    if root.tag not in {markup.clark(tag) for tag in kind.TAGS}:
        raise ExperimentError(
            f"{where}: the root element is {markup.shown(root.tag)}, not {kind.TAGS[0]} "
            f"(of the namespace {markup.NAMESPACES[kind.TAGS[0].partition(':')[0]]}); "
            "give a document of that kind"
        )
    known = {None, *markup.NAMESPACES, *markup.NAMESPACES.values()}
    others = [one for one in sorted(root.nsmap.items(), key=str) if known.isdisjoint(one)]
    return dataclasses.replace(_from_xml(kind, root, where, 0), namespaces=tuple(others))


def write(element: Element) -> bytes:
    """The bytes of a document; raises `ExperimentError` for text that XML cannot hold."""
    nsmap = {**markup.NAMESPACES, **dict(element.namespaces)}
    try:
        root = etree.Element(markup.clark(element.tag), nsmap=nsmap)
        _fill(root, element, 0)
    except ValueError as fault:
        raise ExperimentError(
            f"{element.tag} cannot be written as XML: {fault}; leave such characters out"
        ) from fault
    content: bytes = etree.tostring(root, xml_declaration=True, encoding="UTF-8")
    return content + b"\n"


def _from_xml(kind: type[E], element: Any, where: str, depth: int) -> E:
    place = f"{where} line {element.sourceline}"
    if depth > markup.MAX_DEPTH:
        raise ExperimentError(
            f"{place}: elements are nested deeper than {markup.MAX_DEPTH}; nest fewer"
        )
    attributes = dict(element.attrib)
    left = _elements(element)
    values: dict[str, Any] = {"tag": markup.shown(element.tag)}
    at = f"{place}: {values['tag']}"
    for spec in kind._specs():
        if "text" in spec.options:
            value: Any = (element.text or "").strip()
        elif "verbatim" in spec.options:
            tags = {markup.clark(tag) for tag in spec.options["verbatim"]}
            value = tuple(markup.canonical(one, place) for one in _take(left, tags))
        elif spec.kinds:
            value = _children(spec, element, left, where, depth + 1)
        else:
            value = _attribute(spec, attributes.pop(spec.attribute, None), at)
        values[spec.field] = value
    values["more_attributes"] = tuple(attributes.items())
    values["more"] = tuple(markup.canonical(one, place) for one in left)
    return kind(**values)


def _attribute(spec: _Spec, given: str | None, at: str) -> Any:
    if given is None:
        if spec.required:
            raise ExperimentError(f"{at} lacks its attribute {spec.attribute!r}; add it")
        return spec.default
    stated = f"{at}: {spec.attribute}={given!r} is"
    if spec.choices and given not in spec.choices:
        raise ExperimentError(f"{stated} not legal; {nearest(given, spec.choices)}")
    try:
        return FORMS[spec.type].read(given)
    except ValueError as fault:
        raise ExperimentError(f"{stated} {fault}") from fault


def _children(spec: _Spec, parent: Any, left: list[Any], where: str, depth: int) -> Any:
    pool, wrapper = left, spec.wrapper_in(parent)
    if wrapper:
        pool = [one for found in _take(left, {wrapper}) for one in _elements(found)]
    found = _take(pool, set(spec.kinds))
    if wrapper and pool:
        legal = " or ".join(dict.fromkeys(map(markup.shown, spec.kinds)))
        raise ExperimentError(
            f"{where} line {pool[0].sourceline}: {markup.shown(pool[0].tag)} may not stand in "
            f"{markup.shown(wrapper)}; only {legal} may"
        )
    made = tuple(_from_xml(spec.kinds[one.tag], one, where, depth) for one in found)
    if spec.many:
        return made
    if len(made) > 1 or (spec.required and not made):
        kinds = dict.fromkeys(spec.kinds.values())
        wanted = " or ".join(tag for kind in kinds for tag in kind.TAGS[:3])
        count = "one" if spec.required else "at most one"
        raise ExperimentError(
            f"{where} line {parent.sourceline}: {markup.shown(parent.tag)} must hold {count} "
            f"{wanted}, not {len(made)}; {'add one' if not made else 'leave the others out'}"
        )
    return made[0] if made else None


def _elements(parent: Any) -> list[Any]:
    """The children that are elements, not comments."""
    return [one for one in parent if isinstance(one.tag, str)]


def _take(left: list[Any], wanted: set[str]) -> list[Any]:
    """Remove the elements with these tags from `left` and return them."""
    found = [one for one in left if one.tag in wanted]
    left[:] = [one for one in left if one.tag not in wanted]
    return found


def _fill(made: Any, element: Element, depth: int) -> None:
    """Write the content of `element` into `made`."""
    for spec in element._specs():
        value = getattr(element, spec.field)
        if "text" in spec.options:
            made.text = value or None
        elif "verbatim" in spec.options:
            made.extend(map(markup.parsed, value))
        elif spec.kinds:
            _fill_children(made, spec, value if spec.many else [value] if value else [], depth)
        elif spec.options.get("always") or value != spec.default:
            made.set(spec.attribute, FORMS[spec.type].write(value))
    for key, given in element.more_attributes:
        made.set(key, given)
    made.extend(map(markup.parsed, element.more))
    _break_lines(made, depth)


def _fill_children(made: Any, spec: _Spec, elements: list[Element], depth: int) -> None:
    parent, wrapper = made, spec.wrapper_in(made)
    if wrapper and (elements or spec.options["always"]):
        depth += 1
        parent = etree.SubElement(made, wrapper)
    for one in elements:
        _fill(etree.SubElement(parent, markup.clark(one.tag)), one, depth + 1)
    if parent is not made:
        _break_lines(parent, depth)


def _break_lines(made: Any, depth: int) -> None:
    """Put each child on a line of its own, without touching what is in it."""
    inner = list(made)
    if not inner:
        return
    made.text = made.text or "\n" + _INDENT * (depth + 1)
    for one in inner:
        one.tail = "\n" + _INDENT * (depth + 1)
    inner[-1].tail = "\n" + _INDENT * depth
