"""A system as data: components and the connections between them.

Nothing here is loaded, compiled or run. All times are integer nanoseconds. `check` judges a
system, `lowering` reduces what is put on wires to blocks, `execution.plan` schedules it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

from harness.clock import NANOSECONDS
from harness.fmi.description.model_description import ModelDescription
from harness.instruments.imperfections import Imperfection
from harness.instruments.source import SignalSource
from harness.system.block import Block, BlockSignal, Port
from harness.system.policy import Policy

Descriptions = Mapping[str, ModelDescription]
"""What the FMUs of a system say of themselves, by component."""


@dataclass(frozen=True)
class FmuComponent:
    """An FMU instance: `step_ns` is its communication step, `start_values` are set before
    initialisation, `policy` says how it is run. `inputs` are functions of time that the FMU is
    given also inside its steps: see `participants.track_data.read_inputs`."""

    name: str
    path: Path
    step_ns: int
    start_values: Mapping[str, Any] = field(default_factory=dict)
    policy: Policy = field(default_factory=Policy)
    inputs: Any = None
    phase_ns: ClassVar[int] = 0

    @property
    def period_ns(self) -> int:
        """Its outputs change with each step."""
        return self.step_ns


@dataclass(frozen=True)
class BlockComponent:
    """A discrete-time block, computed at `phase_ns + k * period_ns`."""

    name: str
    block: Block
    period_ns: int
    phase_ns: int = 0

    @property
    def inputs(self) -> Sequence[BlockSignal]:
        """The inputs of the block."""
        return self.block.inputs

    @property
    def outputs(self) -> Sequence[BlockSignal]:
        """The outputs of the block."""
        return self.block.outputs


@dataclass(frozen=True)
class PythonComponent:
    """A plain Python controller: `function(time, *inputs)` returns one number or one an output.

    Every run has a copy of it. Where it cannot be copied, `make` makes one anew, and else it runs
    once: then `uncopied` holds why (see `participants.fresh`).
    """

    name: str
    function: Callable[..., float | Sequence[float]]
    inputs: tuple[BlockSignal, ...]
    outputs: tuple[BlockSignal, ...]
    period_ns: int
    phase_ns: int = 0
    make: Callable[[], Callable[..., Any]] | None = field(default=None, compare=False, repr=False)
    uncopied: list[str] = field(default_factory=list, compare=False, repr=False)


@dataclass(frozen=True)
class SignalComponent:
    """A signal source with the single output `value`, sampled at `phase_ns + k * period_ns`."""

    name: str
    source: SignalSource
    period_ns: int
    phase_ns: int = 0
    inputs: tuple[BlockSignal, ...] = ()

    @property
    def outputs(self) -> tuple[BlockSignal, ...]:
        """The output `value` in the unit of the source."""
        return (Port("value", self.source.unit or ""),)


@dataclass(frozen=True)
class SensitivityComponent:
    """d y(t + period) / d u(t) of an FMU, from its directional derivatives; one output `value`.

    `component` names the FMU, `output` and `input` its variables.
    """

    name: str
    component: str
    output: str
    input: str
    period_ns: int
    phase_ns: int = 0
    inputs: tuple[BlockSignal, ...] = ()
    outputs: tuple[BlockSignal, ...] = (Port("value", ""),)


SampledComponent = BlockComponent | PythonComponent | SignalComponent | SensitivityComponent
Component = FmuComponent | SampledComponent


@dataclass(frozen=True, order=True)
class Endpoint:
    """A variable of a component, written `component.variable`."""

    component: str
    variable: str

    def __str__(self) -> str:
        return f"{self.component}.{self.variable}"


@dataclass(frozen=True)
class Connection:
    """A wire: what is put on it, in order, then a delay after which the value arrives.

    It arrives as `factor` · value + `offset`, the value being converted to the unit of the target
    first, unless `convert_units` is off.
    `extrapolation` is the order of what an FMU sees of another one during a step: 0 holds the
    value, 1 takes it to change linearly (see `master.algorithms.base`).
    """

    source: Endpoint
    target: Endpoint
    delay_ns: int = 0
    imperfections: tuple[Imperfection, ...] = ()
    extrapolation: int = 0
    factor: float = 1.0
    offset: float = 0.0
    convert_units: bool = True


@dataclass(frozen=True)
class Convergence:
    """When a repetition has converged: every signal to `tolerance` times the larger of its size
    and its nominal value, after at most `max_iterations` repetitions."""

    tolerance: float = 1e-6
    max_iterations: int = 50


@dataclass(frozen=True)
class System:
    """Components, connections, times and the algorithm that couples the FMUs.

    `algorithm` is the name of a registered algorithm, such as "jacobi", "gauss-seidel" (FMUs step
    in the order in which they stand in `components`) or "iterative" (FMUs that drive each other
    repeat a step until it agrees with what they reach), or "package.module:Class" (see
    `master.algorithms.base`). `algebraic_loops` says what becomes of loops of direct feedthrough:
    "hold", "refuse" or "solve" (see `master.plan.order`); an algorithm may solve them instead of
    holding. `convergence` is that of all repetitions. A row is recorded every `record_ns`. All
    times are whole ticks: nanoseconds, or parts of them where an FMU's own step is no whole number
    of nanoseconds. `single`: the one FMU is all there is, so the run is its own: columns bear the
    names of its variables.
    """

    components: tuple[Component, ...]
    connections: tuple[Connection, ...]
    start_ns: int
    stop_ns: int
    record_ns: int
    algorithm: str = "jacobi"
    seed: int = 0
    algebraic_loops: str = "hold"
    convergence: Convergence = Convergence()
    ticks_per_second: int = NANOSECONDS
    single: bool = False

    def seconds(self, ticks: int) -> float:
        """The double nearest to an instant, in seconds."""
        return ticks / self.ticks_per_second

    def component(self, name: str) -> Component:
        """The component of that name; raises KeyError."""
        return self._by_name[name]

    @cached_property
    def _by_name(self) -> dict[str, Component]:
        return {component.name: component for component in self.components}

    @property
    def fmus(self) -> tuple[FmuComponent, ...]:
        """The FMU components in order."""
        return tuple(c for c in self.components if isinstance(c, FmuComponent))


ALGEBRAIC_LOOPS = ("hold", "refuse", "solve")
