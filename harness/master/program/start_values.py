"""What stands at the ports of blocks before they have computed for the first time, and at those
elements of array inputs that nothing is wired to.

A block's output has the start value that the block states. Where it states none (0, the default)
and drives an input of an FMU, by a plain wire, a delay or imperfections, it has the value that
makes the input its own start value: that of the component's `start_values`, else that of the
model description. So an FMU is initialised, and runs until the first value arrives, with the
inputs that its maker or the user gave it. Where an output drives several inputs, the first wire
counts; where 0 is meant against the FMU's start value, `start_values` of the component say so.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.fmi.binding.values import parse_value
from harness.fmi.description.model_description import ModelDescription
from harness.fmi.start_values import judge_start_values
from harness.master.plan.planner import Plan
from harness.participants.access import scalar_ports
from harness.system.check import TEXT_TYPES, inputs_of
from harness.system.graph import (
    BlockComponent,
    Endpoint,
    FmuComponent,
    PythonComponent,
)


def start_values(plan: Plan, descriptions: Mapping[str, ModelDescription]) -> dict[Endpoint, Any]:
    """The value of every port of what is no FMU, before anything has been computed, and of the
    elements of FMU inputs."""
    lowered = plan.lowered
    given = {
        c.name: judge_start_values(d, c.start_values, component=c.name, validate=False).told
        for c in lowered.fmus
        for d in (descriptions[c.name],)
    }

    def input_start(end: Endpoint) -> Any:
        told = given[end.component]
        array, place = descriptions[end.component].elements.get(end.variable, (None, 0))
        if array is not None and array.name in told:
            return told[array.name][place]
        port = descriptions[end.component].port(end.variable)
        if port.type in TEXT_TYPES and end.variable not in told:
            return parse_value(port, port.start or "")
        ports = inputs_of(lowered.system.component(end.component), descriptions)
        return told.get(end.variable, ports[end.variable].start)

    elements = {
        end: input_start(end)
        for end in scalar_ports(plan.written, descriptions)
        if end.variable in descriptions[end.component].elements
    }
    values = {
        Endpoint(component.name, signal.name): signal.start
        for component in lowered.sampled
        for signal in (*component.inputs, *component.outputs)
    }
    scales = {wire.target: (wire.factor, wire.offset) for wire in lowered.wires}
    taken: dict[Endpoint, Any] = {}
    for connection in lowered.system.connections:
        source, target = connection.source, connection.target
        block, driven = (lowered.system.component(end.component) for end in (source, target))
        is_block = isinstance(block, (BlockComponent, PythonComponent))
        if is_block and isinstance(driven, FmuComponent) and values[source] == 0.0:
            start = input_start(target)
            if scales[target] != (1.0, 0.0):
                factor, offset = scales[target]
                start = (start - offset) / factor
            taken.setdefault(source, start)
    return values | taken | elements
