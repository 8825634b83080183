"""Jacobi steps all FMUs with the values of the beginning; Gauss–Seidel uses what is reached."""

from dataclasses import replace

import pytest

from harness.errors import GraphError
from harness.master.run import plan_system
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, end, fmu, system, wire

H = 0.01


def pair(algorithm: str, order: tuple[str, str] = ("a", "b")):  # type: ignore[no-untyped-def]
    """Two FMUs, each driven by the other."""
    return system(
        *(fmu(name) for name in order), wire("a.y", "b.u"), wire("b.y", "a.u"),
        algorithm=algorithm, stop_ns=50 * MS,
    )  # fmt: skip


def recursion(sequential: bool) -> list[tuple[float, float]]:
    a, b, rows = 1.0, -2.0, []
    for k in range(6):
        rows.append((a, b))
        t = (k * 10 / 1000) / 64
        reached = 0.9 * a + H * b + t
        b = 0.9 * b + H * (reached if sequential else a) + t
        a = reached
    return rows


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel"])
def test_rows_are_the_recursion_of_the_algorithm(algorithm: str) -> None:
    rows = run(pair(algorithm), {"a": MockFmu(), "b": MockFmu(state=-2.0)})
    found = list(zip(rows["a.y"].tolist(), rows["b.y"].tolist(), strict=True))
    assert found == recursion(algorithm == "gauss-seidel")


def test_order_matters_to_gauss_seidel_only() -> None:
    fmus = {"a": MockFmu(), "b": MockFmu(state=-2.0)}
    for algorithm in ("jacobi", "gauss-seidel"):
        first = run(pair(algorithm), fmus)
        second = run(pair(algorithm, ("b", "a")), fmus)
        same = first["a.y"].tobytes() == second["a.y"].tobytes()
        assert same == (algorithm == "jacobi")


def through(name: str) -> MockFmu:
    return MockFmu((Input("u"), Input("v")), (Output("y", depends=("u",)), Output("z")))


def test_a_chain_of_feedthrough_arrives_within_the_instant() -> None:
    """source.y passes a, b and c by feedthrough: all see the same instant, whatever their order."""
    fmus = {"source": MockFmu()} | {name: through(name) for name in "cba"}
    chain = system(
        *(fmu(name) for name in fmus), wire("source.y", "a.u"), wire("a.y", "b.u"),
        wire("b.y", "c.u"), stop_ns=50 * MS,
    )  # fmt: skip
    rows = run(chain, fmus, ("*", "a.z", "b.z", "c.z"))
    for name, before in (("a", "source"), ("b", "a"), ("c", "b")):
        expected = rows[f"{name}.z"] + rows[f"{before}.y"] / 8
        assert rows[f"{name}.y"].tobytes() == expected.tobytes()


def test_a_loop_of_feedthrough_is_printed_port_by_port() -> None:
    fmus = {name: through(name) for name in "ab"}
    wires = wire("a.y", "b.u"), wire("b.y", "a.u")
    loop = system(fmu("a"), fmu("b"), *wires, algebraic_loops="refuse")
    with pytest.raises(GraphError) as caught:
        plan_system(loop, fmus)  # type: ignore[arg-type]
    text = str(caught.value)
    assert "algebraic loop" in text and "delay" in text
    path = text.split(": ")[1].split(";")[0].split(" -> ")
    assert path[0] == path[-1] and set(path) == {"a.u", "a.y", "b.u", "b.y"}
    broken = replace(loop, connections=(loop.connections[0], wire("b.z", "a.u")))
    assert broken.connections[1].source == end("b.z")
    plan_system(broken, fmus)  # type: ignore[arg-type]


def test_an_fmu_that_is_silent_on_dependencies_may_depend_on_all() -> None:
    fmus = {name: MockFmu() for name in "ab"}
    for one in fmus.values():
        one.description = replace(one.description, feedthrough={"y": None})
    with pytest.raises(GraphError, match="algebraic loop"):
        plan_system(replace(pair("jacobi"), algebraic_loops="refuse"), fmus)  # type: ignore[arg-type]
