"""No chamber reaches vapour pressure, whatever the command and the environment do."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fmus.disturbance_generator.model import plant as generator
from fmus.hybrid_actuator.model import plant as hybrid
from tests.fmus.plants.bench import Run, Simulator

commands = st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=8)
speeds = st.lists(st.floats(-0.5, 0.5), min_size=8, max_size=8)
forces = st.lists(st.floats(-3e4, 3e4), min_size=8, max_size=8)
SLOT = 0.05  # s; commands and motions hold this long


def at(values: list[float], time: float) -> float:
    return values[min(int(time / SLOT + 1e-9), len(values) - 1)]


def assert_above_vapour_pressure(run: Run) -> None:
    vapour = next(q.value for q in run.plant.parameters if q.name == "vapour_pressure")
    assert np.isfinite(run.x).all()
    assert run.output("pressure_a").min() > vapour
    assert run.output("pressure_b").min() > vapour


@settings(max_examples=6, deadline=None, derandomize=True)
@given(commands, speeds)
def test_hybrid_actuator(command, speed):
    simulator = Simulator(hybrid)
    travelled = np.concatenate([[0.0], np.cumsum(speed) * SLOT])
    edges = SLOT * np.arange(len(travelled))

    def inputs(t: float) -> tuple[float, float, float]:
        return at(command, t), float(np.interp(t, edges, travelled)), at(speed, t)

    assert_above_vapour_pressure(simulator.run(inputs, SLOT * 8, rtol=1e-5))


@settings(max_examples=6, deadline=None, derandomize=True)
@given(commands, forces)
def test_disturbance_generator(command, force):
    simulator = Simulator(generator)
    run = simulator.run(lambda t: (at(command, t), at(force, t)), SLOT * 8, rtol=1e-5)
    assert_above_vapour_pressure(run)


def test_a_rod_pulled_out_hard_with_the_motor_at_rest_still_has_oil():
    """0.5 m/s of environment outruns the make-up valve: the chamber thins and stays above."""
    simulator = Simulator(hybrid, {"make_up_rated_flow": 1e-6, "pilot_rated_flow": 1e-6})
    run = simulator.run(lambda t: (0.0, 0.5 * t, 0.5), 0.4, rtol=1e-5)
    assert_above_vapour_pressure(run)
    assert run.output("pressure_a").min() < 2e4
