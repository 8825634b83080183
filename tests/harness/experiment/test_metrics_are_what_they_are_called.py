"""The figures of `[metrics]` against signals whose figures are known."""

import math
from pathlib import Path

import numpy as np
import pytest

from harness.errors import UsageError
from harness.experiment.experiment import Experiment
from harness.experiment.measures import custom, needed_signals
from harness.experiment.schema import MetricSpec
from harness.results.columns import Column
from harness.results.result import Result
from tests.harness.experiment.loops import load

N = 1000
TIME = np.arange(N) / N
SIGNALS = {
    "cos": np.cos(2 * np.pi * TIME),
    "sin": np.sin(2 * np.pi * TIME),
    "ramp": TIME - 0.25,
    "zero": np.zeros(N),
}
RESULT = Result(
    tuple(Column(name, "", "") for name in SIGNALS),
    {"time": TIME, **SIGNALS},
)


def figure(kind: str, signal: str, **more: object) -> float | None:
    return custom(RESULT, MetricSpec.model_validate({"kind": kind, "signal": signal, **more}))


@pytest.mark.parametrize(
    ("kind", "more", "expected"),
    [
        ("rms", {}, math.sqrt(0.5)),
        ("mean", {}, 0.0),
        ("max_abs", {}, 1.0),
        ("std", {}, math.sqrt(0.5)),
        ("final", {"from": 0.25, "to": 0.5}, -1.0),
        ("final_abs", {"to": 0.5}, 1.0),
        ("rms", {"norm_with": ["sin"]}, 1.0),
        ("std", {"norm_with": ["sin"]}, 0.0),
        ("rms", {"norm_with": ["sin", "sin"]}, math.sqrt(1.5)),
        ("max_abs", {"norm_with": ["sin", "sin"]}, math.sqrt(2.0)),
        ("max_abs", {"minus": "sin"}, math.sqrt(2.0)),
        ("rms", {"minus": "cos", "norm_with": ["sin"]}, math.sqrt(0.5)),
        ("rms", {"relative_to": "sin"}, 1.0),
        ("rms", {"relative_to": 0.5}, math.sqrt(2.0)),
    ],
)
def test_figures_of_a_cosine(kind: str, more: dict[str, object], expected: float) -> None:
    assert figure(kind, "cos", **more) == pytest.approx(expected, abs=1e-5)


def test_mean_of_the_magnitude() -> None:
    assert figure("mean_abs", "cos") == pytest.approx(2 / np.pi, abs=1e-5)
    assert figure("mean", "ramp", **{"from": 0.25, "to": 0.75}) == pytest.approx(0.25, abs=1e-12)


@pytest.mark.parametrize(("limit", "answer"), [(1.001, 0.0), (0.999, 1.0), (-1.0, 1.0)])
def test_above_asks_a_question(limit: float, answer: float) -> None:
    assert figure("max_abs", "cos", norm_with=["sin"], above=limit) == answer


def test_above_counts_what_is_no_number() -> None:
    values = {"time": np.array([0.0, 1.0]), "x": np.array([0.0, math.nan])}
    result = Result((Column("x", "", ""),), values)
    spec = MetricSpec(kind="final", signal="x", above=1.0)
    assert custom(result, spec) == 1.0


def test_what_does_not_exist_is_none() -> None:
    assert figure("rms", "cos", relative_to="zero") is None
    assert figure("rms", "cos", **{"from": 2.0}) is None


@pytest.mark.parametrize(("key", "wrong"), [("minus", "lag.z"), ("norm_with", ["lag.u", "lag.z"])])
def test_signals_are_looked_for_before_the_run(tmp_path: Path, key: str, wrong: object) -> None:
    metrics = {"m": {"kind": "rms", "signal": "lag.y", key: wrong}}
    experiment = load(tmp_path)
    experiment = Experiment.from_data({**experiment.data, "metrics": metrics}, experiment.path)
    assert "lag.z" in set(needed_signals(experiment.spec))
    with pytest.raises(UsageError, match=r"'lag\.z' is asked for but not recorded"):
        experiment.run("soft")
