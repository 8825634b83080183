"""The tuned controller around a leaky lagged integrator of about the lead plant's size.

104 000 N/s for full command, lag 10 ms, leak 1 s, sample time 10 ms, reference 2000 N; gains by
SIMC with ranges around them; the tuner's Q and R are the defaults. Paired over seeds.
"""

import numpy as np
import pytest
from scipy.linalg import expm

from controllers.core.block import Block
from controllers.papers.ahn2009.fuzzy_pid import FuzzyPID
from controllers.papers.ahn2009.tuned_fuzzy_pid import TunedFuzzyPID
from controllers.pid.design import simc_integrating
from controllers.pid.pid import Y_KP

T, SLOPE, LAG, LEAK = 0.01, 104_000.0, 0.01, 1.0
M = expm(np.array([[-1 / LEAK, SLOPE, 0], [0, -1 / LAG, 1 / LAG], [0, 0, 0]]) * T)
GAINS = simc_integrating(SLOPE, LAG + T / 2)
FIELDS = {
    "kp": (0.5 * GAINS.kp, 2.0 * GAINS.kp),
    "ki": (0.3 * GAINS.ki, 1.5 * GAINS.ki),
    "kd": (0.0, 0.01 * GAINS.kp),
    "error_range": 2000.0,
    "error_rate_range": 40_000.0,
    "derivative_filter": 0.02,
    "u_min": -1.0,
    "u_max": 1.0,
}
N = 500


def simulate(block: Block, seed: int, load: float) -> tuple[np.ndarray, np.ndarray]:
    """True force (N,) and outputs (N, n_y), with a load disturbance and 5 N of sensor noise."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(0.0, 5.0, N)
    push = load * (30.0 * np.sin(2 * np.pi * T * np.arange(N)) + rng.normal(0.0, 10.0, N))
    p, x, y = block.parameters.copy(), block.state.copy(), np.zeros(len(block.outputs))
    plant, force, rows = np.zeros(3), np.zeros(N), np.zeros((N, len(y)))
    for k in range(N):
        force[k] = plant[0]
        block.step(p, x, np.array([2000.0, force[k] + noise[k]]), y)
        rows[k], plant[2] = y, y[0]
        plant = M @ plant
        plant[0] += push[k]
    return force, rows


def rms(block: Block, seed: int, load: float) -> float:
    return float(np.sqrt(np.mean((simulate(block, seed, load)[0][200:] - 2000.0) ** 2)))


@pytest.mark.parametrize("filter_name", ["ekf", "robust_ekf"])
def test_tuning_lowers_the_error_under_a_load_disturbance(filter_name: str) -> None:
    tuned = TunedFuzzyPID(**FIELDS, filter=filter_name, sensitivity_bounds=(50.0, 1000.0)).block(T)
    plain = FuzzyPID(**FIELDS).block(T)
    ratios = [rms(tuned, seed, 1.0) / rms(plain, seed, 1.0) for seed in range(3)]
    assert max(ratios) < 0.9, ratios


def test_without_disturbance_it_settles_and_hardly_differs() -> None:
    tuned = TunedFuzzyPID(**FIELDS, sensitivity_bounds=(50.0, 1000.0)).block(T)
    force, _ = simulate(tuned, 0, 0.0)
    assert np.max(np.abs(force[200:] - 2000.0)) < 20.0


def test_with_the_papers_alignment_sensor_noise_alone_raises_kp() -> None:
    # The first-order change of U_p is h·P·hᵀ·innovation with the sign of e² (module docstring):
    # under pure sensor noise at a settled loop K_p climbs towards its maximum.
    fields = {**FIELDS, "sensitivity_bounds": (381.0, 381.0), "r": 100.0, "filter": "ekf"}
    paper, causal = (
        simulate(TunedFuzzyPID(**fields, alignment=a).block(T), 1, 0.0)[1][:, Y_KP]
        for a in ("paper", "causal")
    )
    assert paper[-100:].mean() > paper[200:300].mean() > FIELDS["kp"][0]
    assert paper[-100:].mean() > causal[-100:].mean()
