"""The p-point estimator's numbers, and the identities among (18)–(23), (30), (32)."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.stats import norm

from controllers.core.errors import ControllerError
from controllers.kalman.p_point import PPoint, gaussian_score, score

masses = st.floats(1e-4, 0.98)


def test_published_numbers_for_five_percent() -> None:
    five = PPoint(0.05)
    assert five.gamma_p == pytest.approx(1.95996, abs=5e-6)
    assert five.s_m == pytest.approx(0.43848, abs=5e-6)
    assert pytest.approx(0.96523, abs=5e-6) == five.E


def far(one: PPoint) -> float:
    """Where the exponential tail of (20) has fallen by 60 e-folds, 1e-26: quadrature to infinity
    misses narrow tails."""
    rate = 2.0 * one.K / one.p * math.cos(0.5 / one.s_m) ** 2
    return one.gamma_p + 60.0 / rate


@settings(max_examples=60, deadline=None)
@given(p=masses)
def test_equations_18_21_22_hold(p: float) -> None:
    one = PPoint(p)
    s, tangent = one.s_m, np.tan(0.5 / one.s_m)
    assert norm.cdf(-one.gamma_p) == pytest.approx(p / 2, rel=1e-12)
    # the residual of (22) loses digits as tan grows like 1/√p; scaled by its own terms
    assert p * (1 + tangent**2) * (2 * s + tangent) == pytest.approx(2 * s, rel=1e-10)
    inside = 1 + s * np.sin(1 / s)
    assert one.K * one.gamma_p * inside == pytest.approx(1 - p, rel=1e-12)


@settings(max_examples=30, deadline=None)
@given(p=masses)
def test_density_integrates_to_one_with_mass_p_in_the_tails(p: float) -> None:
    one = PPoint(p)

    def f(g: float) -> float:
        return float(one.density(np.array(g)))

    inside = 2 * quad(f, 0.0, one.gamma_p, epsabs=1e-12)[0]
    outside = 2 * quad(f, one.gamma_p, far(one), epsabs=1e-12)[0]
    assert inside == pytest.approx(1 - p, abs=1e-9)
    assert outside == pytest.approx(p, abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(p=masses, ratio=st.floats(-3.0, 3.0).filter(lambda r: abs(abs(r) - 1.0) > 1e-3))
def test_score_is_minus_the_log_derivative(p: float, ratio: float) -> None:
    one = PPoint(p)
    gamma, h = ratio * one.gamma_p, 1e-5 * one.gamma_p
    logs = np.log(one.density(np.array([gamma - h, gamma + h])))
    slope = float(logs[1] - logs[0]) / (2 * h)
    scale = one.score()[4]  # the largest |ψ|
    assert score(one.score(), gamma) == pytest.approx(-slope, abs=2e-6 * scale)


@settings(max_examples=30, deadline=None)
@given(p=masses)
def test_factor_32_is_the_fisher_information(p: float) -> None:
    one, q = PPoint(p), PPoint(p).score()

    def integrand(g: float) -> float:
        return score(q, g) ** 2 * float(one.density(np.array(g)))

    ends = ((0.0, one.gamma_p), (one.gamma_p, far(one)))
    information = 2 * sum(quad(integrand, *end, epsabs=1e-12)[0] for end in ends)
    assert pytest.approx(information, rel=1e-7) == one.E
    assert pytest.approx(one.K / (one.s_m**2 * one.gamma_p), rel=1e-9) == one.E


@given(p=masses, a=st.floats(-50, 50), b=st.floats(-50, 50))
def test_score_is_odd_monotone_and_bounded(p: float, a: float, b: float) -> None:
    q = PPoint(p).score()
    low, high = sorted((a, b))
    assert score(q, -a) == -score(q, a)
    assert score(q, low) <= score(q, high)
    assert abs(score(q, a)) <= q[4] * (1 + 1e-14)


def test_information_is_below_the_gaussian_one_and_vanishes_with_p() -> None:
    # The standard normal (information 1) is in the family, f_0 minimises: E < 1 for every p.
    values = [PPoint(p).E for p in np.geomspace(1e-9, 1 - 1e-6, 60)]
    assert max(values) < 0.97690
    assert values[0] < 0.27
    assert pytest.approx(2 / np.pi, abs=1e-6) == PPoint(1 - 1e-7).E
    assert score(gaussian_score(), 12.5) == 12.5


def test_faults_are_named() -> None:
    with pytest.raises(ControllerError, match=r"PPoint\.p: expected a mass"):
        PPoint(0.0)
