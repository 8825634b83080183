"""What an experiment would trip over after its runs, found before the first of them.

Every variant is put together, so its parameters, wires and units are judged; then all signals and
metrics that plots, figures, studies and sweeps name must be there, and what is subtracted from each
other must be in one unit.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import fields
from pathlib import Path

from harness import registry
from harness.errors import (
    ExperimentError,
    GraphError,
    HarnessError,
    TimingError,
    UnitError,
    UsageError,
    nearest,
)
from harness.experiment.experiment import Experiment
from harness.experiment.measures import MEASURED, needed_signals
from harness.experiment.schema import ExperimentSpec, PlotSpec
from harness.fmi.fmu import Fmu
from harness.master.recorded import columns_of
from harness.master.run import plan_system
from harness.results.metrics import FIGURES
from harness.results.step_response import StepMetrics, TrackingMetrics
from harness.system.units import conversion, parse_unit

Units = Mapping[str, str]
"""The unit of each recorded signal, "" for one without."""


def check_experiment(experiment: Experiment, variants: Sequence[str] = ()) -> None:
    """Judge all that is to be run; raises `ExperimentError` with a line for each fault, and what
    is raised for an FMU that cannot be opened."""
    told: dict[str, list[str]] = {}
    recorded: dict[str, Units] = {}
    chosen = variants or experiment.variants
    with ExitStack() as stack:
        opened: dict[tuple[str, bool], Fmu] = {}
        for variant in chosen:
            spec = experiment.variant_spec(variant)
            try:
                recorded[variant] = _recorded(experiment, variant, opened, stack)
                found = list(_signal_faults(spec, recorded[variant]))
            except (UsageError, ExperimentError, GraphError, TimingError) as fault:
                found = str(fault).splitlines()
            for one in found:
                said = one.removeprefix(f"{experiment.path} ({variant}): ")
                told.setdefault(said, []).append(variant)
    faults = [_of_variants(experiment, said, own, len(chosen)) for said, own in told.items()]
    if not faults:
        faults += [f"{experiment.path}: {one}" for one in _plot_faults(experiment, recorded)]
    faults += _metric_faults(experiment)
    if faults:
        raise ExperimentError("\n".join(dict.fromkeys(faults)))


def _of_variants(experiment: Experiment, said: str, variants: Sequence[str], count: int) -> str:
    """A fault with the variants that have it, which are not named where all of several have it."""
    some = "" if len(variants) == count > 1 else f" ({', '.join(variants)})"
    return f"{experiment.path}{some}: {said}"


def check_metrics(experiment: Experiment) -> None:
    """Judge what a study and a sweep ask for, without a look at the system; raises
    `ExperimentError`."""
    if faults := list(_metric_faults(experiment)):
        raise ExperimentError("\n".join(faults))


def _recorded(
    experiment: Experiment, variant: str, opened: dict[tuple[str, bool], Fmu], stack: ExitStack
) -> Units:
    """The signals of a variant; raises what its system is refused for."""
    bench = experiment.bench(variant)
    system = bench.system()
    fmus = {c.name: _opened(c.path, c.policy.validate, opened, stack) for c in system.fmus}
    plan = plan_system(system, fmus, tuple(bench.record))
    return {column.name: column.unit for column in columns_of(plan, fmus)}


def _signal_faults(spec: ExperimentSpec, units: Units) -> Iterator[str]:
    """Signals of `measure` and `metrics` that are not recorded, or in units that do not match."""
    needed = dict.fromkeys(needed_signals(spec))
    missing = [name for name in needed if name not in units]
    for name in missing:
        yield f"signal {name!r} is asked for but not recorded; {nearest(name, units)}"
    pairs: list[tuple[str, str, str]] = []
    if spec.measure is not None:
        m = spec.measure
        pairs += [("measure", m.reference, one) for one in (m.response, m.measured) if one]
    for name, metric in spec.metrics.items():
        if metric.minus is not None:
            pairs.append((f"metrics.{name}", metric.signal, metric.minus))
        try:
            _ = metric.kind in FIGURES or registry.named(metric.kind, "metric")
        except HarnessError as fault:
            yield f"metrics.{name}: {fault}"
    for key, one, other in pairs:
        if not {one, other} & set(missing) and not _same(units[one], units[other]):
            yield (
                f"{key} compares {one} [{units[one]}] and {other} [{units[other]}], which "
                "are not in one unit"
            )


def _same(one: str, other: str) -> bool:
    if one == other or not (one and other):
        return True
    try:
        return conversion(parse_unit(one), parse_unit(other)) == (1.0, 0.0)
    except UnitError:
        return False


def _plot_faults(experiment: Experiment, recorded: Mapping[str, Units]) -> Iterator[str]:
    for name, plot in experiment.spec.plots.items():
        chosen = [v for v in (plot.variants or recorded) if v in recorded]
        known = {signal for variant in chosen for signal in recorded[variant]}
        for signal in (*plot.signals, *(plot.over or ())) if chosen else ():
            if signal not in known:
                hint = nearest(signal, known)
                yield f"plots.{name}: signal {signal!r} is not recorded; {hint}"
        if plot.membership is not None and chosen:
            yield from _membership_faults(experiment, name, plot, chosen[0])


def _membership_faults(
    experiment: Experiment, name: str, plot: PlotSpec, variant: str
) -> Iterator[str]:
    controllers = experiment.bench(variant).controllers
    having = [key for key, one in controllers.items() if hasattr(one, "membership_curves")]
    if plot.membership not in having:
        yield (
            f"plots.{name}.membership: component {plot.membership!r} of variant {variant!r} has no "
            f"membership functions that change; {nearest(str(plot.membership), having)}"
        )


def metric_names(spec: ExperimentSpec) -> set[str]:
    """The metrics that the runs of an experiment can have, those of single steps without their
    number."""
    found = {*spec.metrics, "lost_loop"}
    if spec.measure is not None:
        found |= {one.name for one in fields(StepMetrics) if one.metadata}
        found |= {one.name for one in fields(TrackingMetrics)}
        found |= {f"measured_{name}" for name in MEASURED if spec.measure.measured}
    return found


def _metric_faults(experiment: Experiment) -> Iterator[str]:
    spec = experiment.spec
    known = {name for v in experiment.variants for name in metric_names(experiment.variant_spec(v))}
    asked: list[tuple[str, str]] = []
    if spec.study is not None and "metrics" in spec.study.model_fields_set:
        asked += [("study.metrics", name) for name in spec.study.metrics]
    if spec.sweep is not None:
        asked += [("sweep.outcome", spec.sweep.outcome)]
    for key, name in asked:
        if not _is_metric(name, known):
            yield f"{experiment.path}: {key} {name!r} is no metric; {nearest(name, known)}"


def _is_metric(name: str, known: Collection[str]) -> bool:
    number, slash, own = name.rpartition("/")
    return own in known and (not slash or number.isdecimal())


def _opened(
    path: Path, validate: bool, opened: dict[tuple[str, bool], Fmu], stack: ExitStack
) -> Fmu:
    """An FMU, unpacked once for all variants."""
    key = (str(path), validate)
    if key not in opened:
        opened[key] = stack.enter_context(Fmu(path, validate=validate))
    return opened[key]
