"""Loops of direct feedthrough are solved where that is asked for, to the last digits they have.

The outputs of the mocks are linear in their inputs, so the solution of a loop is known.
"""

import numpy as np
import pytest

from harness.errors import GraphError, SimulationError
from harness.master.run import plan_system
from harness.system.graph import Convergence, System
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, controller, fmu, system, wire

TIGHT = Convergence(1e-13, 50)
SOLVE = {"algebraic_loops": "solve", "convergence": TIGHT}


def through(gain_eighths: int = 1, **more: object) -> MockFmu:
    """y = state + gain / 8 * (its last input), z = state; earlier inputs feed nothing."""
    inputs = tuple(Input(f"u{j}") for j in range(1, gain_eighths + 1))
    outputs = (Output("y", depends=(inputs[-1].name,)), Output("z"))
    return MockFmu(inputs, outputs, **more)  # type: ignore[arg-type]


def ring(*gains: int, **more: object) -> tuple[System, dict[str, MockFmu]]:
    """FMUs in a circle, each with direct feedthrough of its gain in eighths."""
    names = "abcdefghijkl"[: len(gains)]
    fmus = {n: through(g, state=1.0 + i) for i, (n, g) in enumerate(zip(names, gains, strict=True))}
    wires = [
        wire(f"{names[i - 1]}.y", f"{name}.u{gains[i]}") for i, name in enumerate(names)
    ]  # fmt: skip
    return system(*map(fmu, names), *wires, **{**SOLVE, **more}), fmus


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel"])
@pytest.mark.parametrize("gains", [(1,), (3, 5), (20, 30), (9, 9, 9), (2, 30) * 5])
def test_a_ring_has_the_values_of_its_linear_equations(
    algorithm: str, gains: tuple[int, ...]
) -> None:
    """Also where plain repetition would run away, round gains of 9 and more."""
    whole, fmus = ring(*gains, algorithm=algorithm, stop_ns=30 * MS)
    rows = run(whole, fmus, ("*.y", "*.z"))
    n = len(gains)
    matrix = np.eye(n)
    for i, gain in enumerate(gains):
        matrix[i, i - 1] -= gain / 8
    z = np.column_stack([rows[f"{name}.z"] for name in fmus])
    y = np.column_stack([rows[f"{name}.y"] for name in fmus])
    exact = np.linalg.solve(matrix, z.T).T
    assert np.abs(y - exact).max() <= 1e-11 * np.abs(exact).max()


def test_a_loop_is_solved_in_the_initialisation_too() -> None:
    whole, fmus = ring(3, 5)
    seen: list[float] = []
    fmus["a"].hook = lambda instance, name: (
        seen.append(instance.model.get("y")) if name == "Exit" else None
    )
    run(whole, fmus)
    assert seen == pytest.approx([(1 + 3 / 8 * 2) / (1 - 15 / 64)], rel=1e-12)


def test_what_a_controller_writes_passes_through_the_loop_at_once() -> None:
    """a.y = z + v / 8 + 2 b.y / 8, b.y = z + a.y / 8, and v jumps at every sample."""
    a = MockFmu((Input("v"), Input("u")), (Output("y", depends=("u", "v")), Output("z")))
    fmus = {"a": a, "b": through(1), "c": MockFmu()}
    whole = system(
        fmu("a"), fmu("b"), fmu("c"), controller(lambda time: 100 * time), wire("b.y", "a.u"),
        wire("a.y", "b.u1"), wire("b.y", "c.u"), wire("controller.u", "a.v"), **SOLVE,
        stop_ns=50 * MS,
    )  # fmt: skip
    rows = run(whole, fmus, ("*", "*.z"))
    v = rows["a.v"]
    expected = (rows["b.z"] + (rows["a.z"] + v / 8) / 8) / (1 - 2 / 64)
    assert np.abs(rows["c.u"] - expected).max() < 1e-12


def test_loops_in_which_some_stand_still_are_solved_for_the_others() -> None:
    whole, fmus = ring(3, 5, stop_ns=40 * MS)
    slow = system(
        fmu("a", 10 * MS), fmu("b", 20 * MS), *whole.connections, **SOLVE, stop_ns=40 * MS
    )
    rows = run(slow, fmus, ("*.y", "*.z"))
    a_y = rows["a.z"] + 3 / 8 * rows["b.y"]
    assert np.abs(rows["a.y"] - a_y).max() < 1e-11
    assert rows["b.y"][1] == rows["b.y"][0] != rows["b.y"][2]


def test_a_loop_without_a_solution_is_named() -> None:
    whole, fmus = ring(8)
    with pytest.raises(SimulationError) as caught:
        run(whole, fmus)
    text = str(caught.value)
    assert "a.y -> a.u8" in text and "did not converge in 50 repetitions" in text
    assert "communication steps" not in text, "smaller steps would not help"


def test_where_asked_for_it_is_refused() -> None:
    whole, fmus = ring(3, 5, algebraic_loops="refuse")
    with pytest.raises(GraphError, match='algebraic_loops = "solve"'):
        plan_system(whole, fmus)  # type: ignore[arg-type]
    whole, fmus = ring(3, 5, algebraic_loops="ignore")
    with pytest.raises(GraphError, match="legal names: hold, refuse, solve"):
        plan_system(whole, fmus)  # type: ignore[arg-type]
