"""A caller who asks for a tighter tolerance gets a smaller error, in proportion."""

import numpy as np
import pytest

from tests.fmus.packaging.conftest import NewInstance
from tests.fmus.packaging.plants import hydraulic
from tests.fmus.packaging.test_simulations_agree_with_radau import H, reference

N = 50


def errors(new_instance: NewInstance, version: int, tolerances: list[float]) -> np.ndarray:
    """Largest error of any state over its range, by tolerance."""
    names = [state.name for state in hydraulic.states]
    exact = reference(hydraulic, {"command": 100.0}, np.arange(N + 1) * H)[1:]
    found = []
    for tolerance in tolerances:
        instance = new_instance(hydraulic, version, start=False)
        instance.set(command=100.0)
        instance.initialize(tolerance=tolerance)
        run = instance.run(names, N, H)
        found.append(np.max(np.abs(run - exact) / np.ptp(exact, axis=0)))
    return np.array(found)


def test_each_factor_ten_in_tolerance_gains_at_least_five(
    new_instance: NewInstance, version: int
) -> None:
    found = errors(new_instance, version, [1e-4, 1e-5, 1e-6, 1e-7])
    assert np.all(found[:-1] / found[1:] >= 5.0)
    assert found[-1] <= 1e-5


def test_the_default_is_1e_6(new_instance: NewInstance, version: int) -> None:
    runs = []
    for tolerance in (None, 1e-6, 1e-5):
        instance = new_instance(hydraulic, version, start=False)
        instance.set(command=100.0)
        instance.initialize(tolerance=tolerance)
        runs.append(instance.run(["pressure_a"], N, H))
    assert np.array_equal(runs[0], runs[1])
    assert not np.array_equal(runs[0], runs[2])


@pytest.mark.parametrize("tolerance", [0.0, -1.0, 2.0, float("nan")])
def test_a_tolerance_outside_of_0_to_1_is_refused(
    new_instance: NewInstance, version: int, tolerance: float
) -> None:
    instance = new_instance(hydraulic, version, start=False)
    with pytest.raises(Exception, match="failed with status"):
        instance.initialize(tolerance=tolerance)
    assert "tolerance" in instance.texts("logStatusError")[0]
