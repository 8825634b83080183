"""An experiment: a checked file, its variants, and the bench that each of them runs on."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

from harness import registry
from harness.bench import Bench
from harness.errors import ExperimentError, HarnessError, at, nearest
from harness.experiment.faults import checked
from harness.experiment.measures import custom, needed_signals, tracking
from harness.experiment.merging import (
    DEEPEST,
    Table,
    inherited,
    merge,
    read_experiment,
    with_settings,
)
from harness.experiment.schema import KINDS, ExperimentSpec
from harness.fmi.sources import compiled
from harness.master.prepared import Echo, PreparedSystem, StartValues
from harness.master.run import Progress
from harness.process.limits import Limits
from harness.results.manifest import COMPLETE, run_state
from harness.results.recording import read_recording
from harness.results.result import Result


@dataclass(frozen=True)
class Experiment:
    """A checked experiment. `data` is the file's content after settings; `path` its place."""

    path: Path
    data: Table
    spec: ExperimentSpec

    @classmethod
    def load(cls, path: str | Path, settings: Mapping[str, Any] | None = None) -> Self:
        """Read a file and put `settings` over it and its variants; raises `ExperimentError`."""
        path = Path(path)
        return cls.from_data(with_settings(read_experiment(path), settings or {}), path)

    @classmethod
    def from_data(cls, data: Table, path: Path) -> Self:
        """Check the content of a file; raises `ExperimentError` with one line for each fault."""
        spec = checked(ExperimentSpec, data, str(path))
        experiment = cls(path, data, spec)
        for name in spec.variants:
            experiment.variant_spec(name)
        experiment._check_names()
        return experiment

    def fast(self) -> Self:
        """The fast subset: fewer seeds and a coarser grid, as `[study.fast]` and `[sweep.fast]`
        say. Enough to see that all of it works, not to decide anything."""
        study, sweep = self.spec.study, self.spec.sweep
        settings: Table = {}
        if study is not None and study.fast is not None:
            settings["study"] = {"seeds": study.fast.seeds}
            if study.levels is not None:
                first, *_, last = study.levels.values
                nominal = study.levels.nominal
                ends = sorted({first, nominal} if first != nominal else {nominal, last})
                settings["study"]["levels"] = {"values": ends}
        if sweep is not None and sweep.fast is not None:
            counts = {"x": {"count": sweep.fast.x}, "y": {"count": sweep.fast.y}}
            settings["sweep"] = {"spacing": 1, **counts}
        return self.from_data(merge(self.data, settings), self.path) if settings else self

    @property
    def name(self) -> str:
        """Folder and stem of the file, as in "ahn2009/figure_7"."""
        return f"{self.path.resolve().parent.name}/{self.path.stem}"

    @property
    def variants(self) -> tuple[str, ...]:
        """Names of the variants; a file without any has the one called "run"."""
        return tuple(self.spec.variants) or ("run",)

    def label(self, variant: str) -> str:
        """The variant's name for people."""
        given = self.spec.variants.get(variant)
        return variant if given is None or given.label is None else given.label

    def variant_spec(self, variant: str) -> ExperimentSpec:
        """The whole experiment as that variant changes it."""
        if variant not in self.spec.variants:
            if variant == "run" and not self.spec.variants:
                return self.spec
            raise ExperimentError(
                f"{self.path}: no variant {variant!r}; {nearest(variant, self.variants)}"
            )
        changes = self._changes(variant)
        merged = changes
        if not changes.pop("standalone", False):
            merged = merge({k: v for k, v in self.data.items() if k != "variants"}, changes)
        return checked(ExperimentSpec, merged, f"{self.path} (variants.{variant})")

    def _changes(self, variant: str) -> Table:
        """What a variant changes, with what it takes over from the one that it is `like`."""
        variants, chain = self.data["variants"], [variant]
        while (like := variants[chain[-1]].get("like")) is not None:
            if like not in variants or len(chain) > DEEPEST:
                hint = nearest(str(like), [name for name in variants if name != chain[-1]])
                raise ExperimentError(
                    f"{self.path}: key variants.{chain[-1]}.like {like!r}: {hint}"
                )
            chain.append(like)
        changes = inherited(variants, variant)
        return {key: value for key, value in changes.items() if key not in ("label", "like")}

    def bench(self, variant: str, *, seed: int | None = None) -> Bench:
        """The bench of a variant, with another `seed` if given. Every parameter of a bench is a key
        of the file, of the same name."""
        spec = self.variant_spec(variant)
        registry.search_in(self.path.parent)
        settings = {name: getattr(spec, name) for name in inspect.signature(Bench).parameters}
        bench = Bench(**settings | ({} if seed is None else {"seed": seed}))
        with at(f"{self.path} ({variant})"):
            self._fill(bench, spec)
        return bench

    def _fill(self, bench: Bench, spec: ExperimentSpec) -> None:
        """The methods of a bench are called as the kinds of components, and take their keys.
        Files are named relative to the experiment file."""
        for name, c in spec.components.items():
            given = c.model_dump(by_alias=True)
            kind = next(kind for kind in KINDS if kind in given)
            source, parameters = given.pop(kind), given.pop("parameters", {})
            if kind == "fmu":
                given["validate"] &= spec.validate_fmus
                if source.endswith(".fmu"):
                    source = self.path.parent / source
                    if spec.compile_fmus:
                        source = compiled(source, validate=given["validate"])
            if kind == "signal" and isinstance(parameters.get("file"), str):
                parameters["file"] = str(self.path.parent / parameters["file"])
            add = getattr(bench, kind)
            for key in parameters:
                if key in inspect.signature(add).parameters:
                    raise ExperimentError(
                        f"component {name}: a parameter may not be called {key!r}; a {kind} has "
                        "that key itself"
                    )
            add(name, source, **given, **parameters)
        for target, wire in spec.connections.items():
            bench.connect(wire.source, target, **wire.model_dump(exclude={"source"}))

    def _check_names(self) -> None:
        spec = self.spec
        named = [] if spec.study is None else [("study.baseline", spec.study.baseline)]
        for table, part in (
            ("study", spec.study),
            ("sweep", spec.sweep),
            ("measure", spec.measure),
        ):
            named += [(f"{table}.variants", one) for one in (part.variants if part else ())]
        for name, plot in spec.plots.items():
            named += [(f"plots.{name}.variants", variant) for variant in plot.variants]
        for key, variant in named:
            if variant not in self.variants:
                hint = nearest(variant, self.variants)
                raise ExperimentError(f"{self.path}: {key} {variant!r}: {hint}")
        study = spec.study
        if study is not None and study.variants and study.baseline not in study.variants:
            raise ExperimentError(
                f"{self.path}: study.baseline {study.baseline!r} takes no part; "
                f"{nearest(study.baseline, study.variants)} of study.variants"
            )

    def run(
        self,
        variant: str,
        folder: str | Path | None = None,
        *,
        seed: int | None = None,
        progress: Progress | None = None,
        echo: Echo | None = None,
        limits: Limits | None = None,
        in_process: bool | None = None,
        resume: bool = False,
        overwrite: bool = False,
    ) -> Result:
        """Run one variant; its metrics are in the result. Raises its fault, as `Bench.run` does.

        `limits` are those of the file where none are given. With `resume` a run that is complete
        in `folder` is read, and one that ended early goes on; with `overwrite` it is replaced.
        """
        spec = self.variant_spec(variant)
        state = run_state(Path(folder)) if resume and folder is not None else ""
        if state == COMPLETE and folder is not None:
            return self.recorded(variant, folder)
        bench = self.bench(variant, seed=seed)
        try:
            result = bench.run(
                folder, progress=progress, echo=echo, experiment=self.resolved(variant, spec),
                needed=needed_signals(spec), limits=limits or spec.run_limits(),
                in_process=in_process, resume=bool(state), overwrite=overwrite,
            )  # fmt: skip
        except HarnessError as fault:
            if fault.result is not None:
                fault.result = self.measured(fault.result, spec)
            raise
        return self.measured(result, spec)

    def recorded(self, variant: str, folder: str | Path) -> Result:
        """What a run of a variant has recorded in `folder`, with its metrics."""
        return self.measured(read_recording(Path(folder)), self.variant_spec(variant))

    def resolved(self, variant: str, spec: ExperimentSpec) -> Table:
        """The variant as it is run, for the manifest; `file` is where relative paths begin."""
        dumped = spec.model_dump(mode="json", by_alias=True)
        return dumped | {"variant": variant, "file": str(self.path.resolve())}

    def prepare(self, variant: str) -> PreparedVariant:
        """A variant ready for many runs; use as a context manager."""
        if self.variant_spec(variant).limits.isolate:
            raise ExperimentError(
                f"{self.path}: key limits.isolate: studies and sweeps run many times in one worker "
                "and cannot isolate each run; run the variants one by one"
            )
        return PreparedVariant(self, variant)

    def measured(self, result: Result, spec: ExperimentSpec) -> Result:
        """`result` with the metrics that `measure` and `metrics` ask for."""
        if len(result.time) < 3:
            return result
        registry.search_in(self.path.parent)
        found = tracking(result, spec.measure) if spec.measure is not None else {}
        found |= {name: custom(result, one) for name, one in spec.metrics.items()}
        return replace(result, metrics=found)


class PreparedVariant:
    """A variant of an experiment, put together once and run with other seeds and start values.

    Each run gives the bits that a fresh `Experiment.run` gives. A context manager.
    """

    def __init__(self, experiment: Experiment, variant: str) -> None:
        """Nothing is opened before the first run. Raises `ExperimentError`."""
        self._experiment = experiment
        self._variant = variant
        self._spec = experiment.variant_spec(variant)
        self._needed = tuple(needed_signals(self._spec))
        self._resolved = experiment.resolved(variant, self._spec)
        self._system: PreparedSystem | None = None

    def run(
        self,
        folder: str | Path | None = None,
        *,
        seed: int | None = None,
        start_values: StartValues | None = None,
        progress: Progress | None = None,
        echo: Echo | None = None,
    ) -> Result:
        """As `Experiment.run`, with `start_values` of FMUs besides those of the file."""
        system = self._system or self._experiment.bench(self._variant).prepare()
        self._system = system
        changed = {name: {"start_values": dict(v)} for name, v in (start_values or {}).items()}
        resolved = merge(self._resolved, {"components": changed}) if changed else self._resolved
        try:
            result = system.run(
                folder, seed=seed, start_values=start_values, progress=progress, echo=echo,
                experiment=resolved, needed=self._needed,
            )  # fmt: skip
        except HarnessError as fault:
            self.close()  # an FMU that failed may have taken its library with it
            if fault.result is not None:
                fault.result = self._experiment.measured(fault.result, self._spec)
            raise
        if not system.repeatable:
            self.close()
        return self._experiment.measured(result, self._spec)

    def close(self) -> None:
        """Close the FMUs; the next run opens them again."""
        if self._system is not None:
            self._system.close()
            self._system = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
