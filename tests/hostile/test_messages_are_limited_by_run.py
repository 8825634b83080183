"""What an FMU logs beyond a limit is counted, and costs next to nothing; errors always pass."""

import time
from pathlib import Path

import pytest

from harness import simulate
from harness.errors import SimulationError
from harness.fmi.binding.logger import MOST_A_RUN, LogMessage
from harness.fmi.fmu import Fmu
from tests.hostile.build import hostile_fmu

TIMES = {"stop_time": 0.1, "step_size": 0.01}


@pytest.mark.parametrize("fmi", [2, 3])
def test_unasked_messages_cost_next_to_nothing_and_hide_no_error(tmp_path: Path, fmi: int) -> None:
    many = 100_000
    path = hostile_fmu(tmp_path, f"DoStep log_many 0 {many}", "DoStep log_error 0 0", fmi=fmi)
    with Fmu(path) as fmu, fmu.instantiate("plant") as plant:
        plant.enter_initialization_mode(0.0, 1.0, None)
        plant.exit_initialization_mode()
        began = time.process_time()
        plant.do_step(0.0, 0.01)
        assert time.process_time() - began < 1e-6 * many
        assert plant.log.count == MOST_A_RUN[False] + 1
        assert plant.log.reasons().endswith("the valve broke")


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_run_says_how_many_it_left_out(tmp_path: Path, fmi: int) -> None:
    path = hostile_fmu(tmp_path, "DoStep log_many 0 20000", "DoStep log_error 9", fmi=fmi)
    heard: list[LogMessage] = []
    result = simulate(path, **TIMES, echo=heard.append)
    most = MOST_A_RUN[True]
    assert [message.text for message in heard[:2]] == ["message 0", "message 1"]
    assert len(heard) == most and heard[-1].text == "message 19999"
    said = f"{200_001 - most} messages of FMUs were left out after {most}"
    assert said in result.notes


def test_messages_before_a_crash_are_all_there(tmp_path: Path) -> None:
    path = hostile_fmu(tmp_path, "DoStep log_many 5 3000", "DoStep segfault 5")
    heard: list[LogMessage] = []
    with pytest.raises(SimulationError, match=r"SIGSEGV.*2998 \| hostile: message 2999"):
        simulate(path, **TIMES, echo=heard.append)
    assert [message.text for message in heard] == [f"message {i}" for i in range(3000)]


def test_no_message_commands_a_terminal() -> None:
    assert str(LogMessage(1, "a", "\x1b[31mred\nand more")) == "[Warning] a:  [31mred\nand more"
