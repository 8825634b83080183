"""FMUs of every version and kind run beside a controller, as the page has them, and do what plain
arithmetic says that they do under the inputs that were recorded."""

import math
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from harness.experiment.experiment import Experiment
from tests.docs.pages import NOT_YET, follow, text
from tests.every_way.descriptions import Model
from tests.every_way.models import (
    BALL,
    CLOCKS,
    EVERY_TYPE,
    PARTITIONS,
    THERMOSTAT,
    fmu,
    needs_compiler,
)

PAGE = "any-fmu-in-the-loop.md"
pytestmark = needs_compiler


@dataclass(frozen=True)
class Part:
    """A section of the page, the name of its files, and its FMU."""

    section: str
    name: str
    model: Model
    version: int
    kind: str

    def run(self, folder: Path, request: pytest.FixtureRequest) -> Any:
        """The result of the experiment after all that the section says was done."""
        if NOT_YET in text(PAGE, self.section):
            request.applymarker(pytest.mark.xfail(strict=True, reason="the page says not yet"))
        shutil.copy(fmu(self.model, self.version, self.kind), folder / f"{self.name}.fmu")
        follow(PAGE, folder, self.section)
        request.getfixturevalue("monkeypatch").syspath_prepend(folder)
        return Experiment.load(folder / f"{self.name}.toml").run("run")


def bounce(h: float, v: float, u: float, dt: float) -> tuple[float, float]:
    """h'' = u − 9.81 for `dt` from above the ground, where v becomes −0.7 v."""
    g = 9.81 - u
    while dt > 0.0:
        fall = (v + math.sqrt(v * v + 2.0 * g * max(h, 0.0))) / g
        if fall > dt:
            return h + v * dt - 0.5 * g * dt * dt, v - g * dt
        h, v, dt = 0.0, 0.7 * (g * fall - v), dt - fall
    return h, v


def test_model_exchange(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    part = Part("Model exchange", "ball", BALL, 3, "model-exchange")
    result = part.run(tmp_path, request)
    time, heights, pushes = result.time, result["plant.h"], result["plant.u"]
    h, v = 1.0, 0.0
    for k in range(len(time) - 1):
        h, v = bounce(h, v, pushes[k], time[k + 1] - time[k])
        assert heights[k + 1] == pytest.approx(h, abs=1e-6)
    assert result["plant.bounces"][-1] >= 2
    assert len(set(pushes)) > 20


def heat(temperature: float, heater: bool, ambient: float, dt: float) -> tuple[float, bool]:
    """T' = ambient + 30 heater − T for `dt`, with the heater switched at 19 and 21."""
    while True:
        rest, limit = ambient + 30.0 * heater, 21.0 if heater else 19.0
        until = math.log((rest - temperature) / (rest - limit))
        if until > dt:
            return rest + (temperature - rest) * math.exp(-dt), heater
        temperature, heater, dt = limit, not heater, dt - until


def test_fmi_1(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    part = Part("FMI 1", "room", THERMOSTAT, 1, "co-simulation")
    result = part.run(tmp_path, request)
    temperature, heater = 20.0, True
    for k in range(len(result.time) - 1):
        ambient = 15.0 - 0.5 * result["plant.T"][k]
        assert result["plant.ambient"][k] == pytest.approx(ambient, abs=1e-12)
        temperature, heater = heat(temperature, heater, ambient, 0.05)
        assert result["plant.T"][k + 1] == pytest.approx(temperature, abs=1e-9)
    assert len(set(result["plant.heater"])) == 2


def test_clocks(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    part = Part("Clocks", "clocks", CLOCKS, 3, "co-simulation")
    result = part.run(tmp_path, request)
    ticks, users = result["plant.ticks"], result["plant.users"]
    assert ticks[-1] - ticks[0] == 8
    assert users[-1] == sum(1 for tick in set(ticks) if tick % 2 == 0 and tick > 0)


def test_strings(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    part = Part("Strings", "words", EVERY_TYPE, 3, "co-simulation")
    said = part.run(tmp_path, request)["plant.String_out"]
    assert list(said) == [""] + ["go"] * 5 + ["stop"] * 5


def test_scheduled_execution(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    part = Part("Scheduled execution", "partitions", PARTITIONS, 3, "scheduled-execution")
    result = part.run(tmp_path, request)
    assert result["plant.total"][-1] > 0
    assert set(result["plant.u"]) == {1.0, 2.0}
