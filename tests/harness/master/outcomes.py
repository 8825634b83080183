"""A random system run by the harness and by the brute-force simulation, compared bit for bit."""

import numpy as np

from harness.master.run import plan_system
from tests.harness.master.random_systems import Case
from tests.harness.master.reference_semantics import Simulation
from tests.harness.master.rows import run_to_end


def compare(case: Case) -> None:
    """Rows up to the end, or up to the same fault where a number does not fit its port; such a
    fault may be met before or after the row of its instant is recorded."""
    plan = plan_system(case.system, case.fmus)  # type: ignore[arg-type]
    simulation = Simulation(case.system, case.fmus, plan.recorded)
    times, expected, overflow = simulation.run()
    found, outcome = run_to_end(case.system, case.fmus)
    assert (outcome.fault is not None) == overflow, outcome.fault
    if overflow:
        assert "cannot hold" in str(outcome.fault)
        assert abs(len(found.times) - len(times)) <= 1
    n = min(len(found.times), len(times)) if overflow else len(times)
    assert found.times[:n].tolist() == times[:n]
    for column, name in enumerate(found.columns):
        wanted = np.array([row[column] for row in expected[:n]])
        assert found[name][:n].tobytes() == (wanted + 0.0).tobytes(), (
            f"{name}: {found[name].tolist()} instead of {wanted.tolist()}"
        )
