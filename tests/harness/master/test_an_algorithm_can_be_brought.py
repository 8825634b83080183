"""An algorithm of another package runs by the name of its entry point or by that of its class, and
one that is none is named; none of the harness knows it."""

from collections.abc import Iterator, Mapping
from importlib.metadata import EntryPoint

import pytest

from harness import registry
from harness.errors import GraphError, UsageError
from harness.master.algorithms.base import Algorithm
from harness.master.algorithms.gauss_seidel import GaussSeidel
from harness.master.algorithms.jacobi import Jacobi
from harness.master.plan.actions import Action, Step
from harness.master.run import plan_system
from harness.system.lowering import Wire
from tests.harness.master.mock import MockFmu
from tests.harness.master.rows import Rows, run
from tests.harness.master.small_systems import fmu, system, wire


class Backwards(GaussSeidel):
    """Gauss–Seidel in the opposite order of the components."""

    def knows_end(self, wire: Wire) -> bool:
        order = list(self.step_ns)
        return order.index(wire.source.component) > order.index(wire.target.component)

    def advance(self, due: Mapping[str, int]) -> Iterator[Action]:
        for name in reversed(due):
            yield from self.in_turn(name, due[name])


class Forgetful(Algorithm):
    """Lets the first FMU step only."""

    def advance(self, due: Mapping[str, int]) -> Iterator[Action]:
        yield Step(min(due), due[min(due)])


class Twice(Jacobi):
    """Lets all FMUs step twice."""

    def advance(self, due: Mapping[str, int]) -> Iterator[Action]:
        yield from (*super().advance(due), *super().advance(due))


def pair(algorithm: str, order: str = "ab") -> Rows:
    fmus = {"a": MockFmu(), "b": MockFmu(state=-2.0)}
    whole = system(*map(fmu, order), wire("a.y", "b.u"), wire("b.y", "a.u"), algorithm=algorithm)
    return run(whole, fmus, ("a.y", "b.y"))


def test_by_the_name_of_the_class() -> None:
    expected = pair("gauss-seidel", "ba").rows
    assert pair(f"{__name__}:Backwards").rows.tobytes() == expected.tobytes()
    assert pair("gauss-seidel").rows.tobytes() != expected.tobytes()


def test_by_the_name_of_an_entry_point(monkeypatch: pytest.MonkeyPatch) -> None:
    entry = EntryPoint("backwards", f"{__name__}:Backwards", registry.ALGORITHMS)
    known = {**registry._entries(registry.ALGORITHMS), "backwards": entry}
    monkeypatch.setattr(registry, "_entries", lambda group: known)
    assert pair("backwards").rows.tobytes() == pair("gauss-seidel", "ba").rows.tobytes()
    with pytest.raises(GraphError, match="no algorithm 'backward'; did you mean 'backwards'"):
        pair("backward")


@pytest.mark.parametrize(
    ("kind", "fault"),
    [("Forgetful", "lets b step by 0 s where 10 ms"), ("Twice", "lets a step by 20 ms where 10")],
)
def test_each_fmu_steps_as_far_as_it_is_due(kind: str, fault: str) -> None:
    with pytest.raises(GraphError, match=fault):
        pair(f"{__name__}:{kind}")


def test_what_is_no_algorithm_is_named() -> None:
    whole = system(fmu(), algorithm="harness.bench:Bench")
    with pytest.raises(UsageError, match=r"'harness.bench:Bench' is .* no subclass of"):
        plan_system(whole, {"plant": MockFmu()})  # type: ignore[arg-type]
    with pytest.raises(UsageError, match=r"'harness.bench:Bunch' cannot be imported"):
        pair("harness.bench:Bunch")
