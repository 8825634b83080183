"""The tree of systems and FMUs that a description stands for, with all references followed.

A component that names another description, another package or, as "#id", a system of its own
document is replaced by that system. A component without a source is an empty system with the same
connectors. Units and enumerations belong to the document that defines them, so each element knows
its own. Nothing is opened but descriptions and packages.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from urllib.parse import unquote
from warnings import warn

from harness.errors import ExperimentError, nearest
from harness.ssp import binding
from harness.ssp import document as ssd
from harness.ssp.binding import E
from harness.ssp.package import DEFAULT, Package, open_package, read_bytes
from harness.ssp.parameters import Dictionary, ParameterSet
from harness.system.units import Unit, parse_unit

MAX_ELEMENTS = 100_000
MAX_NESTING = 60
TreePath = tuple[str, ...]


class Definitions:
    """The units and enumerations that a document defines, as the harness computes with them."""

    def __init__(self, document: ssd.SystemStructure | ParameterSet | Dictionary) -> None:
        self._units = {}
        for one in document.units:
            b = one.base
            exponents = (b.kg, b.m, b.s, b.A, b.K, b.mol, b.cd, b.rad)
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

    def resolve(self, uri: str, place: str) -> Path:
        """The file that a URI of this document names."""
        return self.package.resolve(uri, f"{self.where}: {place}", self.folder)

    def document(self, kind: type[E], uri: str, place: str) -> E:
        """The document at a URI of this one, which `place` names; raises `ExperimentError`."""
        where = f"{self.where}: {place}"
        return binding.read(kind, read_bytes(self.resolve(uri, place), where), f"{where}: {uri}")


@dataclass(frozen=True)
class SystemNode:
    """A system at its place; `bindings` are its own and those of the component it stands for."""

    path: TreePath
    element: ssd.SystemElement
    scope: Scope
    bindings: tuple[tuple[ssd.ParameterBinding, Scope], ...]


@dataclass(frozen=True)
class FmuNode:
    """An FMU at its place; `source` is the archive."""

    path: TreePath
    element: ssd.Component
    scope: Scope
    source: Path


@dataclass(frozen=True)
class Tree:
    """All systems and FMUs, each in document order, the root system first."""

    systems: tuple[SystemNode, ...]
    fmus: tuple[FmuNode, ...]

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
    structure = package.structures[file]
    builder = _Builder(stack)
    builder.add_system((), structure.system, _scope(package, structure, file), ())
    return Tree(tuple(builder.systems), tuple(builder.fmus))


def _scope(package: Package, structure: ssd.SystemStructure, file: str) -> Scope:
    return Scope(package, structure, package.folder, package.where(file))


@dataclass
class _Builder:
    stack: ExitStack
    systems: list[SystemNode] = field(default_factory=list)
    fmus: list[FmuNode] = field(default_factory=list)
    packages: dict[Path, Package] = field(default_factory=dict)
    entered: list[object] = field(
        default_factory=list
    )  # documents and systems that the current one is in
    count: int = 0

    def add_system(
        self,
        path: TreePath,
        element: ssd.SystemElement,
        scope: Scope,
        bindings: tuple[tuple[ssd.ParameterBinding, Scope], ...],
    ) -> None:
        """A system with all that is in it; `bindings` are those given from outside."""
        place = f"{scope.where}: system {'.'.join(path) or element.name}"
        own = tuple((one, scope) for one in element.bindings)
        self.systems.append(SystemNode(path, element, scope, (*own, *bindings)))
        if len(path) > MAX_NESTING:
            raise ExperimentError(f"{place}: systems are nested deeper than {MAX_NESTING}")
        seen: set[str] = set()
        for one in element.elements:
            self.count += 1
            if self.count > MAX_ELEMENTS:
                raise ExperimentError(f"{place}: more than {MAX_ELEMENTS} elements in all")
            if one.name in seen or not one.name:
                raise ExperimentError(f"{place}: the element name {one.name!r} is used twice")
            seen.add(one.name)
            if isinstance(one, ssd.SystemElement):
                self.add_system((*path, one.name), one, scope, ())
            elif not isinstance(one, ssd.DictionaryReference):
                self._add_component((*path, one.name), one, scope)

    def _add_component(self, path: TreePath, one: ssd.Component, scope: Scope) -> None:
        place = f"{scope.where}: component {'.'.join(path)}"
        if one.source is None:
            warn(f"{place} has no source; it is taken as an empty system", stacklevel=2)
            self._replace(path, one, scope, ssd.SystemElement(name=one.name), scope, path)
        elif one.source.startswith("#"):
            found = _by_id(scope.structure.system, one.source[1:])
            if found is None:
                raise ExperimentError(f"{place}: no system has the id {one.source[1:]!r}")
            self._replace(path, one, scope, found, scope, id(found))
        elif one.type == ssd.FMU_TYPE:
            source = scope.resolve(one.source, f"component {'.'.join(path)}")
            self.fmus.append(FmuNode(path, one, scope, source))
        elif one.type in (ssd.SSD_TYPE, ssd.SSP_TYPE):
            inner = self._referred(one, scope, place)
            document = scope.resolve(one.source.partition("#")[0], place)
            key = (document, inner.structure.name)
            self._replace(path, one, scope, inner.structure.system, inner, key)
        else:
            raise ExperimentError(
                f"{place} is of type {one.type!r}; FMUs ({ssd.FMU_TYPE}) and other descriptions "
                "can be run"
            )

    def _replace(
        self,
        path: TreePath,
        one: ssd.Component,
        scope: Scope,
        system: ssd.SystemElement,
        inner: Scope,
        key: object,
    ) -> None:
        """A system in the place of a component, with the connectors that only the latter states,
        unless it is in that system, known by `key`, itself."""
        if key in self.entered:
            place = f"{scope.where}: component {'.'.join(path)}"
            raise ExperimentError(f"{place}: {one.source!r} would be a part of itself")
        self.entered.append(key)
        known = {c.name for c in system.connectors}
        more = tuple(c for c in one.connectors if c.name not in known)
        merged = replace(system, name=one.name, connectors=(*system.connectors, *more))
        self.add_system(path, merged, inner, tuple((b, scope) for b in one.bindings))
        self.entered.pop()

    def _referred(self, one: ssd.Component, scope: Scope, place: str) -> Scope:
        """The document that a component names, of a package or beside its own."""
        uri, _, fragment = (one.source or "").partition("#")
        path = scope.resolve(uri, place.rpartition(": ")[2])
        if one.type == ssd.SSD_TYPE:
            where = f"{scope.where}: {uri}"
            structure = binding.read(ssd.SystemStructure, read_bytes(path, where), where)
            return Scope(scope.package, structure, path.parent, where)
        if path not in self.packages:
            self.packages[path] = self.stack.enter_context(open_package(path))
        package, file = self.packages[path], unquote(fragment) or DEFAULT
        if file not in package.structures:
            raise ExperimentError(
                f"{place}: {uri} has no root description {file!r}; "
                f"{nearest(file, package.structures)}"
            )
        return _scope(package, package.structures[file], file)


def _by_id(system: ssd.SystemElement, wanted: str) -> ssd.SystemElement | None:
    if system.id == wanted:
        return system
    for one in system.elements:
        found = _by_id(one, wanted) if isinstance(one, ssd.SystemElement) else None
        if found is not None:
            return found
    return None
