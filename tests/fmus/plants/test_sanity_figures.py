"""Figures that anyone can check by hand against the tables of Ahn & Truong (2009)."""

from math import pi

import numpy as np
import pytest

from fmus.hybrid_actuator.model import plant
from fmus.linearization import equilibrium
from tests.fmus.plants.bench import Simulator

value = {q.name: q.value for q in plant.parameters}
area_a = pi / 4 * value["piston_diameter"] ** 2
full_flow = value["rated_speed"] / (2 * pi) * value["pump_displacement"]


def test_full_speed_is_625_cm3_per_s_0_2_m_per_s_and_104_kn_per_s():
    assert full_flow == pytest.approx(625e-6, rel=1e-12)
    assert full_flow / area_a == pytest.approx(0.2, rel=5e-3)
    assert full_flow / area_a * value["spring_stiffness"] == pytest.approx(104e3, rel=2e-3)


def test_the_model_turns_a_command_into_the_force_rate_of_the_ideal_one():
    """A small steady command, less its leakage, compresses the spring as the ideal pump does."""
    simulator = Simulator(plant)
    command = 0.02
    run = simulator.run(lambda t: (command, 0.0, 0.0), 2.0)
    rate = np.diff(run.output("spring_force")[-51:]).mean() / 0.01
    pressures = run.output("pressure_a")[-51:].mean() - run.output("pressure_b")[-51:].mean()
    leakage = (value["internal_leakage"] + value["external_leakage"]) * pressures
    ideal = (command * full_flow - leakage) / area_a * value["spring_stiffness"]
    # The rest is oil that fills the compressed chamber: a few per cent.
    assert 0.93 * ideal < rate < ideal


def test_2000_n_is_3_85_mm_and_6_4_bar():
    x, u = equilibrium(plant, (0.0, 0.0, 0.0), "force", 2000.0)
    outputs = dict(
        zip((v.name for v in plant.outputs), Simulator(plant).outputs(x, u), strict=True)
    )
    assert outputs["position"] - value["stroke"] / 2 == pytest.approx(3.854e-3, rel=1e-3)
    assert outputs["pressure_a"] - outputs["pressure_b"] == pytest.approx(6.4e5, rel=5e-3)
    assert outputs["force_signal"] == pytest.approx(6.0, rel=1e-9)
    assert 0.0 < u[0] < 0.01
