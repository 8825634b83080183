"""The loop and `--help` execute at most 5 % more instructions than at the last commit."""

import json
import os
import signal

import pytest

from benchmarks import instructions
from tests.every_way.models import needs_compiler


def kept() -> dict[str, float | None]:
    held = json.loads(instructions.COUNTS.read_text())
    if held["versions"] != instructions.versions():
        pytest.skip(f"the counts are of {held['versions']}")
    return dict(held["counts"])


@needs_compiler
def test_of_a_sample_of_the_loop() -> None:
    now = instructions.loop_instructions()
    if now is None:
        pytest.skip("no process can be stepped here")
    assert not instructions.grown({"loop": now}, kept())


def test_of_help() -> None:
    assert not instructions.grown({"help": instructions.help_bytecodes()}, kept())


def test_growth_is_told() -> None:
    before = {"loop": 100.0, "help": 1000.0}
    assert not instructions.grown({"loop": 104.9, "help": None}, before)
    (told,) = instructions.grown({"loop": 106.0, "help": 900.0}, before)
    assert told == "loop: 106 instructions, 6.0 % more than the 100 of the last commit"


def test_a_longer_work_has_more_instructions() -> None:
    def work(numbers: int) -> None:
        os.kill(os.getpid(), signal.SIGSTOP)
        sum(range(numbers))
        os.kill(os.getpid(), signal.SIGSTOP)

    few, more, many = (instructions.stepped(lambda n=n: work(n)) for n in (300, 600, 900))
    if few is None or more is None or many is None:
        pytest.skip("no process can be stepped here")
    assert many - more == pytest.approx(more - few, rel=0.05) and more - few > 3000
