"""Inputs of one FMU that are written together need not lie side by side in memory."""

import pytest

from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.outcomes import compare
from tests.harness.master.random_systems import Case
from tests.harness.master.small_systems import controller, fmu, system, wire


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel"])
def test_two_of_three_inputs_carry_feedthrough(algorithm: str) -> None:
    """u0 and u2 of `middle` change when the controller's output is applied, u1 does not."""
    fmus = {
        "first": MockFmu(outputs=(Output("y", depends=("u",)),)),
        "calm": MockFmu(state=5.0),
        "middle": MockFmu(
            tuple(Input(f"u{i}") for i in range(3)),
            (Output("y", depends=("u0", "u1", "u2")), Output("z")),
        ),
        "last": MockFmu(),
    }
    parts = system(
        *(fmu(name) for name in fmus), controller(lambda time, y: y + 1.0),
        wire("middle.z", "controller.y"), wire("controller.u", "first.u"),
        wire("first.y", "middle.u0"), wire("calm.y", "middle.u1"), wire("first.y", "middle.u2"),
        wire("middle.y", "last.u"), algorithm=algorithm,
    )  # fmt: skip
    compare(Case(parts, fmus))
