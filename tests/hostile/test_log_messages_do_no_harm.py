"""Whatever an FMU logs, the run goes on, what is kept is bounded, and no text breaks a line."""

import resource
from pathlib import Path

import pytest

from harness.errors import FmuError
from harness.fmi.binding.formats import expandable, readable
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.logger import LONGEST_MESSAGE, MOST_MESSAGES, LogMessage
from harness.fmi.fmu import Fmu
from tests.hostile.build import hostile_fmu

WRONG = {
    (2, "log_missing"): "%s %s %s %s %s %s %s %s %s %s", (3, "log_missing"): "%s %s %s",
    (2, "log_write"): "%n%n%n%n%n%n%n%n", (3, "log_write"): "%n%n%n",
    (2, "log_pointer"): "%d: %s", (2, "log_null_text"): "valve (null) at 1.500000",
    (2, "log_thread"): "from another thread", (3, "log_thread"): "from another thread",
    (2, "log_null"): "", (3, "log_null"): "",
    (2, "log_garbage"): "\ufffd\ufffd\ufffd not text \x01",
    (3, "log_garbage"): "\ufffd\ufffd\ufffd not text \x01",
}  # fmt: skip


def stepped(folder: Path, action: str, fmi: int) -> tuple[list[LogMessage], FmuInstance]:
    heard: list[LogMessage] = []
    path = hostile_fmu(folder, f"DoStep {action}", fmi=fmi)
    with Fmu(path) as fmu, fmu.instantiate("plant", logging=True, echo=heard.append) as plant:
        plant.enter_initialization_mode(0.0, 1.0, None)
        plant.exit_initialization_mode()
        plant.do_step(0.0, 0.01)
        return heard, plant


@pytest.mark.parametrize(("fmi", "action"), WRONG)
def test_message(tmp_path: Path, fmi: int, action: str) -> None:
    heard, plant = stepped(tmp_path, action, fmi)
    assert [message.text for message in heard] == [WRONG[fmi, action]]
    assert plant.log.reasons().isprintable()


@pytest.mark.parametrize("fmi", [2, 3])
def test_formats_whose_arguments_are_numbers_are_expanded(tmp_path: Path, fmi: int) -> None:
    [message] = stepped(tmp_path, "log_format", fmi)[0]
    assert "%" not in message.text


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_message_for_nobody_is_dropped(tmp_path: Path, fmi: int) -> None:
    assert stepped(tmp_path, "log_stranger", fmi)[0] == []


@pytest.mark.parametrize("fmi", [2, 3])
def test_long_messages_are_cut(tmp_path: Path, fmi: int) -> None:
    [message] = stepped(tmp_path, "log_long", fmi)[0]
    assert set(message.text) == {"x"} and len(message.text) <= LONGEST_MESSAGE


@pytest.mark.parametrize("fmi", [2, 3])
def test_many_messages_are_counted_in_bounded_memory(tmp_path: Path, fmi: int) -> None:
    path = hostile_fmu(tmp_path, "DoStep log_many 0 100000", fmi=fmi)
    with Fmu(path) as fmu, fmu.instantiate("plant", logging=True) as plant:
        plant.enter_initialization_mode(0.0, 1.0, None)
        plant.exit_initialization_mode()
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        plant.do_step(0.0, 0.01)
        assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 20_000  # kB
        assert plant.log.count == 100_000 and len(plant.log.messages) == MOST_MESSAGES
        assert plant.log.messages[-1].text == "message 99999"


def test_the_reason_of_a_fault_is_one_line(tmp_path: Path) -> None:
    with Fmu(hostile_fmu(tmp_path, fmi=2)) as fmu, fmu.instantiate("plant") as plant:
        plant.log.add(3, b"c", b"first\nsecond \x1b[31m" + b"x" * 5000)
        with pytest.raises(FmuError) as caught:
            plant.check(3, "DoStep")
    assert str(caught.value).isprintable() and len(str(caught.value)) < 700


def test_formats_that_may_not_be_expanded() -> None:
    for bad in (b"%n", b"%hhn", b"100%", b"%99999999d", b"%.99999999f", b"%y", b"%ls", b"%S"):
        assert not expandable(bad, 0), bad
    for good in (b"", b"plain", b"100%%", b"%d %5.2f %-8x %lld %c %p"):
        assert expandable(good, 0), good
    assert not readable(0) and not readable(12) and not readable(2**62)
