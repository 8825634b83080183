"""Running the experiments of a paper and judging its claims."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.errors import ExperimentError, UsageError, nearest
from harness.experiment.claims import ClaimsSpec, load_claims
from harness.experiment.evidence import REGION, Evidence
from harness.experiment.experiment import Experiment
from harness.experiment.judging import Verdict, family_size, judge
from harness.experiment.parallel import Workers, given_or_one
from harness.experiment.report import write_report
from harness.experiment.study import Study, run_study
from harness.experiment.sweep import Region, run_sweep, write_sweep
from harness.experiment.variants import run_variants
from harness.results.result import Result

CLAIMS_FILE = "claims.toml"

Report = Callable[[float, str], None]
"""Called with the share that is done of what is being run, and its name."""


@dataclass(frozen=True)
class Paper:
    """A folder of experiments with its claims."""

    name: str
    folder: Path
    experiments: Mapping[str, Path]
    claims: ClaimsSpec


@dataclass(frozen=True)
class Reproduction:
    """A paper with its verdicts among `family` tests, and the evidence and pictures of each
    experiment."""

    paper: Paper
    verdicts: tuple[Verdict, ...]
    evidence: Mapping[str, Evidence]
    pictures: Mapping[str, tuple[Path, ...]]
    fast: bool
    family: int


def load_paper(name: str, experiments: Mapping[str, Path]) -> Paper:
    """The paper `name` among `experiments` ("paper/figure" to path); raises `UsageError`."""
    papers = {key.partition("/")[0] for key in experiments}
    if name not in papers:
        raise UsageError(f"no paper {name!r}; {nearest(name, papers)}")
    own = {k.partition("/")[2]: p for k, p in experiments.items() if k.startswith(f"{name}/")}
    folder = next(iter(own.values())).parent
    if not (folder / CLAIMS_FILE).is_file():
        raise ExperimentError(f"paper {name} has no {CLAIMS_FILE} in {folder}")
    return Paper(name, folder, own, load_claims(folder / CLAIMS_FILE))


def reproduce(
    paper: Paper,
    output: Path,
    *,
    fast: bool = False,
    only: Collection[str] = (),
    workers: Workers | None = None,
    report: Report | None = None,
) -> Reproduction:
    """Run every experiment of `paper` and judge its claims; pictures and rows go to `output`.
    Studies and sweeps are spread over `workers` (None: one process of its own).

    `fast` takes the subset that the experiments declare: enough to see that all of it works, not
    to decide. With `only` the claims of these ids are judged, among all of the paper, and what they
    need is run.
    """
    specs = _checked_experiments(paper, only)
    needs = _needs(paper, only)
    evidence: dict[str, Evidence] = {}
    pictures: dict[str, tuple[Path, ...]] = {}
    with given_or_one(workers) as crew:
        for name in needs or paper.experiments:
            experiment = specs[name].fast() if fast else specs[name]
            run = _Run(experiment, output / name, crew, report)
            evidence[name], pictures[name] = run.some(needs[name]) if needs else run.all()
    family = family_size(paper.claims, {name: one.spec for name, one in specs.items()})
    verdicts = judge(paper.claims, evidence.__getitem__, chosen=only, family=family)
    return Reproduction(paper, verdicts, evidence, pictures, fast, family)


def _checked_experiments(paper: Paper, only: Collection[str]) -> dict[str, Experiment]:
    """All experiments, after a check of the names that claims and `only` have."""
    ids = [claim.id for claim in paper.claims.claims]
    for name in only:
        if name not in ids:
            raise UsageError(f"{paper.name}: no claim {name!r}; {nearest(name, ids)}")
    for claim in paper.claims.claims:
        for place in (place for test in claim.criteria for place in (test.own, test.other)):
            if place.experiment not in paper.experiments:
                raise UsageError(
                    f"claim {claim.id} of {paper.name}: no experiment {place.experiment!r}; "
                    f"{nearest(place.experiment, paper.experiments)}"
                )
    return {name: Experiment.load(path) for name, path in paper.experiments.items()}


Needs = Mapping[str, frozenset[str]]
"""Metrics that are asked of the variants of an experiment."""


def _needs(paper: Paper, only: Collection[str]) -> dict[str, Needs]:
    """What the claims `only` need of each experiment."""
    found: dict[str, dict[str, frozenset[str]]] = {}
    for claim in paper.claims.claims:
        for test in claim.criteria if claim.id in only else ():
            for place in (test.own, test.other):
                variants = found.setdefault(place.experiment, {})
                known = variants.get(place.variant, frozenset())
                variants[place.variant] = known | {place.metric}
    return dict(found)


@dataclass(frozen=True)
class _Run:
    """The runs of one experiment."""

    experiment: Experiment
    folder: Path
    workers: Workers
    report: Report | None

    def all(self) -> tuple[Evidence, tuple[Path, ...]]:
        """The variants with their pictures, the study and the sweep."""
        spec = self.experiment.spec
        results: Mapping[str, Result] = {}
        written: list[Path] = []
        if spec.study is None or not spec.study.alone:
            named = () if spec.study is None else spec.study.variants
            results = self._results(named or self.experiment.variants)
            written = write_report(self.experiment, results, self.folder)
        study, regions = None, {}
        if self.experiment.spec.study is not None:
            study = self._study(())
        if self.experiment.spec.sweep is not None:
            regions = self._regions(())
            written += write_sweep(self.experiment, regions, self.folder)
        metrics = {variant: dict(result.metrics) for variant, result in results.items()}
        pictures = tuple(path for path in written if path.suffix == ".png")
        return Evidence(metrics, study, regions), pictures

    def some(self, needs: Needs) -> tuple[Evidence, tuple[Path, ...]]:
        """What gives the metrics of these variants, and no more."""
        swept = tuple(variant for variant, metrics in needs.items() if REGION in metrics)
        measured = tuple(variant for variant, metrics in needs.items() if metrics - {REGION})
        study: Study | None = None
        results: Mapping[str, Result] = {}
        if measured and self.experiment.spec.study is not None:
            study = self._study(measured)
        elif measured:
            results = self._results(measured)
        regions = self._regions(swept) if swept else {}
        metrics = {variant: dict(result.metrics) for variant, result in results.items()}
        return Evidence(metrics, study, regions), ()

    def _results(self, variants: Sequence[str]) -> Mapping[str, Result]:
        label = self.experiment.label

        def moved(variant: str, share: float | None, compiling: str = "") -> None:
            if share is not None:
                self._progress(f": {label(variant)}")(share)

        ran = run_variants(self.experiment, variants, self.folder, moved)
        for fault in ran.faults.values():
            if fault.result is None:
                raise fault
        return ran.results

    def _study(self, variants: Sequence[str]) -> Study:
        progress = self._progress(": study")
        study = run_study(self.experiment, variants, workers=self.workers, progress=progress)
        study.write(self.folder)
        return study

    def _regions(self, variants: tuple[str, ...]) -> dict[str, Region]:
        progress = self._progress(": sweep")
        return run_sweep(self.experiment, variants, workers=self.workers, progress=progress)

    def _progress(self, what: str) -> Callable[[float], None]:
        report = self.report
        name = f"{self.experiment.name}{what}"
        return lambda share: None if report is None else report(share, name)
