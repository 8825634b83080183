"""With the fuzzy outputs held constant the fuzzy PID is the PID, bit for bit."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.papers.ahn2009.fuzzy_pid import FuzzyPID
from controllers.pid.pid import N_LAW_OUTPUT, PID
from tests.controllers.compiled import run

T = 0.01
fraction = st.floats(0.0, 1.0)
bound = st.floats(1e-6, 1.0)


@settings(max_examples=20, deadline=None)
@given(
    u=st.tuples(fraction, fraction, fraction),
    low=st.tuples(bound, bound, bound),
    span=st.tuples(bound, bound, bound),
    law=st.sampled_from(["forward", "trapezoidal"]),
    implication=st.sampled_from(["min", "product"]),
    seed=st.integers(0, 99),
)
def test_constant_weights_give_the_pid(u, low, span, law, implication, seed) -> None:
    pairs = [(a, a + b) for a, b in zip(low, span, strict=True)]
    gains = [a + c * (high - a) for (a, high), c in zip(pairs, u, strict=True)]
    common = {"integration": law, "derivative_filter": 0.02, "u_min": -2.0, "u_max": 2.0}
    triangles = [v for j in range(5) for v in (j * 0.25, 0.25, 0.25)] * 2
    fuzzy = FuzzyPID(
        kp=pairs[0],
        ki=pairs[1],
        kd=pairs[2],
        error_range=3.0,
        error_rate_range=50.0,
        theta_p=(*triangles, *[u[0]] * 5),
        theta_i=(*triangles, *[u[1]] * 5),
        theta_d=(*triangles, *[u[2]] * 5),
        implication=implication,
        **common,
    )
    plain = PID(kp=gains[0], ki=gains[1], kd=gains[2], **common)
    inputs = np.random.default_rng(seed).normal(0.0, 2.0, (60, 2))
    expected = run(plain.block(T), inputs)
    np.testing.assert_array_equal(run(fuzzy.block(T), inputs)[:, :N_LAW_OUTPUT], expected)
