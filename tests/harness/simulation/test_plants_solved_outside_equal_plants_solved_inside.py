"""Our own plants: model exchange by CVODE gives the trajectory of their co-simulation."""

import numpy as np
import pytest

from harness import registry, simulate
from tests.harness.simulation.fmus import needs_compiler

pytestmark = needs_compiler
STOP = {"two_mass_drive": 0.2, "hybrid_actuator": 0.2, "single_machine_infinite_bus": 1.0}


@pytest.mark.parametrize("fmi_version", [2, 3])
@pytest.mark.parametrize("plant", sorted(STOP))
def test_both_agree(plant: str, fmi_version: int) -> None:
    stop = STOP[plant]
    path = registry.plant_fmu(plant, fmi_version)
    inputs = {v: ([0.0, stop / 4, stop / 4], [0.0, 0.0, 0.5]) for v in _inputs(path)}
    options = {"stop_time": stop, "output_interval": stop / 50, "inputs": inputs}
    inside = simulate(path, relative_tolerance=1e-11, **options)  # type: ignore[arg-type]
    outside = simulate(path, interface_type="me", relative_tolerance=1e-11, **options)  # type: ignore[arg-type]
    for name in inside.names:
        left = {float(t): v for t, v in zip(inside.time, inside[name], strict=True)}
        right = dict(zip(map(float, outside.time), outside[name], strict=True))
        common = sorted(set(left) & set(right) - {stop / 4})
        assert len(common) >= 49
        a, b = (np.array([one[t] for t in common]) for one in (left, right))
        assert np.abs(a - b).max() <= 2e-5 * max(np.abs(a).max(), 1e-12), name


def _inputs(path: object) -> list[str]:
    from harness import Fmu

    with Fmu(path) as fmu:  # type: ignore[arg-type]
        return [v.name for v in fmu.description.inputs]
