"""Rows of random systems equal those of a brute-force simulation of the timing contract, bit for
bit: several rates, phases and delays, all types of ports, both algorithms, FMI 2 and FMI 3."""

import numpy as np
from hypothesis import given, settings

from harness.execution.run import plan_system
from tests.harness.execution.random_systems import Case, systems
from tests.harness.execution.reference_semantics import Simulation
from tests.harness.execution.rows import run


@settings(max_examples=120, deadline=None, derandomize=True)
@given(systems())
def test_rows_equal_those_of_the_contract(case: Case) -> None:
    plan = plan_system(case.system, case.fmus)  # type: ignore[arg-type]
    times, expected = Simulation(case.system, case.fmus, plan.recorded).run()
    found = run(case.system, case.fmus)
    assert found.times.tolist() == times
    for column, name in enumerate(found.columns):
        wanted = np.array([row[column] for row in expected])
        assert found[name].tobytes() == (wanted + 0.0).tobytes(), (
            name,
            found[name].tolist(),
            wanted.tolist(),
        )
