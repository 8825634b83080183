"""By default an output in a loop of direct feedthrough is that of the last step, said in a note;
what FMUs do not say of their dependencies orders what it can and makes no such loop of others."""

from dataclasses import replace

import pytest

from harness.errors import SimulationError
from harness.master.plan.planner import Plan
from harness.master.run import plan_system
from harness.system.graph import System
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, controller, fmu, system, wire


def gain(state: float = 0.0, *, silent: bool = False, inputs: str = "u") -> MockFmu:
    """y = state + (1 + j) / 8 of the j-th input; the state decays to 0.9 of it, inputs come on."""
    ports = tuple(map(Input, inputs))
    made = MockFmu(ports, (Output("y", depends=tuple(inputs)),), state=state)
    if silent:
        made.description = replace(made.description, feedthrough={"y": None})
    return made


def ring(**more: object) -> System:
    wires = wire("a.y", "b.u"), wire("b.y", "a.u")
    return system(fmu("a"), fmu("b"), *wires, stop_ns=60 * MS, **more)


def planned(whole: System, fmus: dict[str, MockFmu]) -> Plan:
    return plan_system(whole, fmus)  # type: ignore[arg-type]


@pytest.mark.parametrize("silent", [False, True])
def test_the_sequence_is_that_of_the_last_steps(silent: bool) -> None:
    """Jacobi on the loop, one sweep an instant, from inputs of 0 in the initialisation."""
    rows = run(ring(), {"a": gain(1.0, silent=silent), "b": gain(-2.0, silent=silent)})
    a, b, u, v = 1.0, -2.0, -2.0, 1.0  # states; inputs as they leave the initialisation
    for k in range(7):
        y, z = a + u / 8, b + v / 8
        assert (rows["a.y"][k], rows["b.y"][k]) == (y, z)
        assert (rows["a.u"][k], rows["b.u"][k]) == (z, y)
        u, v = z, y
        a, b = 0.9 * a + 0.01 * u + k / 100 / 64, 0.9 * b + 0.01 * v + k / 100 / 64


def test_one_note_names_the_loop_port_by_port() -> None:
    (note,) = planned(ring(), {"a": gain(), "b": gain()}).notes
    path = note.split(": ")[1].split(";")[0].split(" -> ")
    assert path[0] == path[-1] and set(path) == {"a.u", "a.y", "b.u", "b.y"}
    assert '"solve" would repeat' in note and "assumed" not in note
    (note,) = planned(ring(), {"a": gain(), "b": gain(silent=True)}).notes
    assert "(assumed, as no dependencies are listed by b)" in note


@pytest.mark.parametrize("how", [{"algebraic_loops": "solve"}, {"algorithm": "iterative"}])
def test_without_a_note_where_it_is_solved(how: dict[str, str]) -> None:
    fmus = {name: MockFmu(states=True, outputs=(Output("y", depends=("u",)),)) for name in "ab"}
    assert planned(ring(**how), fmus).notes == ()


def test_what_is_declared_keeps_its_order_in_a_loop_that_is_assumed() -> None:
    """a.y -> b.u -> b.y is declared; only c, which lists nothing, closes the circle."""
    fmus = {"b": gain(1.0), "c": gain(2.0, silent=True), "a": gain(3.0)}
    whole = system(*map(fmu, fmus), wire("a.y", "b.u"), wire("b.y", "c.u"), wire("c.y", "a.u"),
                   record_ns=10 * MS, stop_ns=30 * MS)  # fmt: skip
    rows = run(whole, fmus, ("*",))
    states = rows["b.y"] - rows["b.u"] / 8
    decayed = [1.0]
    for k in range(3):
        decayed.append(0.9 * decayed[-1] + 0.01 * rows["b.u"][k] + k / 100 / 64)
    assert states == pytest.approx(decayed, abs=1e-15), "b.y is of this instant's a.y"
    assert rows["a.u"].tolist() == rows["c.y"].tolist() and len(planned(whole, fmus).notes) == 1


def test_an_assumed_dependency_orders_where_it_closes_no_loop() -> None:
    fmus = {"b": gain(silent=True), "a": gain(8.0)}
    whole = system(fmu("b"), fmu("a"), wire("a.y", "b.u"), stop_ns=10 * MS)
    assert run(whole, fmus)["b.y"][0] == 1.0 and planned(whole, fmus).notes == ()


def test_what_a_controller_writes_still_passes_at_once() -> None:
    """The command reaches b through a.y in the instant; the loop's own share is that of before."""
    fmus = {"a": gain(inputs="vu"), "b": gain()}
    whole = system(
        fmu("a"), fmu("b"), controller(lambda time: 800 * time), wire("controller.u", "a.v"),
        wire("a.y", "b.u"), wire("b.y", "a.u"), stop_ns=20 * MS,
    )  # fmt: skip
    rows = run(whole, fmus)
    assert rows["b.u"][1] == pytest.approx(rows["a.y"][1] + 8 / 8 + 2 / 8 * rows["b.y"][1]
                                           - 2 / 8 * rows["a.u"][0])  # fmt: skip


@pytest.mark.parametrize("state", [1.0, 1e-3, 1e5])
def test_a_singular_loop_that_is_to_be_solved_does_not_converge(state: float) -> None:
    """a.y = a + 8/8 b.y, b.y = b + 8/8 a.y has no solution unless a + b = 0."""
    ports = "".join(map(str, range(8)))
    fmus = {}
    for name, one in zip("ab", (state, 0.0), strict=True):
        made = MockFmu(tuple(map(Input, ports)), (Output("y", depends=("7",)),), state=one)
        fmus[name] = made
    whole = system(fmu("a"), fmu("b"), wire("a.y", "b.7"), wire("b.y", "a.7"),
                   algebraic_loops="solve")  # fmt: skip
    with pytest.raises(SimulationError, match="did not converge in 50 repetitions"):
        run(whole, fmus)
