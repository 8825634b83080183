"""The ten lines of the bench's docstring run, and calls that cannot be meant say why."""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest

from harness.bench import Bench
from harness.errors import HarnessError, TimingError, UsageError


def ten_lines() -> Bench:
    bench = Bench(stop_time=1.0, step=0.01)
    bench.fmu("plant", "hybrid_actuator")
    bench.controller("controller", "pid", kp=2e-5, ki=2e-4, measured_unit="N")
    bench.signal("reference", "step", time=0.1, final=2000.0, unit="N")
    bench.connect("reference.value", "controller.reference")
    bench.connect("plant.force", "controller.measured", noise={"std": 5.0})
    bench.connect("controller.u", "plant.command")
    return bench


def test_the_ten_lines_give_arrays_frames_and_pictures() -> None:
    result = ten_lines().run()
    assert result["plant.force"].shape == result.time.shape == (101,)
    assert result.unit("plant.force") == result.unit("reference.value") == "N"
    frame = result.dataframe()
    assert frame.index.name == "time" and frame["plant.force"].iloc[-1] > 1000.0
    plt.close(result.plot("plant.force", "controller.u"))


def test_a_bench_runs_again_with_the_same_bits() -> None:
    bench = ten_lines()
    assert bench.run().data.tobytes() == bench.run().data.tobytes()


def test_progress_ends_at_one_and_never_goes_back() -> None:
    shares: list[float] = []
    ten_lines().run(progress=shares.append)
    assert shares == sorted(shares) and shares[-1] == 1.0


def test_a_controller_is_whatever_steps() -> None:
    class Counter:
        def __init__(self) -> None:
            self.count = 0

        def step(self, time: float) -> float:
            self.count += 1
            return float(self.count)

    bench = Bench(stop_time=0.5, step=0.1)
    bench.controller("object", Counter())
    bench.controller("function", lambda time, x: 2 * x)
    bench.connect("object.u", "function.x")
    result = bench.run()
    assert np.array_equal(result["function.u"], 2.0 * np.arange(1, 7))


BAD: list[tuple[str, tuple[Any, ...], dict[str, Any], str]] = [
    ("fmu", ("p", "hybrid_actuater"), {}, "no plant 'hybrid_actuater'; did you mean 'hybrid_act"),
    ("fmu", ("p.q", "hybrid_actuator"), {}, r"'p\.q' must have no '\.' and no '/'"),
    ("controller", ("c", "pif"), {}, "no controller 'pif'; did you mean 'pid'"),
    ("controller", ("c", "math:nothing"), {}, "controller 'math:nothing' cannot be imported"),
    ("controller", ("c", lambda *, y: y), {}, r"takes \(time, input, input, …\) by position"),
    ("controller", ("c", 7), {}, "7 is no controller; give a registered name"),
    ("controller", ("c", lambda time: 0.0), {"gain": 1}, "'gain' is no argument with a default"),
    ("controller", ("c", "pid"), {"sample_time": -1.0}, "sample_time of c must be positive"),
    ("controller", ("c", "pid"), {"sample_time": 1 / 3}, "no whole number of nanoseconds"),
    ("signal", ("s", "stp"), {}, "component s: unknown signal kind 'stp': did you mean 'step'"),
    ("connect", ("s", "t.u"), {}, "'s' is no port; write component.variable"),
    ("sensitivity", ("s",), {"of": "a.y", "to": "b.u"}, "a.y and b.u belong to different"),
]


@pytest.mark.parametrize(("method", "arguments", "named", "words"), BAD)
def test_calls_that_cannot_be_meant(
    method: str, arguments: tuple[Any, ...], named: dict[str, Any], words: str
) -> None:
    with pytest.raises(HarnessError, match=words):
        getattr(Bench(stop_time=1.0), method)(*arguments, **named)


def test_names_are_used_once() -> None:
    bench = Bench(stop_time=1.0)
    bench.controller("c", lambda time: 0.0)
    with pytest.raises(UsageError, match="'c' is used twice"):
        bench.signal("c", "step", final=1.0)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "1", True, 1e-12])
def test_times_are_whole_nanoseconds(value: Any) -> None:
    with pytest.raises(TimingError, match="stop_time"):
        Bench(stop_time=value)


def test_a_run_folder_that_holds_something_is_not_touched(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("keep")
    with pytest.raises(HarnessError, match=r"not empty.*mine\.txt"):
        ten_lines().run(tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["mine.txt"]
