"""The test bench for scripts and notebooks: put a system together, run it, look at it.

    bench = Bench(stop_time=3.0, step=0.01)
    bench.fmu("plant", "hybrid_actuator")
    bench.controller("controller", "pid", kp=6.5e-5, ki=1.1e-4, u_min=-1.0, u_max=1.0)
    bench.signal("reference", "step", time=0.1, final=2000.0, unit="N")
    bench.connect("reference.value", "controller.reference")
    bench.connect("plant.force", "controller.measured", noise={"std": 5.0})
    bench.connect("controller.u", "plant.command")
    result = bench.run()
    result.plot("plant.force", "controller.u")

Experiment files are read into the same bench, so whatever one can do, the other can.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness import registry
from harness.clock import to_nanoseconds, to_period
from harness.construction import construct, input_names, known_parameters, step_of_new
from harness.display import html_table, progress_in_notebook
from harness.errors import ExperimentError, UsageError, at, nearest
from harness.instruments.imperfections import Imperfection, make_imperfection
from harness.instruments.signals import make_signal
from harness.instruments.source import SignalSource
from harness.master.prepared import Echo, PreparedSystem
from harness.master.run import Progress
from harness.process.limits import Limits
from harness.results.result import Result
from harness.system.block import Block, Port
from harness.system.graph import (
    BlockComponent,
    Component,
    Connection,
    Convergence,
    Endpoint,
    FmuComponent,
    PythonComponent,
    SensitivityComponent,
    SignalComponent,
    System,
)
from harness.system.policy import Policy

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Bench", "Echo", "Progress"]


@dataclasses.dataclass(kw_only=True, eq=False, repr=False)
class Bench:
    """A system under construction; times are seconds, all methods raise `HarnessError`.

    `step` is the communication step of the FMUs, the sample time of controllers and signals, and
    the interval of recorded rows, each unless stated otherwise. `algorithm` couples FMUs:
    "jacobi", "gauss-seidel", "iterative", another registered one or "package.module:Class";
    `algebraic_loops` between them have the values of the last step ("hold"), or are refused or
    solved ("refuse", "solve"), and what is repeated has converged to `coupling_tolerance`
    (relative) within `max_iterations`. `seed` seeds all noise. `fmi_version` is that of the FMUs
    built from plants, `portable` asks for their Python packaging (FMI 2). `controllers` are the
    controller objects by component name.
    """

    stop_time: float
    step: float = 0.01
    start_time: float = 0.0
    record_step: float | None = None
    record: Sequence[str] = ("*",)
    algorithm: str = "jacobi"
    algebraic_loops: str = "hold"
    coupling_tolerance: float = 1e-6
    max_iterations: int = 50
    seed: int = 0
    fmi_version: int = 3
    portable: bool = False
    controllers: dict[str, Any] = dataclasses.field(init=False, default_factory=dict)
    _components: dict[str, Component] = dataclasses.field(init=False, default_factory=dict)
    _connections: list[Connection] = dataclasses.field(init=False, default_factory=list)

    def __post_init__(self) -> None:
        """Raises `TimingError` where a time is no whole number of nanoseconds."""
        to_period(self.step, "step")
        self.system()

    def __repr__(self) -> str:
        """One line: the times, the components, how many wires."""
        span = f"{self.start_time:g} … {self.stop_time:g} s, step {self.step:g} s"
        parts = ", ".join(self._components) or "no components"
        return f"<Bench: {span}; {parts}; {len(self._connections)} wires>"

    def _repr_html_(self) -> str:
        """The components and the wires."""
        parts = [
            (c.name, type(c).__name__.removesuffix("Component"), c.period_ns / 1e9)
            for c in self._components.values()
        ]
        wires = [
            (c.source, c.target, f"{c.delay_ns / 1e9:g}" if c.delay_ns else "",
             ", ".join(type(one).__name__ for one in c.imperfections))
            for c in self._connections
        ]  # fmt: skip
        heads = ("from", "to", "delay (s)", "imperfections")
        shown = html_table(repr(self).strip("<>"), ("component", "kind", "step (s)"), parts)
        return shown + html_table("wires", heads, wires)

    # components

    def fmu(
        self,
        name: str,
        source: str | Path,
        *,
        step: float | None = None,
        start_values: Mapping[str, Any] | None = None,
        **policy: Any,
    ) -> None:
        """An FMU: the name of a plant, or the path of an .fmu file. `step` is its communication
        step, `policy` says how it is run: see `harness.system.policy.Policy`."""
        text = str(source)
        if text.endswith(".fmu") or "/" in text or "\\" in text:
            path = Path(source)
        else:
            version = 2 if self.portable else self.fmi_version
            path = registry.plant_fmu(text, version, portable=self.portable)
        period = self._period(step, f"step of {name}")
        how = construct(name, Policy, policy)
        self._add(FmuComponent(name, path, period, dict(start_values or {}), how))

    def controller(
        self,
        name: str,
        source: Any,
        *,
        sample_time: float | None = None,
        phase: float = 0.0,
        outputs: Sequence[str] = ("u",),
        **parameters: Any,
    ) -> None:
        """A controller or estimator.

        `source` is a registered name or "package.module:Class" (with its `parameters`), a
        controller object with a method `block(sample_time)`, a block, or plain Python: a function,
        or an object with a method `step`, of `(time, *inputs)`. The names of its inputs are those
        of its arguments, its results are called `outputs`; arguments with a default are parameters.
        Every run begins with what plain Python holds now, and leaves that as it is; see
        `harness.participants.fresh`.
        """
        period = self._period(sample_time, f"sample_time of {name}")
        phase_ns = to_nanoseconds(phase, f"phase of {name}")
        if isinstance(source, str):
            source = registry.controller(source)
        make: Callable[[], Callable[..., Any]] | None = None
        if isinstance(source, type):
            make = partial(step_of_new, name, source, parameters)
            source = construct(name, source, parameters)
        elif parameters and callable(source) and not hasattr(source, "block"):
            source = partial(source, **known_parameters(name, source, parameters))
        elif parameters:
            raise UsageError(
                f"component {name}: parameters are taken with a name, a class or a function only"
            )
        self.controllers[name] = source
        if not isinstance(source, Block) and hasattr(source, "block"):
            source = source.block(period / 1e9)
        if isinstance(source, Block):
            self._add(BlockComponent(name, source, period, phase_ns))
            return
        function = getattr(source, "step", source)
        if not callable(function):
            raise UsageError(
                f"component {name}: {source!r} is no controller; give a registered name, a class, "
                "a block, a function or an object with a method step"
            )
        ports = tuple(Port(argument) for argument in input_names(name, function))
        made = tuple(Port(output) for output in outputs)
        self._add(PythonComponent(name, function, ports, made, period, phase_ns, make))

    def signal(
        self,
        name: str,
        source: str | SignalSource,
        *,
        step: float | None = None,
        **parameters: Any,
    ) -> None:
        """A signal by its kind ("step", "sine", "white_noise", …) with parameters, or as a source.
        Its output is `name.value`, sampled every `step`."""
        if isinstance(source, str):
            with at(f"component {name}"):
                source = make_signal(source, parameters)
        self._add(SignalComponent(name, source, self._period(step, f"step of {name}")))

    def sensitivity(self, name: str, of: str, *, to: str, sample_time: float | None = None) -> None:
        """d `of` one sample later / d `to` now, both `fmu.variable` of one FMU; see
        `harness.participants.sensitivity`."""
        output, known = self._endpoint(of), self._endpoint(to)
        if output.component != known.component:
            raise UsageError(f"sensitivity {name}: {of} and {to} belong to different components")
        period = self._period(sample_time, f"sample_time of {name}")
        self._add(
            SensitivityComponent(name, output.component, output.variable, known.variable, period)
        )

    # wires

    def connect(
        self,
        source: str,
        target: str,
        *,
        delay: float = 0.0,
        extrapolation: int = 0,
        imperfections: Sequence[Imperfection | Mapping[str, Any]] = (),
        factor: float = 1.0,
        offset: float = 0.0,
        convert_units: bool = True,
        **named: Mapping[str, Any],
    ) -> None:
        """A wire from `component.output` to `component.input`; arrays of equal dimensions whole, or
        an element of one, as in "plant.pressure[2]".

        What is put on it, in order: `imperfections` (objects, or mappings with a `kind`), then
        those named by kind, as in `noise={"std": 5.0}`; then a `delay` in seconds. What arrives
        is `factor` · value + `offset`, the value being converted to the target's unit first
        unless `convert_units` is off. From FMU to FMU, `extrapolation=1` takes the value to change
        linearly during a step instead of holding it.
        """
        with at(f"connection {source} -> {target}"):
            put = [_imperfection(one) for one in imperfections]
            put += [make_imperfection(kind, parameters) for kind, parameters in named.items()]
        label = f"delay of {source} -> {target}"
        self._connections.append(
            Connection(
                self._endpoint(source),
                self._endpoint(target),
                to_nanoseconds(delay, label),
                tuple(put),
                extrapolation,
                factor,
                offset,
                convert_units,
            )
        )

    def ports(self) -> pd.DataFrame:
        """What there is to wire, a row a port: "component.variable", input or output, type, unit,
        what it is wired from, and what it is; FMUs are opened for it."""
        import pandas as pd

        from harness.master.opened import descriptions_of, opened
        from harness.system.check import ports_of

        system = self.system()
        with opened(system) as fmus:
            rows = ports_of(system, descriptions_of(system, fmus))
        heads = ("port", "direction", "type", "unit", "wired from", "meaning")
        return pd.DataFrame(list(rows), columns=list(heads)).set_index("port")

    # running

    def system(self) -> System:
        """The system as data."""
        return System(
            tuple(self._components.values()),
            tuple(self._connections),
            to_nanoseconds(self.start_time, "start_time"),
            to_nanoseconds(self.stop_time, "stop_time"),
            self._period(self.record_step, "record_step"),
            self.algorithm,
            self.seed,
            self.algebraic_loops,
            Convergence(self.coupling_tolerance, self.max_iterations),
        )

    def run(
        self,
        folder: str | Path | None = None,
        *,
        progress: Progress | None = None,
        echo: Echo | None = None,
        experiment: Mapping[str, Any] | None = None,
        needed: Iterable[str] = (),
        limits: Limits | None = None,
        in_process: bool | None = None,
        resume: bool = False,
        overwrite: bool = False,
    ) -> Result:
        """Run to the stop time; rows go to `folder`, or stay in memory.

        A run that ends early raises its fault, and Ctrl-C `KeyboardInterrupt`, whose attribute
        `result` holds the rows so far (None where there are none).
        `echo(component, message)` sees the messages of FMUs; `experiment` goes to the
        manifest; signals that are `needed` afterwards are looked for before the run begins.

        A system with FMUs runs in a worker process within `limits`, so that an FMU that crashes,
        hangs or exits ends the run and not the caller; with `in_process` true all of it runs in
        this process. What plain Python controllers remember stays in the run; what those without
        outputs see is there afterwards where they run in this process.
        With `resume` the run in `folder` goes on from its last checkpoint, with `overwrite` it is
        replaced; else a folder that holds something is refused.
        """
        try:
            with progress_in_notebook("run") as bar:
                return self._run(
                    None if folder is None else Path(folder), limits, in_process, resume,
                    progress=progress or bar, echo=echo, experiment=experiment, needed=needed,
                    overwrite=overwrite,
                )  # fmt: skip
        except KeyboardInterrupt as interrupt:
            if not hasattr(interrupt, "result"):  # before anything was recorded
                interrupt.result = None  # type: ignore[attr-defined]
            raise

    def _run(
        self, folder: Path | None, limits: Limits | None, in_process: bool | None, resume: bool,
        **told: Any,
    ) -> Result:  # fmt: skip
        if self._in_worker(in_process):
            from harness.process.run import run_supervised

            return run_supervised(
                self.system(), folder, record=tuple(self.record), limits=limits, resume=resume,
                **told,
            )  # fmt: skip
        if limits is not None and limits.isolate and self.system().fmus:
            raise UsageError("isolation needs a worker process of the run's own, on Linux")
        if resume:
            raise UsageError("only runs with FMUs, in a worker process on Linux, can be resumed")
        with self.prepare() as prepared:
            return prepared.run(folder, **told)

    def _in_worker(self, in_process: bool | None) -> bool:
        components = self._components.values()
        if in_process or not any(isinstance(c, FmuComponent) for c in components):
            return False
        from harness.process.fork import available

        sinks = [c.name for c in components if isinstance(c, PythonComponent) and not c.outputs]
        if available() and sinks and in_process is None:
            warnings.warn(
                f"{sinks[0]} has no outputs, and what it keeps stays in the worker process of the "
                "run; run with in_process=True to have it here, or False to do without",
                stacklevel=4,
            )
        return available()

    def prepare(self) -> PreparedSystem:
        """The system with its FMUs open and planned, for many runs; use as a context manager."""
        return PreparedSystem(self.system(), self.record)

    def _add(self, component: Component) -> None:
        if component.name in self._components:
            raise UsageError(f"component name {component.name!r} is used twice")
        if "." in component.name or "/" in component.name or not component.name:
            raise UsageError(f"component name {component.name!r} must have no '.' and no '/'")
        self._components[component.name] = component

    def _period(self, seconds: float | None, what: str) -> int:
        return to_period(self.step if seconds is None else seconds, what)

    def _endpoint(self, text: str) -> Endpoint:
        component, dot, variable = text.partition(".")
        if not dot:
            known = self._components.get(component)
            if isinstance(known, (SignalComponent, SensitivityComponent)):
                return Endpoint(component, "value")
            hint = nearest(component, self._components)
            raise UsageError(f"{text!r} is no port; write component.variable ({hint})")
        return Endpoint(component, variable)


def _imperfection(given: Imperfection | Mapping[str, Any]) -> Imperfection:
    if not isinstance(given, Mapping):
        return given
    if "kind" not in given:
        raise ExperimentError(f"imperfection {dict(given)!r} lacks its 'kind'")
    return make_imperfection(given["kind"], {k: v for k, v in given.items() if k != "kind"})
