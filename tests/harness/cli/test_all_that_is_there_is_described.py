"""Every plant, controller, signal, imperfection and metric says what it is and how it is wired."""

import pytest

from harness.bench import Bench
from harness.cli.main import run_command_line
from harness.experiment.catalogue import describe, known

EVERY = [(kind, name) for kind, names in known().items() for name in names]


@pytest.mark.parametrize(("kind", "name"), EVERY)
def test_each_has_words_and_an_example(kind: str, name: str) -> None:
    one = next(one for one in describe(name) if one.kind == kind)
    assert len(one.text) > 10 and (name in one.example)
    if kind == "plant":
        assert {row[1] for row in one.ports} <= {"input", "output"} and one.ports
    elif kind == "signal":
        assert one.ports[0][0] == "value"


def test_a_controller_has_ports_units_and_meanings() -> None:
    (pid,) = describe("pid")
    ports = {row[0]: row for row in pid.ports}
    assert ports["u"][1] == "output" and ports["reference"][3] == "set point"
    parameters = {row[0]: row for row in pid.parameters}
    assert parameters["kp"][1:] == ("", "output_unit/measured_unit", "proportional gain")
    assert parameters["u_max"][1] == "inf" and "kp=…" in pid.example


@pytest.mark.parametrize(
    ("command", "code", "words"),
    [
        (("describe", "pid"), 0, "set point"),
        (("describe", "noise"), 0, "standard deviation"),
        (("describe", "hybrid_actuatr"), 2, "did you mean 'hybrid_actuator'"),
        (("info", "pid"), 2, "pid is a controller: `fmu-harness describe pid`"),
        (("info", "hybrid_actuator"), 2, "`fmu-harness describe hybrid_actuator`"),
    ],
)
def test_the_command_line(
    capsys: pytest.CaptureFixture[str], command: tuple[str, ...], code: int, words: str
) -> None:
    assert run_command_line(list(command)) == code
    said = capsys.readouterr()
    assert words in said.out + said.err


def test_a_bench_lists_its_ports() -> None:
    bench = Bench(stop_time=1.0)
    bench.fmu("plant", "oscillator_left")
    bench.controller("c", "pid", kp=1.0)
    bench.connect("c.u", "plant.coupling_force", convert_units=False)
    ports = bench.ports()
    assert ports.loc["plant.coupling_force", "wired from"] == "c.u"
    assert ports.loc["plant.position", ["direction", "unit"]].tolist() == ["output", "m"]
    assert "plant.mass" not in ports.index and ports.loc["c.reference", "wired from"] == ""
