"""The claims of a paper as data (`claims.toml`): what the paper says, where, and the figure of an
experiment that decides it. The rules that make a verdict stand are checked as a file is read; how
it is judged is in `harness.experiment.judging`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pydantic import Field, model_validator

from harness.experiment.faults import checked, read_toml
from harness.experiment.schema import Strict


@dataclass(frozen=True)
class Place:
    """A metric of a variant of an experiment."""

    experiment: str
    variant: str
    metric: str

    def __str__(self) -> str:
        return f"{self.experiment}/{self.variant}: {self.metric}"


class CriterionSpec(Strict):
    """A figure of an experiment, and the limit that it is held against.

    The figure is the `metric` of a `variant`, or its difference to (its `compare = "ratio"` over)
    another one: that of the variant `against`, of the metric `against_metric`, of the experiment
    `against_experiment`, each by default the test's own. Both are paired by seed. With
    `share_above` it is the share of the runs whose metric is above that.

    A limit is `below` or `above` for what is to differ from it, and `near` = [value, tolerance] for
    what is to be equivalent to a value. `curve` has other values of the limit that the project
    chose (`share_above` where there is one), at which the claim is judged too. `level` picks one of
    the study's levels; without it the claim is judged at all of them.
    """

    experiment: str
    variant: str
    metric: str
    against: str | None = None
    against_metric: str | None = None
    against_experiment: str | None = None
    compare: Literal["difference", "ratio"] = "difference"
    share_above: float | None = None
    below: float | None = None
    above: float | None = None
    near: tuple[float, float] | None = None
    level: float | None = None
    curve: tuple[float, ...] = ()

    @model_validator(mode="after")
    def _one_limit(self) -> CriterionSpec:
        if sum(limit is not None for limit in (self.below, self.above, self.near)) != 1:
            raise ValueError("needs exactly one of below, above and near = [value, tolerance]")
        if self.compare == "ratio" and not self.is_comparison:
            raise ValueError(
                'compare = "ratio" needs what to compare with: against, against_metric or '
                "against_experiment"
            )
        if self.share_above is not None and self.is_comparison:
            raise ValueError("share_above counts the runs of one variant and compares nothing")
        if self.curve and self.chosen_limit is None:
            raise ValueError("curve needs a limit that was chosen: share_above, below or above")
        return self

    @property
    def own(self) -> Place:
        """Where the figure stands."""
        return Place(self.experiment, self.variant, self.metric)

    @property
    def other(self) -> Place:
        """Where that stands which it is compared with; `own` where it is compared with nothing."""
        return Place(
            self.against_experiment or self.experiment,
            self.against or self.variant,
            self.against_metric or self.metric,
        )

    @property
    def is_comparison(self) -> bool:
        """Whether the figure is a difference or a ratio."""
        return self.other != self.own

    @property
    def limit(self) -> float | None:
        """What the figure is held against; None where it is a value with a tolerance."""
        return self.below if self.below is not None else self.above

    @property
    def chosen_limit(self) -> tuple[str, float] | None:
        """The key and the value of the limit that somebody chose; None for a comparison with the
        limit at which both are alike, which nobody did, and for `near`, which has a tolerance."""
        if self.share_above is not None:
            return "share_above", self.share_above
        alike = 1.0 if self.compare == "ratio" else 0.0
        if self.limit is None or (self.is_comparison and self.limit == alike):
            return None
        return "below" if self.below is not None else "above", self.limit


class ClaimSpec(Strict):
    """One claim: `paper` is its number or words; `test` decides it, and `given` is a condition
    under which it is tested too."""

    id: str
    page: str
    claim: str
    paper: float | str = ""
    unit: str = ""
    test: CriterionSpec | None = None
    given: CriterionSpec | None = None
    untestable: str | None = None
    reason: str = ""

    @property
    def said(self) -> str:
        """The paper's number with its unit, or its words."""
        if isinstance(self.paper, float):
            return f"{self.paper:g} {self.unit}".strip()
        return self.paper

    @property
    def criteria(self) -> tuple[CriterionSpec, ...]:
        """The test and the condition, where there are such."""
        return tuple(one for one in (self.test, self.given) if one is not None)

    @model_validator(mode="before")
    @classmethod
    def _flat(cls, data: object) -> object:
        """The keys of the test may stand in the claim itself."""
        if isinstance(data, dict) and "experiment" in data:
            names = set(CriterionSpec.model_fields)
            own = {k: v for k, v in data.items() if k not in names}
            return {**own, "test": {k: v for k, v in data.items() if k in names}}
        return data

    @model_validator(mode="after")
    def _decidable(self) -> ClaimSpec:
        if (self.test is None) == (self.untestable is None):
            raise ValueError("needs either a test (experiment, variant, metric) or untestable")
        return self


class ClaimsSpec(Strict):
    """A whole `claims.toml`. `mechanisms` are groups of variants that have the same thing active,
    under other settings. Where a claim is about a metric of `readings`, it is judged by each of the
    metrics that this gives, under their names."""

    paper: str
    claims: tuple[ClaimSpec, ...] = Field(min_length=1)
    mechanisms: dict[str, tuple[str, ...]] = Field(default_factory=dict)
    readings: dict[str, dict[str, str]] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _ruled(self) -> ClaimsSpec:
        names = [claim.id for claim in self.claims]
        for claim in self.claims:
            if names.count(claim.id) > 1:
                raise ValueError(f"claim {claim.id}: each claim needs an id of its own")
            for fault in self._faults_of_condition(claim):
                raise ValueError(
                    f"claim {claim.id}: a condition (given) must keep what is claimed and may only "
                    f"change where: {fault}"
                )
        return self

    def _faults_of_condition(self, claim: ClaimSpec) -> Iterator[str]:
        test, given = claim.test, claim.given
        if test is None or given is None:
            return
        for key in ("metric", "against_metric", "compare", "share_above", *_LIMITS):
            own, other = getattr(test, key), getattr(given, key)
            if own != other:
                yield f"{key} must stay {own!r}, not {other!r}"
        for key, pair in (("variant", (test.variant, given.variant)),
                          ("against", (test.against, given.against))):  # fmt: skip
            if pair[0] != pair[1] and not any(
                set(pair) <= set(group) for group in self.mechanisms.values()
            ):
                yield (
                    f"{key} {pair[1]!r} is not of the mechanism of {pair[0]!r}; the variants that "
                    "have the same thing active are named in [mechanisms]"
                )

    def readings_of(self, test: CriterionSpec) -> dict[str, CriterionSpec]:
        """The test under each name of its metric's readings; under "" where it has none."""
        named = self.readings.get(test.metric)
        if named is None or test.against_metric is not None:
            return {"": test}
        return {name: test.model_copy(update={"metric": metric}) for name, metric in named.items()}


_LIMITS = ("below", "above", "near")


def load_claims(path: Path) -> ClaimsSpec:
    """Read `claims.toml`; raises `ExperimentError` with one line for each fault."""
    return checked(ClaimsSpec, read_toml(path, "claims file"), str(path))
