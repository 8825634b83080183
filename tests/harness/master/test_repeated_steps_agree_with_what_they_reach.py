"""Iterative: FMUs that drive each other repeat a step until its inputs are what it reaches.

Every step of the mocks is linear, so the fixed point is the solution of two linear equations.
"""

import numpy as np
import pytest

from harness.master.program.frame import Frame
from harness.system.graph import Convergence, System
from tests.harness.master import reference_executor
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, fmu, system, wire

TIGHT = Convergence(1e-13, 50)


def pair(step_ns: int, *more: object, convergence: Convergence = TIGHT) -> System:
    """Two FMUs, each driven by the other."""
    return system(
        fmu("a", step_ns), fmu("b", step_ns), wire("a.y", "b.u"), wire("b.y", "a.u"), *more,
        algorithm="iterative", stop_ns=8 * step_ns, record_ns=step_ns, convergence=convergence,
    )  # fmt: skip


def mocks(fmi_major: int = 2) -> dict[str, MockFmu]:
    return {
        "a": MockFmu(fmi_major=fmi_major, states=True, **kinds(fmi_major)),
        "b": MockFmu(fmi_major=fmi_major, states=True, state=-2.0, **kinds(fmi_major)),
    }


def kinds(fmi_major: int) -> dict:  # type: ignore[type-arg]
    real = "Real" if fmi_major == 2 else "Float64"
    return {"inputs": (Input("u", real),), "outputs": (Output("y", real),)}


def implicit(h: float, n: int = 9) -> np.ndarray:
    """a' = 0.9 a + h b' + t / 64 and the same for b, solved for a' and b' in every step."""
    x = np.array([[1.0, -2.0]])
    for k in range(n - 1):
        right = 0.9 * x[-1] + k * h / 64
        x = np.vstack([x, np.linalg.solve([[1.0, -h], [-h, 1.0]], right)])
    return x


@pytest.mark.parametrize("fmi_major", [2, 3])
@pytest.mark.parametrize("step_ms", [10, 3000], ids=["weak", "beyond plain repetition"])
def test_inputs_are_the_values_at_the_end_of_the_step(fmi_major: int, step_ms: int) -> None:
    """With a gain of 3 a step, taking over what is reached would run away."""
    rows = run(pair(step_ms * MS), mocks(fmi_major))
    found = np.column_stack([rows["a.y"], rows["b.y"]])
    exact = implicit(step_ms / 1000)
    assert np.abs(found - exact).max() <= 1e-11 * np.abs(exact).max()


def test_every_repetition_begins_at_the_snapshot_and_no_snapshot_is_left() -> None:
    fmus = mocks()
    run(pair(10 * MS), fmus)
    for one in fmus.values():
        (instance,) = one.instances
        calls = instance.calls
        assert calls.count("GetState") == 8, "one snapshot a step"
        assert calls.count("SetState") == calls.count("DoStep") > 8
        assert instance.snapshots == {}, "the run frees what it took"


def test_nothing_steps_at_the_stop_time() -> None:
    fmus = mocks()
    run(pair(10 * MS), fmus)
    (instance,) = fmus["a"].instances
    assert max(time for time, _ in instance.model.steps) == pytest.approx(0.07)


def test_only_fmus_that_drive_each_other_repeat() -> None:
    """`before` drives the pair and `after` follows it: both step once, and save nothing."""
    fmus = mocks() | {"before": MockFmu(), "after": MockFmu()}
    fmus["a"] = MockFmu((Input("u"), Input("v")), states=True)
    whole = system(
        fmu("after"), fmu("a"), fmu("b"), fmu("before"), wire("a.y", "b.u"), wire("b.y", "a.u"),
        wire("before.y", "a.v"), wire("b.y", "after.u"), algorithm="iterative", stop_ns=80 * MS,
        convergence=TIGHT,
    )  # fmt: skip
    rows = run(whole, fmus)
    for name in ("before", "after"):
        (instance,) = fmus[name].instances
        assert instance.calls.count("DoStep") == 8 and "GetState" not in instance.calls
    t = np.arange(8) / 100 / 64
    expected = 0.9 * rows["after.y"][:-1] + 0.01 * rows["b.y"][1:] + t
    assert np.abs(rows["after.y"][1:] - expected).max() < 1e-12, "it sees what the pair reached"


def test_compiled_and_interpreted_repetitions_give_the_same_bits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    compiled = run(pair(3000 * MS), mocks())
    monkeypatch.setattr(Frame, "run", reference_executor.run)
    interpreted = run(pair(3000 * MS), mocks())
    assert compiled.rows.tobytes() == interpreted.rows.tobytes()
