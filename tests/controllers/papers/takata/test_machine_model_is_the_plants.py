"""The filter's model of the machine is the plant: f, Jacobians and noise, by CasADi."""

import casadi as ca
import numpy as np
import pytest

from controllers.core.errors import ControllerError
from controllers.papers.takata.machine_model import MachineParameters
from fmus.linearization import parameter_values, plant_functions
from fmus.single_machine_infinite_bus.model import plant

SEED = 8
CHANGED = {"inertia": 0.05, "damping": 0.1, "line_reactance": 0.7, "mechanical_power": 0.6}


@pytest.mark.parametrize("changed", [{}, CHANGED])
@pytest.mark.parametrize("with_input", [True, False])
def test_rate_jacobian_and_noise(changed, with_input):
    model = MachineParameters(**changed, input_in_jacobian=with_input).model()
    f, _ = plant_functions(plant)
    p = parameter_values(plant, {**changed, "rest_angle": float(model.parameters[4])})
    x, u = ca.SX.sym("x", 2), ca.SX.sym("u", 2)
    rate = f(x, u, p)
    given = u if with_input else ca.vertcat(0, 0)
    exact = ca.Function("exact", [x, u], [
        rate, ca.jacobian(f(x, given, p), x), ca.jacobian(rate, u[0])
    ])  # fmt: skip
    rng = np.random.default_rng(SEED)
    for _ in range(200):
        state, control = rng.uniform((-4, -12), (4, 12)), rng.uniform(-10, 10)
        for function, expected in zip(
            (model.rate, model.jacobian, model.noise), exact(state, [control, 0.0]), strict=True
        ):
            out = np.full(expected.numel(), np.nan)
            function(model.parameters, state, np.array([control]), out)
            wanted = expected.full().ravel()
            assert np.abs(out - wanted).max() < 1e-13 * (1 + np.abs(wanted).max())


def test_the_rest_is_an_equilibrium_and_too_much_power_is_refused():
    rate = np.empty(2)
    model = MachineParameters(mechanical_power=0.5).model()
    model.rate(model.parameters, np.zeros(2), np.zeros(1), rate)
    assert np.abs(rate).max() < 1e-14
    with pytest.raises(ControllerError, match="less than P_max = 1"):
        MachineParameters(mechanical_power=1.2)
