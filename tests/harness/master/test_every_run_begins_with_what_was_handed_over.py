"""What a plain Python controller remembers of one run does not reach the next one."""

from collections.abc import Callable
from threading import Lock
from typing import Any

import numpy as np
import pytest

from harness.bench import Bench
from harness.errors import UsageError

total, history = 0.0, [0.0]


class Integrator:
    def __init__(self, gain: float = 1.0) -> None:
        self.gain, self.sum, self.held = gain, 0.0, np.zeros(1)

    def step(self, time: float, y: float) -> float:
        self.held[0] += y
        self.sum += self.gain * y
        return float(self.sum + self.held[0])


class Locked(Integrator):
    def __init__(self, gain: float = 1.0) -> None:
        super().__init__(gain)
        self.others = [Lock()]


def closure() -> Callable[..., float]:
    count, seen = 0.0, [0.0]

    def step(time: float, y: float, memory: Any = None) -> float:
        nonlocal count
        count += y
        seen.append(count)
        return sum(seen)

    return lambda time, y: step(time, y)


def of_the_module(time: float, y: float) -> float:
    global total
    total += y
    return total + _helper(y)


def _helper(y: float) -> float:
    history.append(y)
    return sum(history)


def bench(source: Any, **parameters: Any) -> Bench:
    made = Bench(stop_time=0.5, step=0.1)
    made.signal("one", "constant", value=1.0)
    made.controller("c", source, **parameters)
    made.connect("one", "c.y")
    return made


@pytest.mark.parametrize("make", [Integrator, closure, lambda: of_the_module, lambda: Locked])
def test_the_second_run_gives_the_bits_of_the_first(make: Callable[[], Any]) -> None:
    made = bench(make())
    with made.prepare() as prepared:
        runs = [made.run(), made.run(in_process=True), prepared.run(), prepared.run()]
    assert len({run.data.tobytes() for run in runs}) == 1
    assert runs[0].numbers("c.u")[-1] > 5.0


def test_what_the_user_changes_counts_and_what_a_run_changes_does_not() -> None:
    controller = Integrator()
    made = bench(controller)
    first = made.run()
    assert (controller.sum, controller.held[0]) == (0.0, 0.0)
    controller.gain = 2.0
    assert made.run().numbers("c.u")[-1] == first.numbers("c.u")[-1] * 1.5


def test_what_controllers_share_they_share_in_the_run() -> None:
    common = Integrator()
    made = bench(lambda time, y: common.step(time, y))
    made.controller("other", lambda time, y: common.step(time, y))
    seen: list[float] = []
    made.controller("sink", lambda time, y: seen.append(common.sum), outputs=())
    for name in ("other", "sink"):
        made.connect("one", f"{name}.y")
    first = made.run()
    assert made.run().data.tobytes() == first.data.tobytes()
    assert first.numbers("c.u")[0] == 2.0 and first.numbers("other.u")[0] == 4.0


def test_a_sink_is_the_users_own() -> None:
    made, seen = bench(Integrator()), []  # type: ignore[var-annotated]
    made.controller("sink", lambda time, y: seen.append(y), outputs=())
    made.connect("c.u", "sink.y")
    made.run()
    assert seen == [2.0, 4.0, 6.0, 8.0, 10.0, 12.0]


def test_a_second_run_of_what_cannot_be_copied_is_refused() -> None:
    made = bench(Locked())
    made.run()
    with pytest.raises(UsageError, match=r"component c: a second run .* give the class itself"):
        made.run()
