"""Variants that run at the same time give what they give one after the other: rows, metrics, what
is printed and its order, faults. Ctrl-C ends all of them, and `resume` goes on with each."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from harness.errors import HarnessError
from harness.experiment.experiment import Experiment
from harness.experiment.variants import Ran, run_variants
from harness.process import side_by_side as apart
from harness.process.fork import available
from harness.results.recording import read_recording
from tests.hostile.build import hostile_fmu

pytestmark = pytest.mark.skipif(not available(), reason="workers are processes on Linux alone")

FILE = """
title = "hostile plants"
stop_time = 3.0
step = 0.01
[components.plant]
fmu = "{first}"
[components.reference]
signal = "white_noise"
parameters = {{ std = 1.0 }}
[connections]
"plant.u" = "reference.value"
[metrics.most]
signal = "plant.y"
kind = "max_abs"
[checkpoint]
every = 0.05
[variants.one]
[variants.two.components.plant]
fmu = "{second}"
[variants.three.components.plant]
start_values = {{ T = 0.2 }}
"""
COMMAND = """
import os
os.cpu_count = lambda: 3
from harness.cli.main import main
main()
"""


def write(folder: Path, first: str, second: str) -> Path:
    names = {}
    for name, behaviour in (("first", first), ("second", second)):
        (folder / name).mkdir()
        names[name] = hostile_fmu(folder / name, *filter(None, [behaviour])).relative_to(folder)
    file = folder / "hostile.toml"
    file.write_text(FILE.format(**names))
    return file


def ran(file: Path, out: Path, cores: int, patch: pytest.MonkeyPatch) -> Ran:
    patch.setattr(os, "cpu_count", lambda: cores)
    experiment = Experiment.load(file)
    return run_variants(experiment, experiment.variants, out, lambda *_: None)


def test_rows_metrics_and_faults_are_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write(tmp_path, "", "DoStep segfault 150")
    both = [ran(file, tmp_path / str(cores), cores, monkeypatch) for cores in (1, 3)]
    for one in both:
        assert list(one.results) == ["one", "two", "three"] and list(one.faults) == ["two"]
        assert len(one.results["two"].time) == 151 and one.results["one"].metrics
    first, second = both
    assert first.results["three"].metrics == second.results["three"].metrics
    told = [
        str(one.faults["two"]).replace(str(tmp_path / n), "")
        for one, n in zip(both, "13", strict=True)
    ]
    assert told[0] == told[1] and "crashed with SIGSEGV" in told[0]
    for name in first.results:
        left, right = (tmp_path / n / name / "results.csv" for n in "13")
        assert left.read_bytes() == right.read_bytes()


def test_what_is_said_comes_in_order(capsys: pytest.CaptureFixture[str]) -> None:
    def work(number: int, tell: apart.Tell) -> int:
        tell("begun")
        time.sleep(0.2 if number == 0 else 0.0)
        print("said by", number)
        if number == 1:
            raise HarnessError("as it must be")
        return number

    heard: list[object] = []
    works = [lambda tell, number=number: work(number, tell) for number in range(3)]
    ended = apart.side_by_side(works, lambda *told: heard.append(told))
    assert [one.value for one in ended] == [0, None, 2]
    assert str(ended[1].fault) == "as it must be"
    assert sorted(heard) == [(number, "begun") for number in range(3)]
    assert capsys.readouterr().out == "said by 0\nsaid by 1\nsaid by 2\n"


def test_a_process_that_dies_is_told() -> None:
    (ended,) = apart.side_by_side([lambda tell: os.kill(os.getpid(), signal.SIGKILL)], print)
    assert str(ended.fault) == "a process of the run ended with code -9"


def test_ctrl_c_and_resume(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = write(tmp_path, "DoStep sleep 0 3", "DoStep sleep 0 3"), tmp_path / "out"
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND, "run", str(file), "--output", str(out)],
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        cwd=Path(__file__).parents[2],
    )  # fmt: skip
    names = ("one", "two", "three")
    while not all((out / name / "checkpoint.npz").exists() for name in names):
        assert process.poll() is None
        time.sleep(0.005)
    process.send_signal(signal.SIGINT)
    told = process.communicate()[1]
    assert process.returncode == 1 and "error: interrupted by Ctrl-C at t = " in told
    for name in names:
        kept = read_recording(out / name)
        assert kept.status.state == "incomplete" and 0 < len(kept.time) < 301
    assert run_command_line(["resume", str(out)]) == 0
    for name in names:
        assert len(read_recording(out / name).time) == 301
