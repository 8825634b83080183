"""Equations (39)–(47) against finite differences of U and of u, away from kinks."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from controllers.fuzzy.gradient import infer_gradient
from controllers.fuzzy.inference import FuzzySystem, Membership, grid_rules, infer
from controllers.fuzzy.membership import KINDS, PARAMETERS, membership, membership_gradient
from controllers.papers.ahn2009.fuzzy_pid import FuzzyPID
from controllers.papers.ahn2009.tuned_fuzzy_pid import TunedFuzzyPID
from controllers.papers.ahn2009.tuned_step import GRADIENT, THETA, tuned
from tests.controllers.compiled import run

H = 1e-6


def evaluate(system: FuzzySystem, theta: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, ...]:
    mu, firing, strength = (
        np.zeros(n) for n in (system.n_functions, len(system.rules), system.n_weights)
    )
    out, gradient, dmu = np.full(1, np.nan), np.zeros(len(theta)), np.zeros(system.n_functions)
    s = system.structure()
    infer(s, theta, x, mu, firing, strength, out)
    infer_gradient(s, theta, x, mu, firing, strength, out, 0, dmu, gradient)
    return out, gradient, mu, firing


def smooth_here(mu: np.ndarray, firing: np.ndarray, aggregation: str) -> bool:
    """No two memberships nearly equal, none nearly 0 or 1: all kinks are further than H."""
    levels = np.sort(np.concatenate([mu, [0.0, 1.0]]))
    gaps = np.diff(levels)
    apart = gaps[(levels[1:] > 0.0) & (levels[:-1] < 1.0)]
    if aggregation == "max":
        heights = np.unique(firing[firing > 0])
        products = np.diff(heights) if len(heights) > 1 else np.ones(1)
        return bool(np.all(apart > 1e-3) and np.all(products > 1e-3))
    return bool(np.all(apart > 1e-3))


@settings(max_examples=80, deadline=None)
@given(
    seed=st.integers(0, 100_000),
    implication=st.sampled_from(["min", "product"]),
    aggregation=st.sampled_from(["sum", "max"]),
)
def test_all_components_of_a_perturbed_paper_system(seed, implication, aggregation) -> None:
    rng = np.random.default_rng(seed)
    base = FuzzyPID(kp=(0, 1), ki=(0, 1), kd=(0, 1), error_range=1.0, error_rate_range=1.0)
    rules = base.system("pid"[seed % 3]).rules
    triangles = [
        tuple(
            Membership("triangular", (j / 4 + rng.uniform(-0.05, 0.05), *rng.uniform(0.2, 0.4, 2)))
            for j in range(5)
        )
        for _ in range(2)
    ]
    system = FuzzySystem(
        (triangles[0], triangles[1]), (tuple(rng.random(5)),), rules, implication, aggregation
    )
    theta, x = system.theta(), rng.random(2)
    _, gradient, mu, firing = evaluate(system, theta, x)
    assume(smooth_here(mu, firing, aggregation))
    for i in range(len(theta)):
        step = np.zeros(len(theta))
        step[i] = H
        upper, lower = (evaluate(system, theta + sign * step, x)[0][0] for sign in (1, -1))
        assert gradient[i] == pytest.approx((upper - lower) / (2 * H), abs=3e-8)


@settings(max_examples=100, deadline=None)
@given(kind=st.sampled_from(sorted(KINDS)), seed=st.integers(0, 100_000))
def test_membership_derivatives(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    q = rng.uniform(0.5, 1.5, len(PARAMETERS[kind]))
    if kind == "trapezoidal":
        q[1] = q[0] + rng.uniform(0.1, 1.0)
    x, code = rng.uniform(-1.0, 4.0), KINDS[kind]
    feet = [q[0], q[0] - q[1], q[0] + q[-1], q[0] - q[-2], q[1], q[1] + q[-1]]
    assume(kind in ("gaussian", "sigmoidal") or min(abs(x - np.array(feet))) > 1e-4)
    dq = np.full(len(q), np.nan)
    slope = membership_gradient(code, x, q, dq)
    expected = (membership(code, x + H, q) - membership(code, x - H, q)) / (2 * H)
    assert slope == pytest.approx(expected, abs=1e-8)
    for i in range(len(q)):
        step = np.eye(len(q))[i] * H
        expected = (membership(code, x, q + step) - membership(code, x, q - step)) / (2 * H)
        assert dq[i] == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_of_the_whole_control_signal(axis: int) -> None:
    # ∂u_PID/∂θ kept by the tuned block, against FuzzyPID run with θ moved by ±h.
    fields = {
        "kp": (1e-4, 5e-4),
        "ki": (0.0, 1e-3),
        "kd": (0.0, 1e-5),
        "error_range": 2000.0,
        "error_rate_range": 40000.0,
        "integration": "backward",
    }
    inputs = np.array([[2000.0, 300.0], [2000.0, 600.0], [2000.0, 867.0]])
    block = TunedFuzzyPID(
        sensitivity_bounds=(0.0, 0.0), q_centre=0, q_half_width=0, q_weight=0, **fields
    ).block(0.01)
    p, x, y = block.parameters, block.state.copy(), np.zeros(len(block.outputs))
    for u in inputs:
        block.step(p, x, u, y)
    theta, kept = (tuned(p, x, which).reshape(3, 35)[axis] for which in (THETA, GRADIENT))
    name = "theta_" + "pid"[axis]
    for i in range(35):
        moved = [tuple(theta + sign * H * np.eye(35)[i]) for sign in (1, -1)]
        up, down = (run(FuzzyPID(**{name: m}, **fields).block(0.01), inputs)[-1, 0] for m in moved)
        assert kept[i] == pytest.approx((up - down) / (2 * H), abs=1e-8)
    assert np.max(np.abs(kept)) > 1e-3


def test_a_rule_table_with_shared_functions_sums_over_all_rules() -> None:
    # One function of |e| in two firing rules: ∂U/∂a is the sum of both contributions.
    wide, flat = Membership("triangular", (0.5, 1.0, 1.0)), Membership("trapezoidal", (-9, 9, 1, 1))
    system = FuzzySystem(
        ((wide, flat), (flat, flat)), ((0.0, 1.0, 0.5),), grid_rules(((0, 1), (2, 2)))
    )
    _, gradient, _, _ = evaluate(system, system.theta(), np.array([0.2, 0.3]))
    # μ = 0.7, strengths (0.7, 0.7, 2): U = 1.7/3.4, slopes (0 − 0.5)/3.4 + (1 − 0.5)/3.4 = 0.
    assert gradient[0] == pytest.approx(0.0, abs=1e-15)
    system = FuzzySystem(
        ((wide, flat), (flat, flat)), ((0.0, 1.0, 0.5),), grid_rules(((1, 1), (2, 2)))
    )
    _, gradient, _, _ = evaluate(system, system.theta(), np.array([0.2, 0.3]))
    # strength of w_2 is 1.4 from two rules: U = 2.4/3.4, ∂U/∂μ = 2·(1 − U)/3.4, ∂μ/∂a = −1.
    assert gradient[0] == pytest.approx(-2 * (1 - 2.4 / 3.4) / 3.4, rel=1e-12)
