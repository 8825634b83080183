"""Items of enumerations on wires: they go by name where two FMUs give the same names other numbers.

FMI passes the number of an item, and nothing makes two FMUs number alike. A wire that has a
`value_map`, a factor or an offset says itself what becomes of numbers, and is left as it is.
"""

from __future__ import annotations

from dataclasses import replace

from harness.errors import GraphError
from harness.instruments.imperfections import ValueMap
from harness.system.graph import Connection, Descriptions, Endpoint, System


def match_items(system: System, descriptions: Descriptions) -> tuple[System, tuple[str, ...]]:
    """A checked `system` in which wires translate the numbers of items where it takes that, and a
    note for each such wire.

    Raises `GraphError` with one line for each wire where some items would go by name, and others
    are unknown to the target.
    """
    connections, notes, faults = [], [], []
    for connection in system.connections:
        source, target = (
            _items(end, descriptions) for end in (connection.source, connection.target)
        )
        moved = {n: (source[n], target[n]) for n in source if target.get(n, source[n]) != source[n]}
        if not moved or _says_itself(connection):
            connections.append(connection)
            continue
        label, unknown = (
            f"connection {connection.source} -> {connection.target}",
            set(source) - set(target),
        )
        if unknown:
            faults.append(
                f"{label}: items of the same name have other numbers ({_listed(moved)}), and the "
                f"target has no item {min(unknown)!r}; put a value_map with a table of numbers on "
                "the wire"
            )
            continue
        notes.append(f"{label}: items go by name, since their numbers differ ({_listed(moved)})")
        table = ValueMap(tuple(moved.values()))
        connections.append(replace(connection, imperfections=(*connection.imperfections, table)))
    if faults:
        raise GraphError("\n".join(faults))
    return replace(system, connections=tuple(connections)), tuple(notes)


def _items(end: Endpoint, descriptions: Descriptions) -> dict[str, int]:
    """The numbers of the items of a port by name; empty where it is no enumeration of an FMU."""
    if end.component not in descriptions:
        return {}
    return {
        name: number
        for number, name in descriptions[end.component].port(end.variable).details.items
    }


def _says_itself(connection: Connection) -> bool:
    mapped = any(isinstance(one, ValueMap) for one in connection.imperfections)
    return mapped or (connection.factor, connection.offset) != (1.0, 0.0)


def _listed(moved: dict[str, tuple[int, int]]) -> str:
    shown = [f"{name!r} {a} becomes {b}" for name, (a, b) in moved.items()]
    return ", ".join(shown[:3]) + (f" and {len(shown) - 3} more" if len(shown) > 3 else "")
