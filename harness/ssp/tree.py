"""The tree of systems and FMUs that a description stands for, with all references followed.

A component that names another description, another package or, as "#id", a system of its own
document is replaced by that system. A component without a source is an empty system with the same
connectors. Units and enumerations belong to the document that defines them, so each element knows
its own. Nothing is opened but descriptions and packages.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from urllib.parse import unquote
from warnings import warn

from harness.errors import ExperimentError, at, nearest
from harness.ssp import DEFAULT, binding
from harness.ssp import document as ssd
from harness.ssp.binding import E
from harness.ssp.package import Package, open_package, read_document
from harness.ssp.parameters import Dictionary, ParameterSet
from harness.system.units import BASE_UNITS, Unit, parse_unit

MAX_ELEMENTS = 100_000
MAX_NESTING = 60
TreePath = tuple[str, ...]


class Definitions:
    """The units and enumerations that a document defines, as the harness computes with them."""

    def __init__(self, document: ssd.SystemStructure | ParameterSet | Dictionary) -> None:
        self._units = {}
        for one in document.units:
            b = one.base
            exponents = tuple(getattr(b, name) for name in BASE_UNITS)
            self._units[one.name] = Unit(one.name, exponents, b.factor, b.offset)
        self._enumerations = {
            one.name: {item.name: item.value for item in one.items} for one in document.enumerations
        }

    def unit(self, name: str | None) -> Unit | None:
        """The unit of that name, None where none is stated."""
        return parse_unit(name, self._units) if name else None

    def items(self, name: str | None) -> Mapping[str, int] | None:
        """The items of the enumeration of that name, None where none is defined."""
        return self._enumerations.get(name or "")


@dataclass(frozen=True)
class Scope:
    """A document as its elements see it: its units and enumerations, and where its URIs start."""

    package: Package
    structure: ssd.SystemStructure
    folder: Path
    where: str

    @cached_property
    def definitions(self) -> Definitions:
        """The units and enumerations that the document defines."""
        return Definitions(self.structure)

    def resolve(self, uri: str) -> Path:
        """The file that a URI of this document names; raises `ExperimentError`."""
        return self.package.resolve(uri, self.folder)

    def content(self, kind: type[E], given: ssd.Reference, legal: str, fmu: str | None = None) -> E:
        """What is `given` inline or by a source, relative to this document or into the `fmu` at
        that URI; its type must be the `legal` one. Raises `ExperimentError`."""
        if given.type != legal:
            raise ExperimentError(
                f"a {kind.__name__} of type {given.type!r} cannot be read; give one of {legal}"
            )
        uri = given.source
        if uri is None:
            if isinstance(given.inline, kind):
                return given.inline
            raise ExperimentError(
                f"the {kind.__name__} has neither a source nor a content; give it one of them"
            )
        if given.source_base == "SSD":
            return read_document(kind, self.resolve(uri), uri)
        if fmu is None:
            raise ExperimentError(
                f"{uri!r} is relative to a component without FMU; leave out its sourceBase"
            )
        return binding.read(kind, _member(self.resolve(fmu), uri), uri)


def _member(archive: Path, name: str) -> bytes:
    try:
        with zipfile.ZipFile(archive) as opened:
            return opened.read(name)
    except (OSError, KeyError, zipfile.BadZipFile, RuntimeError) as fault:
        raise ExperimentError(
            f"{archive.name} has no readable {name!r}; pack it into the FMU, or put it beside the "
            "description and leave out sourceBase"
        ) from fault


Bindings = tuple[tuple[ssd.ParameterBinding, Scope], ...]


@dataclass(frozen=True)
class SystemNode:
    """A system at its place; `bindings` are its own and those of the component it stands for."""

    path: TreePath
    element: ssd.SystemElement
    scope: Scope
    bindings: Bindings


@dataclass(frozen=True)
class FmuNode:
    """An FMU at its place; `source` is the archive."""

    path: TreePath
    element: ssd.Component
    scope: Scope
    source: Path

    @property
    def bindings(self) -> Bindings:
        """The parameters that are bound to it."""
        return tuple((one, self.scope) for one in self.element.bindings)


@dataclass(frozen=True)
class Tree:
    """All systems and FMUs, each in document order, the root system first."""

    systems: tuple[SystemNode, ...]
    fmus: tuple[FmuNode, ...]

    @property
    def nodes(self) -> tuple[SystemNode | FmuNode, ...]:
        """All of them, the systems first."""
        return (*self.systems, *self.fmus)

    @cached_property
    def system_at(self) -> Mapping[TreePath, SystemNode]:
        """The systems by place."""
        return {node.path: node for node in self.systems}

    @cached_property
    def fmu_at(self) -> Mapping[TreePath, FmuNode]:
        """The FMUs by place."""
        return {node.path: node for node in self.fmus}


def build_tree(package: Package, file: str, stack: ExitStack) -> Tree:
    """The tree of a root description; packages inside it are open until `stack` closes."""
    builder, scope = _Builder(stack), _scope(package, file)
    builder.add_system((), scope.structure.system, scope, ())
    return Tree(tuple(builder.systems), tuple(builder.fmus))


def _scope(package: Package, file: str) -> Scope:
    """A root description of a package; raises `ExperimentError`."""
    if file not in package.structures:
        hint = nearest(file, package.structures)
        raise ExperimentError(f"{package.path} has no root description {file!r}; {hint}")
    return Scope(package, package.structures[file], package.folder, package.where(file))


@dataclass
class _Builder:
    stack: ExitStack
    systems: list[SystemNode] = field(default_factory=list)
    fmus: list[FmuNode] = field(default_factory=list)
    packages: dict[Path, Package] = field(default_factory=dict)
    documents: dict[Path, Scope] = field(default_factory=dict)
    entered: list[int] = field(default_factory=list)  # ids of the systems around the current one
    count: int = 0

    def add_system(
        self, path: TreePath, element: ssd.SystemElement, scope: Scope, bindings: Bindings
    ) -> None:
        """A system with all that is in it; `bindings` are those given from outside."""
        place = f"{scope.where}: system {'.'.join(path) or element.name}"
        own = tuple((one, scope) for one in element.bindings)
        self.systems.append(SystemNode(path, element, scope, (*own, *bindings)))
        if len(path) > MAX_NESTING:
            raise ExperimentError(
                f"{place}: systems are nested deeper than {MAX_NESTING}; nest fewer"
            )
        seen: set[str] = set()
        for one in element.elements:
            self.count += 1
            if self.count > MAX_ELEMENTS:
                raise ExperimentError(
                    f"{place}: more than {MAX_ELEMENTS} elements in all; leave some out"
                )
            if one.name in seen or not one.name:
                fault = "is used twice" if one.name else "is empty"
                raise ExperimentError(
                    f"{place}: the element name {one.name!r} {fault}; give each its own"
                )
            seen.add(one.name)
            if isinstance(one, ssd.SystemElement):
                self.add_system((*path, one.name), one, scope, ())
            elif not isinstance(one, ssd.DictionaryReference):
                self._add_component((*path, one.name), one, scope)

    def _add_component(self, path: TreePath, one: ssd.Component, scope: Scope) -> None:
        """An FMU, or the system that a component stands for, with the connectors that only the
        component states."""
        place = f"{scope.where}: component {'.'.join(path)}"
        if one.source is None:
            warn(f"{place} has no source; it is taken as an empty system", stacklevel=2)
        with at(place):
            in_document = one.source is None or one.source.startswith("#")
            if one.type == ssd.FMU_TYPE and not in_document:
                self.fmus.append(FmuNode(path, one, scope, scope.resolve(one.source or "")))
                return
            system, inner = self._system_of(one, scope)
            if id(system) in self.entered:
                raise ExperimentError(
                    f"{one.source!r} would be a part of itself; name another system"
                )
        self.entered.append(id(system))
        known = {c.name for c in system.connectors}
        more = tuple(c for c in one.connectors if c.name not in known)
        merged = replace(system, name=one.name, connectors=(*system.connectors, *more))
        self.add_system(path, merged, inner, tuple((b, scope) for b in one.bindings))
        self.entered.pop()

    def _system_of(self, one: ssd.Component, scope: Scope) -> tuple[ssd.SystemElement, Scope]:
        """The system that a component names, of this document, of one beside it or of a package."""
        if one.source is None:
            return ssd.SystemElement(name=one.name), scope
        uri, _, fragment = one.source.partition("#")
        if not uri:
            found = _by_id(scope.structure.system, fragment)
            if found is None:
                raise ExperimentError(
                    f"no system has the id {fragment!r}; give it to one, or name another"
                )
            return found, scope
        path = scope.resolve(uri)
        if one.type == ssd.SSD_TYPE:
            if path not in self.documents:
                where = f"{scope.where}: {uri}"
                structure = read_document(ssd.SystemStructure, path, uri)
                self.documents[path] = Scope(scope.package, structure, path.parent, where)
            return self.documents[path].structure.system, self.documents[path]
        if one.type != ssd.SSP_TYPE:
            raise ExperimentError(
                f"it is of type {one.type!r}; give an FMU ({ssd.FMU_TYPE}), or a description "
                f"({ssd.SSD_TYPE}, {ssd.SSP_TYPE})"
            )
        if path not in self.packages:
            self.packages[path] = self.stack.enter_context(open_package(path))
        inner = _scope(self.packages[path], unquote(fragment) or DEFAULT)
        return inner.structure.system, inner


def _by_id(system: ssd.SystemElement, wanted: str) -> ssd.SystemElement | None:
    if system.id == wanted:
        return system
    for one in system.elements:
        found = _by_id(one, wanted) if isinstance(one, ssd.SystemElement) else None
        if found is not None:
            return found
    return None
