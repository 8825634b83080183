"""The form of an experiment file (TOML). Unknown keys are faults, each named with its place.

A file describes one system, and `variants` that differ from it, to be compared on identical
disturbances. Components are told apart by the key that says what they are: `fmu`, `controller`,
`signal` or `sensitivity`. Connections are keyed by the input that they feed. With `extends` a file
takes over another one, named relative to it, and changes parts of it.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    field_validator,
    model_validator,
)

from harness import registry
from harness.errors import UsageError, nearest
from harness.process.limits import CALL_SECONDS, CHECKPOINT_SECONDS, Limits, memory_size
from harness.results.metrics import FIGURES
from harness.system.policy import DiscardedSteps, Solver

KINDS = ("fmu", "controller", "signal", "sensitivity")


class Strict(BaseModel):
    """A table that refuses unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class FmuSpec(Strict):
    """An FMU: `fmu` is a plant's name or a path, relative to the experiment file; `step` its
    communication step (s). The keys after `start_values` are those of
    `harness.system.policy.Policy`."""

    fmu: str
    step: float | None = None
    start_values: dict[str, Any] = Field(default_factory=dict)
    interface_type: str | None = None
    tolerance: float | None = None
    solver: Solver = "cvode"
    largest_step: float | None = None
    event_mode: bool | None = None
    discarded_steps: DiscardedSteps = "fail"
    validate_: bool = Field(default=True, alias="validate")
    allow_not_finite: bool = False


class ControllerSpec(Strict):
    """A controller or estimator by name or "module:Class" or "module:function"; the module lies
    beside the file, in the working folder, or is installed."""

    controller: str
    sample_time: float | None = None
    phase: float = 0.0
    outputs: tuple[str, ...] = ("u",)
    parameters: dict[str, Any] = Field(default_factory=dict)


class SignalSpec(Strict):
    """A signal by kind; `step` is the interval at which it is sampled."""

    signal: str
    step: float | None = None
    parameters: dict[str, Any] = Field(default_factory=dict)


class SensitivitySpec(Strict):
    """d `sensitivity` one sample later / d `to` now, both "fmu.variable"."""

    sensitivity: str
    to: str
    sample_time: float | None = None


def _kind(table: Any) -> str | None:
    keys = table if isinstance(table, dict) else getattr(table, "__dict__", ())
    found = [kind for kind in KINDS if kind in keys]
    return found[0] if len(found) == 1 else None


ComponentSpec = Annotated[
    Annotated[FmuSpec, Tag("fmu")]
    | Annotated[ControllerSpec, Tag("controller")]
    | Annotated[SignalSpec, Tag("signal")]
    | Annotated[SensitivitySpec, Tag("sensitivity")],
    Discriminator(
        _kind,
        custom_error_type="component_kind",
        custom_error_message=f"must have exactly one of the keys {', '.join(KINDS)}",
    ),
]


class ConnectionSpec(Strict):
    """What comes into an input: `from` a port, put on the wire `imperfections` (tables with a
    `kind`), then a `delay` in seconds; `extrapolation` 1 from FMU to FMU. It arrives as `factor` ·
    value + `offset`, after the conversion of units unless `convert_units` is off. A plain string
    is the port alone."""

    source: str = Field(alias="from")
    delay: float = 0.0
    extrapolation: Literal[0, 1] = 0
    imperfections: tuple[dict[str, Any], ...] = ()
    factor: float = 1.0
    offset: float = 0.0
    convert_units: bool = True

    @model_validator(mode="before")
    @classmethod
    def _port_alone(cls, given: Any) -> Any:
        return {"from": given} if isinstance(given, str) else given


class VariantSpec(BaseModel):
    """What a variant changes: any part of the file, merged table by table. `like` names another
    variant whose changes it takes over first. A `standalone` one takes over nothing, and states all
    of it."""

    model_config = ConfigDict(extra="allow", frozen=True)
    label: str | None = None
    like: str | None = None
    standalone: bool = False


class MeasureSpec(Strict):
    """The signals that metrics are computed of; `band` and `window` are shares (0 to 1).

    `window_time` states the final window in seconds instead; a response has settled when it has
    stayed in the band for `dwell` seconds at least. `measured` is the response as the controller
    sees it; its error is reported besides. `variants` are those that the picture of the response
    shows, all where none are named.
    """

    reference: str
    response: str
    control: str
    measured: str | None = None
    band: float = 0.02
    window: float = 0.1
    window_time: float | None = Field(default=None, gt=0.0)
    dwell: float = Field(default=0.0, ge=0.0)
    variants: tuple[str, ...] = ()


class MetricSpec(Strict):
    """One figure of the rows between `from` and `to` (s): a `kind` of `FIGURES` in
    `harness.results.metrics`, or "package.module:function" of your own, of `signal`, or of its
    difference to `minus`, or of the Euclidean norm of `signal` and the signals `norm_with`;
    `relative_to` divides it by a number, or by the RMS of a signal. With `above` it is a question:
    1 where the figure is not within that limit, else 0; as "lost_loop" it counts lost runs."""

    kind: str
    signal: str
    minus: str | None = None
    norm_with: tuple[str, ...] = ()
    start: float | None = Field(default=None, alias="from")
    end: float | None = Field(default=None, alias="to")
    relative_to: float | str | None = None
    above: float | None = None

    @field_validator("kind")
    @classmethod
    def _a_figure(cls, given: str) -> str:
        if given not in FIGURES and ":" not in given:
            raise ValueError(
                f"no metric {given!r}; {nearest(given, FIGURES)} (or 'package.module:function' "
                "for your own)"
            )
        return given


class AxisSpec(Strict):
    """One axis of a sweep: `count` values of the setting `key`, from `from` to `to`."""

    key: str
    first: float = Field(alias="from")
    last: float = Field(alias="to")
    count: int = Field(ge=2)
    label: str = ""

    @property
    def values(self) -> tuple[float, ...]:
        """The values, evenly spaced; both ends are among them."""
        step = (self.last - self.first) / (self.count - 1)
        return tuple(self.first + i * step for i in range(self.count))


class FastSweepSpec(Strict):
    """The coarser grid of the fast subset: the counts of both axes."""

    x: int = Field(ge=2)
    y: int = Field(ge=2)


class SweepSpec(Strict):
    """Closed-loop runs over a grid of two settings; a point is inside where the metric `outcome`
    is below `below`. A run that ends early is outside. With `own_seeds` each point has noise of its
    own, the same for all variants; else one realisation decides the whole picture. With `spacing`
    s, every s-th point of both axes is run, and those between near the border of the region only.
    `fast` is the grid of the fast subset, all of which is run; without it that has this grid.
    `seed` is that of the first point, where it is not the experiment's. `variants` names those that
    take part; all do where it names none."""

    outcome: str
    below: float
    own_seeds: bool = False
    spacing: int = Field(default=1, ge=1)
    x: AxisSpec
    y: AxisSpec
    fast: FastSweepSpec | None = None
    seed: int | None = Field(default=None, ge=0)
    variants: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _spacing_fits(self) -> Self:
        if self.spacing & (self.spacing - 1) or any(
            (axis.count - 1) % self.spacing for axis in (self.x, self.y)
        ):
            raise ValueError(
                f"spacing {self.spacing} must be a power of 2 that divides both counts less one "
                f"({self.x.count - 1} and {self.y.count - 1})"
            )
        if self.own_seeds and self.spacing > 1:
            raise ValueError(
                "with own_seeds a point says nothing of its neighbours; leave spacing out"
            )
        return self


class PlotSpec(Strict):
    """One picture: `signals` over time, of all variants, in one panel a signal; with `over`, as
    surfaces over two other signals; or the `membership` functions of a controller before and after
    the run. The latter two are drawn of the first variant."""

    signals: tuple[str, ...] = ()
    over: tuple[str, str] | None = None
    membership: str | None = None
    title: str = ""
    variants: tuple[str, ...] = ()


class FastStudySpec(Strict):
    """How many seeds the fast subset has."""

    seeds: int = Field(ge=2)


class LevelsSpec(Strict):
    """A study repeated at each of `values` of a `quantity`, which the settings `keys` are set to,
    or with `factor` the values that the file gives them are multiplied by. At the value `nominal`
    the experiment is what the file says. The fast subset has that one and an end."""

    quantity: str
    unit: str = "1"
    keys: tuple[str, ...] = Field(min_length=1)
    values: tuple[float, ...] = Field(min_length=2)
    nominal: float
    factor: bool = False

    @model_validator(mode="after")
    def _ordered(self) -> LevelsSpec:
        if any(a >= b for a, b in pairwise(self.values)):
            raise ValueError("values must increase")
        if self.nominal not in self.values:
            raise ValueError("nominal must be one of the values")
        return self


class StudySpec(Strict):
    """Repetition over seeds: `seeds` runs from the experiment's seed on; differences of
    `metrics` are taken against the variant `baseline`. `fast` says how many seeds the fast subset
    has; without it that has all. With `levels` all of it is repeated at each of them. `variants`
    names those that take part; all do where it names none. With `alone` no single runs are drawn
    beside it when a paper is reproduced."""

    seeds: int = Field(ge=2)
    baseline: str
    metrics: tuple[str, ...] = ("steady_state_rms", "iae", "actuator_travel")
    confidence: float = Field(default=0.95, gt=0.0, lt=1.0)
    fast: FastStudySpec | None = None
    levels: LevelsSpec | None = None
    variants: tuple[str, ...] = ()
    alone: bool = False


class LimitsSpec(Strict):
    """What a run may use: seconds a `call` into an FMU may take, seconds for the whole `run`
    (absent: any), and `memory` such as "4 GiB" (absent: nine tenths of the machine's). With
    `isolate` it may write no file but its own, open no connection and signal nobody."""

    call: float = Field(default=CALL_SECONDS, gt=0.0)
    run: float | None = Field(default=None, gt=0.0)
    memory: str | int | None = None
    isolate: bool = False

    @field_validator("memory")
    @classmethod
    def _a_size(cls, given: str | int | None) -> str | int | None:
        try:
            if given is not None and memory_size(given) <= 0:
                raise ValueError("must be positive")
        except UsageError as fault:
            raise ValueError(str(fault)) from fault
        return given


class CheckpointSpec(Strict):
    """A checkpoint, from which a run can be resumed, is written `every` so many seconds of wall
    time, and `every_simulated` seconds of simulated time; 0: never."""

    every: float = Field(default=CHECKPOINT_SECONDS, ge=0.0)
    every_simulated: float = Field(default=0.0, ge=0.0)


class ExperimentSpec(Strict):
    """A whole experiment file."""

    title: str
    description: str = ""
    extends: str | None = None
    stop_time: float
    start_time: float = 0.0
    step: float = 0.01
    record_step: float | None = None
    record: tuple[str, ...] = ("*",)
    algorithm: str = "jacobi"
    algebraic_loops: Literal["hold", "refuse", "solve"] = "hold"
    coupling_tolerance: float = Field(default=1e-6, gt=0.0, lt=1.0)
    max_iterations: int = Field(default=50, ge=2)
    seed: int = Field(default=0, ge=0)
    fmi_version: Literal[2, 3] = 3
    portable: bool = False
    validate_fmus: bool = True
    compile_fmus: bool = False
    components: dict[str, ComponentSpec] = Field(min_length=1)
    connections: dict[str, ConnectionSpec] = Field(default_factory=dict)
    variants: dict[str, VariantSpec] = Field(default_factory=dict)
    measure: MeasureSpec | None = None
    plots: dict[str, PlotSpec] = Field(default_factory=dict)
    metrics: dict[str, MetricSpec] = Field(default_factory=dict)
    study: StudySpec | None = None
    sweep: SweepSpec | None = None
    limits: LimitsSpec = LimitsSpec()
    checkpoint: CheckpointSpec = CheckpointSpec()

    @field_validator("algorithm")
    @classmethod
    def _an_algorithm(cls, given: str) -> str:
        try:
            registry.check_name(registry.ALGORITHMS, given, "algorithm")
        except UsageError as fault:
            raise ValueError(str(fault)) from fault
        return given

    def run_limits(self) -> Limits:
        """The limits of a run."""
        memory = None if self.limits.memory is None else memory_size(self.limits.memory)
        every = self.checkpoint.every or None
        return Limits(
            self.limits.call, self.limits.run, memory, every, self.limits.isolate,
            self.checkpoint.every_simulated or None,
        )  # fmt: skip
