"""`timing` measures delays in a worker: an FMU that dies or hangs there ends it in one sentence."""

from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from tests.hostile.build import hostile_fmu
from tests.hostile.worlds import children

FILE = """
title = "a loop"
stop_time = 1.0
step = 0.01
[limits]
call = 0.3
[components.plant]
fmu = "hostile.fmu"
[components.controller]
controller = "pid"
parameters = { kp = 0.5 }
[components.reference]
signal = "step"
parameters = { final = 1.0 }
[connections]
"controller.reference" = "reference"
"controller.measured" = "plant.y"
"plant.u" = "controller.u"
"""


@pytest.mark.parametrize(
    ("behaviour", "words"),
    [
        ("DoStep segfault 4", "doStep by 10 ms at t = 0.04 s crashed with SIGSEGV"),
        ("DoStep exit 4", "doStep by 10 ms at t = 0.04 s ended the process as by exit(0)"),
        ("DoStep hang 4", "doStep by 10 ms at t = 0.04 s had not returned after 0.3 s"),
        ("load segfault", "loading its library crashed with SIGSEGV"),
    ],
)
def test_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], behaviour: str, words: str
) -> None:
    hostile_fmu(tmp_path, behaviour)
    (tmp_path / "loop.toml").write_text(FILE)
    before = children()
    assert run_command_line(["timing", str(tmp_path / "loop.toml")]) == 1
    told = capsys.readouterr().err
    assert words in told and "Traceback" not in told and children() == before
