"""Random systems of mock FMUs, compiled blocks, plain Python controllers, signals and delays."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from harness.instruments.signals import make_signal
from harness.system.block import Array, KernelBlock, Port
from harness.system.graph import (
    BlockComponent,
    Component,
    Connection,
    Endpoint,
    FmuComponent,
    PythonComponent,
    SignalComponent,
    System,
)
from tests.harness.master.mock import FMI2_TYPES, FMI3_TYPES, Input, MockFmu, Output


def filter_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """x <- p0 x + p1 sum of u_i / (1 + i), y_i = x (1 + i): order and instants show in the bits."""
    total = 0.0
    for i in range(u.shape[0]):
        total += u[i] / (1 + i)
    x[0] = p[0] * x[0] + p[1] * total
    for i in range(y.shape[0]):
        y[i] = x[0] * (1 + i)


def control(time: float, *inputs: float) -> float:
    """A plain Python controller with the time in it."""
    return sum(inputs, 0.25 * time) / 4


@dataclass(frozen=True)
class Case:
    system: System
    fmus: dict[str, MockFmu]


@st.composite
def mock_fmus(draw: st.DrawFn) -> MockFmu:
    """An FMU with ports of any type; about half of its outputs depend directly on inputs, and some
    have a second or third name."""
    major = draw(st.sampled_from([2, 3]))
    kinds = st.sampled_from(FMI2_TYPES if major == 2 else FMI3_TYPES)
    real = "Real" if major == 2 else "Float64"
    mostly = st.one_of(st.just(real), st.just(real), kinds)
    inputs = tuple(Input(f"u{i}", draw(mostly)) for i in range(draw(st.integers(1, 3))))
    names = st.lists(st.sampled_from([port.name for port in inputs]), unique=True)
    free = draw(st.integers(0, 2))
    outputs = tuple(
        Output(f"y{i}", draw(mostly), 1.0 + i, () if i == free else tuple(sorted(draw(names))))
        for i in range(draw(st.integers(1, 3)))
    )
    also = draw(st.lists(st.sampled_from(outputs), max_size=3))
    outputs += tuple(port.also(f"also{i}") for i, port in enumerate(also))
    return MockFmu(inputs, outputs, major, state=draw(st.sampled_from([1.0, -0.75, 2.5])))


@st.composite
def systems(draw: st.DrawFn) -> Case:
    """A system that passes all checks: wires without delay go forwards where a loop threatens."""
    tick = draw(st.sampled_from([1_000_000, 700_000, 123_457]))
    fmus = {f"fmu{i}": draw(mock_fmus()) for i in range(draw(st.integers(1, 3)))}
    components: list[Component] = [
        FmuComponent(name, Path("mock.fmu"), tick * draw(st.sampled_from([2, 3, 4, 4])))
        for name in fmus
    ]
    longest = max(c.step_ns for c in components if isinstance(c, FmuComponent))
    for i in range(draw(st.integers(0, 1))):
        period = draw(st.sampled_from([longest, 2 * longest, 3 * tick]))
        source = make_signal("white_noise", {"std": 1.0})
        components.append(SignalComponent(f"signal{i}", source, period))
    for i in range(draw(st.integers(1, 3))):
        period = draw(st.sampled_from([longest, 2 * longest, 3 * longest, 3 * tick, 5 * tick]))
        phase = draw(st.sampled_from([0, tick, longest])) % period
        inputs = tuple(Port(f"u{j}") for j in range(draw(st.integers(1, 2))))
        outputs = tuple(Port(f"y{j}", start=0.5) for j in range(draw(st.integers(1, 2))))
        if draw(st.booleans()):
            block = KernelBlock(
                inputs, outputs, filter_step, np.array([0.5, 0.125]), np.array([0.25])
            )
            components.append(BlockComponent(f"block{i}", block, period, phase))
        else:
            components.append(
                PythonComponent(f"block{i}", control, inputs, outputs[:1], period, phase)
            )
    connections = [wire for c in components for wire in draw(wires(c, components, fmus, tick))]
    length = 48 * tick
    start = draw(st.sampled_from([0, 5 * tick]))
    system = System(
        tuple(draw(st.permutations(components))), tuple(draw(st.permutations(connections))), start,
        start + length, tick * draw(st.sampled_from([1, 4, 6])),
        draw(st.sampled_from(["jacobi", "gauss-seidel"])), 7,
    )  # fmt: skip
    return Case(system, fmus)


@st.composite
def wires(
    draw: st.DrawFn, target: Component, components: list[Component], fmus: dict[str, MockFmu],
    tick: int,
) -> list[Connection]:  # fmt: skip
    """Wires to all inputs of a component, or to most of them where it is an FMU."""
    made = []
    is_fmu = isinstance(target, FmuComponent)
    names = [p.name for p in (fmus[target.name].model().inputs if is_fmu else target.inputs)]
    for name in names:
        if is_fmu and draw(st.integers(0, 4)) == 0:
            continue
        source, port, direct = draw(st.sampled_from(sources(components, fmus)))
        forwards = components.index(source) < components.index(target)
        loops = not forwards and (
            direct if is_fmu and isinstance(source, FmuComponent)
            else not is_fmu and not isinstance(source, FmuComponent)
        )  # fmt: skip
        delay = draw(st.sampled_from([0, 0, tick, 3 * tick, 4 * tick, 9 * tick + 100]))
        if loops:
            delay = delay or tick
        made.append(Connection(Endpoint(source.name, port), Endpoint(target.name, name), delay))
    return made


def sources(
    components: list[Component], fmus: dict[str, MockFmu]
) -> list[tuple[Component, str, bool]]:
    """Outputs of all components, and whether they depend directly on an input."""
    found = []
    for c in components:
        if isinstance(c, FmuComponent):
            found += [(c, port.name, bool(port.depends)) for port in fmus[c.name].model().outputs]
        else:
            found += [(c, port.name, False) for port in c.outputs]
    return found
