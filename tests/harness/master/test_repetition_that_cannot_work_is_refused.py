"""The iterative algorithm names who cannot repeat, and what does not converge by how much."""

import pytest

from harness.errors import GraphError, SimulationError, TimingError
from harness.master.run import plan_system
from harness.system.graph import Convergence, System
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, fmu, system, wire


def pair(steps: tuple[int, int] = (10, 10), delay_ms: int = 0, **more: object) -> System:
    return system(
        *(fmu(name, step * MS) for name, step in zip("ab", steps, strict=True)),
        wire("a.y", "b.u"), wire("b.y", "a.u", delay_ms * MS), algorithm="iterative", **more,
    )  # fmt: skip


def test_the_fmu_without_states_is_named() -> None:
    fmus = {"a": MockFmu(states=True), "b": MockFmu()}
    with pytest.raises(GraphError) as caught:
        plan_system(pair(), fmus)  # type: ignore[arg-type]
    text = str(caught.value)
    assert "the state of b cannot be saved" in text and "canGetAndSetFMUState" in text
    plan_system(pair(delay_ms=20), fmus)  # type: ignore[arg-type]  # a delay parts them


def test_unequal_steps_are_named() -> None:
    fmus = {name: MockFmu(states=True) for name in "ab"}
    with pytest.raises(TimingError, match="a 10 ms, b 20 ms"):
        plan_system(pair((10, 20)), fmus)  # type: ignore[arg-type]


def test_the_worst_signal_is_named_with_its_residual() -> None:
    """b pushes a while a is negative, and then it is not: there is no fixed point."""
    flip = Output("y", "Boolean", gain=0.0, depends=("u",))
    fmus = {
        "a": MockFmu((Input("u"),), (Output("y", gain=-1.0),), states=True, state=-5e-3),
        "b": MockFmu((Input("u"),), (flip,), states=True),
    }
    limits = Convergence(1e-6, 8)
    with pytest.raises(SimulationError) as caught:
        run(pair(convergence=limits), fmus)
    text = str(caught.value)
    assert "did not converge in 8 repetitions" in text and "at t = 0 s" in text
    assert "coupling a.y -> b.u" in text and "(relative residual 0.01, tolerance 1e-06)" in text
    assert "smaller communication steps" in text


def test_a_step_that_fails_is_named_as_ever() -> None:
    fmus = {name: MockFmu(states=True) for name in "ab"}
    fmus["b"].statuses["SetState"] = 3
    with pytest.raises(SimulationError, match="component b: setting the FMU state at t = 0 s"):
        run(pair(), fmus)


@pytest.mark.parametrize(
    ("limits", "sentence"),
    [(Convergence(0.0, 50), "tolerance 0 must lie"), (Convergence(1e-6, 1), "must be at least 2")],
)
def test_limits_that_cannot_be_meant(limits: Convergence, sentence: str) -> None:
    fmus = {name: MockFmu(states=True) for name in "ab"}
    with pytest.raises(GraphError, match=sentence):
        plan_system(pair(convergence=limits), fmus)  # type: ignore[arg-type]
