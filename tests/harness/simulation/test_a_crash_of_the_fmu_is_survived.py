"""In a worker an FMU may crash, end the process or hang: the caller lives, with the rows that came
before; and where nothing goes wrong the result is that of a simulation in this process."""

import os
import signal
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from harness import simulate
from harness.cli.main import run_command_line
from harness.errors import FmuError, SimulationError
from harness.process.limits import Limits
from tests.harness.simulation.fmus import misbehaving_fmu, model_fmu, needs_compiler

pytestmark = [needs_compiler, pytest.mark.skipif(os.name == "nt", reason="signals")]
OPTIONS = {"stop_time": 1.0, "step_size": 0.1}


@pytest.mark.parametrize(
    ("action", "words"),
    [
        ("raise(11)", "crashed with SIGSEGV"),
        ("abort()", "crashed with SIGABRT"),
        ("exit(3)", r"ended the process as by exit\(3\)"),
        ("_exit(0)", r"ended the process as by exit\(0\)"),
    ],
)
def test_rows_before_a_crash_are_kept(action: str, words: str) -> None:
    with pytest.raises(SimulationError, match=rf"doStep by 100 ms at t = 0\.5 s {words}") as caught:
        simulate(misbehaving_fmu(action), **OPTIONS)
    result = caught.value.result
    assert result.time.tolist() == [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]
    assert result["counter"].tolist() == [0, 0, 0, 1, 1, 2]
    assert result.status.state == "incomplete"


def test_what_a_crash_left_unpacked_is_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = misbehaving_fmu("abort()")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(SimulationError):
        simulate(path, **OPTIONS)
    assert list(tmp_path.iterdir()) == []


def test_the_command_says_it_in_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.csv"
    options = ["--stop-time", "1", "--step-size", "0.25", "--output-file", str(out)]
    chosen = ["--output-variables", "counter"]
    assert run_command_line(["simulate", str(misbehaving_fmu("abort()")), *options, *chosen]) == 1
    text = capsys.readouterr().err
    assert out.read_text() == '"time","counter"\n0,0\n0.25,1\n0.5,2\n'
    assert "crashed with SIGABRT" in text and "Traceback" not in text


def test_a_hang_ends_with_an_interrupt() -> None:
    def interrupt() -> None:
        time.sleep(1.5)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt, daemon=True).start()
    with pytest.raises(SimulationError, match=r"interrupted by Ctrl-C at t = 0\.5 s") as caught:
        simulate(misbehaving_fmu("for(;;)sleep(1)"), **OPTIONS)
    assert len(caught.value.result.time) == 6


def test_a_hang_has_a_deadline() -> None:
    with pytest.raises(SimulationError, match=r"had not returned after 0\.2 s"):
        simulate(misbehaving_fmu("for(;;)sleep(1)"), **OPTIONS, limits=Limits(call=0.2))


@pytest.mark.parametrize(
    ("action", "words"), [("for(;;)sleep(1)", "had not returned after 0"), ("raise(11)", "SIGSEGV")]
)
def test_so_have_the_rates_of_model_exchange(action: str, words: str) -> None:
    limits, path = Limits(call=0.2), misbehaving_fmu(action, "CRASH_RATES")
    with pytest.raises(SimulationError, match=rf"fmi2GetDerivatives at t = .*{words}") as caught:
        simulate(path, interface_type="me", stop_time=1.0, output_interval=0.01, limits=limits)
    assert len(caught.value.result.time) > 1


def test_functions_as_inputs_work_in_the_worker() -> None:
    offset = 1.0
    result = simulate(model_fmu("2"), **OPTIONS, inputs={"u": lambda t: t + offset},
                      output_variables=["u"])  # fmt: skip
    held = [0.0, *result.time[:-1]]  # what is set at t holds until the next row
    assert result["u"].tolist() == pytest.approx([t + offset for t in held], abs=1e-15)


@pytest.mark.parametrize("kind", ["1-slave", "2", "3"])
def test_without_a_fault_the_result_is_the_same(kind: str) -> None:
    here = simulate(model_fmu(kind), **OPTIONS, in_process=True)
    there = simulate(model_fmu(kind), **OPTIONS)
    assert here.names == there.names and here.notes == there.notes
    assert all(np.array_equal(here[name], there[name]) for name in here.names)


def test_faults_come_back_as_they_are() -> None:
    with pytest.raises(FmuError, match=r"returned Error: no step beyond 0\.45 s") as caught:
        simulate(model_fmu("1-slave"), **OPTIONS, start_values={"end": 0.45})
    assert list(caught.value.result.time) == [0.0, 0.1, 0.2, 0.3, 0.4]
