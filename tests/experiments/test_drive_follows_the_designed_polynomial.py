"""Without noise and with the full state, the FMU's load speed is the designed step response.

    ω_2/ω_ref = ω_r⁴/(s² + 2ξω_r·s + ω_r²)²

The design is in continuous time: sampled control comes to it as the sample time falls, with an
error of first order, and the extrapolated response is it. The lag of the torque loop, which the
design neglects, falls with the sample time here.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.signal import lti, step

from controllers.papers.serkies2013.two_mass_controller import TwoMassController
from fmus.two_mass_drive.model import plant
from harness.bench import Bench

OMEGA, XI, SIZE, STOP = 40.0, 0.7, 0.1, 0.3
COARSEST = 2e-3


def designed(time):
    pair = [1.0, 2 * XI * OMEGA, OMEGA**2]
    _, response = step(lti([OMEGA**4], np.polymul(pair, pair)), T=time)
    return SIZE * response


def response(T_2, sample_time, delay=0.0):
    """Load speed at multiples of the coarsest sample time; the torque lags by 2 % of a sample."""
    bench = Bench(stop_time=STOP, step=sample_time, record_step=COARSEST)
    start = {"torque_time_constant": sample_time / 50, "load_time_constant": T_2}
    bench.fmu("drive", plant.fmu(3), start_values=start, tolerance=1e-9)
    bench.controller("controller", TwoMassController(
        resonant_frequency=OMEGA, damping=XI, motor_time_constant=0.203, shaft_time_constant=1.2e-3,
    ))  # fmt: skip
    bench.signal("reference", "constant", value=SIZE)
    bench.signal("inertia", "constant", value=T_2, unit="s")
    bench.connect("reference.value", "controller.reference")
    bench.connect("inertia.value", "controller.load_time_constant")
    for output, target in (
        ("load_speed", "measured"),
        ("motor_speed", "motor_speed"),
        ("shaft_torque", "shaft_torque"),
        ("load_speed", "load_speed"),
    ):
        bench.connect(f"drive.{output}", f"controller.{target}")
    bench.connect("controller.u", "drive.torque_reference", delay=delay)
    result = bench.run()
    return result.time, result["drive.load_speed"]


@pytest.mark.parametrize("T_2", [0.1, 0.203, 0.406])
def test_order_one_and_the_limit(T_2):
    samples = [COARSEST / 2**k for k in range(2, 6)]
    runs = [response(T_2, sample) for sample in samples]
    wanted = designed(runs[0][0])
    errors = np.array([np.abs(y - wanted).max() for _, y in runs])
    assert errors[:-1] / errors[1:] == pytest.approx([2.0] * 3, abs=0.02)
    first = [2 * b[1] - a[1] for a, b in pairwise(runs)]
    second = (4 * first[-1] - first[-2]) / 3
    assert np.abs(second - wanted).max() < 1e-6 * SIZE


def test_at_the_papers_sample_time_and_delay_it_is_the_designed_one_a_little_late():
    """Half a sample of hold and 100 µs of dead time: 0.35 ms late at most, as a delay would be."""
    time, found = response(0.203, 5e-4, delay=1e-4)
    late = np.abs(found - designed(time)).max()
    steepest = np.abs(np.gradient(designed(time), time)).max()
    assert 0.1e-3 * steepest < late < 2 * 0.35e-3 * steepest
    assert found[-1] == pytest.approx(designed(time)[-1], rel=2e-3)
