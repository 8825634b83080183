"""The two-mass drive obeys (1)–(3) of Serkies & Szabat 2013, and what follows from them."""

from math import sqrt

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import expm

from fmus.linearization import linearize, parameter_values, plant_functions
from fmus.two_mass_drive.model import NOMINAL, plant
from harness.bench import Bench
from tests.fmus.plants.bench import Simulator, draw

SEED = 4
T_C = 1.2e-3
VALUES = {q.name: q.value for q in plant.parameters}


def test_rates_are_those_of_the_paper():
    f, _ = plant_functions(plant)
    rng = np.random.default_rng(SEED)
    for _ in range(50):
        x, u = draw(plant, rng)
        m_e, w_1, w_2, m_s, _angle = x
        rate = f(x, u, parameter_values(plant)).full().ravel()
        expected = [(m_e - m_s) / NOMINAL, (m_s - u[1]) / u[2], (w_1 - w_2) / T_C]
        assert rate[1:4] == pytest.approx(expected, rel=1e-12)
        assert rate[4] == VALUES["base_speed"] * w_1


def test_energy_changes_by_supply_less_losses_also_with_friction():
    f, h = plant_functions(plant)
    changed = {"shaft_damping": 0.3, "motor_friction": 0.02, "load_friction": 0.05}
    p = parameter_values(plant, changed)
    x, u = ca.SX.sym("x", 5), ca.SX.sym("u", 3)
    y = h(x, u, p)
    names = [v.name for v in plant.outputs]
    rate = ca.jacobian(y[names.index("stored_energy")], x) @ f(x, u, p)
    books = ca.Function("books", [x, u], [rate, y])
    rng = np.random.default_rng(SEED)
    for _ in range(200):
        found, values = books(*draw(plant, rng))
        y_now = dict(zip(names, values.full().ravel(), strict=True))
        supplied = y_now["motor_power"] - y_now["load_power"] - y_now["dissipated_power"]
        assert abs(float(found) - supplied) < 1e-12 * (1 + abs(supplied))
        assert y_now["dissipated_power"] >= 0.0


@pytest.mark.parametrize("T_2", [NOMINAL / 2, NOMINAL, 2 * NOMINAL])
def test_the_free_shaft_swings_at_its_resonance(T_2):
    model = linearize(plant, np.zeros(5), np.array([0.0, 0.0, T_2]))
    swing = model.eigenvalues().imag.max()
    assert swing == pytest.approx(sqrt((1 / NOMINAL + 1 / T_2) / T_C), rel=1e-12)


def test_the_torque_never_exceeds_its_limit_and_small_ones_are_exact():
    simulator = Simulator(plant)
    for wanted, reached in ((10.0, 3.0), (-10.0, -3.0), (2.9, 2.9), (-2.9, -2.9), (0.0, 0.0)):
        rate = simulator.rate(np.zeros(5), np.array([wanted, 0.0, NOMINAL]))
        assert rate[0] * VALUES["torque_time_constant"] == pytest.approx(reached, abs=1e-12)
    corner = np.linspace(2.98, 3.02, 401)
    torque = [simulator.rate(np.zeros(5), np.array([m, 0.0, NOMINAL]))[0] for m in corner]
    assert np.all(np.diff(torque) >= -1e-9) and max(torque) * 1e-4 <= 3.0 + 1e-12


def test_no_load_is_without_inertia():
    simulator = Simulator(plant)
    floor = VALUES["smallest_load_time_constant"]
    x = np.array([0.0, 0.0, 0.0, 1.0, 0.0])
    for T_2, taken in ((-1.0, floor), (0.0, floor), (1.5 * floor, 1.5 * floor), (0.1, 0.1)):
        assert simulator.rate(x, np.array([0.0, 0.0, T_2]))[2] == pytest.approx(1 / taken)


@pytest.mark.parametrize("version", [2, 3])
def test_the_fmu_follows_the_matrix_exponential_while_the_inertia_changes(version):
    """Linear between the samples, so exact there; the speed does not jump with T_2."""
    step = 5e-4
    bench = Bench(stop_time=0.2, step=step, fmi_version=version)
    bench.fmu("drive", plant.fmu(version), tolerance=1e-10)
    bench.signal("torque", "sine", amplitude=1.0, frequency=13.0)
    bench.signal("load", "step", time=0.05, final=0.7)
    bench.signal("inertia", "multi_step", times=(0.0, 0.1), values=(0.203, 0.406))
    bench.connect("torque.value", "drive.torque_reference")
    bench.connect("load.value", "drive.load_torque")
    bench.connect("inertia.value", "drive.load_time_constant")
    result = bench.run()
    outputs = ["electromagnetic_torque", "motor_speed", "load_speed", "shaft_torque", "motor_angle"]
    found = np.column_stack([result[f"drive.{name}"] for name in outputs])
    x = np.zeros(5)
    models = {T: linearize(plant, x, np.array([0.0, 0.0, T])) for T in (0.203, 0.406)}
    for k in range(len(result.time) - 1):
        u = [result[f"drive.{v.name}"][k] for v in plant.inputs]
        model = models[u[2]]
        A, B = model.A, model.B[:, :2]
        whole = expm(np.block([[A, B], [np.zeros((2, 7))]]) * step)
        x = whole[:5, :5] @ x + whole[:5, 5:] @ np.array(u[:2])
        assert found[k + 1] == pytest.approx(x, abs=2e-8)
