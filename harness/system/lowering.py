"""Reduces arrays, and what is put on wires, to components, so that the planner knows scalars only.

Every signal inside the harness is a scalar. An element of an array of FMI 3 is a port of its own,
"a[1]" or "a[2,3]" with indices from 1. A wire between whole arrays of equal dimensions stands for
one wire an element; what is on it is on each of them. Arrays of different dimensions, and an array
and a scalar, are not wired: the check of the system names both.

A wire with imperfections becomes a chain of blocks, one an imperfection, run at the rate of the
reader (of the source where the reader is an FMU); a random or added source becomes a signal
component. A wire with a delay becomes a delay line that runs when values arrive: d after the
sample instants of the source, even between the instants of everything else. The chain works in
the unit of the source; the last wire converts it to that of the target.

The delay line runs before everything else at its instant, so that with depth 0 it passes on what
was held until then; that is how a delay of one sample comes about without a memory of its own. What
it gives before the first value arrives is filled in when a run is initialised: the initial value of
its source.

The components made here are named after the wire's target: "controller.measured/noise",
"plant.command/delay".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

import numpy as np

from harness.clock import to_seconds
from harness.fmi.description.model_description import element_names
from harness.instruments.imperfection_steps import delay_step, pass_step
from harness.instruments.imperfections import Imperfection
from harness.system.block import KernelBlock, Port
from harness.system.check import inputs_of, outputs_of
from harness.system.graph import (
    BlockComponent,
    Component,
    Connection,
    Descriptions,
    Endpoint,
    FmuComponent,
    SampledComponent,
    SignalComponent,
    System,
)
from harness.system.units import Unit, exact_conversion


@dataclass(frozen=True)
class DelayComponent(BlockComponent):
    """A delay line: runs before all else at its instants, which need not be on the plant's grid.

    It takes in the value of its source at `source_phase_ns + k * period_ns`.
    """

    source_phase_ns: int = 0


@dataclass(frozen=True)
class Wire:
    """A plain wire: target = factor * source + offset; a `linear` one is extrapolated."""

    source: Endpoint
    target: Endpoint
    factor: float = 1.0
    offset: float = 0.0
    linear: bool = False


@dataclass(frozen=True)
class LoweredSystem:
    """`system` with all that it puts on wires made explicit as components and plain wires."""

    system: System
    components: tuple[Component, ...]
    wires: tuple[Wire, ...]

    @property
    def fmus(self) -> tuple[FmuComponent, ...]:
        """The FMU components in order."""
        return self.system.fmus

    @property
    def fmu_wires(self) -> tuple[Wire, ...]:
        """The wires from FMU to FMU that nothing delays."""
        names = {c.name for c in self.fmus}
        return tuple(
            w for w in self.wires if w.source.component in names and w.target.component in names
        )

    @property
    def sampled(self) -> tuple[SampledComponent, ...]:
        """Everything that is no FMU."""
        return tuple(c for c in self.components if not isinstance(c, FmuComponent))

    @cached_property
    def by_name(self) -> dict[str, Component]:
        """The components by name."""
        return {c.name: c for c in self.components}

    @cached_property
    def wires_to(self) -> dict[str, tuple[Wire, ...]]:
        """The wires to each component."""
        found: dict[str, list[Wire]] = {name: [] for name in self.by_name}
        for wire in self.wires:
            found[wire.target.component].append(wire)
        return {name: tuple(wires) for name, wires in found.items()}


def expand_arrays(system: System, descriptions: Descriptions) -> System:
    """`system` with wires between whole arrays replaced by wires between their elements."""
    connections = tuple(
        one for connection in system.connections for one in _expanded(connection, descriptions)
    )
    return replace(system, connections=connections)


def _expanded(connection: Connection, descriptions: Descriptions) -> Iterator[Connection]:
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


def lower(system: System, descriptions: Descriptions) -> LoweredSystem:
    """Make imperfections, delays and unit conversions of a checked system explicit."""
    components: list[Component] = list(system.components)
    wires: list[Wire] = []
    for connection in system.connections:
        chain = _Chain(system, connection)
        for imperfection in connection.imperfections:
            chain.add_imperfection(imperfection)
        if connection.delay_ns:
            chain.add_delay(connection.delay_ns)
        source = outputs_of(system.component(connection.source.component), descriptions)
        target = inputs_of(system.component(connection.target.component), descriptions)
        factor, offset = _arithmetic(
            connection,
            source[connection.source.variable].unit,
            target[connection.target.variable].unit,
        )
        linear = connection.extrapolation == 1
        components += chain.made
        wires += [*chain.wires, Wire(chain.end, connection.target, factor, offset, linear)]
    return LoweredSystem(system, tuple(components), tuple(wires))


def _arithmetic(
    connection: Connection, source: Unit | None, target: Unit | None
) -> tuple[float, float]:
    """Factor and offset of the conversion of units and of the connection, in one."""
    if not connection.convert_units:
        return connection.factor, connection.offset
    unit_factor, unit_offset = exact_conversion(source, target)
    factor = Fraction(connection.factor)
    return float(factor * unit_factor), float(factor * unit_offset + Fraction(connection.offset))


class _Chain:
    """Grows the chain of components on one wire; `end` is where the next link starts, `timing` a
    component with the instants at which its value changes."""

    def __init__(self, system: System, connection: Connection) -> None:
        source = system.component(connection.source.component)
        target = system.component(connection.target.component)
        self.target = connection.target
        self.timing: Component = source
        self.link_timing = source if isinstance(target, FmuComponent) else target
        self.end = connection.source
        self.made: list[SampledComponent] = []
        self.wires: list[Wire] = []

    def add_imperfection(self, imperfection: Imperfection) -> None:
        rate = self.link_timing
        name = self._name(getattr(imperfection, "kind", type(imperfection).__name__.lower()))
        block = imperfection.block(to_seconds(rate.period_ns))
        self.made.append(BlockComponent(name, block, rate.period_ns, rate.phase_ns))
        self.wires.append(Wire(self.end, Endpoint(name, block.inputs[0].name)))
        if imperfection.source is not None:
            added = SignalComponent(
                f"{name}.source", imperfection.source, rate.period_ns, rate.phase_ns
            )
            self.made.append(added)
            value = Endpoint(added.name, "value")
            self.wires.append(Wire(value, Endpoint(name, block.inputs[1].name)))
        self.end = Endpoint(name, block.outputs[0].name)
        self.timing = rate

    def add_delay(self, delay_ns: int) -> None:
        rate = self.timing
        arrival = rate.phase_ns + delay_ns
        phase, samples = arrival % rate.period_ns, arrival // rate.period_ns
        # at its instant the line sees the value taken in before: that of the last sample where it
        # runs later in the cycle than its source, else one sample further back
        depth = samples if phase > rate.phase_ns else samples - 1
        name = self._name("delay")
        self.made.append(
            DelayComponent(name, delay_block(depth), rate.period_ns, phase, rate.phase_ns)
        )
        self.wires.append(Wire(self.end, Endpoint(name, "in")))
        self.end = Endpoint(name, "out")

    def _name(self, kind: str) -> str:
        taken = sum(
            c.name.startswith(f"{self.target}/{kind}") and not c.name.endswith(".source")
            for c in self.made
        )
        return f"{self.target}/{kind}" + (str(taken + 1) if taken else "")


def delay_block(depth: int) -> KernelBlock:
    """A delay of `depth` executions; its state is the next place and a ring of `depth` values."""
    step = delay_step if depth else pass_step
    return KernelBlock((Port("in"),), (Port("out"),), step, state=np.zeros(1 + depth))
