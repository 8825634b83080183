"""What runs say of the claims of a paper.

A verdict needs the whole interval on one side of the limit, or the claim stays undecided. All
claims of a paper are tested at once, so Holm's correction holds the probability of any wrong
verdict among them to 5 %. That two things are equivalent is shown by two one-sided tests; that they
do not differ significantly shows nothing. Over the levels of a study, or the values of a limit that
the project chose, the verdict is a region.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from harness.experiment.claims import ClaimSpec, ClaimsSpec, CriterionSpec
from harness.experiment.evidence import REGION, Source, sample_of
from harness.experiment.schema import ExperimentSpec, LevelsSpec
from harness.results.intervals import Estimate, Sample, holm_levels

HOLDS, CONDITIONALLY, FAILS = "holds", "holds conditionally", "does not hold"
UNDECIDED, UNTESTABLE = "undecided", "cannot be tested"
PARTLY = "holds in a region"
RESTS = "rests on its limit"
"""The limit that the project chose lies within the interquartile range of what it judges, and no
`curve` says where the verdict turns."""
ALPHA = 0.05
"""The probability of any wrong verdict among those of a paper, at most."""


@dataclass(frozen=True)
class Trial:
    """A test of a claim at one value `at` of a quantity (None where nothing is varied): its sample,
    and what was found. `ours` has the interval that holds for all claims of the paper at once."""

    claim: str
    reading: str
    is_condition: bool
    at: float | None
    test: CriterionSpec
    sample: Sample
    rests: bool
    ours: Estimate
    met: bool | None = None


@dataclass(frozen=True)
class Finding:
    """What the runs say of one reading of a claim, or of its condition: a trial, or one at each
    value of the `quantity` in `unit`."""

    reading: str
    trials: tuple[Trial, ...]
    quantity: str = ""
    unit: str = ""

    @property
    def verdict(self) -> str:
        """The verdict in a word or two."""
        met = {trial.met for trial in self.trials}
        if len(self.trials) == 1 and self.trials[0].rests:
            return RESTS
        if len(met) == 1:
            return {True: HOLDS, False: FAILS, None: UNDECIDED}[met.pop()]
        return PARTLY if True in met else UNDECIDED if met == {None} else FAILS

    @property
    def border(self) -> float | None:
        """The first value of the quantity at which the mean crosses the limit, on the line between
        two values; None where it does not."""
        points = [
            (trial.at, trial.ours.value - limit)
            for trial in self.trials
            if trial.at is not None and (limit := trial.test.limit) is not None
        ]
        for (x, d), (x_next, d_next) in pairwise(points):
            if np.sign(d) * np.sign(d_next) < 0:
                return float(x + (x_next - x) * d / (d - d_next))
        return None


@dataclass(frozen=True)
class Verdict:
    """A claim with what the runs say of each of its readings, and of its condition."""

    claim: ClaimSpec
    findings: tuple[Finding, ...] = ()
    given: Finding | None = None

    @property
    def verdict(self) -> str:
        """The verdict by the first reading."""
        if not self.findings:
            return UNTESTABLE
        found = self.findings[0].verdict
        condition = self.given is not None and self.given.verdict in (HOLDS, PARTLY)
        return CONDITIONALLY if condition and found != HOLDS else found


def judge(
    claims: ClaimsSpec,
    source: Source,
    *,
    chosen: Collection[str] = (),
    family: int | None = None,
) -> tuple[Verdict, ...]:
    """The verdicts on all claims of a paper, or on those `chosen` by id, among `family` tests."""
    asked = [claim for claim in claims.claims if not chosen or claim.id in chosen]
    trials = [trial for claim in asked for trial in _trials(claims, claim, source)]
    decided = _decided(trials, family)
    verdicts = []
    for claim in asked:
        own = [trial for trial in decided if trial.claim == claim.id]
        findings = [
            _finding([t for t in own if t.reading == name and not t.is_condition], source)
            for name in dict.fromkeys(t.reading for t in own if not t.is_condition)
        ]
        condition = [t for t in own if t.is_condition]
        given = _finding(condition, source) if condition else None
        verdicts.append(Verdict(claim, tuple(findings), given))
    return tuple(verdicts)


def family_size(claims: ClaimsSpec, experiments: Mapping[str, ExperimentSpec]) -> int:
    """How many tests the claims of a paper are, those without noise left out."""
    count = 0
    for _, _, _, test in _tests(claims, claims.claims):
        spec = experiments[test.experiment]
        noisy = spec.study is not None
        if test.metric == REGION:
            noisy = spec.sweep is not None and spec.sweep.own_seeds
        levels = None if spec.study is None else spec.study.levels
        count += noisy * len(list(_positions(test, levels)))
    return count


def _tests(
    claims: ClaimsSpec, asked: Sequence[ClaimSpec]
) -> Iterator[tuple[ClaimSpec, str, bool, CriterionSpec]]:
    """Every test: the claim, the name of the reading, whether it is a condition, the criterion."""
    for claim in asked:
        if claim.test is not None:
            for name, test in claims.readings_of(claim.test).items():
                yield claim, name, False, test
        if claim.given is not None:
            yield claim, "", True, claim.given


def _positions(
    test: CriterionSpec, levels: LevelsSpec | None
) -> Iterator[tuple[float | None, CriterionSpec]]:
    """The values at which a test is made, each with the test there."""
    if levels is not None and test.level is None:
        if not test.curve:
            for value in levels.values:
                yield value, test.model_copy(update={"level": value})
            return
        test = test.model_copy(update={"level": levels.nominal})
    if not test.curve:
        yield None, test
        return
    assert test.chosen_limit is not None  # a claims file is refused without
    key, limit = test.chosen_limit
    for value in sorted({limit, *test.curve}):
        yield value, test.model_copy(update={key: value})


def _trials(claims: ClaimsSpec, claim: ClaimSpec, source: Source) -> Iterator[Trial]:
    for _, name, is_condition, test in _tests(claims, [claim]):
        study = source(test.experiment).study
        levels = None if study is None or not study.levels else study.spec.levels
        for at, here in _positions(test, levels):
            sample, judged = sample_of(here, source)
            limit = here.chosen_limit
            rests = not test.curve and limit is not None and judged.has_within_quartiles(limit[1])
            yield Trial(claim.id, name, is_condition, at, here, sample, rests, sample.estimate())


def _decided(trials: Sequence[Trial], family: int | None) -> list[Trial]:
    """The trials with what was found, each at the level that Holm's correction gives it."""
    random = [trial for trial in trials if trial.sample.is_random and not trial.sample.is_missing]
    family = max(family or 0, len(random), 1)
    p_values = [_p_value(trial.test, trial.sample) for trial in random]
    levels = dict(zip(map(id, random), holm_levels(p_values, ALPHA, family=family), strict=True))
    decided = []
    for trial in trials:
        sides = 1.0 if trial.test.near is None else 2.0  # two one-sided tests
        ours = trial.sample.estimate(1.0 - sides * ALPHA / family)
        met = _met(trial.test, trial.sample, levels.get(id(trial), ALPHA))
        decided.append(replace(trial, ours=ours, met=None if trial.rests else met))
    return decided


def _finding(trials: Sequence[Trial], source: Source) -> Finding:
    first = trials[0]
    if first.at is None:
        return Finding(first.reading, tuple(trials))
    if first.test.curve:
        return Finding(first.reading, tuple(trials), f"limit of {first.test.metric}")
    study = source(first.test.experiment).study
    assert study is not None and study.spec.levels is not None
    levels = study.spec.levels
    return Finding(first.reading, tuple(trials), levels.quantity, levels.unit)


def _p_value(test: CriterionSpec, sample: Sample) -> float:
    """The smallest level at which `_met` decides."""
    if test.near is None:
        assert test.limit is not None
        return 2.0 * sample.tail(test.limit)
    low, high = test.near[0] - test.near[1], test.near[0] + test.near[1]
    nearer = max(sample.tail(low), sample.tail(high))
    return nearer if low < sample.estimate().value < high else 2.0 * nearer


def _met(test: CriterionSpec, sample: Sample, level: float) -> bool | None:
    """Whether the whole interval at `level` meets the limit; None where it lies across. A figure
    that does not exist in most runs meets none."""
    if sample.is_missing:
        return False
    found = sample.estimate(1.0 - level)
    if test.near is not None:
        low, high = test.near[0] - test.near[1], test.near[0] + test.near[1]
        within = sample.estimate(1.0 - 2.0 * level)
        if low <= within.low and within.high <= high:
            return True
        return None if found.high >= low and found.low <= high else False
    if test.below is not None:
        return True if found.high < test.below else (False if found.low >= test.below else None)
    assert test.above is not None
    return True if found.low > test.above else (False if found.high <= test.above else None)
