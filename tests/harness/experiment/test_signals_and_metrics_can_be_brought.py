"""A file names signals, imperfections and metrics of one's own as package.module:object; what is
none is one sentence."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.random import SeedSequence

from harness.errors import HarnessError
from harness.experiment.experiment import Experiment
from harness.instruments.imperfections import Bias
from harness.instruments.source import FunctionSampler

FILE = """
title = "A staircase"
stop_time = 1.0
step = 0.1

[components]
source = { signal = "MODULE:Staircase", parameters = { height = 2.0 } }
sensor = { controller = "gain" }

[connections]
"sensor.u" = { from = "source.value", imperfections = [{ kind = "MODULE:Raised", value = 1.0 }] }

[metrics]
span = { kind = "MODULE:span", signal = "sensor.y" }
""".replace("MODULE", __name__)


@dataclass(frozen=True)
class Staircase:
    """A step of `height` each second half."""

    height: float
    unit: str | None = None

    def sampler(self, seed: SeedSequence) -> FunctionSampler:
        return FunctionSampler(lambda ns: self.height * (ns >= 500_000_000))


class Raised(Bias):
    """An imperfection under another name."""


@dataclass(frozen=True)
class Silent:
    """No signal: it has no sampler."""


def span(values: np.ndarray) -> float:
    return float(np.ptp(values) + 100.0 * values[0])


def run(folder: Path, text: str) -> dict[str, float | None]:
    path = folder / "own.toml"
    path.write_text(text, encoding="utf-8")
    return dict(Experiment.load(path).run("run").metrics)


def test_they_are_found_by_their_names(tmp_path: Path) -> None:
    assert run(tmp_path, FILE) == {"span": 102.0}


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (":Staircase", ":Stairs", "signal '.*:Stairs' cannot be imported"),
        (":Staircase", ":span", "signal '.*:span' must be a dataclass, got <function"),
        (f'"{__name__}:Staircase", parameters = {{ height = 2.0 }}', f'"{__name__}:Silent"',
         "signal '.*:Silent' lacks what .*SignalSource asks"),
        ("height =", "hight =", "has no key 'hight': did you mean 'height'"),
        (":span", ":spam", "metric '.*:spam' cannot be imported"),
        (f"{__name__}:span", "rmse", r"no metric 'rmse'; did you mean 'rms'.*module:function"),
    ],
)  # fmt: skip
def test_what_is_none_is_named(tmp_path: Path, before: str, after: str, words: str) -> None:
    assert before in FILE
    with pytest.raises(HarnessError, match=words):
        run(tmp_path, FILE.replace(before, after))
