"""Ctrl-C ends any run from Python, also one within a callback, and the interrupt has the rows."""

import signal
import threading

import pytest

from harness.bench import Bench
from harness.registry import plant_fmu
from harness.results.result import Result


def bench(with_fmu: bool) -> Bench:
    made = Bench(stop_time=1e6, step=0.001)
    if with_fmu:
        made.fmu("plant", plant_fmu("oscillator_left", 3))
    made.signal("wave", "sine", amplitude=1.0, frequency=1.0)
    made.controller("c", lambda time, y: y)
    made.connect("wave", "c.y")
    return made


def interrupt() -> None:
    signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)


@pytest.mark.parametrize("with_fmu", [False, True])
def test_one_signal_is_enough(with_fmu: bool) -> None:
    made, timers = bench(with_fmu), []

    def moved(share: float) -> None:
        if share > 0 and not timers:
            timers.append(threading.Timer(0.2, interrupt))
            timers[0].start()

    with pytest.raises(KeyboardInterrupt, match="interrupted by Ctrl-C") as caught:
        made.run(progress=moved)
    result = caught.value.result  # type: ignore[attr-defined]
    assert isinstance(result, Result) and len(result.time) > 1
    assert result.status.state == "incomplete"


def test_before_the_first_row_there_is_no_result(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(self: Bench) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Bench, "prepare", interrupted)
    with pytest.raises(KeyboardInterrupt) as caught:
        bench(False).run()
    assert caught.value.result is None  # type: ignore[attr-defined]
