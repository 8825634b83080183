"""The relief valves open at 175 bar above the reservoir and hold a piston at its end stop."""

import numpy as np

from fmus.hybrid_actuator.model import plant
from fmus.physics.valves import RELIEF_WIDTH, relief_valve
from tests.fmus.plants.bench import Simulator

CRACKING = 175e5
# The motor's rated torque stalls at 78 bar; a peak torque of 45 N·m reaches the relief valve.
PEAK_TORQUE = {"torque_limit": 45.0, "power_limit": 12e3}
AGAINST_STOP = {"rod_displacement": 0.070}


def run_into_stop(changed: dict[str, float]):
    # The environment has given way, so that the stop carries the piston.
    return Simulator(plant, changed).run(
        lambda t: (1.0, 0.075, 0.0), 0.5, rtol=1e-5, start=AGAINST_STOP
    )


def test_characteristic():
    assert float(relief_valve(CRACKING - RELIEF_WIDTH, CRACKING, 4.2e-10)) == 0.0
    assert float(relief_valve(CRACKING + 10e5, CRACKING, 4.2e-10)) == 4.2e-10 * 10e5


def test_peak_torque_against_the_end_stop_is_relieved_between_175_and_210_bar():
    run = run_into_stop(PEAK_TORQUE)
    pressure, flow = run.output("pressure_a"), run.output("relief_flow_a")
    assert pressure.max() < 210e5
    assert pressure[-1] > CRACKING
    assert flow[-1] > 1e-5
    assert np.all(flow[pressure < CRACKING - 2e5] == 0.0)


def test_at_rated_torque_only_the_shock_of_the_rotor_can_open_it():
    run = run_into_stop({})
    assert run.output("pressure_a").max() < 210e5
    assert run.output("relief_flow_a")[-1] == 0.0
    assert run.output("pressure_a")[-1] < 120e5
    assert run.output("position").max() < 0.150 + 5e-4
