"""Reduces what is put on wires to components, so that the planner knows components only.

A wire with imperfections becomes a chain of blocks, one an imperfection, run at the rate of the
reader (of the source where the reader is an FMU); a random or added source becomes a signal
component. A wire with a delay becomes a delay line that runs when values arrive: d after the
sample instants of the source, even between the instants of everything else. The chain works in
the unit of the source; the last wire converts it to that of the target.

The components made here are named after the wire's target: "controller.measured/noise",
"plant.command/delay".
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from harness.clock import to_seconds
from harness.instruments.imperfections import Imperfection
from harness.system.check import Descriptions, inputs_of, outputs_of
from harness.system.delay import delay_block
from harness.system.graph import (
    BlockComponent,
    Component,
    Connection,
    Endpoint,
    FmuComponent,
    SampledComponent,
    SignalComponent,
    System,
)
from harness.system.units import Unit, conversion, exact_conversion


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

    def component(self, name: str) -> Component:
        """The component of that name; raises KeyError."""
        return {c.name: c for c in self.components}[name]


@dataclass(frozen=True)
class Rate:
    """Sample instants `phase_ns + k * period_ns`, k = 0, 1, …"""

    period_ns: int
    phase_ns: int = 0


def rate_of(component: Component) -> Rate:
    """The instants at which a component's outputs change."""
    if isinstance(component, FmuComponent):
        return Rate(component.step_ns)
    return Rate(component.period_ns, component.phase_ns)


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
    if (connection.factor, connection.offset) == (1.0, 0.0):
        return conversion(source, target)
    unit_factor, unit_offset = exact_conversion(source, target)
    factor = Fraction(connection.factor)
    return float(factor * unit_factor), float(factor * unit_offset + Fraction(connection.offset))


class _Chain:
    """Grows the chain of components on one wire; `end` is where the next link starts."""

    def __init__(self, system: System, connection: Connection) -> None:
        source = system.component(connection.source.component)
        target = system.component(connection.target.component)
        self.target = connection.target
        self.source_rate = rate_of(source)
        self.link_rate = rate_of(source if isinstance(target, FmuComponent) else target)
        self.end = connection.source
        self.made: list[SampledComponent] = []
        self.wires: list[Wire] = []

    def add_imperfection(self, imperfection: Imperfection) -> None:
        rate = self.link_rate
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
        self.source_rate = rate

    def add_delay(self, delay_ns: int) -> None:
        rate = self.source_rate
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
