"""What the last variant, a plot or a metric would trip over ends the command before a run."""

from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from tests.harness.experiment.loops import FILE, MACHINE, write


class Needy:
    def __init__(self, pole: float, gain: float = 1.0) -> None:
        """Never made here."""


LAST = '[variants.last]\ncomponents.controller = { controller = "pid", parameters = %s }\n[study]'
FAULTS = {
    "a parameter of the last variant": (
        FILE.replace("[study]", LAST % "{ kpp = 1.0 }"),
        r"(last): component controller: PID has no parameter 'kpp'; did you mean 'kp'",
    ),
    "a parameter that is missing": (
        FILE.replace("tests.harness.experiment.loops:Lag", f"{__name__}:Needy"),
        "component lag: Needy needs the parameter 'pole', which is not given; its parameters are",
    ),
    "a signal of a plot": (
        FILE + '[plots.gains]\nsignals = ["lag.yy"]\n',
        "plots.gains: signal 'lag.yy' is not recorded; did you mean 'lag.y'",
    ),
    "membership functions": (
        FILE + '[plots.gains]\nmembership = "lag"\n',
        "plots.gains.membership: component 'lag' of variant 'soft' has no membership functions",
    ),
    "a metric of a study": (
        FILE.replace('metrics = ["iae"]', 'metrics = ["iaee"]'),
        "study.metrics 'iaee' is no metric; did you mean 'iae'",
    ),
    "the outcome of a sweep": (
        MACHINE.replace('outcome = "distance"', 'outcome = "distanc"'),
        "sweep.outcome 'distanc' is no metric; did you mean 'distance'",
    ),
    "a function that is not there": (
        FILE + '[metrics.own]\nkind = "tests.no_such:figure"\nsignal = "lag.y"\n',
        "metrics.own: metric 'tests.no_such:figure' cannot be imported",
    ),
    "units of measure": (
        MACHINE + '[measure]\nreference = "plant.speed"\nresponse = "plant.angle_deviation"\n'
        'control = "controller.u"\n',
        "measure compares plant.speed [rad/s] and plant.angle_deviation [rad], which are not in",
    ),
    "units of a metric": (
        MACHINE + '[metrics.own]\nkind = "final"\nsignal = "plant.speed"\n'
        'minus = "plant.angle_deviation"\n',
        "metrics.own compares plant.speed [rad/s] and plant.angle_deviation [rad], which are not",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_nothing_is_run(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, words = FAULTS[name]
    folder = tmp_path / "run"
    code = run_command_line(["run", str(write(tmp_path, text)), "--output", str(folder)])
    said = capsys.readouterr().err
    assert (code, words in said) == (2, True), said
    assert len(said.splitlines()) == 1, "one fault is one line, however many variants have it"
    assert not folder.exists() and "Traceback" not in said
