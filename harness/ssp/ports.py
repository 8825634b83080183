"""The ends of connections: connectors of systems and FMUs, and entries of signal dictionaries.

What a connector does not state is taken from the variable of the FMU behind it. A unit that both
state differently is that of the connector: it was written by whoever put the system together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from harness.errors import ExperimentError, at, nearest
from harness.fmi.description.model_description import ModelDescription, Variable
from harness.fmi.start_values import find_target
from harness.ssp.common import DataType
from harness.ssp.document import DICTIONARY_TYPE, DictionaryReference
from harness.ssp.parameters import Dictionary
from harness.ssp.tree import Definitions, Tree, TreePath
from harness.system.units import Unit, parse_unit

SOURCES = ("output", "calculatedParameter", "constant", "local", "independent")
SINKS = ("input", "parameter", "structuralParameter")
Describe = Callable[[Path], ModelDescription]


@dataclass(frozen=True)
class Node:
    """A connector of the element at `path`, or with `dictionary` an entry of that dictionary of
    the system at `path`."""

    path: TreePath
    name: str
    dictionary: str = ""

    def __str__(self) -> str:
        owner = ".".join((*self.path, *([self.dictionary] if self.dictionary else [])))
        return f"{owner}.{self.name}" if owner else self.name


@dataclass(frozen=True)
class Port:
    """What is known of a node: `kind` as seen from outside, unit, type and enumeration items."""

    kind: str
    unit: Unit | None = None
    type: str = ""
    items: Mapping[str, int] | None = None


class Ports:
    """Looks up nodes of a tree; FMUs are described by `describe`."""

    def __init__(self, tree: Tree, describe: Describe) -> None:
        self.tree = tree
        self.describe = describe
        self.port = cache(self._find)
        """What a node is; raises `ExperimentError` for a connector that does not exist."""
        self._entries = cache(self._read_dictionary)

    def variable_unit(self, node: Node) -> Unit | None:
        """The unit of the FMU's variable, whatever the connector says."""
        description = self.describe(self.tree.fmu_at[node.path].source)
        return unit_of(description.variables.get(node.name), description)

    def referred(self, path: TreePath, reference: DictionaryReference, name: str) -> Node:
        """The dictionary entry behind a reference's connector, in this or an enclosing system."""
        known: list[str] = []
        for depth in range(len(path), -1, -1):
            for one in self.tree.system_at[path[:depth]].element.dictionaries:
                known.append(one.name)
                if one.name == reference.dictionary:
                    return Node(path[:depth], name, one.name)
        where = self.tree.system_at[path].scope.where
        raise ExperimentError(
            f"{where}: signal dictionary reference {'.'.join((*path, reference.name))}: there is "
            f"no dictionary {reference.dictionary!r} in its system or around it; "
            f"{nearest(reference.dictionary, known)}"
        )

    def _find(self, node: Node) -> Port:
        if node.dictionary:
            entries = self._entries(node.path, node.dictionary)
            if node.name not in entries:
                hint = nearest(node.name, entries)
                raise ExperimentError(f"dictionary {node.dictionary} has no {node.name!r}; {hint}")
            return entries[node.name]
        if node.path in self.tree.fmu_at:
            return self._of_fmu(node)
        system = self.tree.system_at[node.path]
        connector = system.element.connector(node.name)
        if connector is None:
            hint = nearest(node.name, [c.name for c in system.element.connectors])
            raise ExperimentError(f"there is no connector {node}; {hint}")
        return _typed(connector.kind, connector.type, system.scope.definitions)

    def _of_fmu(self, node: Node) -> Port:
        fmu = self.tree.fmu_at[node.path]
        description = self.describe(fmu.source)
        target = find_target(description, node.name)
        connector = fmu.element.connector(node.name)
        if target is None:
            raise ExperimentError(
                f"FMU {fmu.source.name} of {'.'.join(node.path)} has no variable "
                f"{node.name!r}; {nearest(node.name, description.variables)}"
            )
        variable = target[0]
        own = unit_of(variable, description)
        if connector is None:
            return Port(variable.causality, own, variable.type)
        said = _typed(connector.kind, connector.type, fmu.scope.definitions)
        kind = said.kind if said.kind not in ("inout", "unspecified") else variable.causality
        return Port(kind, said.unit or own, said.type or variable.type, said.items)

    def _read_dictionary(self, path: TreePath, name: str) -> dict[str, Port]:
        system = self.tree.system_at[path]
        given = next(d for d in system.element.dictionaries if d.name == name)
        with at(f"{system.scope.where}: signal dictionary {name}"):
            content = system.scope.content(Dictionary, given, DICTIONARY_TYPE)
        definitions = Definitions(content)
        return {one.name: _typed("inout", one.type, definitions) for one in content.entries}


def _typed(kind: str, given: DataType | None, known: Definitions) -> Port:
    if given is None:
        return Port(kind)
    return Port(kind, known.unit(given.unit), given.kind, known.items(given.name))


def unit_of(variable: Variable | None, description: ModelDescription) -> Unit | None:
    """The unit of an FMU's variable, None where there is none."""
    unit = variable.unit if variable is not None else None
    return parse_unit(unit, description.units) if unit else None
