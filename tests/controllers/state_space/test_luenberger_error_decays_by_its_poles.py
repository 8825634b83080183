"""The error of a Luenberger observer obeys the polynomial of its poles; it is 0 if it starts at 0.

The plant is stepped by scipy's matrix exponential, which shares no code with the observer.
"""

import numpy as np
import pytest
from scipy.linalg import expm

from controllers.core.errors import ControllerError
from controllers.state_space.luenberger import Luenberger
from tests.controllers.compiled import run

T = 5e-4
DRIVE = {  # motor speed, load speed, shaft torque, load torque; only the first is measured
    "A": ((0.0, 0.0, -5.0, 0.0), (0.0, 0.0, 5.0, -5.0), (833.0, -833.0, 0.0, 0.0), (0.0,) * 4),
    "B": ((5.0,), (0.0,), (0.0,), (0.0,)),
    "C": ((1.0, 0.0, 0.0, 0.0),),
}
POLES = (-60.0, -80.0, (-40.0, 30.0), (-40.0, -30.0))


def errors(
    observer: Luenberger, x_0: np.ndarray, share: float = 0.0, samples: int = 60
) -> np.ndarray:
    """x − x̂ over samples of a plant that obeys the same model under a random input."""
    A, B, C = (np.array(m) for m in (observer.A, observer.B, observer.C))
    n, n_u = B.shape
    big = expm(np.block([[A, B], [np.zeros((n_u, n + n_u))]]) * T)
    Phi, Gamma = big[:n, :n], big[:n, n:]
    u = np.random.default_rng(7).normal(size=(samples, n_u))
    x, states = x_0.astype(float), []
    for k, now in enumerate(u):
        if k:
            x = Phi @ x + Gamma @ (share * now + (1.0 - share) * u[k - 1])
        states.append(x)
    true = np.array(states)
    rows = run(observer.block(T), np.column_stack([true @ C.T, u]))
    return true - rows[:, :n]


def residual(error: np.ndarray, poles: np.ndarray) -> float:
    """By how much a sequence misses the recursion that has the poles' polynomial, relative."""
    c = np.real(np.poly(np.exp(poles * T)))
    terms = np.array([c[i] * error[len(c) - 1 - i : len(error) - i] for i in range(len(c))])
    return float(np.abs(terms.sum(axis=0)).max() / np.abs(terms).max())


@pytest.mark.parametrize("late", [T, 2e-4, 0.0])
def test_of_one_measurement(late: float) -> None:
    observer = Luenberger(**DRIVE, poles=POLES, input_delay=late)
    error = errors(observer, np.array([0.1, -0.2, 0.3, 0.4]), 1.0 - late / T)
    assert residual(error, observer.eigenvalues) < 1e-9
    assert np.abs(errors(observer, np.zeros(4), 1.0 - late / T)).max() < 1e-12


def test_of_two_measurements() -> None:
    seen = DRIVE | {"C": ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0))}
    observer = Luenberger(**seen, poles=POLES)
    assert residual(errors(observer, np.ones(4)), observer.eigenvalues) < 1e-9


def test_faster_poles_forget_sooner_and_pass_more_noise() -> None:
    noise = np.random.default_rng(1).normal(size=(4000, 1))
    left, passed = [], []
    for factor in (1.0, 3.0):
        poles = tuple(-factor * s for s in (50.0, 60.0, 70.0, 80.0))
        observer = Luenberger(**DRIVE, poles=poles)
        left.append(np.abs(errors(observer, np.ones(4), samples=400)[-1]).max())
        rows = run(observer.block(T), np.column_stack([noise, np.zeros_like(noise)]))
        passed.append(rows[1000:, 1].std())
    assert left[1] < left[0] and passed[1] > 2.0 * passed[0]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"C": ((0.0, 0.0, 0.0, 1.0),)}, "observable model of 4 states, received '1 of them'"),
        ({"poles": (-1.0, -2.0, -3.0)}, "4 poles, complex ones with their conjugates"),
        ({"poles": (-1.0, -2.0, -3.0, (-4.0, 1.0))}, "with their conjugates"),
        ({"B": ((1.0,), (0.0,))}, "Luenberger.B: expected 4 rows"),
        ({"states": ("a", "b")}, "Luenberger.states: expected 4 names"),
        ({"A": ((1.0, 2.0),)}, "Luenberger.A: expected rows of 1 numbers"),
        ({"input_delay": 1.0}, "0 to the sample time"),
    ],
)
def test_what_cannot_be_meant(change: dict, sentence: str) -> None:
    with pytest.raises(ControllerError, match=sentence):
        Luenberger(**{**DRIVE, "poles": POLES, **change}).block(T)
