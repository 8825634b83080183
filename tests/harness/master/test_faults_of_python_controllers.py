"""An exception in a plain Python controller names controller, sample and time; rows are kept."""

import pytest

from harness.bench import Bench
from harness.errors import HarnessError, SimulationError
from tests.harness.master.mock import MockFmu
from tests.harness.master.rows import run_to_end
from tests.harness.master.small_systems import controller, fmu, system, wire


def bench(function: object, **options: object) -> Bench:
    made = Bench(stop_time=1.0, step=0.1)
    made.controller("worker", function, **options)  # type: ignore[arg-type]
    return made


def test_exception_is_the_cause_and_the_sample_is_named() -> None:
    def broken(time: float) -> float:
        return 1 / (0.45 - time) if time < 0.45 else 1 / 0

    with pytest.raises(SimulationError) as caught:
        bench(broken).run()
    fault = caught.value
    assert str(fault) == (
        "controller worker raised ZeroDivisionError: division by zero at t = 0.5 s (sample 5)"
    )
    assert isinstance(fault.__cause__, ZeroDivisionError)
    assert fault.result is not None
    assert fault.result.time.tolist() == [0.0, 0.1, 0.2, 0.3, 0.4]
    assert fault.result.status.state == "incomplete"


def test_sample_number_counts_the_controllers_own_samples() -> None:
    def broken(time: float) -> float:
        if time > 0.6:
            raise RuntimeError("enough")
        return 0.0

    with pytest.raises(SimulationError, match=r"enough at t = 0\.7 s \(sample 3\)"):
        bench(broken, sample_time=0.2, phase=0.1).run()


@pytest.mark.parametrize("kind", [KeyboardInterrupt, SystemExit])
def test_interrupts_are_no_faults_and_rows_are_kept(kind: type[BaseException], tmp_path) -> None:  # type: ignore[no-untyped-def]
    def interrupted(time: float) -> float:
        if time > 0.65:
            raise kind
        return time

    with pytest.raises(kind):
        bench(interrupted).run(tmp_path / "run")
    from harness.results.recording import read_recording

    kept = read_recording(tmp_path / "run")
    assert len(kept.time) == 7
    assert kept.status.state == "incomplete" and kind.__name__ in kept.status.reason


def test_instances_are_freed_after_an_interrupt() -> None:
    def interrupted(time: float, y: float) -> float:
        raise KeyboardInterrupt

    plant = MockFmu()
    parts = fmu(), controller(interrupted), wire("plant.y", "controller.y")
    with pytest.raises(KeyboardInterrupt):
        run_to_end(system(*parts), {"plant": plant})
    assert plant.instances[0].calls[-1] == "Free"


@pytest.mark.parametrize(
    ("result", "words"),
    [
        ("three", "must be real number, not str"),
        (None, "NoneType"),
        (float("nan"), "output worker.u is nan at t = 0 s"),
    ],
)
def test_results_that_are_no_number(result: object, words: str) -> None:
    with pytest.raises(HarnessError, match=words):
        bench(lambda time: result).run()


def test_wrong_number_of_results() -> None:
    with pytest.raises(SimulationError, match=r"returned 1 values for 2 outputs \(a, b\)"):
        bench(lambda time: [1.0], outputs=("a", "b")).run()


def test_a_sink_needs_no_result() -> None:
    seen = []
    made = bench(lambda time: 1.0)
    made.controller("sink", lambda time, u: seen.append((time, u)), outputs=())
    made.connect("worker.u", "sink.u")
    made.run()
    assert seen == [(k / 10, 1.0) for k in range(11)]


def test_several_outputs_keep_their_order() -> None:
    result = bench(lambda time: (time, -time, 5), outputs=("a", "b", "c")).run()
    assert (result["worker.b"] == -result["worker.a"]).all() and set(result["worker.c"]) == {5.0}
