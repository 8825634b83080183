"""At the 0.1 ms of its paper the servo's FMU is as accurate as at longer steps."""

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from fmus.electro_hydraulic_servo.model import STATES, plant
from fmus.linearization import parameter_values, plant_functions
from harness.bench import Bench
from harness.results.result import Result


def simulated(step: float) -> Result:
    """The paper's current for 0.95 s and 0.05 s of none."""
    bench = Bench(stop_time=1.0, step=step)
    bench.fmu("plant", plant.fmu(3))
    times, values = [0.0, 0.95], [1e-3, 0.0]
    bench.signal("current", "multi_step", times=times, values=values, unit="A")
    bench.connect("current.value", "plant.current")
    return bench.run()


def test_sample_time_of_the_paper_agrees_with_radau() -> None:
    """At 0.1 ms, the fastest state included, to 1e-5 of its range."""
    f, _ = plant_functions(plant)
    p = parameter_values(plant)
    x, u = ca.SX.sym("x", 4), ca.SX.sym("u", 3)
    slope = ca.Function("slope", [x, u], [ca.jacobian(f(x, u, p), x)])
    result = simulated(1e-4)
    state, begin = np.zeros(4), 0.0
    for end, current in ((0.95, 1e-3), (1.0, 0.0)):
        held = [current, 0.0, 0.0]
        rows = (result.time >= begin - 1e-9) & (result.time <= end + 1e-9)
        solution = solve_ivp(
            lambda t, z, held=held: f(z, held, p).full().ravel(),
            (begin, end), state, "Radau", np.clip(result.time[rows], begin, end),
            jac=lambda t, z, held=held: slope(z, held).full(),
            rtol=1e-10, atol=1e-13 * np.array([s.nominal for s in STATES]) / 1e-3,
        )  # fmt: skip
        for i, s in enumerate(STATES):
            shown = result[f"plant.{s.name}"]
            error = np.abs(shown[rows] - solution.y[i]).max()
            assert error <= 1e-5 * np.ptp(shown), s.name
        state, begin = solution.y[:, -1], end
