"""A linear wire brings the value in the middle of the step: extrapolated, or between both ends."""

import numpy as np
import pytest

from harness.errors import GraphError, TimingError
from harness.master.run import plan_system
from harness.system.graph import Connection, Convergence, System
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, controller, end, fmu, system, wire

H = 0.01


def linear(source: str, target: str, delay_ns: int = 0, *imperfections: object) -> Connection:
    return Connection(end(source), end(target), delay_ns, imperfections, extrapolation=1)  # type: ignore[arg-type]


def pair(algorithm: str, **more: object) -> System:
    return system(
        fmu("a"), fmu("b"), linear("a.y", "b.u"), linear("b.y", "a.u"), algorithm=algorithm,
        stop_ns=60 * MS, convergence=Convergence(1e-14, 50), **more,
    )  # fmt: skip


def recursion(algorithm: str) -> list[tuple[float, float]]:
    a, b = 1.0, -2.0
    a_before, b_before = a, b
    rows = []
    for k in range(7):
        rows.append((a, b))
        t = k * H / 64
        ahead_a, ahead_b = a + (a - a_before) / 2, b + (b - b_before) / 2
        a_before, b_before = a, b
        if algorithm == "iterative":
            right = [0.9 * a + H * b / 2 + t, 0.9 * b + H * a / 2 + t]
            a, b = np.linalg.solve([[1, -H / 2], [-H / 2, 1]], right)
        else:
            a = 0.9 * a + H * ahead_b + t
            b = 0.9 * b + H * ((a_before + a) / 2 if algorithm == "gauss-seidel" else ahead_a) + t
    return rows


@pytest.mark.parametrize("slopes", [False, True], ids=["middle", "slope"])
@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel", "iterative"])
def test_rows_are_the_recursion_of_the_algorithm(algorithm: str, slopes: bool) -> None:
    """The mocks are as linear in a slope as in a value, so both ways come to the same."""
    fmus = {
        "a": MockFmu(states=True, can_interpolate_inputs=slopes),
        "b": MockFmu(state=-2.0, states=True, can_interpolate_inputs=slopes),
    }
    rows = run(pair(algorithm), fmus)
    found = np.column_stack([rows["a.y"], rows["b.y"]])
    assert np.abs(found - np.array(recursion(algorithm))).max() < 1e-14
    for one in fmus.values():
        assert ("SetRealInputDerivatives" in one.instances[0].calls) == slopes


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "iterative"])
def test_a_slope_comes_from_fmus_outside_of_a_group_too(algorithm: str) -> None:
    """b repeats with c while a drives it; what it gets of a is the mean of both ends either way."""
    found = []
    for slopes in (False, True):
        inputs = (Input("u"), Input("v"))
        fmus = {
            "a": MockFmu(states=True),
            "b": MockFmu(inputs, states=True, can_interpolate_inputs=slopes),
            "c": MockFmu(states=True, can_interpolate_inputs=slopes),
        }
        whole = system(
            *map(fmu, "abc"), linear("a.y", "b.u"), wire("c.y", "b.v"), linear("b.y", "c.u"),
            algorithm=algorithm, stop_ns=60 * MS, convergence=Convergence(1e-14, 50),
        )  # fmt: skip
        found.append(run(whole, fmus).rows)
    assert np.abs(found[0] - found[1]).max() < 1e-14


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel", "iterative"])
def test_a_row_shows_the_value_at_its_own_time(algorithm: str) -> None:
    fmus = {name: MockFmu(states=True) for name in "ab"}
    rows = run(pair(algorithm), fmus)
    assert np.array_equal(rows["a.u"], rows["b.y"]) and np.array_equal(rows["b.u"], rows["a.y"])


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "iterative"])
def test_direct_feedthrough_sees_the_end_of_the_step_not_its_middle(algorithm: str) -> None:
    """b follows a, c takes b.y at the end of the step: b.z + a.y / 8 of that very instant."""
    fmus = {
        "a": MockFmu(states=True),
        "b": MockFmu(outputs=(Output("y", depends=("u",)), Output("z")), states=True),
        "c": MockFmu(states=True),
    }
    whole = system(
        *map(fmu, "abc"), linear("a.y", "b.u"), wire("b.y", "c.u"), algorithm=algorithm,
        stop_ns=60 * MS,
    )  # fmt: skip
    rows = run(whole, fmus, ("*", "b.z"))
    reached = (rows["b.z"] + rows["a.y"] / 8)[1:]
    t = np.arange(6) * H / 64
    assert np.abs(rows["c.y"][1:] - (0.9 * rows["c.y"][:-1] + H * reached + t)).max() < 1e-15


@pytest.mark.parametrize(
    ("whole", "sentence"),
    [
        (system(fmu("a"), fmu("b"), linear("a.y", "b.u", MS)), "with a delay or with imperf"),
        (system(fmu("b"), controller(lambda time: 1.0), linear("controller.u", "b.u")),
         "only a wire from FMU to FMU"),
        (system(fmu("a"), fmu("b"), linear("a.n", "b.u")), "only real numbers"),
    ],
)  # fmt: skip
def test_wires_that_cannot_be_linear_are_named(whole: System, sentence: str) -> None:
    fmus = {name: MockFmu(outputs=(Output("y"), Output("n", "Integer"))) for name in "ab"}
    fmus = {c.name: fmus[c.name] for c in whole.fmus}
    with pytest.raises(GraphError, match=sentence):
        plan_system(whole, fmus)  # type: ignore[arg-type]


def test_unequal_steps_are_named() -> None:
    whole = system(fmu("a", 20 * MS), fmu("b"), linear("a.y", "b.u"))
    with pytest.raises(TimingError, match="a at 0 s, b at 0 s, 10 ms"):
        plan_system(whole, {name: MockFmu() for name in "ab"})  # type: ignore[arg-type]
    split = system(
        fmu("a"), fmu("b"), linear("a.y", "b.u"), wire("a.y", "b.v", 3 * MS)
    )  # a value that arrives between b's steps
    fmus = {"a": MockFmu(), "b": MockFmu((Input("u"), Input("v")))}
    with pytest.raises(TimingError, match="evenly spaced"):
        plan_system(split, fmus)  # type: ignore[arg-type]
