"""What the timing contract comes to for a system: the schedule in words, and delays measured.

The delays are measured, not derived: the system is run twice, the second time with a pulse in the
output of one controller at one sample; the first instant at which anything else differs between
the two runs is when it got there.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.clock import show
from harness.fmi.fmu import Fmu
from harness.master.plan.actions import Action, Iterate
from harness.master.plan.planner import Plan
from harness.master.recorded import columns_of
from harness.master.run import execute, plan_system
from harness.results.recording import Recording
from harness.results.result import Result
from harness.system.block import Array, KernelBlock
from harness.system.graph import (
    BlockComponent,
    Component,
    Endpoint,
    FmuComponent,
    PythonComponent,
    SensitivityComponent,
    SignalComponent,
    System,
)

PULSE_SAMPLE = 3
_SAMPLES_AFTER = 12
_WATCHING = (SignalComponent, SensitivityComponent)
_SIZES = (1e-3, 1.0, 1e3)  # the first pulse that moves anything is taken


@dataclass(frozen=True)
class Arrival:
    """When a pulse computed at `computed_ns` showed first in `port`, None where it never did."""

    port: Endpoint
    computed_ns: int
    arrived_ns: int | None
    period_ns: int

    @property
    def samples(self) -> float | None:
        """The delay in samples of the controller."""
        if self.arrived_ns is None:
            return None
        return (self.arrived_ns - self.computed_ns) / self.period_ns


def schedule(plan: Plan) -> Iterator[tuple[str, str]]:
    """Pairs (instant, what happens) of one cycle, in order."""
    for instant in plan.instants:
        for line in _lines(instant.actions):
            yield show(instant.offset_ns) if instant.offset_ns else "0 s", line


def _lines(actions: Iterable[Action], indent: str = "") -> Iterator[str]:
    for action in actions:
        yield f"{indent}{action}"
        if isinstance(action, Iterate):
            yield from _lines(action.body, indent + "    ")


def measure_delays(system: System, fmus: Mapping[str, Fmu]) -> dict[Endpoint, tuple[Arrival, ...]]:
    """For each controller output that drives an FMU: when a pulse in it arrives where.

    Every controller's outputs are held at their start values in both runs, so that the loop is
    open and the pulse is the only difference.
    """
    found = {}
    for connection in system.connections:
        source = system.component(connection.source.component)
        target = system.component(connection.target.component)
        if isinstance(source, (BlockComponent, PythonComponent)) and isinstance(
            target, FmuComponent
        ):
            found[connection.source] = _measure(system, fmus, connection.source)
    return found


def _measure(system: System, fmus: Mapping[str, Fmu], pulsed: Endpoint) -> tuple[Arrival, ...]:
    source = system.component(pulsed.component)
    assert isinstance(source, (BlockComponent, PythonComponent))
    computed = system.start_ns + source.phase_ns + PULSE_SAMPLE * source.period_ns
    ports = _watched(system, pulsed)
    baseline = _run(_opened(system, pulsed, 0.0), fmus, ports)
    times: list[int | None] = []
    for size in _SIZES:
        found = _run(_opened(system, pulsed, size), fmus, ports)
        times = [_first_difference(p, baseline, found, system.ticks_per_second) for p in ports]
        if any(time is not None for time in times[1:]):
            break
    arrivals = zip(ports, times, strict=True)
    return tuple(Arrival(port, computed, time, source.period_ns) for port, time in arrivals)


def _watched(system: System, pulsed: Endpoint) -> list[Endpoint]:
    """The pulsed output, the FMU inputs it drives, and the block inputs it may come back to."""
    driven = [c.target for c in system.connections if c.source == pulsed]
    fmus = {component.name for component in system.fmus}
    back = [
        c.target for c in system.connections
        if c.source.component in fmus and c.target.component not in fmus
    ]  # fmt: skip
    return [pulsed, *driven, *back]


def _opened(system: System, pulsed: Endpoint, size: float) -> System:
    """All controllers replaced by constants, the pulsed one by a pulse of `size`."""
    periods = [c.period_ns for c in system.components if not isinstance(c, _WATCHING)]
    delays = [c.delay_ns for c in system.connections if c.delay_ns]
    phases = [c.phase_ns for c in system.components]
    record = math.gcd(*periods, *delays, *phases)
    longest = max([*periods, *delays])
    length = math.lcm(*[c.step_ns for c in system.fmus])
    wanted = (PULSE_SAMPLE + _SAMPLES_AFTER) * longest
    return replace(
        system,
        components=tuple(_held(c, pulsed, size) for c in system.components),
        record_ns=record,
        stop_ns=system.start_ns + -(-wanted // length) * length,
    )


def pulse_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """p = (sample, place, size, start values…): the outputs are held, one of them is pulsed."""
    for i in range(y.shape[0]):
        y[i] = p[3 + i]
    if x[0] == p[0] and p[1] >= 0.0:
        y[int(p[1])] += p[2]
    x[0] += 1.0


def _held(c: Component, pulsed: Endpoint, size: float) -> Component:
    """A block of constants with that pulse in place of a controller."""
    if not isinstance(c, (BlockComponent, PythonComponent)):
        return c
    names = [signal.name for signal in c.outputs]
    place = names.index(pulsed.variable) if c.name == pulsed.component else -1
    values = [PULSE_SAMPLE, place, size, *(signal.start for signal in c.outputs)]
    parameters = np.array(values, dtype=np.float64)
    block = KernelBlock(tuple(c.inputs), tuple(c.outputs), pulse_step, parameters, np.zeros(1))
    return BlockComponent(c.name, block, c.period_ns, c.phase_ns)


def _run(system: System, fmus: Mapping[str, Fmu], ports: list[Endpoint]) -> Result:
    plan = plan_system(system, fmus, tuple(map(str, dict.fromkeys(ports))))
    with Recording(columns_of(plan, fmus)) as recording:
        outcome = execute(plan, fmus, recording)
        if outcome.fault is not None:
            raise outcome.fault
        return recording.finish()


def _first_difference(port: Endpoint, first: Result, second: Result, ticks: int) -> int | None:
    changed = np.flatnonzero(first[str(port)] != second[str(port)])
    return round(float(first.time[changed[0]]) * ticks) if changed.size else None
