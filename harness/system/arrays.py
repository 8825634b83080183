"""Arrays of FMI 3 in a system: every signal inside the harness is a scalar.

An element is a port of its own, "a[1]" or "a[2,3]" with indices from 1. A wire between whole
arrays of equal dimensions stands for one wire an element; what is on it (delay, imperfections) is
on each of them. It refuses to wire arrays of different dimensions, and an array to a scalar: the
check of the system names both.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from harness.fmi.description.model_description import ModelDescription, element_names
from harness.system.graph import Connection, Endpoint, System


def expand_arrays(system: System, descriptions: Mapping[str, ModelDescription]) -> System:
    """`system` with wires between whole arrays replaced by wires between their elements."""
    connections = tuple(
        one for connection in system.connections for one in _expanded(connection, descriptions)
    )
    return replace(system, connections=connections)


def _expanded(
    connection: Connection, descriptions: Mapping[str, ModelDescription]
) -> Iterator[Connection]:
    ends = (connection.source, connection.target)
    found = [
        descriptions[end.component].variables.get(end.variable)
        for end in ends
        if end.component in descriptions
    ]
    arrays = [variable for variable in found if variable is not None and variable.shape]
    if len(arrays) < 2 or arrays[0].shape != arrays[1].shape:
        yield connection
        return
    for one, other in zip(*(element_names(v.name, v.shape) for v in arrays), strict=True):
        yield replace(
            connection,
            source=Endpoint(connection.source.component, one),
            target=Endpoint(connection.target.component, other),
        )
