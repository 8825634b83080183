"""Co-simulation and model exchange under FMPy agree with scipy's Radau at rtol 1e-10."""

import numpy as np
import pytest
from fmpy import simulate_fmu
from scipy.integrate import solve_ivp

from fmus.packaging.plant.build import cached_fmu
from fmus.packaging.plant.functions import plant_functions
from fmus.plant import Plant
from tests.fmus.packaging.plants import hydraulic, oscillator, van_der_pol

H = 0.01
CASES = [(oscillator, {"force": 3.0}), (van_der_pol, {}), (hydraulic, {"command": 100.0})]


def reference(plant: Plant, inputs: dict[str, float], times: np.ndarray) -> np.ndarray:
    """States at `times`, shape (len(times), n_x)."""
    functions = plant_functions(plant)
    u = [inputs[variable.name] for variable in plant.inputs]
    scale = np.array([state.nominal for state in plant.states])
    solution = solve_ivp(
        lambda _t, x: functions.f(x, u),
        (0.0, times[-1]),
        functions.x_start,
        "Radau",
        times,
        rtol=1e-10,
        atol=1e-12 * scale,
        jac=lambda _t, x: functions.f_x(x, u),
    )
    return np.asarray(solution.y).T


@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize(("plant", "inputs"), CASES, ids=lambda c: getattr(c, "name", ""))
def test_states_agree_to_1e_5_of_their_range(
    plant: Plant, inputs: dict[str, float], version: int, interface: str
) -> None:
    names = [state.name for state in plant.states]
    result = simulate_fmu(
        str(cached_fmu(plant, version)),
        fmi_type=interface,
        stop_time=0.5,
        output_interval=H,
        step_size=H,
        start_values=inputs,
        output=names,
        relative_tolerance=1e-8,
    )
    exact = reference(plant, inputs, np.asarray(result["time"]))
    for i, name in enumerate(names):
        error = np.abs(result[name] - exact[:, i]).max()
        assert error <= 1e-5 * np.ptp(exact[:, i]), name


def test_an_oscillator_follows_its_closed_form(version: int) -> None:
    """mass x'' + damping x' + stiffness x = 0 from x(0) = 0.1 at rest."""
    result = simulate_fmu(
        str(cached_fmu(oscillator, version)),
        fmi_type="CoSimulation",
        stop_time=2.0,
        output_interval=H,
        output=["position"],
        relative_tolerance=1e-9,
    )
    mass, damping, stiffness = (p.value for p in oscillator.parameters)
    decay = damping / (2 * mass)
    omega = np.sqrt(stiffness / mass - decay**2)
    t = np.asarray(result["time"])
    exact = 0.1 * np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
    assert np.abs(result["position"] - exact).max() <= 1e-9
