"""Directional and adjoint derivatives: exact, for states, inputs and parameters."""

import numpy as np

from fmus.packaging.plant.functions import plant_functions
from fmus.plant import Plant
from tests.fmus.packaging.conftest import NewInstance
from tests.fmus.packaging.plants import hydraulic, oscillator

SEED = 20240501


def names(plant: Plant) -> tuple[list[str], list[str]]:
    """Unknowns (derivatives, outputs) and knowns (states, inputs, parameters)."""
    unknowns = [f"der({s.name})" for s in plant.states] + [v.name for v in plant.outputs]
    return unknowns, [v.name for v in (*plant.states, *plant.inputs, *plant.parameters)]


def test_states_and_inputs_give_the_linear_model(new_instance: NewInstance, version: int) -> None:
    instance = new_instance(oscillator, version)
    unknowns, _ = names(oscillator)
    found = instance.sensitivity(unknowns, ["position", "velocity", "force"])
    m, d, k = 2.0, 1.5, 80.0
    rate = [-k / m, -d / m, 1 / m]
    assert np.allclose(found, [[0, 1, 0], rate, [1, 0, 0], [k, 0, 0], rate], rtol=1e-15, atol=0)


def test_all_columns_agree_with_central_differences(
    new_instance: NewInstance, version: int
) -> None:
    """In the middle of a run, parameters included; relative to the row's scale 1e-6."""
    instance = new_instance(hydraulic, version)
    instance.set(command=100.0)
    instance.run(["force"], 10, 0.01)
    unknowns, knowns = names(hydraulic)
    found = instance.sensitivity(unknowns, knowns)
    functions = plant_functions(hydraulic)
    point = np.array(instance.get(*knowns))
    scale = np.array([v.nominal for v in (*hydraulic.states, *hydraulic.inputs)])
    scale = np.concatenate([scale, np.abs(functions.p_start)])

    def value(z: np.ndarray) -> np.ndarray:
        x, u, p = z[:5], z[5:6], z[6:]
        return np.concatenate([functions.f(x, u, p), functions.h(x, u, p)])

    for j, size in enumerate(scale):
        step = np.zeros(len(point))
        step[j] = 1e-5 * size
        difference = (value(point + step) - value(point - step)) / (2e-5 * size)
        row_scale = np.abs(value(point)) / size + np.abs(found[:, j])
        assert np.all(np.abs(found[:, j] - difference) <= 1e-6 * row_scale), knowns[j]


def test_a_seed_mixes_the_columns(new_instance: NewInstance, version: int) -> None:
    instance = new_instance(hydraulic, version)
    unknowns, knowns = names(hydraulic)
    seed = np.random.default_rng(SEED).normal(size=len(knowns))
    rows = [instance.references[name] for name in unknowns]
    columns = [instance.references[name] for name in knowns]
    found = instance.fmu.getDirectionalDerivative(rows, columns, list(seed))
    parts = instance.sensitivity(unknowns, knowns) * seed
    assert np.allclose(found, parts.sum(axis=1), rtol=0, atol=1e-14 * np.abs(parts).sum())


def test_adjoint_is_the_transpose(new_instance: NewInstance) -> None:
    instance = new_instance(hydraulic, 3)
    unknowns, knowns = names(hydraulic)
    jacobian = instance.sensitivity(unknowns, knowns)
    rows = [instance.references[name] for name in unknowns]
    columns = [instance.references[name] for name in knowns]
    transposed = [
        instance.fmu.getAdjointDerivative([row], columns, [1.0], len(columns)) for row in rows
    ]
    assert np.array_equal(transposed, jacobian)


def test_output_derivatives_are_h_x_times_f(new_instance: NewInstance) -> None:
    """dy/dt of the oscillator's outputs with the force held."""
    instance = new_instance(oscillator, 2)
    instance.run(["position"], 7, 0.01)
    velocity, acceleration = instance.get("velocity", "der(velocity)")
    references = [instance.references[n] for n in ("position", "spring_force", "acceleration")]
    found = instance.fmu.getRealOutputDerivatives(references, [1, 1, 1])
    jerk = -80.0 / 2 * velocity - 1.5 / 2 * acceleration
    assert np.allclose(found, [velocity, 80 * velocity, jerk], rtol=1e-12, atol=0)
