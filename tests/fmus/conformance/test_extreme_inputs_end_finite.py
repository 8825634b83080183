"""Whatever the inputs do, up to ten times their nominals, steps succeed and values are finite.

Each input is held at plus or minus a multiple of its nominal, a second for every combination of
signs, with jumps in between.
"""

import numpy as np
import pytest

from fmus.plant import Plant
from harness.bench import Bench

MULTIPLES = (1.0, 10.0)


@pytest.mark.parametrize("multiple", MULTIPLES)
def test_all_combinations_of_signs(plant: Plant, version: int, multiple: float) -> None:
    """A failed step or a NaN in an output raises; states and derivatives are looked at here."""
    combinations = 2.0 ** min(len(plant.inputs), 4)
    bench = Bench(stop_time=combinations, step=0.01, fmi_version=version)
    bench.fmu("plant", plant.fmu(version))
    for number, variable in enumerate(plant.inputs):
        amplitude, period = multiple * variable.nominal, 2.0 * 2.0 ** (number % 4)
        bench.signal(f"signal_{number}", "square", amplitude=amplitude, period=period)
        bench.connect(f"signal_{number}", f"plant.{variable.name}")
    states = [f"plant.{state.name}" for state in plant.states]
    rates = [f"plant.der({state.name})" for state in plant.states]
    bench.record = ("plant.*", *states, *rates)
    result = bench.run()
    assert result.time[-1] == combinations
    assert np.isfinite(result.data).all()
    for variable in plant.inputs:
        seen = np.unique(np.sign(result[f"plant.{variable.name}"]))
        assert np.array_equal(seen, [-1.0, 1.0])
