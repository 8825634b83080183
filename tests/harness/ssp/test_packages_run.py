"""A package runs as our own files do: same rows, table, plots, run folder, timing, variants."""

from pathlib import Path

import numpy as np
import pytest

from harness.bench import Bench
from harness.cli.main import run_command_line
from harness.ssp.to_experiment import open_experiment
from tests.harness.fmi.archives import oscillator_fmu
from tests.harness.ssp.packages import archive, component, connector, ssd, wire

LINEAR = '<ssc:LinearTransformation factor="-20" offset="0.25"/>'
START = (
    "<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>"
    "<ssv:ParameterSet version='1.0' name='p'><ssv:Parameters><ssv:Parameter name='{}'>"
    "<ssv:Real value='{}'/></ssv:Parameter></ssv:Parameters></ssv:ParameterSet>"
    "</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>"
)


def two_oscillators(name: str, stiffness: float = 80.0, times: str = 'stopTime="0.5"') -> str:
    """`left` at the root, `right` in the system S, which calls its force `push`."""
    position, force = connector("position", "output"), connector("force", "input")
    right = component("right", force, START.format("mass", 3.0), "resources/o.fmu")
    inner = (
        f"<ssd:System name='S'><ssd:Connectors>{connector('push', 'input')}</ssd:Connectors>"
        f"<ssd:Elements>{right}</ssd:Elements>"
        f"<ssd:Connections>{wire('push', 'right.force')}</ssd:Connections></ssd:System>"
    )
    left = component("left", position, source="resources/o.fmu")
    whole = (
        START.format("left.stiffness", stiffness) + f"<ssd:Elements>{left}{inner}</ssd:Elements>"
        f"<ssd:Connections>{wire('left.position', 'S.push', LINEAR)}</ssd:Connections>"
    )
    step = (
        "<ssd:Annotations><ssc:Annotation type='org.openmodelica'><o:Annotations xmlns:o='urn:o'>"
        "<o:FixedStepMaster stepSize='0.010000'/></o:Annotations></ssc:Annotation>"
        "</ssd:Annotations>"
    )
    return ssd(whole, f"<ssd:DefaultExperiment {times}>{step}</ssd:DefaultExperiment>", name=name)


@pytest.fixture
def package(tmp_path: Path) -> Path:
    files = {
        "SystemStructure.ssd": two_oscillators("soft"),
        "other.ssd": two_oscillators("stiff", 300.0),
        "resources/o.fmu": oscillator_fmu(2).read_bytes(),
    }
    return archive(tmp_path / "two.ssp", files)


@pytest.mark.filterwarnings("ignore:.*states no")
def test_rows_are_those_of_the_same_bench(package: Path) -> None:
    bench = Bench(stop_time=0.5, step=0.01)
    bench.fmu("left", oscillator_fmu(2), start_values={"stiffness": 300.0})
    bench.fmu("S_right", oscillator_fmu(2), start_values={"mass": 3.0})
    bench.connect("left.position", "S_right.force", factor=-20.0, offset=0.25, convert_units=False)
    expected = bench.run()
    with open_experiment(package) as experiment:
        assert experiment.variants == ("soft", "stiff")
        found = experiment.run("stiff")
    assert set(found.names) == set(expected.names)
    for name in expected.names:
        assert np.array_equal(found[name], expected[name]), name
    pushed = found["S_right.force"][:-1]
    assert np.array_equal(pushed, -20.0 * found["left.position"][:-1] + 0.25)
    assert pushed[0] == -20.0 * 0.1 + 0.25, "no zero in the first step"


@pytest.mark.filterwarnings("ignore:.*states no")
def test_commands(package: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "run"
    arguments = ["run", str(package), "--variant", "stiff", "--output", str(out)]
    assert run_command_line(arguments) == 0
    said = capsys.readouterr()
    assert "states no step: 0.01 s, from its annotation org.openmodelica" in said.err
    assert "states no algorithm: Jacobi" in said.err
    assert "S_right.force" in said.out
    assert {p.name for p in out.iterdir()} >= {"stiff", "stiff.png", "metrics.csv"}
    assert run_command_line(["timing", str(package), "--set", "algorithm=gauss-seidel"]) == 0
    assert "copy left.position -> S_right.force" in capsys.readouterr().out
    assert run_command_line(["run", str(package), "--variant", "sitff"]) == 2
    assert "no variant 'sitff'; did you mean 'stiff'" in capsys.readouterr().err


def test_what_is_not_stated_is_said(tmp_path: Path) -> None:
    content = two_oscillators("plain", times="").replace("FixedStepMaster", "Other")
    files = {"SystemStructure.ssd": content, "resources/o.fmu": oscillator_fmu(2).read_bytes()}
    with (
        pytest.warns(UserWarning) as said,
        open_experiment(archive(tmp_path / "x.ssp", files)) as experiment,
    ):
        spec = experiment.spec
    texts = " | ".join(str(one.message) for one in said)
    assert "states no stop time" in texts and "states no step" in texts
    assert repr(spec.step) in texts and repr(spec.stop_time) in texts
