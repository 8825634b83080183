"""The machine at the infinite bus: two equilibria a turn, their poles, and the energy balance."""

from math import cos, pi, sqrt

import casadi as ca
import numpy as np
import pytest

from fmus.linearization import linearize, parameter_values, plant_functions
from fmus.single_machine_infinite_bus.model import plant
from tests.fmus.plants.bench import Simulator, draw

SEED = 5
M = D = 0.06
REST = next(q.value for q in plant.parameters if q.name == "rest_angle")
SADDLE = pi - 2 * REST


@pytest.mark.parametrize("angle", [0.0, SADDLE, 2 * pi, SADDLE - 2 * pi])
def test_equilibria_without_control_and_their_poles(angle):
    """M s² + D s + cos δ = 0: a stable pair at rest, one pole on either side at the saddle."""
    x = np.array([angle, 0.0])
    assert np.abs(Simulator(plant).rate(x, np.zeros(2))).max() < 1e-14
    root = np.emath.sqrt(D * D - 4 * M * cos(angle + REST))
    expected = np.array([(-D - root) / (2 * M), (-D + root) / (2 * M)])
    found = linearize(plant, x, np.zeros(2)).eigenvalues()
    assert np.abs(np.sort_complex(found) - np.sort_complex(expected)).max() < 1e-12


def test_the_control_has_no_effect_where_the_sine_is_zero():
    for angle in (-REST, pi - REST):
        model = linearize(plant, np.array([angle, 0.0]), np.zeros(2))
        assert abs(model.B[1, 0]) < 1e-14
    assert linearize(plant, np.zeros(2), np.zeros(2)).B[1, 0] == pytest.approx(-0.8 / M, rel=1e-14)


def test_energy_changes_by_damping_and_what_the_inputs_do():
    f, h = plant_functions(plant)
    p = parameter_values(plant)
    x, u = ca.SX.sym("x", 2), ca.SX.sym("u", 2)
    names = [v.name for v in plant.outputs]
    y = h(x, u, p)
    rate = ca.jacobian(y[names.index("transient_energy")], x) @ f(x, u, p)
    along = ca.Function("along", [x, u], [rate, y])
    rng = np.random.default_rng(SEED)
    for _ in range(300):
        state, inputs = draw(plant, rng)
        found, outputs = along(state, inputs)
        power = float(outputs[names.index("electrical_power")])
        speed, field, turbine = state[1], inputs[0], inputs[1]
        raised = power * field / (1 + field)
        assert float(found) == pytest.approx(
            (turbine - raised - D * speed) * speed, rel=1e-10, abs=1e-10
        )


def test_without_damping_a_swing_ends_where_the_equal_area_criterion_says():
    """Released at rest at x_0, the machine turns back where P_in x + cos(x + δ_0) is the same."""
    released = 1.0
    run = Simulator(plant, {"damping": 0.0}).run(
        lambda t: (0.0, 0.0), 2.0, rtol=1e-10, start={"angle_deviation": released}
    )
    energy = run.output("transient_energy")
    assert np.abs(energy - energy[0]).max() < 1e-8
    level = 0.8 * released + cos(released + REST)
    low, high = -2.0, 0.0  # 0.8 x + cos(x + δ_0) rises there
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if 0.8 * middle + cos(middle + REST) < level else (low, middle)
    # The farthest sample misses the turning point by at most ω̇·Ts²/8.
    acceleration = abs(0.8 - sqrt(1 - cos(low + REST) ** 2)) / M
    assert low <= run.state("angle_deviation").min() < low + acceleration * 0.01**2 / 8 + 1e-8
