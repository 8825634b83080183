"""Barragán's experiments: what the identifier learns of a plant FMU inside its control loop.

The generator's FMU is under PID control; the block's parameters must be those of batch ridge
least squares on the recorded signals, and its sensitivity that of the FMU's derivatives.
"""

from pathlib import Path

import numpy as np
import pytest

from controllers.identification.identifier import Identifier
from controllers.identification.narx import fit
from controllers.identification.offline import ridge_least_squares
from harness.experiment.experiment import Experiment
from harness.results.result import Result

FOLDER = Path(__file__).parents[2] / "experiments/barragan"
SHORT = {  # a quarter of the experiment
    "stop_time": 40.0,
    "components": {"identifier": {"parameters": {"learn_until": 25.0, "free_run_from": 25.0}}},
}


@pytest.fixture(scope="module")
def machine() -> Experiment:
    return Experiment.load(FOLDER / "single_machine.toml", SHORT)


def described(experiment: Experiment, variant: str) -> Identifier:
    return Identifier(**experiment.variant_spec(variant).components["identifier"].parameters)


def scaled(identifier: Identifier, result: Result) -> tuple[np.ndarray, np.ndarray]:
    of_angle, of_field = identifier.scales()
    angle, field = result["sensor.y"], result["controller.u"]
    return of_angle.scaled(angle)[:, None], of_field.scaled(field)[:, None]


@pytest.mark.parametrize("variant", ["linear", "least_squares"])
def test_consequents_are_those_of_batch_least_squares(machine: Experiment, variant: str) -> None:
    result = machine.run(variant)
    identifier = described(machine, variant)
    start, adaptation = identifier.start_model(), identifier.adapted()
    learnt = result.time < 25.0 - 1e-9
    y, u = scaled(identifier, result)
    X, Y = identifier.lags.rows(y[learnt], u[learnt])
    variance = adaptation.variance[start.n_antecedent :]
    batch = ridge_least_squares(start, X, Y, adaptation.r, variance)
    found = [result[f"identifier.{name}"][-1] for name in start.parameter_names()]
    assert np.abs(np.array(found) - batch.theta()).max() < 1e-7
    first = int(np.sum(learnt))  # the instant of 25 s, whose regressor goes two samples back
    made = identifier.lags.free_run(batch.evaluate, y[first - 2 :], u[first - 2 :])
    simulated = identifier.scales()[0].physical(made[2:, 0])
    found_free = result["identifier.angle_simulated"][first:]
    np.testing.assert_allclose(found_free, simulated, rtol=0, atol=1e-6)


def test_rules_find_the_sensitivity_and_run_free_where_a_linear_model_cannot(
    machine: Experiment,
) -> None:
    fits, errors = {}, {}
    for variant in ("linear_clean", "least_squares_clean"):
        result = machine.run(variant)
        tested = result.time > 25.0
        true, free = result["plant.angle_deviation"], result["identifier.angle_simulated"]
        fits[variant] = fit(true[tested], free[tested])
        exact, found = result["exact.value"], result["identifier.sensitivity_angle_field"]
        difference = (found - exact)[tested]
        errors[variant] = np.sqrt(np.mean(difference**2) / np.mean(exact[tested] ** 2))
    assert fits["least_squares_clean"] > 90.0 > 70.0 > fits["linear_clean"], fits
    assert errors["least_squares_clean"] < 0.05 < errors["linear_clean"], errors


def test_benchmark_orders_the_models() -> None:
    experiment = Experiment.load(FOLDER / "narendra_parthasarathy.toml")
    errors = {}
    for variant in ("linear", "least_squares", "gaussian"):
        errors[variant] = experiment.run(variant).metrics["free_run_error"]
    assert errors["gaussian"] < errors["least_squares"] < errors["linear"]
    assert errors["gaussian"] < 0.2
